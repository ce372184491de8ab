"""Figures that are computed when they are first read: few users look at all of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any, TypeVar

Value = TypeVar("Value")


def known(value: Value) -> Callable[[], Value]:
    """Return a function that returns a known value, where another might compute it later."""
    return partial(_itself, value)


def _itself(value: Value) -> Value:
    return value


@dataclass(frozen=True, eq=False)
class Later(Mapping[str, Value]):
    """A mapping that is made when it is first read.

    Attributes
    ----------
    make : callable
        Takes no arguments and returns the mapping.
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
        """Return how to pickle it: as a plain dict of what it holds."""
        return dict, (dict(self),)
