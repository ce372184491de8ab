"""Contact lines where contact is localised: the valley of the gap between two flanks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from loadshare.tooth.body import Array
from loadshare.tooth.flank import Patch, dot, principal_directions
from loadshare.tooth.gap import LAST_STEP, Lines, Trace, solve

# From the anchor, points on the flanks are found in four to seven steps; what takes longer lies
# beyond the edge of regression of the driven flank or inside the driver's base circle.
NEWTON_STEPS = 10


@dataclass(frozen=True, eq=False)
class Anchor:
    """Where the valleys of m pairs of teeth begin: points at which both flanks nearly touch.

    Parameters
    ----------
    driver_at, driven_at : tuple of two arrays (m, 1)
        Surface parameters on both flanks.
    point : array (m, 1, 3)
        Origin of the stations [m].
    major, minor : array (m, 1, 3)
        Directions of least and of greatest relative curvature.
    """

    driver_at: tuple[Array, Array]
    driven_at: tuple[Array, Array]
    point: Array
    major: Array
    minor: Array


def anchor(
    driver_at: tuple[Array, Array], driven_at: tuple[Array, Array], flanks: tuple[Patch, Patch]
) -> Anchor:
    """Anchor the valleys at given points, with the principal directions found there."""
    major, minor = principal_directions(*flanks)
    return Anchor(driver_at, driven_at, flanks[0].point, major, minor)


def follow(
    lines: Lines,
    pairs: Array,
    stations: Array,
    start: Anchor,
    driver: float,
    driven: float,
) -> Trace:
    """Follow valleys of the gap at stations along the major axis of the contact ellipse.

    At every station s the point X of the driver's flank lies at (X − X0)·e_major = s, its normal
    meets the driven flank at the distance t, and the gap does not change along e_minor:

        X + t n = Y,   (X − X0)·e_major = s,   (n + n_driven)·e_minor = 0,

    five equations for two parameters on either flank and t, solved by Newton's method. The line so
    found passes through the point of contact, is tangent there to the major axis, and is the
    contact line itself where the flanks touch along one.

    Parameters
    ----------
    lines : Lines
        The pair of gears.
    pairs : array (m,)
        Pairs of teeth.
    stations : array (m, n)
        Distances along the major axis [m].
    start : Anchor
        Where the stations count from.
    driver, driven : float
        Rotations [rad].

    Returns
    -------
    Trace
        With NaN as gap where Newton's method finds no point.
    """
    pairs = np.broadcast_to(pairs[:, None], stations.shape)
    a, b, c, d = (
        np.broadcast_to(part, stations.shape) for part in (*start.driver_at, *start.driven_at)
    )
    gap = np.zeros(stations.shape)
    for _ in range(NEWTON_STEPS):
        own, other = lines.patches(pairs, (a, b), (c, d), driver, driven)
        matrix = _matrix(own, other, gap, start)
        right = np.empty((*stations.shape, 5))
        right[..., :3] = other.point - own.point - gap[..., None] * own.normal
        right[..., 3] = stations - dot(own.point - start.point, start.major)
        right[..., 4] = -dot(own.normal + other.normal, start.minor)
        with np.errstate(invalid="ignore", over="ignore"):
            step = solve(matrix, right)
            moved = np.abs(step * _scale(matrix)).max(axis=-1)
            a, b, c, d, gap = (old + step[..., i] for i, old in enumerate((a, b, c, d, gap)))
        if not np.nanmax(moved) > LAST_STEP:
            break
    own, other = lines.patches(pairs, (a, b), (c, d), driver, driven)
    unit_station = np.zeros((*stations.shape, 5))
    unit_station[..., 3] = 1.0
    along = solve(_matrix(own, other, gap, start), unit_station)
    tangent = along[..., :1] * own.point_a + along[..., 1:2] * own.point_b
    return Trace(own, other, (a, b), (c, d), np.where(moved <= LAST_STEP, gap, np.nan), tangent)


def _matrix(own: Patch, other: Patch, gap: Array, start: Anchor) -> Array:
    matrix = np.zeros((*gap.shape, 5, 5))
    reach = gap[..., None]
    matrix[..., :3, 0] = own.point_a + reach * own.normal_a
    matrix[..., :3, 1] = own.point_b + reach * own.normal_b
    matrix[..., :3, 2] = -other.point_a
    matrix[..., :3, 3] = -other.point_b
    matrix[..., :3, 4] = own.normal
    matrix[..., 3, 0] = dot(own.point_a, start.major)
    matrix[..., 3, 1] = dot(own.point_b, start.major)
    for column, change in enumerate((own.normal_a, own.normal_b, other.normal_a, other.normal_b)):
        matrix[..., 4, column] = dot(change, start.minor)
    return matrix


def _scale(matrix: Array) -> Array:
    """Metres that the points move per unit of each unknown."""
    length: Array = np.sqrt((matrix[..., :3, :] ** 2).sum(axis=-2))
    return length
