"""Numbers as text, with the unit and the prefix in which an engineer reads them."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import groupby

NONE = "–"
"""Shown where there is no figure."""


def counted(number: int, noun: str = "value") -> str:
    """Return a number of things in words: ``1 problem``, ``2 problems``."""
    return f"{number} {noun}" + ("" if number == 1 else "s")


ALIKE = 1e-9
"""Relative difference between positions that is round-off."""


def decimals(values: Iterable[float], significant: int = 5) -> int:
    """Return how many decimals, at least one, show `significant` digits of the largest value."""
    largest = max((abs(v) for v in values if math.isfinite(v)), default=0.0)
    if largest == 0.0:
        return 1
    return min(max(significant - 1 - math.floor(math.log10(largest)), 1), 9)


def fixed(value: float | None, places: int) -> str:
    """Return a value with `places` decimals; no minus sign before a zero."""
    if value is None:
        return NONE
    return f"{round(value, places) + 0.0:.{places}f}"


def omega(value: float | None) -> str:
    """Return a load-sharing coefficient."""
    return fixed(value, 4)


def micrometres(value: float | None) -> str:
    """Return a length [m] in µm."""
    return fixed(None if value is None else value * 1e6, 3)


def small(value: float) -> str:
    """Return a figure whose order of magnitude alone matters, such as a residual."""
    return "0" if value == 0.0 else f"{value:.1e}"


def runs(numbers: Iterable[int], to: str = "–") -> list[str]:
    """Return the runs in whole numbers, rising and without repeats: ``1–3`` and ``7``."""
    # Consecutive numbers differ from their places in the row by the same amount.
    placed = groupby(enumerate(sorted(set(numbers))), key=lambda item: item[1] - item[0])
    found = [[number for _, number in run] for _, run in placed]
    return [f"{run[0]}{to}{run[-1]}" if len(run) > 1 else f"{run[0]}" for run in found]


def significant(value: float, digits: int = 4) -> str:
    """Return a value with `digits` significant digits, without exponent and trailing zeros."""
    if value == 0.0 or not math.isfinite(value):
        return f"{value:g}"
    places = digits - 1 - math.floor(math.log10(abs(value)))
    text = f"{round(value, places):.{max(places, 0)}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit as it is written, and the factor to it from the SI unit.

    Attributes
    ----------
    name : str
        Empty for a pure number.
    factor : float
        Value in this unit over the value in SI units.
    """

    name: str
    factor: float = 1.0

    def of(self, value: float) -> float:
        """Return the value in this unit; no minus sign before a zero."""
        return value * self.factor + 0.0

    def title(self, what: str) -> str:
        """Return the title of an axis or a column: ``torque [N·m]``."""
        return f"{what} [{self.name}]" if self.name else what


def printed_unit(unit: str) -> str:
    """Return a unit of a case file as it is printed: µm for um, N·m for N*m."""
    return re.sub(r"\bum\b", "µm", unit).replace("*", "·")


NUMBER = Unit("")
MICROMETRE = Unit("µm", 1e6)
MILLIMETRE = Unit("mm", 1e3)
MICRORADIAN = Unit("µrad", 1e6)
ROUND_OFF = 1e-12
"""Length that counts as zero [m]."""

# By the unit's name in labelled arrays: from small to large, each with the SI value at which the
# next one becomes easier to read.
_LADDERS: dict[str, tuple[tuple[Unit, float], ...]] = {
    "m": ((Unit("nm", 1e9), 1e-8), (MICROMETRE, 1e-2), (MILLIMETRE, math.inf)),
    "N": ((Unit("N"), 1e4), (Unit("kN", 1e-3), math.inf)),
    "N·m": ((Unit("N·m"), 1e5), (Unit("kN·m", 1e-3), math.inf)),
    "rad": ((MICRORADIAN, 1e-3), (Unit("mrad", 1e3), 1.0), (Unit("rad"), math.inf)),
    "1": ((NUMBER, math.inf),),
    "": ((NUMBER, math.inf),),
}


def engineering(values: Iterable[float], unit: str) -> Unit:
    """Return the unit in which values are easiest to read.

    Parameters
    ----------
    values : iterable of float
        SI.
    unit : str
        Their SI unit: "m", "N", "N·m", "rad", "1". Any other is kept as it is.
    """
    ladder = _LADDERS.get(unit)
    if ladder is None:
        return Unit(unit)
    largest = max((abs(v) for v in values if math.isfinite(v)), default=0.0)
    if largest < ROUND_OFF and unit == "m":
        return MICROMETRE
    return next(known for known, end in ladder if largest < end)


def read_best(value: float, unit: str, digits: int = 4) -> str:
    """Return a value [SI] with `digits` significant digits, in the unit that is easiest to read."""
    best = engineering([value], unit)
    return f"{significant(best.of(value), digits)} {best.name}"
