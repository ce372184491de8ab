"""What keys of a case take: counts, which have no value between two whole numbers, or units."""

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
    """Tell whether what a key takes is a whole number, as of teeth, copies or positions.

    Parameters
    ----------
    path : tuple of str or int
        The key; it need not be in a case.
    """
    return any(map(_is_whole, _kinds(path)))


@cache
def unit_of(path: Path) -> str:
    """Return the SI unit of what a key takes, empty where that is a bare number.

    Parameters
    ----------
    path : tuple of str or int
        The key; it need not be in a case.
    """
    return next((d.unit for kind in _kinds(path) for d in _dimensions(kind)), "")


def _kinds(path: Path) -> list[Any]:
    """Annotations of what is at a key."""
    kinds: list[Any] = [Content]
    for step in path:
        kinds = [below for kind in kinds for below in _below(kind, step)]
    return kinds


def _below(kind: Any, step: str | int) -> Iterator[Any]:
    """Yield the annotations of what is at a key, or a place of a list, of such a value."""
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
    """Yield what the values of an annotation may measure."""
    if isinstance(kind, Dimension):
        yield kind
    for inner in get_args(kind):
        yield from _dimensions(inner)


def _is_whole(kind: Any) -> bool:
    """Whether a value of an annotation may be a whole number alone, lists and tables apart."""
    if kind is int:
        return True
    return get_origin(kind) not in (dict, tuple) and any(map(_is_whole, get_args(kind)))
