"""Pictures of results, requested by the packages that compute these.

The package that draws lies above them; `loadshare`, which knows every package, registers it here.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

__all__ = ["Figure", "picture", "register_drawing"]

if TYPE_CHECKING:
    from loadshare.report.figure import Figure
else:
    Figure = Any

_drawing: list[Callable[[], Callable[..., Figure]]] = []


def register_drawing(who: Callable[[], Callable[..., Figure]]) -> None:
    """Register `who`, which is called when a picture is requested and returns what draws it."""
    _drawing[:] = [who]


def picture(found: object, *settings: Any, **named: Any) -> Figure:
    """Return the picture, or the choice of pictures, of a result."""
    (who,) = _drawing
    return who()(found, *settings, **named)
