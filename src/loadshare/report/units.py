"""Axis titles with units, and the prefix in which an engineer reads a figure."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from loadshare.report.numbers import significant


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit as it is written, and how many of it an SI unit holds.

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
        """Value in this unit; no minus sign before a zero."""
        return value * self.factor + 0.0

    def title(self, what: str) -> str:
        """Title of an axis or a column: ``torque [N·m]``."""
        return f"{what} [{self.name}]" if self.name else what


NUMBER = Unit("")
MICROMETRE = Unit("µm", 1e6)
MILLIMETRE = Unit("mm", 1e3)
MICRORADIAN = Unit("µrad", 1e6)
ROUND_OFF = 1e-12
"""Length that is as good as none [m]."""

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
    """Return the unit in which values are read best.

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
    """Return a value [SI] with so many significant digits in the unit in which it is read best."""
    best = engineering([value], unit)
    return f"{significant(best.of(value), digits)} {best.name}"
