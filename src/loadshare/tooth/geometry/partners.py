"""What two gears must have in common to run together, and how it is told where they do not."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import NamedTuple

from loadshare.errors import Problem
from loadshare.tooth.words import problem


class Demand(NamedTuple):
    """A dimension of a gear, whether it fits the partner, and what would."""

    name: str
    fits: bool
    given: str
    allowed: str


def same(
    name: str, own: float, other: float, written: Callable[[float], str], whose: str
) -> Demand:
    """That a dimension is its partner's."""
    fits = math.isclose(own, other, rel_tol=1e-9)
    return Demand(name, fits, written(own), f"that of the {whose}, {written(other)}")


def misfits(gear: str, message: str, demands: Iterable[Demand]) -> list[Problem]:
    """Problems with the dimensions of a gear, "driver" or "driven", that do not fit."""
    return [
        problem(f"{gear}.{demand.name}", demand.given, message, demand.allowed)
        for demand in demands
        if not demand.fits
    ]
