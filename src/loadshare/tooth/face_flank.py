"""The flank of a face gear in closed form, as the envelope of its shaper."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from loadshare.tooth.body import Array
from loadshare.tooth.face_gear import FaceGear
from loadshare.tooth.flank import Patch, solve_2
from loadshare.tooth.placement import turned

Pair: TypeAlias = tuple[Array, Array]

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
        """Points of the flank at the shaper's roll `a` and base-tangent angle `b` [rad].

        Parameters
        ----------
        a, b : array
            Surface parameters ξ and Φ, broadcast against each other.
        turn : array or float
            Angle by which the tooth has turned about z [rad].

        Returns
        -------
        Patch
            In the frame in which the gear turns.
        """
        gear, s = self.gear, -self.side
        base, ratio = gear.shaper.base_radius, gear.roll_ratio
        roll, phi, turn = np.broadcast_arrays(a, b, turn)
        cosine, sine = np.cos(phi), np.sin(phi)
        axial = gear.axial_scale / cosine
        reach = s * base * roll
        across, around = self._vector(cosine, sine, 0.0), self._vector(-sine, cosine, 0.0)
        point = self._generated(roll, phi)

        # Seen from the gear, everything also turns back by m φ_s about z.
        back, back_normal = ratio * _about_z(point), ratio * _about_z(around)
        along_phi = self._vector(
            -base * sine - reach * cosine, base * cosine - reach * sine, axial * sine / cosine
        )
        components = (
            point,
            -s * around,
            s * (base * around - back),
            along_phi - back,
            back_normal,
            s * (across + back_normal),
        )
        return Patch.spun(components, turn - self._turned_back(roll, phi))

    def point(self, roll: Array, phi: Array) -> Array:
        """Points (..., 3) of the flank of tooth 0 at surface parameters ξ and Φ [m]."""
        points = np.moveaxis(self._generated(roll, phi), 0, -1)
        return turned(points, -self._turned_back(roll, phi))

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

    def _generated(self, roll: Array, phi: Array) -> Array:
        """Coordinates (3, ...) of the points where the shaper generates them, gear frame [m]."""
        base, reach = self.gear.shaper.base_radius, -self.side * roll
        cosine, sine = np.cos(phi), np.sin(phi)
        return self._vector(
            base * (cosine - reach * sine),
            base * (sine + reach * cosine),
            self.gear.axial_scale / cosine,
        )

    def _vector(self, towards: Array, tangential: Array, axial: Array | float) -> Array:
        """Components (3, ...) in the gear's frame of a vector given in the shaper's."""
        angle = self.gear.shaft_angle
        c, n = math.cos(angle), math.sin(angle)
        return np.stack([c * towards + n * axial, tangential, c * axial - n * towards])

    def _blank(self, roll: Array, phi: Array) -> tuple[Pair, Pair, Pair]:
        """Length and depth of the blank [m], then the slopes of either over ξ and Φ."""
        gear, s = self.gear, -self.side
        base = gear.shaper.base_radius
        c, n = math.cos(gear.shaft_angle), math.sin(gear.shaft_angle)
        cosine, sine = np.cos(phi), np.sin(phi)
        x, y, z = self._generated(roll, phi)
        radius = np.hypot(x, y)
        by_roll = self._vector(-s * base * sine, s * base * cosine, 0.0)
        by_phi = self._vector(
            -y, base * (cosine - s * roll * sine), gear.axial_scale * sine / cosine**2
        )
        (out_roll, up_roll), (out_phi, up_phi) = (
            ((x * dx + y * dy) / radius, dz) for dx, dy, dz in (by_roll, by_phi)
        )
        return (
            (n * radius + c * z, c * radius - n * z),
            (n * out_roll + c * up_roll, n * out_phi + c * up_phi),
            (c * out_roll - n * up_roll, c * out_phi - n * up_phi),
        )


def _about_z(vectors: Array) -> Array:
    """ẑ × vectors (3, ...)."""
    return np.stack([-vectors[1], vectors[0], np.zeros_like(vectors[0])])
