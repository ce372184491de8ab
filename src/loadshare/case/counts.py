"""Which keys of a case take whole numbers, and the dimensions of the others."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import Any, get_args, get_origin

from loadshare.case.content import Content
from loadshare.case.described import kinds_at
from loadshare.case.keys import Path
from loadshare.case.quantity import Dimension


@cache
def takes_count(path: Path) -> bool:
    """Tell whether a key takes a whole number, such as a number of teeth, copies or positions.

    Parameters
    ----------
    path : tuple of str or int
        The key; it need not be in a case.
    """
    return any(map(_is_whole, kinds_at(Content, path)))


@cache
def dimension_of(path: Path) -> Dimension | None:
    """Return the dimension of a key's value; None for a bare number.

    Parameters
    ----------
    path : tuple of str or int
        The key; it need not be in a case.
    """
    return next((d for kind in kinds_at(Content, path) for d in _dimensions(kind)), None)


def _dimensions(kind: Any) -> Iterator[Dimension]:
    """Yield the dimensions that an annotation allows."""
    if isinstance(kind, Dimension):
        yield kind
    for inner in get_args(kind):
        yield from _dimensions(inner)


def _is_whole(kind: Any) -> bool:
    """Return whether an annotation allows a single whole number, outside lists and tables."""
    if kind is int:
        return True
    return get_origin(kind) not in (dict, tuple) and any(map(_is_whole, get_args(kind)))
