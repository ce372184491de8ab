"""The solid tooth of a cylindrical gear."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from loadshare.tooth.cylindrical.gear import HelicoidGear
from loadshare.tooth.cylindrical.root import Curve, root_curve
from loadshare.tooth.geometry.body import Array, ToothBody


@dataclass(frozen=True)
class HelicoidBody(ToothBody):
    """`ToothBody` of a cylindrical gear, without its micrometre modifications.

    Of a herringbone gear it is one half, with z = 0 in the middle of that half.
    """

    gear: HelicoidGear

    @property
    def shape(self) -> Literal["external", "internal"]:
        """Kind of gear body."""
        return "internal" if self.gear.internal else "external"

    @property
    def rim(self) -> float:
        """Inner radius of the body, outer radius if internal [m]."""
        return self.gear.rim_radius

    @cached_property
    def _root(self) -> Curve:
        return root_curve(self.gear)

    def outline(self, u: ArrayLike, w: ArrayLike, side: int) -> Array:
        """Boundary of half of tooth 0; see `ToothBody.outline`.

        The fillet goes by its length, and so does the involute.
        """
        gear = self.gear
        u, w = np.broadcast_arrays(np.asarray(u, float), np.asarray(w, float))
        axial = (w - 0.5) * gear.face_width
        up = np.maximum((u - self.foot) / (1.0 - self.foot), 0.0)
        roll = np.sqrt(gear.form_roll**2 + up * (gear.tip_roll**2 - gear.form_roll**2))
        phi = gear.base_half_angle - gear.kind * roll
        involute = gear.base_radius * (1.0 + 1j * gear.kind * roll) * np.exp(1j * phi)
        root = self._root(np.minimum(u / self.foot, 1.0))
        half = np.where(u <= self.foot, root, involute)
        section = (half if side > 0 else half.conj()) * np.exp(1j * gear.twist * axial)
        return np.stack([section.real, section.imag, axial], axis=-1)

    def locate(self, points: Array) -> tuple[Array, Array]:
        """Flank coordinates (u, w) of points (..., 3); see `ToothBody.locate`."""
        gear = self.gear
        square = (points[..., 0] ** 2 + points[..., 1] ** 2) / gear.base_radius**2 - 1.0
        up = (square - gear.form_roll**2) / (gear.tip_roll**2 - gear.form_roll**2)
        return self.foot + (1.0 - self.foot) * up, points[..., 2] / gear.face_width + 0.5

    def margins(self, a: Array, b: Array) -> dict[str, Array]:
        """Distance to the edges of the flank, at ξ = `a` and ζ = `b`; see `ToothBody.margins`."""
        gear, reach = self.gear, self.gear.kind * self.gear.base_radius
        return {
            "tip": reach * (gear.tip_roll - a),
            "root": reach * (a - gear.form_roll),
            "face": 0.5 * gear.face_width - np.abs(b),
        }
