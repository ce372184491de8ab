"""The flank of a cylindrical gear as a surface in closed form."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from loadshare.tooth.body import Array
from loadshare.tooth.flank import Patch, dot
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

        across = _vector(np.cos(phi), np.sin(phi), 0.0)
        around = _vector(-across[..., 1], across[..., 0], 0.0)
        up = np.array([0.0, 0.0, 1.0])
        plain = s * (cosine * around - sine * up)
        generator = sine * around + cosine * up
        point = radius * across - (per_roll * radius * roll)[..., None] * around
        point[..., 2] += axial

        if gear.deviation.none:
            # Along ξ only e_r changes the point, along ζ also the generator does.
            reach = (radius * roll)[..., None] * across
            tilting = -s * cosine * across
            return Patch(
                point,
                plain,
                reach,
                twist * per_roll * reach + generator / cosine,
                per_roll * tilting,
                twist * tilting,
            )

        taken, by_roll, by_roll2 = gear.deviation.profile(radius * roll)
        by_roll, by_roll2 = radius * by_roll, radius**2 * by_roll2
        lead, by_axial, by_axial2 = gear.deviation.lead(axial)
        taken = taken + lead
        reach = radius * roll - kind * cosine * taken
        reach_roll = radius - kind * cosine * by_roll
        reach_axial = -kind * cosine * by_axial

        # The normal in the frame (e_r, generator, plain normal) is (tilt, lean, 1), made unit.
        tilt = by_roll / reach
        tilt_roll = by_roll2 / reach - tilt * reach_roll / reach
        tilt_axial = -tilt * reach_axial / reach
        lean = cosine * (by_axial - twist * per_roll * by_roll)
        lean_roll = -cosine * twist * per_roll * by_roll2
        lean_axial = cosine * by_axial2
        raw = tilt[..., None] * across + lean[..., None] * generator + plain
        # Change of that vector with φ alone, its components held.
        turning = tilt[..., None] * around - (lean * sine + s * cosine)[..., None] * across
        length = np.sqrt(dot(raw, raw))[..., None]
        normal = raw / length

        def change(of_tilt: Array, of_lean: Array, of_phi: float) -> Array:
            raw_change = of_tilt[..., None] * across + of_lean[..., None] * generator
            raw_change = (raw_change + of_phi * turning) / length
            tangential: Array = raw_change - dot(normal, raw_change)[..., None] * normal
            return tangential

        point_roll = reach[..., None] * across
        return Patch(
            point - taken[..., None] * plain,
            normal,
            point_roll - by_roll[..., None] * plain,
            twist * per_roll * point_roll + generator / cosine - by_axial[..., None] * plain,
            change(tilt_roll, lean_roll, per_roll),
            change(tilt_axial, lean_axial, twist),
        )


def _vector(x: Array, y: Array, z: float) -> Array:
    return np.stack([x, y, np.full_like(x, z)], axis=-1)
