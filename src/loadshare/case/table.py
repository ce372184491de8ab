"""Immutable tables, in which cases and results hold their parts by name."""

from __future__ import annotations

from typing import Any, NoReturn, TypeVar

Item = TypeVar("Item")


class Table(dict[str, Item]):
    """A table that cannot be changed, so that what is known of its case stays true."""

    def _refuse(self, *_: object, **__: object) -> NoReturn:
        raise TypeError("cases and results cannot be changed; Case.replace makes a new case")

    __setitem__ = __delitem__ = __ior__ = _refuse
    clear = pop = popitem = setdefault = update = _refuse

    def __reduce__(self) -> tuple[type[Table[Item]], tuple[dict[str, Any]]]:
        """Copy and pickle it as a whole; by default it would be filled name by name."""
        return type(self), (dict(self),)


def fixed(value: Any) -> Any:
    """Return a dictionary as a table, and anything else as it is."""
    return Table(value) if type(value) is dict else value
