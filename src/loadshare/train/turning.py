"""How far the input turns over the positions of a case."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from loadshare.train.gear import Gear
from loadshare.train.period import Period

March = tuple[str, float, int]
"""Gear, its revolutions, steps."""


class Turning(NamedTuple):
    """How far the input turns over all positions.

    Attributes
    ----------
    steps : int
        Number of positions.
    whole : float
        Angle over all positions [rad].
    """

    steps: int
    whole: float

    def after(self, passed: Any) -> Any:
        """Return the angle [rad] by which the input has turned after `passed` positions."""
        return self.whole * passed / self.steps


def turning_of(
    gears: Mapping[str, Gear],
    positions: int,
    rotating: bool,
    march: March | None,
    period: Period | None,
) -> Turning:
    """Return how far the input turns.

    In a mesh cycle the gears turn by one pitch of the gear of `cycle_gear`, or through the common
    period of all meshes. In a march they turn through the given revolutions of its gear.

    Parameters
    ----------
    gears, positions, rotating, march, period
        As in `Train`.
    """
    if march is not None:
        gear, revolutions, steps = march
        return Turning(steps, 2.0 * math.pi * revolutions / abs(gears[gear].ratio))
    steps = positions if period is None else period.steps(positions)
    name = cycle_gear(gears) if rotating else None
    if name is None:
        return Turning(steps, 0.0)
    if period is not None:
        return Turning(steps, 2.0 * math.pi * float(period.revolutions))
    one = gears[name]
    return Turning(steps, 2.0 * math.pi / ((one.teeth or math.inf) * abs(one.relative)))


def cycle_gear(gears: Mapping[str, Gear]) -> str | None:
    """Return the gear whose pitch makes a mesh cycle.

    It is the input gear, or else the nearest to it whose teeth are known; None if there is none.
    """
    return next((n for n, g in gears.items() if g.teeth is not None and g.relative), None)
