"""The solid tooth of a cylindrical gear, and its root curve up to the involute."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from loadshare.settings import TEETH
from loadshare.tooth.cylindrical.gear import HelicoidGear
from loadshare.tooth.geometry.body import Array, ToothBody

Curve: TypeAlias = Callable[[Array], Array]


@dataclass(frozen=True)
class HelicoidBody(ToothBody):
    """`ToothBody` of a cylindrical gear, without its micrometre modifications.

    For a herringbone gear it is one half, with z = 0 in the middle of that half.
    """

    gear: HelicoidGear

    @property
    def rim(self) -> float:
        """Inner radius of the body, outer radius if internal [m]."""
        return self.gear.rim_radius

    @property
    def axial_pitches(self) -> float:
        """Number of axial pitches in the face width."""
        return self.gear.face_width * abs(self.gear.twist) * self.gear.teeth / (2.0 * math.pi)

    @cached_property
    def _root(self) -> Curve:
        return root_curve(self.gear)

    def outline(self, u: ArrayLike, w: ArrayLike, side: int) -> Array:
        """Return the boundary of half of tooth 0; see `ToothBody.outline`.

        `u` is linear in arc length on the fillet and on the involute.
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
        """Return the flank coordinates (u, w) of points (..., 3); see `ToothBody.locate`."""
        gear = self.gear
        square = (points[..., 0] ** 2 + points[..., 1] ** 2) / gear.base_radius**2 - 1.0
        up = (square - gear.form_roll**2) / (gear.tip_roll**2 - gear.form_roll**2)
        return self.foot + (1.0 - self.foot) * up, points[..., 2] / gear.face_width + 0.5

    def margins(self, a: Array, b: Array) -> dict[str, Array]:
        """Return distances to the flank's edges at ξ = `a`, ζ = `b`; see `ToothBody.margins`."""
        gear, reach = self.gear, self.gear.kind * self.gear.base_radius
        return {
            "tip": reach * (gear.tip_roll - a),
            "root": reach * (a - gear.form_roll),
            "face": 0.5 * gear.face_width - np.abs(b),
        }


def root_curve(gear: HelicoidGear) -> Curve:
    """Return the transverse root curve of tooth 0 on its side +1, at ζ = 0.

    Parameters
    ----------
    gear : HelicoidGear
        A gear without undercut.

    Returns
    -------
    callable
        Function that returns complex points x + iy [m] at shares v of the curve's length, from 0
        in the middle of the space to 1 where the involute begins.
    """
    curve = _filleted(gear) if gear.internal else _generated(gear)
    return _by_length(curve)


def rack_tip_half_width(gear: HelicoidGear) -> float:
    """Return half the width of the flat on the generating rack's tip, in normal section [m].

    Negative where the tip radius is too large for the rack's tooth.
    """
    corner_depth = gear.dedendum - gear.tip_radius
    slope = math.tan(gear.pressure_angle)
    radius_share = gear.tip_radius / math.cos(gear.pressure_angle)
    return gear.module * (math.pi / 4 - corner_depth * slope - radius_share)


def fillet_angle(gear: HelicoidGear) -> float:
    """Return the polar angle [rad] of an internal gear's root fillet centre, from tooth 0."""
    beside = gear.form_roll - gear.tip_radius * gear.module / gear.base_radius
    return gear.base_half_angle + gear.form_roll - math.atan(beside)


def _generated(gear: HelicoidGear) -> Curve:
    """Return the root circle for −1 ≤ t ≤ 0, trochoid of the rack's tip radius for 0 ≤ t ≤ 1.

    The rack rolls on the reference circle. A point of its tip, whose normal makes the angle τ with
    the direction of depth, generates when that normal passes through the pitch point; in the
    transverse section of a helical gear the tip is an ellipse.
    """
    cos_helix = math.cos(gear.helix_angle)
    corner = gear.tip_radius * gear.module
    corner_x = rack_tip_half_width(gear) / cos_helix
    corner_y = (gear.profile_shift - gear.dedendum) * gear.module + corner
    last = 0.5 * math.pi - gear.pressure_angle
    half_pitch = math.pi / gear.teeth

    def curve(t: Array) -> Array:
        tau = last * np.maximum(t, 0.0)
        x = corner_x + corner * np.sin(tau) / cos_helix
        y = corner_y - corner * np.cos(tau)
        beside = -y * np.tan(tau) * cos_helix
        angle = half_pitch + (beside - x) / gear.radius - np.arctan2(beside, y + gear.radius)
        angle = np.where(t < 0.0, half_pitch + (angle - half_pitch) * (1.0 + t), angle)
        points: Array = np.hypot(beside, y + gear.radius) * np.exp(1j * angle)
        return points

    return curve


def _filleted(gear: HelicoidGear) -> Curve:
    """Return the root circle for −1 ≤ t ≤ 0, arc tangent to it and the involute for 0 ≤ t ≤ 1."""
    corner = gear.tip_radius * gear.module
    centre_angle = fillet_angle(gear)
    end = gear.base_half_angle + gear.form_roll - 0.5 * math.pi
    half_pitch = math.pi / gear.teeth

    def curve(t: Array) -> Array:
        turn = np.where(t < 0.0, half_pitch + (centre_angle - half_pitch) * (1.0 + t), centre_angle)
        facing = turn + (end - centre_angle) * np.maximum(t, 0.0)
        points: Array = (gear.root - corner) * np.exp(1j * turn) + corner * np.exp(1j * facing)
        return points

    return curve


def _by_length(curve: Curve) -> Curve:
    """Change a curve's parameter from −1 ≤ t ≤ 1 to the share of its length."""
    from scipy.interpolate import PchipInterpolator

    grid = np.concatenate([[-1.0], np.linspace(0.0, 1.0, 65)])
    chord = np.abs(np.diff(curve(grid)))
    chord[0] = abs(curve(np.zeros(1))[0]) * abs(np.angle(curve(grid[:1]) / curve(grid[1:2]))[0])
    length = np.concatenate([[0.0], np.cumsum(chord)])
    if length[1] >= length[-1]:  # a sharp corner
        return lambda v: curve(v - 1.0)
    flat = length[1] <= TEETH.fits * length[-1]
    if flat:
        grid, length = grid[1:], length[1:] - length[1]
    share = length / length[-1]
    fillet = PchipInterpolator(share if flat else share[1:], grid if flat else grid[1:])
    start = 0.0 if flat else share[1]

    def by_share(v: Array) -> Array:
        on_circle = v / start - 1.0 if start > 0.0 else v
        return curve(np.where(v < start, on_circle, fillet(np.clip(v, start, 1.0))))

    return by_share
