"""When two results are equal: where they say the same, number by number."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any


class Comparable:
    """What is equal to another of its kind that says the same, such as its own pickle."""

    __slots__ = ()

    def _said(self) -> Any:
        """Return all by which it is compared."""
        return _fields(self)

    def __eq__(self, other: object) -> bool:
        """Whether another of its kind says the same; no number is equal to no number."""
        if not isinstance(other, type(self)):
            return NotImplemented
        return same(self._said(), other._said())

    def __hash__(self) -> int:
        """Let it be kept in sets, without a look at all that it holds."""
        return hash(type(self))


def same(one: Any, other: Any) -> bool:
    """Whether two values are the same, and all that they hold."""
    if isinstance(one, Mapping):
        alike = isinstance(other, Mapping) and one.keys() == other.keys()
        return alike and all(same(one[key], other[key]) for key in one)
    if isinstance(one, tuple | list):
        return len(one) == len(other) and all(map(same, one, other))
    if hasattr(one, "dtype"):
        # Here, so that commands that compute nothing do without it.
        import numpy as np

        return np.array_equal(one, other, equal_nan=one.dtype.kind == "f")
    if is_dataclass(one) and not isinstance(one, Comparable):
        return type(one) is type(other) and same(_fields(one), _fields(other))
    return bool(one == other or (one != one and other != other))


def _fields(one: Any) -> dict[str, Any]:
    return {f.name: getattr(one, f.name) for f in fields(one) if f.compare}
