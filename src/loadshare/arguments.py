"""Checks of arguments other than the case, with errors that say what is allowed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from numbers import Integral


def whole(name: str, given: object, least: int = 1) -> int:
    """Return a whole number, Python's or NumPy's, as an int.

    Raises
    ------
    ValueError
        If it is not a whole number, or below the least.
    """
    if not isinstance(given, Integral) or isinstance(given, bool) or given < least:
        raise ValueError(f"{name} {given!r}; allowed: a whole number from {least} on")
    return int(given)


def check_mapping(wanted: str, example: str, given: object) -> None:
    """Check that a mapping is given.

    Raises
    ------
    TypeError
        If it is not a mapping.
    """
    if not isinstance(given, Mapping):
        raise TypeError(f"{wanted} are expected, as in {example}, not {type(given).__name__}")


def one_of(name: str, given: object, allowed: Iterable[str]) -> None:
    """Check that a word is one of those that are allowed.

    Raises
    ------
    ValueError
        If it is not.
    """
    words = tuple(allowed)
    if not isinstance(given, str) or given not in words:
        raise ValueError(f"unknown {name} {given!r}; allowed: {', '.join(words)}")
