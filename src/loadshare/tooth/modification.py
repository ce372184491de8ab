"""Deliberate deviations of a flank from the involute helicoid."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from loadshare.tooth.body import Array


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

    def profile(self, roll: Array) -> tuple[Array, Array, Array]:
        """Material taken off at a length of roll [m], with first and second derivative."""
        m = self.modification
        half = 0.5 * (self.tip - self.root)
        middle = roll - 0.5 * (self.tip + self.root)
        bend = m.profile_crowning / half**2
        taken = bend * middle**2
        slope = 2.0 * bend * middle
        second = np.full_like(roll, 2.0 * bend)
        if m.tip_relief:
            # Grows towards the tip, which an internal gear has at its shorter roll.
            towards = np.sign(half)
            start = self.tip - towards * m.tip_relief_length
            into = np.maximum(towards * (roll - start) / m.tip_relief_length, 0.0)
            n = m.tip_relief_exponent
            taken = taken + m.tip_relief * into**n
            inside = into > 0.0
            first = m.tip_relief * n * into ** (n - 1) * inside
            slope = slope + first * towards / m.tip_relief_length
            second = second + m.tip_relief * n * (n - 1) * inside / m.tip_relief_length**2
        return taken, slope, second

    def lead(self, axial: Array) -> tuple[Array, Array, Array]:
        """Material taken off at ζ [m], with first and second derivative."""
        m = self.modification
        bend = 4.0 * m.lead_crowning / self.width**2
        taken = bend * axial**2
        slope = 2.0 * bend * axial
        second = np.full_like(axial, 2.0 * bend)
        if m.end_relief:
            start = 0.5 * self.width - m.end_relief_length
            into = np.maximum(np.abs(axial) - start, 0.0) / m.end_relief_length
            taken = taken + m.end_relief * into
            slope = slope + m.end_relief / m.end_relief_length * np.sign(axial) * (into > 0.0)
        return taken, slope, second
