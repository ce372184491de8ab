"""The flank of a face gear in closed form, as the envelope of its shaper."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from loadshare.tooth.body import Array
from loadshare.tooth.face_gear import FaceGear
from loadshare.tooth.flank import Patch, solve_2
from loadshare.tooth.placement import turned

Pair: TypeAlias = tuple[Array, Array]
Vector: TypeAlias = tuple[Array, Array, Array]

# A Newton step below this [rad] is the last: what is left is about its square, below round-off.
LAST_TURN = 1e-8


@dataclass(frozen=True)
class FaceFlank:
    """One side of tooth 0 of a face gear.

    The parameters are the shaper's angle of roll ξ and the angle Φ of the base tangent, along
    which the shaper's flank is normal to the gear's while it generates the point. With shaper axis
    a, e_r and e_t at Φ in its transverse plane, s its side and m the ratio of the rotations,

        X = u(Φ) a + r_bs e_r + s r_bs ξ e_t,    u cos Φ = const (equation of meshing),

    in the frame in which both turn; turning back by m φ_s, φ_s = Φ − s(ψ_bs − ξ), gives the flank.
    The normal is that of the shaper's flank, reversed. Litvin & Fuentes, Gear Geometry and Applied
    Theory, ch. 18, give the same surface as vector equations.

    Parameters
    ----------
    gear : FaceGear
        The gear.
    side : {+1, −1}
        Which flank.
    """

    gear: FaceGear
    side: int = -1

    def patch(self, a: Array, b: Array, turn: Array | float) -> Patch:
        """Points of the flank at ξ = `a` and Φ = `b` [rad]; see `HelicoidFlank.patch`."""
        gear, s = self.gear, -self.side
        base = gear.shaper.base_radius
        roll, phi, turn = np.broadcast_arrays(a, b, turn)
        cosine, sine = np.cos(phi), np.sin(phi)
        x, y, u = self._generated(s * roll, cosine, sine)
        # Seen from the gear, everything also turns back about z = (−sin Γ, 0, cos Γ) by m φ_s.
        k, n = (gear.roll_ratio * float(gear.axes[2, i]) for i in (2, 0))
        tilted = Patch.of(
            (x, y, u),
            (s * sine, -s * cosine, 0.0),
            (s * (k * y - base * sine), s * (base * cosine - k * x + n * u), -s * n * y),
            ((k - 1.0) * y, (1.0 - k) * x + n * u, u * sine / cosine - n * y),
            (-k * cosine, -k * sine, n * cosine),
            (s * (1.0 - k) * cosine, s * (1.0 - k) * sine, s * n * cosine),
        ).turned(gear.axes)
        return tilted.spun(turn - self._turned_back(roll, phi))

    def point(self, roll: Array, phi: Array) -> Array:
        """Points (..., 3) of the flank of tooth 0 at surface parameters ξ and Φ [m]."""
        made = self._generated(-self.side * roll, np.cos(phi), np.sin(phi))
        return turned(np.stack(self._in_gear(*made), axis=-1), -self._turned_back(roll, phi))

    def at_blank(self, length: Array, depth: Array) -> tuple[Array, Array]:
        """Surface parameters of the points at given lengths and depths of the blank [m].

        Newton's method from the plane section that the flank would have at infinite radius.

        Returns
        -------
        roll, phi : array
            NaN where the flank has no such point.
        """
        gear = self.gear
        length, depth = np.broadcast_arrays(length, depth)
        with np.errstate(invalid="ignore"):
            start = np.arccos(gear.axial_scale / length)
            roll = (depth / gear.shaper.base_radius - np.cos(start)) / np.sin(start)
        phi = self.side * start
        for _ in range(30):
            now, first, second = self._blank(roll, phi)
            step_a, step_b = solve_2(first, second, now[0] - length, now[1] - depth)
            roll, phi = roll - step_a, phi - step_b
            if not np.nanmax(np.abs(step_a) + np.abs(step_b), initial=0.0) > LAST_TURN:
                break
        return roll, phi

    def at_length(self, length: Array, roll: Array | float) -> Array:
        """Base-tangent angle Φ of the points with a given shaper roll at lengths of the blank."""
        gear = self.gear
        length, roll = np.broadcast_arrays(length, roll)
        with np.errstate(invalid="ignore"):
            phi = self.side * np.arccos(gear.axial_scale / length)
        for _ in range(30):
            now, along, _ = self._blank(roll, phi)
            step = (now[0] - length) / along[1]
            phi = phi - step
            if not np.nanmax(np.abs(step), initial=0.0) > LAST_TURN:
                break
        return phi

    def _turned_back(self, roll: Array, phi: Array) -> Array:
        """Angle m φ_s of the gear since it stood with tooth 0 on +x [rad]."""
        gear, s = self.gear, -self.side
        shaper_turn = phi - s * gear.shaper.base_half_angle + s * roll
        return gear.roll_ratio * shaper_turn - self.side * np.pi / gear.teeth

    def _generated(self, reach: Array, cosine: Array, sine: Array) -> Vector:
        """Where the shaper generates points, in its frame, from s ξ and cosine and sine of Φ."""
        base = self.gear.shaper.base_radius
        towards, tangential = cosine - reach * sine, sine + reach * cosine
        return base * towards, base * tangential, self.gear.axial_scale / cosine

    def _in_gear(self, towards: Array, tangential: Array, axial: Array | float) -> Vector:
        """Components in the gear's frame of a vector given in the shaper's."""
        (c, _, n), _, _ = self.gear.axes.tolist()
        return c * towards + n * axial, tangential, c * axial - n * towards

    def _blank(self, roll: Array, phi: Array) -> tuple[Pair, Pair, Pair]:
        """Length and depth of the blank [m], then the slopes of either over ξ and Φ."""
        s, base = -self.side, self.gear.shaper.base_radius
        (c, _, n), _, _ = self.gear.axes.tolist()
        cosine, sine = np.cos(phi), np.sin(phi)
        made = self._generated(s * roll, cosine, sine)
        x, y, z = self._in_gear(*made)
        radius = np.hypot(x, y)
        by_roll = self._in_gear(-s * base * sine, s * base * cosine, 0.0)
        by_phi = self._in_gear(-made[1], made[0], made[2] * sine / cosine)
        (out_roll, up_roll), (out_phi, up_phi) = (
            ((x * dx + y * dy) / radius, dz) for dx, dy, dz in (by_roll, by_phi)
        )
        return (
            (n * radius + c * z, c * radius - n * z),
            (n * out_roll + c * up_roll, n * out_phi + c * up_phi),
            (c * out_roll - n * up_roll, c * out_phi - n * up_phi),
        )
