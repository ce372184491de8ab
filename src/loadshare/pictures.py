"""Pictures of what was found, asked for by the rooms that find it.

The room that draws is above them; `loadshare`, which knows every room, says here who draws.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

__all__ = ["Figure", "drawn_by", "picture"]

if TYPE_CHECKING:
    from loadshare.report.figure import Figure
else:
    Figure = Any

_drawn_by: list[Callable[[], Callable[..., Figure]]] = []


def drawn_by(who: Callable[[], Callable[..., Figure]]) -> None:
    """Let `who`, called when the first picture is asked for, return the function that draws."""
    _drawn_by[:] = [who]


def picture(found: object, *settings: Any, **named: Any) -> Figure:
    """Return the picture, or the choice of pictures, of what was found."""
    (who,) = _drawn_by
    return who()(found, *settings, **named)
