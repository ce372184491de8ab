"""The solid tooth of a face gear."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from loadshare.settings import TEETH
from loadshare.tooth.face.flank import FaceFlank
from loadshare.tooth.face.gear import FaceGear
from loadshare.tooth.geometry.body import Array, ToothBody, turned


@dataclass(frozen=True)
class FaceBody(ToothBody):
    """`ToothBody` of a face gear.

    Width stations are equal steps of the length along the shaper's axis (at 90°: coaxial
    cylinders). The fillet is the path of the shaper's tip corner; between two fillets the root is
    the path of the shaper's tip land.
    """

    gear: FaceGear

    @property
    def rim(self) -> float:
        """Thickness of the body below the root [m]."""
        return self.gear.rim_thickness

    @cached_property
    def flank(self) -> FaceFlank:
        """The flank that a pinion pushes, side −1."""
        return FaceFlank(self.gear)

    def outline(self, u: ArrayLike, w: ArrayLike, side: int) -> Array:
        """Return the boundary of half of tooth 0; see `ToothBody.outline`.

        `u` is linear in depth on the flank and in the shaper's angle on the fillet.
        """
        length = self.gear.inner + np.asarray(w, float) * self.gear.face_width
        u, *station = np.broadcast_arrays(np.asarray(u, float), length, *self._foot(length))
        length, foot_phi, foot_depth = station
        rooted = u <= self.foot
        above = ~rooted
        trailing = np.empty((*u.shape, 3))
        trailing[rooted] = self._root(u[rooted] / self.foot, length[rooted], foot_phi[rooted])
        up = np.minimum((u[above] - self.foot) / (1.0 - self.foot), 1.0)
        depth = foot_depth[above] + up * (self.gear.tip_depth - foot_depth[above])
        trailing[above] = self.flank.point(*self.flank.at_blank(length[above], depth))
        half: Array = trailing * np.array([1.0, -float(side), 1.0])
        return half

    def _root(self, share: Array, length: Array, foot_phi: Array) -> Array:
        """Return the root at shares of its line, from the middle of the space to the flank."""
        share = np.maximum(share, 0.0)
        land = self._land_share
        along = np.maximum((share - land) / (1.0 - land), 0.0)
        root = self._corner(length, foot_phi, along)
        # From the end of the fillet the land continues at that radius to the middle of the space.
        space = -math.pi / self.gear.teeth
        polar = np.arctan2(root[..., 1], root[..., 0])
        into = np.where(share < land, 1.0 - share / (land or 1.0), 0.0)
        return turned(root, (space - polar) * into)

    def locate(self, points: Array) -> tuple[Array, Array]:
        """Return the flank coordinates (u, w) of points (..., 3); see `ToothBody.locate`."""
        gear = self.gear
        length, depth = gear.blank(points)
        _, foot_depth = self._foot(length)
        up = (depth - foot_depth) / (gear.tip_depth - foot_depth)
        return self.foot + (1.0 - self.foot) * up, (length - gear.inner) / gear.face_width

    def margins(self, a: Array, b: Array) -> dict[str, Array]:
        """Return distances to the flank's edges at ξ = `a`, Φ = `b`; see `ToothBody.margins`."""
        gear, shaper = self.gear, self.gear.shaper
        length, depth = gear.blank(self.flank.point(a, b))
        return {
            "tip": depth - gear.tip_depth,
            "root": shaper.base_radius * (shaper.tip_roll - a),
            "inner end": length - gear.inner,
            "outer end": gear.outer - length,
        }

    def _foot(self, length: Array) -> tuple[Array, Array]:
        """Return the base-tangent angle and depth where the shaper's tip ends the flank."""
        tip = np.full_like(length, self.gear.shaper.tip_roll)
        phi = self.flank.at_length(length, tip)
        return phi, self.gear.blank(self.flank.point(tip, phi))[1]

    @property
    def _last_phi(self) -> float:
        """Base-tangent angle at which the shaper's tip corner is deepest in the gear."""
        return -math.atan(self.gear.shaper.tip_roll)

    @cached_property
    def _land_share(self) -> float:
        """Share of u from 0 to `foot` that is land; the rest is fillet.

        It is the same over the whole width, so that a line of constant u stays on the fillet: the
        share of the length at mid-width, but at most one half, because the fillet shrinks outwards.
        """
        gear = self.gear
        middle = np.array(gear.pitch_radius)
        corner = self._corner(middle, self._foot(middle)[0], np.linspace(0.0, 1.0, 33))
        fillet = np.linalg.norm(np.diff(corner, axis=0), axis=1).sum()
        # The tip land cuts the space while the shaper turns through the land's own half angle.
        radius = math.hypot(corner[0, 0], corner[0, 1])
        land = radius * gear.roll_ratio * gear.shaper.tip_half_angle
        return min(float(land / (land + fillet)), 0.5)

    def _corner(self, length: Array, foot_phi: Array, along: Array) -> Array:
        """Return the shaper's tip corner path, from the deepest point (`along` 0) to the flank."""
        gear, shaper = self.gear, self.gear.shaper
        phi = self._last_phi + along * (foot_phi - self._last_phi)
        polar = phi + math.atan(shaper.tip_roll)
        towards, tangential, axis = gear.axes.T
        arm = shaper.tip * (
            np.cos(polar)[..., None] * towards + np.sin(polar)[..., None] * tangential
        )
        axial = np.broadcast_to(length, polar.shape)
        sine, cosine = axis[0], axis[2]
        for _ in range(TEETH.meets):
            point = axial[..., None] * axis + arm
            rise = point[..., 0] / np.hypot(point[..., 0], point[..., 1])
            step = (gear.blank(point)[0] - length) / (sine**2 * rise + cosine**2)
            axial = axial - step
            if np.abs(step).max(initial=0.0) < TEETH.last_step:
                break
        point = axial[..., None] * axis + arm
        angle = gear.roll_ratio * (shaper.base_half_angle - shaper.tip_roll - phi)
        return turned(point, angle - math.pi / gear.teeth)
