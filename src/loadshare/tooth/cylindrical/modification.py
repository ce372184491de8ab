"""Deliberate deviations of a flank from the involute helicoid."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple


@dataclass(frozen=True)
class Modification:
    """Micro-geometry of both flanks of a tooth; every amount is material taken off [m].

    Amounts are measured along the flank's normal.

    Parameters
    ----------
    tip_relief : float
        Relief C_αa at the tip corner.
    tip_relief_length : float
        Length of roll, along the transverse line of action, over which the relief grows [m].
    tip_relief_exponent : {1, 2}
        1 for linear, 2 for parabolic relief, which starts without a kink.
    profile_crowning : float
        Crowning C_α: a parabola with this height at both ends of the usable profile.
    lead_crowning : float
        Crowning C_β: a parabola with this height at both ends of the face width.
    end_relief : float
        Linear relief C_βI,II at both ends of the face width.
    end_relief_length : float
        Length along the axis over which the end relief grows [m].
    """

    tip_relief: float = 0.0
    tip_relief_length: float = 0.0
    tip_relief_exponent: Literal[1, 2] = 1
    profile_crowning: float = 0.0
    lead_crowning: float = 0.0
    end_relief: float = 0.0
    end_relief_length: float = 0.0


@dataclass(frozen=True)
class Deviation:
    """A modification laid on a flank of known extent.

    Parameters
    ----------
    modification : Modification
        What is taken off.
    root, tip : float
        Lengths of roll at the ends of the usable profile [m]; an internal gear has root > tip.
    width : float
        Face width [m], the flank being −width/2 ≤ ζ ≤ width/2.
    """

    modification: Modification
    root: float
    tip: float
    width: float

    @property
    def none(self) -> bool:
        """Whether nothing is taken off."""
        m = self.modification
        return not (m.tip_relief or m.profile_crowning or m.lead_crowning or m.end_relief)

    @property
    def numbers(self) -> Taken:
        """All of it, as compiled code reads it."""
        # Floats, for code is compiled for them; another kind of number would have it made again.
        amounts = {name: float(getattr(self.modification, name)) for name in Taken._fields[4:]}
        extent = float(self.root), float(self.tip), float(self.width)
        return Taken(self.modification.tip_relief_exponent, *extent, **amounts)


class Taken(NamedTuple):
    """What a deviation takes off, by the names of `Modification` and of `Deviation`."""

    tip_relief_exponent: int
    root: float
    tip: float
    width: float
    tip_relief: float
    tip_relief_length: float
    profile_crowning: float
    lead_crowning: float
    end_relief: float
    end_relief_length: float
