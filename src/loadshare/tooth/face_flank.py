"""The flank of a face gear in closed form, as the envelope of its shaper."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from loadshare.tooth.body import Array
from loadshare.tooth.face_gear import FaceGear
from loadshare.tooth.flank import Patch, dot, solve_2


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
        towards, tangential, axis = gear.axes.T
        cosine, sine = np.cos(phi)[..., None], np.sin(phi)[..., None]
        across = cosine * towards + sine * tangential
        around = cosine * tangential - sine * towards
        axial = gear.axial_scale / cosine
        point = axial * axis + base * (across + (s * roll)[..., None] * around)

        # Seen from the gear, everything also turns back by m φ_s about z.
        back = ratio * _about_z(point)
        point_roll = s * (base * around - back)
        point_phi = (
            axial * (sine / cosine) * axis + base * (around - (s * roll)[..., None] * across) - back
        )
        back_normal = ratio * _about_z(around)
        angle = turn + self.side * np.pi / gear.teeth
        angle = angle - ratio * (phi - s * gear.shaper.base_half_angle + s * roll)
        vectors = np.stack(
            [point, -s * around, point_roll, point_phi, back_normal, s * (across + back_normal)]
        )
        spun = (vectors[..., 0] + 1j * vectors[..., 1]) * np.exp(1j * angle)
        return Patch(*np.stack([spun.real, spun.imag, vectors[..., 2]], axis=-1))

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
            patch = self.patch(roll, phi, 0.0)
            now = gear.blank(patch.point)
            gradient = self._blank_gradient(patch.point)
            first, second = (
                (dot(rise, patch.point_a), dot(rise, patch.point_b)) for rise in gradient
            )
            step_a, step_b = solve_2(first, second, now[0] - length, now[1] - depth)
            roll, phi = roll - step_a, phi - step_b
            if not np.nanmax(np.abs(step_a) + np.abs(step_b), initial=0.0) > 1e-13:
                break
        return roll, phi

    def at_length(self, length: Array, roll: Array | float) -> Array:
        """Base-tangent angle Φ of the points with a given shaper roll at lengths of the blank."""
        gear = self.gear
        length, roll = np.broadcast_arrays(length, roll)
        with np.errstate(invalid="ignore"):
            phi = self.side * np.arccos(gear.axial_scale / length)
        for _ in range(30):
            patch = self.patch(roll, phi, 0.0)
            along = dot(self._blank_gradient(patch.point)[0], patch.point_b)
            step = (gear.blank(patch.point)[0] - length) / along
            phi = phi - step
            if not np.nanmax(np.abs(step), initial=0.0) > 1e-13:
                break
        return phi

    def _blank_gradient(self, points: Array) -> tuple[Array, Array]:
        towards, _, axis = self.gear.axes.T
        outward = points * np.array([1.0, 1.0, 0.0])
        outward = outward / np.sqrt(dot(outward, outward))[..., None]
        up = np.array([0.0, 0.0, 1.0])
        return axis[0] * outward + axis[2] * up, towards[0] * outward + towards[2] * up


def _about_z(vectors: Array) -> Array:
    """ẑ × vectors."""
    return np.stack([-vectors[..., 1], vectors[..., 0], np.zeros_like(vectors[..., 0])], axis=-1)
