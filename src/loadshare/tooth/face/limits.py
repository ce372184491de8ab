"""How far in and out a face gear can reach: undercut and pointed teeth."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

from loadshare.tooth.face.flank import FaceFlank
from loadshare.tooth.face.gear import FaceGear
from loadshare.tooth.geometry.body import Array
from loadshare.tooth.geometry.flank import dot


def undercut_limit(gear: FaceGear) -> float:
    """Inner limit L1 of the blank, where the shaper's tip begins to undercut the flank [m].

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
    angle = _root(margin, 1e-6, 0.5 * math.pi - 1e-6)
    point = flank.patch(np.array(tip), np.array(flank.side * angle), 0.0).point
    return float(gear.blank(point)[0])


def regularity(flank: FaceFlank, roll: Array, phi: Array) -> Array:
    """Area of the surface tangents over r_bs², positive on the regular part of the flank."""
    patch = flank.patch(roll, phi, 0.0)
    area = dot(np.cross(*patch.rays), patch.normal)
    return flank.side * area / flank.gear.shaper.base_radius**2


def pointing_limit(gear: FaceGear) -> float:
    """Outer limit L2 of the blank, where the tip land vanishes [m].

    Solved on the true surface: both flanks of a tooth meet at tip depth.
    """
    flank = FaceFlank(gear)

    def margin(length: float) -> float:
        return tip_half_angle(flank, length)

    # The plane section is within a percent or two of the answer.
    planar = planar_pointing_limit(gear)
    return _root(margin, max(undercut_limit(gear), 0.9 * planar), 1.2 * planar)


def tip_half_angle(flank: FaceFlank, length: float) -> float:
    """Half the angle of the tip land at a length of the blank, seen from the gear's axis [rad]."""
    roll, phi = flank.at_blank(np.array(length), np.array(flank.gear.tip_depth))
    point = flank.patch(roll, phi, 0.0).point
    return float(flank.side * np.arctan2(point[1], point[0]))


def planar_pointing_limit(gear: FaceGear) -> float:
    """Outer limit by Litvin's plane section, which takes the profile as a straight rack's [m].

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
    return gear.axial_scale / math.cos(_root(margin, lowest, 0.5 * math.pi - 1e-6))


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    return float(brentq(function, low, high, xtol=1e-14, rtol=1e-14))
