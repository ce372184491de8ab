"""Arguments besides the case: checked, with errors that say what is allowed."""

from __future__ import annotations

from collections.abc import Iterable
from numbers import Integral


def whole(name: str, given: object) -> int:
    """Return a whole number, of NumPy as well, as Python's.

    Raises
    ------
    ValueError
        If it is none, or below 1.
    """
    if not isinstance(given, Integral) or isinstance(given, bool) or given < 1:
        raise ValueError(f"{name} {given!r}; allowed: a whole number from 1 on")
    return int(given)


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
