"""Numbers and problems of tooth geometry as text."""

from __future__ import annotations

import math

from loadshare.errors import Problem


def problem(key: str, given: str, message: str, allowed: str, hint: str = "") -> Problem:
    """A problem with one dimension; geometry does not know the file it came from."""
    return Problem("", key, given, message, allowed, hint)


def millimetres(length: float) -> str:
    """A length [m] as text in mm."""
    return f"{plain(length * 1e3)} mm"


def degrees(angle: float) -> str:
    """An angle [rad] as text in degrees."""
    return f"{plain(math.degrees(angle))} deg"


def plain(number: float) -> str:
    """A number with six figures."""
    return f"{number:.6g}"
