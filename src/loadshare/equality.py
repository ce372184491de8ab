"""Equality of results: the same content, number by number."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any


class Comparable:
    """An object that equals another of its class with the same content, such as its own pickle."""

    __slots__ = ()

    def _said(self) -> Any:
        """Return all that is compared."""
        return _fields(self)

    def __eq__(self, other: object) -> bool:
        """Return whether another of its class has the same content; NaN equals NaN."""
        if not isinstance(other, type(self)):
            return NotImplemented
        return same(self._said(), other._said())

    def __hash__(self) -> int:
        """Return a hash of the class alone: it may be kept in sets without reading its content."""
        return hash(type(self))


def same(one: Any, other: Any) -> bool:
    """Return whether two values, and all that they hold, are the same."""
    if isinstance(one, Mapping):
        alike = isinstance(other, Mapping) and one.keys() == other.keys()
        return alike and all(same(one[key], other[key]) for key in one)
    if isinstance(one, tuple | list):
        return len(one) == len(other) and all(map(same, one, other))
    if hasattr(one, "dtype"):
        # Imported here, so that commands that compute nothing do not load it.
        import numpy as np

        return np.array_equal(one, other, equal_nan=one.dtype.kind == "f")
    if is_dataclass(one) and not isinstance(one, Comparable):
        return type(one) is type(other) and same(_fields(one), _fields(other))
    return bool(one == other or (one != one and other != other))


def _fields(one: Any) -> dict[str, Any]:
    return {f.name: getattr(one, f.name) for f in fields(one) if f.compare}
