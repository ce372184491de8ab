r"""Spline friction that remembers its slip (formulation, section 5).

With memory the slip s of a spline is a coordinate of its own. The shaft bends by p − s, friction
resists the change s − s₀ from the slip of the position before, and the clearance limits s itself:

.. math:: W(p) = \min_s \tfrac12 K_w \lVert p - s\rVert^2 + F_m \lVert s - s_0\rVert
    \quad \text{s.t.} \quad \lVert s\rVert \le S_2 - F_m / K_w

Friction and clearance are radial laws about two different centres, s₀ and the unloaded place.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from loadshare.contact.radial import Piece, RadialLaw
from loadshare.settings import LAWS
from loadshare.train.gear import Vector

if TYPE_CHECKING:
    from loadshare.train.elements import Spline
    from loadshare.train.equilibrium import Equilibrium


@dataclass(frozen=True, slots=True)
class _Part:
    """One of the two elements of a spline that remembers its slip.

    Attributes
    ----------
    spline : Spline
    """

    spline: Spline

    @property
    def friction_force(self) -> float | None:
        """Friction bound F_m [N] where it is fixed."""
        return self.spline.friction_force

    def bound(self, torque: float) -> float:
        """Return the friction bound [N] at a torque [N·m]."""
        return self.spline.bound(torque)


class SlipFriction(_Part):
    """Friction of a spline against a change of its slip."""

    __slots__ = ()

    def law(self, torque: float) -> RadialLaw:
        """Return the law about the slip of the position before: F_m in any direction of slip.

        Raises
        ------
        ValueError
            If the spline's law jumps where it starts to slip; the message names the numbers.
        """
        spline, bound = self.spline, self.spline.bound(torque)
        spline.law(torque)
        if spline.stick_limit is not None:
            bent = spline.bending_stiffness * spline.stick_limit
            if bent < bound * (1.0 - LAWS.written):
                raise ValueError(
                    f"{spline.name}: friction with memory has no step from K_w S1 = {bent:.6g} N "
                    f"to F_m = {bound:.6g} N; leave stick_limit out"
                )
        return RadialLaw((Piece(bound, 0.0, math.inf, "slip"),))


class SlipStop(_Part):
    """Clearance of a spline, which limits its slip."""

    __slots__ = ()

    def law(self, torque: float) -> RadialLaw:
        """Return the rigid stop at S2 − F_m/K_w about the unloaded place; at 0 if that is less."""
        spline = self.spline
        room = spline.clearance - spline.bound(torque) / spline.bending_stiffness
        return RadialLaw((Piece(0.0, 0.0, max(room, 0.0), "slip"),))


def slip_of(spline: Spline, answer: Equilibrium) -> Vector:
    """Return the slip s (3,) [m] of a spline with memory: p less the bending of its shaft."""
    forces = (answer.radial_reaction[name] for name in (spline.name, spline.stop_name))
    bending = -sum(map(np.asarray, forces)) / spline.bending_stiffness
    return np.asarray(answer.displacement[spline.gear] - bending)
