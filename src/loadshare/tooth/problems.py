"""Problems of gears as text, each with the dimension that causes it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal
from typing import TypeAlias

from loadshare.errors import CaseError, Problem
from loadshare.settings import TEETH

LENGTHS = {
    *("module", "face_width", "helix_gap", "rim", "inner", "outer", "centre_distance"),
    *("tip_relief", "tip_relief_length", "end_relief", "end_relief_length"),
    *("profile_crowning", "lead_crowning"),
}
"""Dimensions that are written in mm."""
ANGLES = {"pressure_angle", "helix_angle", "shaft_angle"}
"""Dimensions that are written in degrees."""

Check: TypeAlias = tuple[str, float | str, bool, str]
"""Name of a dimension, its value, whether that is allowed, and what would be."""


def up(number: float) -> float:
    """Round up to six figures, as a limit of "at least" requires."""
    return _with_six_figures(number, ROUND_CEILING)


def down(number: float) -> float:
    """Round down to six figures, as a limit of "at most" requires."""
    return _with_six_figures(number, ROUND_FLOOR)


def _with_six_figures(number: float, rounding: str) -> float:
    # Figures beyond the fifteenth are round-off, which would turn a limit of 0.3 mm into 0.300001.
    exact = Decimal(f"{number:.15g}")
    return float(exact.quantize(Decimal(1).scaleb(exact.adjusted() - 5), rounding))


def millimetres(length: float, to: Callable[[float], float] = float) -> str:
    """Return a length [m] as text in mm; a limit is rounded `up` or `down`."""
    return f"{digits(to(length * 1e3))} mm"


def degrees(angle: float, to: Callable[[float], float] = float) -> str:
    """Return an angle [rad] as text in degrees; a limit is rounded `up` or `down`."""
    return f"{digits(to(math.degrees(angle)))} deg"


def digits(number: float) -> str:
    """Return a number as text with six figures."""
    return f"{number:.6g}"


def written(key: str, value: float) -> str:
    """Return the value of a dimension [m, rad or 1] as text, in the unit that its name implies."""
    name = key.rpartition(".")[2]
    if name in LENGTHS:
        return millimetres(value)
    return degrees(value) if name in ANGLES else digits(value)


def problem(key: str, given: float | str, message: str, allowed: str, hint: str = "") -> Problem:
    """Return a problem with one dimension, without its file, which geometry does not know."""
    text = given if isinstance(given, str) else written(key, given)
    return Problem("", key, text, message, allowed, hint)


def same(name: str, own: float, other: float, whose: str) -> Check:
    """Check that a dimension equals that of its partner."""
    fits = math.isclose(own, other, rel_tol=TEETH.fits)
    return name, own, fits, f"that of the {whose}, {written(name, other)}"


def failed(key: str, message: str, checks: Iterable[Check]) -> list[Problem]:
    """Return a problem for each failed check of a gear, "driver" or "driven"."""
    return [
        problem(f"{key}.{name}", value, message, allowed)
        for name, value, fits, allowed in checks
        if not fits
    ]


def refuse(problems: Iterable[Problem]) -> None:
    """Raise an error if there are any problems."""
    found = list(problems)
    if found:
        raise CaseError(found)
