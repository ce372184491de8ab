"""The gap between two flanks along the line on which they come closest."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from loadshare.errors import LoadshareError
from loadshare.tooth.body import Array
from loadshare.tooth.flank import Patch, dot

# A Newton step below this [m] is the last: convergence is quadratic, so that what is left is its
# square over a radius of curvature, far below round-off.
LAST_STEP = 1e-10


@dataclass(frozen=True, eq=False)
class Trace:
    """Points of contact lines, m lines with n stations each.

    Parameters
    ----------
    driver, driven : Patch
        Both flanks where the normal of the driver's meets them, fixed frame.
    driver_at, driven_at : tuple of two arrays (m, n)
        Their surface parameters.
    gap : array (m, n)
        Distance along the driver's normal [m], negative where the flanks overlap; NaN where the
        normal does not meet the driven flank.
    tangent : array (m, n, 3)
        Derivative of the driver's point with respect to the station.
    """

    driver: Patch
    driven: Patch
    driver_at: tuple[Array, Array]
    driven_at: tuple[Array, Array]
    gap: Array
    tangent: Array

    @property
    def slope(self) -> Array:
        """Derivative of the gap with respect to the station (m, n).

        X + t n stays on the driven flank, so that its derivative has no part along that normal.
        """
        across = self.driven.normal
        moving = self.tangent + self.gap[..., None] * self.driver.normal_change(self.tangent)
        slope: Array = -dot(moving, across) / dot(self.driver.normal, across)
        return slope


class Lines(Protocol):
    """The contact lines of a pair of gears, as geometry gives them before any gap is known."""

    @property
    def arm(self) -> float:
        """Approach along the normal per radian of the driver [m]."""
        ...

    def ideal(self, phase: float) -> tuple[float, float]:
        """Rotations of driver and driven gear at a phase of the ideal pair [rad]."""
        ...

    def extents(self, driver: float, driven: float) -> tuple[Array, Array, Array]:
        """Pairs on both active flanks, with the first and last station of their lines [m]."""
        ...

    def patches(
        self,
        pairs: Array,
        driver_at: tuple[Array, Array],
        driven_at: tuple[Array, Array],
        driver: Array | float,
        driven: float,
    ) -> tuple[Patch, Patch]:
        """Points of both flanks of pairs of teeth, fixed frame."""
        ...

    def trace(self, pairs: Array, stations: Array, driver: float, driven: float) -> Trace:
        """Flanks and gap at stations (m, n) of the lines of m pairs."""
        ...

    def margins(
        self, driver_at: tuple[Array, Array], driven_at: tuple[Array, Array]
    ) -> Mapping[str, Array]:
        """Distance to every edge of the active flanks by name [m], negative beyond it."""
        ...


def least_gap(
    lines: Lines, pairs: Array, start: Array, end: Array, driver: float, driven: float
) -> tuple[Array, Array]:
    """Least gap on each line, ends included, and the station where it stands.

    A grid finds the place; where the slope of the gap changes sign beside it, the secant of the
    slope gives the station.

    Parameters
    ----------
    lines : Lines
        The pair of gears.
    pairs, start, end : array (m,)
        Pairs of teeth with their first and last station.
    driver, driven : float
        Rotations [rad].

    Returns
    -------
    gap, station : array (m,)
        Both in metres.
    """
    row = np.arange(len(pairs))
    low, high = start, end
    for grid in (17, 9):
        stations = low[:, None] + (high - low)[:, None] * np.linspace(0.0, 1.0, grid)
        trace = lines.trace(pairs, stations, driver, driven)
        if not np.isfinite(trace.gap).all():
            raise LoadshareError(
                "the flanks do not face each other along the whole contact line; "
                "make the misalignment or the modifications smaller"
            )
        at = np.argmin(trace.gap, axis=1)
        left, right = np.maximum(at - 1, 0), np.minimum(at + 1, grid - 1)
        low, high = stations[row, left], stations[row, right]
    least, station = trace.gap[row, at], stations[row, at]
    slope = trace.slope
    falling = slope[row, at] > 0.0
    left, right = np.where(falling, left, at), np.where(falling, at, right)
    before, after = slope[row, left], slope[row, right]
    turns = (before < 0.0) & (after > 0.0)
    if turns.any():
        share = before / np.where(turns, before - after, 1.0)
        between = stations[row, left] + share * (stations[row, right] - stations[row, left])
        between = np.where(turns, between, station)
        found = lines.trace(pairs, between[:, None], driver, driven).gap[:, 0]
        better = found < least
        least, station = np.where(better, found, least), np.where(better, between, station)
    return least, station


def meet(
    lines: Lines,
    pairs: Array,
    driver_at: tuple[Array, Array],
    driven_at: tuple[Array, Array],
    driver: float,
    driven: float,
) -> tuple[Patch, Patch, tuple[Array, Array], Array]:
    """Follow the driver's normals to the driven flank, by Newton's method.

    Parameters
    ----------
    lines : Lines
        The pair of gears.
    pairs : array (m, n)
        Pair of teeth of every point.
    driver_at : tuple of two arrays (m, n)
        Points of the driver's flank.
    driven_at : tuple of two arrays (m, n)
        Where to start on the driven flank.
    driver, driven : float
        Rotations [rad].

    Returns
    -------
    driver, driven : Patch
        Both flanks where the normals meet them.
    driven_at : tuple of two arrays (m, n)
        Surface parameters there.
    gap : array (m, n)
        Distance along the normals [m], NaN where Newton's method found no point.
    """
    a, b = driven_at
    own, other = lines.patches(pairs, driver_at, (a, b), driver, driven)
    gap = dot(other.point - own.point, own.normal)
    for _ in range(25):
        apart = own.point + gap[..., None] * own.normal - other.point
        columns = np.stack([other.point_a, other.point_b, -own.normal], axis=-1)
        step = solve(columns, apart)
        a, b, gap = a + step[..., 0], b + step[..., 1], gap + step[..., 2]
        _, other = lines.patches(pairs, driver_at, (a, b), driver, driven)
        moved = np.abs(np.einsum("...ij,...j->...i", columns, step)).max(axis=-1)
        if moved.max() < LAST_STEP:
            break
    return own, other, (a, b), np.where(moved < LAST_STEP, gap, np.nan)


def solve(matrix: Array, right: Array) -> Array:
    """Solve stacked small systems; a singular one gives NaN instead of stopping the others."""
    try:
        answer = np.asarray(np.linalg.solve(matrix, right[..., None])[..., 0], np.float64)
    except np.linalg.LinAlgError:
        regular = np.abs(np.linalg.det(matrix)) > 0.0
        matrix = np.where(regular[..., None, None], matrix, np.eye(matrix.shape[-1]))
        answer = np.asarray(np.linalg.solve(matrix, right[..., None])[..., 0], np.float64)
        answer = np.where(regular[..., None], answer, np.nan)
    return answer
