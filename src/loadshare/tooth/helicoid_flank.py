"""The flank of a cylindrical gear as a surface in closed form."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from loadshare.tooth.body import Array
from loadshare.tooth.flank import Patch
from loadshare.tooth.helicoid import HelicoidGear


@dataclass(frozen=True)
class HelicoidFlank:
    """One side of tooth 0 of a cylindrical gear.

    The parameters are the angle of roll ξ = tan α_y and the axial coordinate ζ [m]. The involute
    unwinds from the base circle at the angle φ = s ψ_b − s σ ξ + κ ζ (s the side, σ = +1 external
    or −1 internal, κ the twist), so that

        X = r_b e_r(φ) + s σ r_b ξ e_t(φ) + ζ e_z − h n,    n = s (cos β_b e_t(φ) − sin β_b e_z),

    with h(ξ, ζ) the material taken off by the modification. Curvatures are exact with h included.

    Parameters
    ----------
    gear : HelicoidGear
        The gear.
    side : {+1, −1}
        Which flank.
    """

    gear: HelicoidGear
    side: int = 1

    def patch(self, a: Array, b: Array, turn: Array | float) -> Patch:
        """Points of the flank at roll `a` [rad] and axial coordinate `b` [m].

        Parameters
        ----------
        a, b : array
            Surface parameters ξ and ζ, broadcast against each other.
        turn : array or float
            Angle by which the tooth has turned about z [rad].

        Returns
        -------
        Patch
            In the frame in which the gear turns.
        """
        gear, s, kind = self.gear, self.side, self.gear.kind
        radius, twist = gear.base_radius, gear.twist
        sine, cosine = math.sin(gear.base_helix_angle), math.cos(gear.base_helix_angle)
        roll, axial, turn = np.broadcast_arrays(a, b, turn)
        per_roll = -s * kind
        phi = turn + s * gear.base_half_angle + per_roll * roll + twist * axial

        # Components along e_r, e_t and e_z, which turn with φ: the generator of the helicoid is
        # (0, sin β_b, cos β_b), the plain normal s (0, cos β_b, −sin β_b).
        across, up = s * cosine, -s * sine
        arc = -per_roll * radius * roll
        if gear.deviation.none:
            reach = radius * roll
            return Patch.of(
                (radius, arc, axial),
                (0.0, across, up),
                # Along ξ only e_r changes the point, along ζ also the generator does.
                (reach, 0.0, 0.0),
                (twist * per_roll * reach, sine / cosine, 1.0),
                (-per_roll * across, 0.0, 0.0),
                (-twist * across, 0.0, 0.0),
            ).spun(phi)

        taken, by_roll, by_roll2 = gear.deviation.profile(radius * roll)
        by_roll, by_roll2 = radius * by_roll, radius**2 * by_roll2
        lead, by_axial, by_axial2 = gear.deviation.lead(axial)
        taken = taken + lead
        reach = radius * roll - kind * cosine * taken
        reach_roll = radius - kind * cosine * by_roll
        reach_axial = -kind * cosine * by_axial

        # The normal along e_r, generator and plain normal is (tilt, lean, 1), made unit.
        tilt = by_roll / reach
        lean = cosine * (by_axial - twist * per_roll * by_roll)
        over = 1.0 / np.sqrt(1.0 + tilt**2 + lean**2)
        normal = np.stack([tilt * over, (lean * sine + across) * over, (lean * cosine + up) * over])
        # It changes with tilt, lean and φ, over ξ and over ζ, and keeps its length.
        tilts, leans = np.empty((2, 2, *roll.shape))
        tilts[0] = (by_roll2 - tilt * reach_roll) * (over / reach)
        tilts[1] = tilt * reach_axial * (-over / reach)
        leans[0] = (-cosine * twist * per_roll) * by_roll2 * over
        leans[1] = cosine * by_axial2 * over
        turns = np.array([per_roll, twist]).reshape(2, *[1] * roll.ndim)
        change = np.empty((3, 2, *roll.shape))
        change[0] = tilts - turns * normal[1]
        change[1] = sine * leans + turns * normal[0]
        change[2] = cosine * leans
        change -= normal[:, None] * np.sum(normal[:, None] * change, axis=0)
        return Patch.of(
            (radius, arc - across * taken, axial - up * taken),
            normal,
            (reach, -across * by_roll, -up * by_roll),
            (twist * per_roll * reach, sine / cosine - across * by_axial, 1.0 - up * by_axial),
            change[:, 0],
            change[:, 1],
        ).spun(phi)
