"""The flank of a face gear in closed form, as the envelope of its shaper, and its limits.

Undercut limits how far in a face gear can reach, and pointed teeth how far out.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import NamedTuple, TypeAlias

import numpy as np

from loadshare.settings import TEETH
from loadshare.tooth.face.gear import FaceGear
from loadshare.tooth.geometry.body import Array
from loadshare.tooth.geometry.flank import Patch, dot, patch, solve_2

Place: TypeAlias = tuple[Array, Array]


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

    def patch(self, a: Array | float, b: Array, turn: Array | float) -> Patch:
        """Return points of the flank at ξ = `a` and Φ = `b` [rad]; see `HelicoidFlank.patch`."""
        from loadshare.tooth.geometry.compiled import faces

        return patch(faces, self.numbers, a, b, turn)

    @cached_property
    def numbers(self) -> FaceNumbers:
        """The flank in the form that compiled code reads."""
        gear, shaper = self.gear, self.gear.shaper
        return FaceNumbers(
            side=float(self.side),
            teeth=gear.teeth,
            ratio=gear.roll_ratio,
            scale=gear.axial_scale,
            base=shaper.base_radius,
            half_angle=shaper.base_half_angle,
            axes=gear.axes,
        )

    def point(self, roll: Array, phi: Array) -> Array:
        """Return points (..., 3) of the flank of tooth 0 at surface parameters ξ and Φ [m]."""
        return self.patch(roll, phi, 0.0).point

    def at_blank(self, length: Array, depth: Array) -> tuple[Array, Array]:
        """Return the surface parameters of points at given lengths and depths of the blank [m].

        Newton's method starts from the plane section that the flank would have at infinite radius.

        Returns
        -------
        roll, phi : array
            NaN where the flank has no such point.
        """
        with np.errstate(invalid="ignore"):
            start = np.arccos(self.gear.axial_scale / length)
            roll = (depth / self.gear.shaper.base_radius - np.cos(start)) / np.sin(start)
        roll, phi = np.broadcast_arrays(roll, self.side * start)
        for _ in range(TEETH.steps):
            at, slopes = self._blank(roll, phi)
            step = solve_2(*slopes, at[0] - length, at[1] - depth)
            roll, phi = roll - step[0], phi - step[1]
            if not np.any(np.abs(step) > TEETH.last_turn):
                break
        return roll, phi

    def at_length(self, length: Array, roll: Array | float) -> Array:
        """Return the angle Φ of the base tangent at given lengths of the blank and shaper rolls."""
        with np.errstate(invalid="ignore"):
            phi = self.side * np.arccos(self.gear.axial_scale / length)
        for _ in range(TEETH.steps):
            at, slopes = self._blank(roll, phi)
            step = (at[0] - length) / slopes[0][1]
            phi = phi - step
            if not np.any(np.abs(step) > TEETH.last_turn):
                break
        return phi

    def _blank(self, roll: Array | float, phi: Array) -> tuple[Place, tuple[Place, Place]]:
        """Return length and depth of the blank [m], and the slopes of both over ξ and Φ."""
        patch = self.patch(roll, phi, 0.0)
        point, rays = patch.point, patch.rays
        radius = np.hypot(point[..., 0], point[..., 1])
        out = (rays[..., 0] * point[..., 0] + rays[..., 1] * point[..., 1]) / radius
        sine, cosine = math.sin(self.gear.shaft_angle), math.cos(self.gear.shaft_angle)
        along, down = out * sine + rays[..., 2] * cosine, out * cosine - rays[..., 2] * sine
        return self.gear.blank(point), ((along[0], along[1]), (down[0], down[1]))


class FaceNumbers(NamedTuple):
    """Numbers of a flank, named as in `FaceGear`; `base` and `half_angle` are the shaper's."""

    side: float
    teeth: int
    ratio: float
    scale: float
    base: float
    half_angle: float
    axes: Array


def undercut_limit(gear: FaceGear) -> float:
    """Return the inner limit L1 of the blank, where the shaper's tip begins to undercut [m].

    There the line of singular points of the envelope, on which the two surface tangents are
    parallel, meets the line that the shaper's tip corner traces. For side s and u' = du/dΦ the
    condition is (ẑ×X·e_r) u' + s r_bs ξ (ẑ×X·a) = 0 (Litvin & Fuentes, ch. 18, as a set of three
    determinants).
    """
    flank = FaceFlank(gear)
    tip = gear.shaper.tip_roll

    def margin(angle: float) -> float:
        return float(regularity(flank, np.array(tip), np.array(flank.side * angle)))

    # Near Φ = 0 the margin is negative; it grows without bound towards 90°.
    angle = root_of(margin, TEETH.beside, 0.5 * math.pi - TEETH.beside)
    point = flank.patch(np.array(tip), np.array(flank.side * angle), 0.0).point
    return float(gear.blank(point)[0])


def regularity(flank: FaceFlank, roll: Array, phi: Array) -> Array:
    """Return the area of the surface tangents over r_bs², positive where the flank is regular."""
    patch = flank.patch(roll, phi, 0.0)
    area = dot(np.cross(*patch.rays), patch.normal)
    return flank.side * area / flank.gear.shaper.base_radius**2


def pointing_limit(gear: FaceGear) -> float:
    """Return the outer limit L2 of the blank, where the tip land vanishes [m].

    Solved on the true surface: both flanks of a tooth meet at tip depth.
    """
    margin = partial(tip_half_angle, FaceFlank(gear))
    # The plane section is within a percent or two of the answer.
    planar = planar_pointing_limit(gear)
    return root_of(margin, max(undercut_limit(gear), 0.9 * planar), 1.2 * planar)


def tip_half_angle(flank: FaceFlank, length: float) -> float:
    """Return half the angle of the tip land at a length of the blank, about the gear axis [rad]."""
    roll, phi = flank.at_blank(np.array(length), np.array(flank.gear.tip_depth))
    point = flank.patch(roll, phi, 0.0).point
    return float(flank.side * np.arctan2(point[1], point[0]))


def planar_pointing_limit(gear: FaceGear) -> float:
    """Return the outer limit by Litvin's plane section, which treats the profile as a rack's [m].

    α − (depth/r_bs) sin α = π/(2 N_s) − inv α_0 (for a shaper without profile shift), then
    L2 = u(α). Litvin & Fuentes, ch. 18.
    """
    shaper = gear.shaper
    depth = gear.tip_depth / shaper.base_radius
    right = math.pi / shaper.teeth - shaper.base_half_angle

    def margin(angle: float) -> float:
        return angle - depth * math.sin(angle) - right

    # With depth > 1 the left side falls before it rises; the root sought is on the rising branch.
    lowest = math.acos(1.0 / depth) if depth > 1.0 else 0.0
    return gear.axial_scale / math.cos(root_of(margin, lowest, 0.5 * math.pi - TEETH.beside))


class NoLimitError(ValueError):
    """The limit does not exist for teeth of these proportions."""


def root_of(function: Callable[[float], float], low: float, high: float) -> float:
    """Return the zero of a function between two values.

    Raises
    ------
    NoLimitError
        If there is none.
    """
    ends = function(low), function(high)
    if not min(ends) <= 0.0 <= max(ends):
        raise NoLimitError
    from scipy.optimize import brentq

    return float(brentq(function, low, high, xtol=TEETH.zero, rtol=TEETH.zero))
