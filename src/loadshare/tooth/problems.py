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
"""Name of a dimension, its value, whether that will do, and what would."""


def up(number: float) -> float:
    """Return the least number of six figures that is not below one: what "at least" allows."""
    return _with_six_figures(number, ROUND_CEILING)


def down(number: float) -> float:
    """Return the greatest number of six figures that is not above one: what "at most" allows."""
    return _with_six_figures(number, ROUND_FLOOR)


def _with_six_figures(number: float, rounding: str) -> float:
    # What is beyond fifteen figures is round-off, of which a limit of 0.3 mm is not to be 0.300001.
    exact = Decimal(f"{number:.15g}")
    return float(exact.quantize(Decimal(1).scaleb(exact.adjusted() - 5), rounding))


def millimetres(length: float, to: Callable[[float], float] = float) -> str:
    """A length [m] as text in mm; a limit is rounded `up` or `down`."""
    return f"{digits(to(length * 1e3))} mm"


def degrees(angle: float, to: Callable[[float], float] = float) -> str:
    """An angle [rad] as text in degrees; a limit is rounded `up` or `down`."""
    return f"{digits(to(math.degrees(angle)))} deg"


def digits(number: float) -> str:
    """A number with six figures."""
    return f"{number:.6g}"


def written(key: str, value: float) -> str:
    """The value of a dimension [m, rad or 1], in the unit that its name asks for."""
    name = key.rpartition(".")[2]
    if name in LENGTHS:
        return millimetres(value)
    return degrees(value) if name in ANGLES else digits(value)


def problem(key: str, given: float | str, message: str, allowed: str, hint: str = "") -> Problem:
    """A problem with one dimension; geometry does not know the file it came from."""
    text = given if isinstance(given, str) else written(key, given)
    return Problem("", key, text, message, allowed, hint)


def same(name: str, own: float, other: float, whose: str) -> Check:
    """That a dimension is its partner's."""
    fits = math.isclose(own, other, rel_tol=TEETH.fits)
    return name, own, fits, f"that of the {whose}, {written(name, other)}"


def failed(key: str, message: str, checks: Iterable[Check]) -> list[Problem]:
    """Problems with the dimensions of a gear, "driver" or "driven", that will not do."""
    return [
        problem(f"{key}.{name}", value, message, allowed)
        for name, value, fits, allowed in checks
        if not fits
    ]


def refuse(problems: Iterable[Problem]) -> None:
    """Raise problems where there are any."""
    found = list(problems)
    if found:
        raise CaseError(found)
