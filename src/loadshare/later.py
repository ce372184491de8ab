"""Figures that are computed when they are first asked for: few who solve look at all of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any, TypeVar

Value = TypeVar("Value")


def known(value: Value) -> Callable[[], Value]:
    """Return what hands out a value that is at hand, where one may be computed later."""
    return partial(_itself, value)


def _itself(value: Value) -> Value:
    return value


@dataclass(frozen=True, eq=False)
class Later(Mapping[str, Value]):
    """A mapping that is made when it is first looked into.

    Attributes
    ----------
    make : callable
        Without arguments; returns the mapping.
    """

    make: Callable[[], Mapping[str, Value]]

    @cached_property
    def _made(self) -> Mapping[str, Value]:
        return self.make()

    def __getitem__(self, key: str) -> Value:
        return self._made[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._made)

    def __len__(self) -> int:
        return len(self._made)

    def __repr__(self) -> str:
        """Show what it holds, as a dict does."""
        return repr(dict(self))

    def __reduce__(self) -> tuple[Any, ...]:
        """Be handed to another process as what it holds."""
        return dict, (dict(self),)
