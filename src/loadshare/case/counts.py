"""Which keys of a case take whole numbers, and the SI units of the others."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import Any, get_args, get_origin

from loadshare.case.content import Content
from loadshare.case.element import Element
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
    return any(map(_is_whole, _kinds(path)))


@cache
def unit_of(path: Path) -> str:
    """Return the SI unit of a key's value; empty for a bare number.

    Parameters
    ----------
    path : tuple of str or int
        The key; it need not be in a case.
    """
    return next((d.unit for kind in _kinds(path) for d in _dimensions(kind)), "")


def _kinds(path: Path) -> list[Any]:
    """Return the annotations of the value at a key."""
    kinds: list[Any] = [Content]
    for step in path:
        kinds = [below for kind in kinds for below in _below(kind, step)]
    return kinds


def _below(kind: Any, step: str | int) -> Iterator[Any]:
    """Yield the annotations of what such a value holds at a key or list index."""
    if isinstance(kind, type) and issubclass(kind, Element):
        fields = {about.alias or name: about for name, about in kind.model_fields.items()}
        if step in fields:
            yield fields[str(step)].annotation
            yield from fields[str(step)].metadata
    elif get_origin(kind) is dict:
        yield get_args(kind)[1]
    elif get_origin(kind) is tuple:
        if isinstance(step, int):
            yield get_args(kind)[0]
    else:
        for inner in get_args(kind):
            yield from _below(inner, step)


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
