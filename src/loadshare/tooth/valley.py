"""Contact lines where contact is localised: the valley of the gap between two flanks."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from loadshare.tooth.body import Array
from loadshare.tooth.flank import Patch, cross, dot, principal_directions, solve_2
from loadshare.tooth.gap import LAST_STEP, Lines, Trace

# From the anchor, points on the flanks are found in three to six steps, from their neighbours in
# two or three; what takes longer lies beyond the edge of regression of the driven flank or inside
# the driver's base circle.
NEWTON_STEPS = 10
# After so many steps each is a quarter of the one before, or Newton's method gets nowhere in time.
SURE = 3

Index: TypeAlias = NDArray[np.int64] | NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Anchor:
    """Where the valleys of m pairs of teeth begin: points at which both flanks nearly touch.

    Parameters
    ----------
    at : array (4, m)
        Surface parameters on the driver's and on the driven flank.
    point : array (m, 3)
        Origin of the stations [m].
    major, minor : array (m, 3)
        Directions of least and of greatest relative curvature.
    """

    at: Array
    point: Array
    major: Array
    minor: Array

    def rows(self, chosen: Index) -> Anchor:
        """Anchors of some lines."""
        return Anchor(
            self.at[:, chosen], self.point[chosen], self.major[chosen], self.minor[chosen]
        )


def anchor(
    driver_at: tuple[Array, Array], driven_at: tuple[Array, Array], flanks: tuple[Patch, Patch]
) -> Anchor:
    """Anchor the valleys at given points (m,), with the principal directions found there."""
    major, minor = principal_directions(*flanks)
    return Anchor(np.stack([*driver_at, *driven_at]), flanks[0].point, major, minor)


@dataclass(frozen=True, eq=False)
class Valleys:
    """Valleys of the gap between the flanks of m pairs, along the axis of the contact ellipse.

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
    pairs, driver, driven : array (m,)
        Pairs of teeth, and the rotations of the gears [rad].
    start : Anchor
        Where the stations count from.
    known : tuple of array (m, g) and array (5, m, g), optional
        Evenly spaced stations with what was found there, from which Newton's method begins.
    """

    lines: Lines
    pairs: Array
    driver: Array
    driven: Array
    start: Anchor
    known: tuple[Array, Array] | None = field(default=None, repr=False)

    def rows(self, chosen: Index) -> Valleys:
        """The valleys of some pairs."""
        known = self.known and (self.known[0][chosen], self.known[1][:, chosen])
        turned = self.pairs[chosen], self.driver[chosen], self.driven[chosen]
        return Valleys(self.lines, *turned, self.start.rows(chosen), known)

    def knowing(self, stations: Array, found: Array) -> Valleys:
        """The same valleys with what was found (5, m, g) at evenly spaced stations (m, g)."""
        return replace(self, known=(stations, found))

    def guess(self, stations: Array) -> Array | None:
        """What :meth:`find` finds, good to micrometres, where all that it takes is known."""
        near = self.known and _interpolated(*self.known, stations)
        return near if near is not None and np.isfinite(near).all() else None

    def find(self, stations: Array, last: float = LAST_STEP) -> Array:
        """Surface parameters on both flanks and gap (5, m, n) at stations (m, n) [m].

        The gap is NaN where Newton's method finds no point. A step below `last` [m] is the last.
        """
        unknowns = self._begin(stations).reshape(5, -1)
        line = np.repeat(np.arange(len(stations)), stations.shape[1])
        found = np.full_like(unknowns, np.nan)
        left = np.arange(len(line))
        here, wanted = self._points(line), stations.ravel()
        before = np.full(len(line), np.inf)
        for number in range(NEWTON_STEPS):
            step, moved = here._step(unknowns, wanted)
            unknowns = unknowns + step
            done = moved <= last
            found[:, left[done]] = unknowns[:, done]
            going = ~done & np.isfinite(moved)
            if number >= SURE:
                going &= moved < 0.25 * before
            if not going.any():
                break
            before = moved[going]
            if not going.all():
                left, unknowns, wanted = left[going], unknowns[:, going], wanted[going]
                here = here.rows(going)
        return found.reshape(5, *stations.shape)

    def trace(self, stations: Array) -> Trace:
        """Flanks and gap at stations (m, n) [m]."""
        a, b, c, d, gap = self.find(stations)
        line = np.repeat(np.arange(len(stations)), stations.shape[1]).reshape(stations.shape)
        here = self._points(line)
        own, other = here._flanks((a, b), (c, d))
        along = here._slopes(own, other, gap)
        tangent = along[0][..., None] * own.rays[0] + along[1][..., None] * own.rays[1]
        return Trace(own, other, (a, b), (c, d), gap, tangent)

    def _points(self, line: Index) -> Valleys:
        """The valley of every point, by the numbers of their lines."""
        return replace(self, known=None).rows(line)

    def _slopes(self, own: Patch, other: Patch, gap: Array) -> Array:
        """Derivatives (5, ...) of the unknowns over the station."""
        still, one = np.zeros_like(gap), np.ones_like(gap)
        return _solve(own, other, gap, self.start, 0.0 * own.point, one, still)

    def _flanks(
        self, driver_at: tuple[Array, Array], driven_at: tuple[Array, Array]
    ) -> tuple[Patch, Patch]:
        return (
            self.lines.driver_patch(self.pairs, driver_at, self.driver),
            self.lines.driven_patch(self.pairs, driven_at, self.driven),
        )

    def _begin(self, stations: Array) -> Array:
        """First guesses (5, m, n): cubic interpolation of what is known, else the tangent."""
        near = self.known and _interpolated(*self.known, stations)
        if near is not None and np.isfinite(near).all():
            return near
        a, b, c, d = self.start.at
        slopes = self._slopes(*self._flanks((a, b), (c, d)), np.zeros_like(a))
        start = slopes[:, :, None] * stations
        start[:4] += self.start.at[:, :, None]
        return start if near is None else np.where(np.isfinite(near), near, start)

    def _step(self, unknowns: Array, stations: Array) -> tuple[Array, Array]:
        """Newton's step (5, n) at one point of every line, and how far it moves points [m]."""
        a, b, c, d, gap = unknowns
        own, other = self._flanks((a, b), (c, d))
        start = self.start
        step = _solve(
            own,
            other,
            gap,
            start,
            other.point - own.point - gap[..., None] * own.normal,
            stations - dot(own.point - start.point, start.major),
            -dot(own.normal + other.normal, start.minor),
        )
        moved = np.abs(step)
        moved[:2] *= np.sqrt(dot(own.rays, own.rays))
        moved[2:4] *= np.sqrt(dot(other.rays, other.rays))
        return step, moved.max(axis=0)


def _interpolated(grid: Array, values: Array, stations: Array) -> Array:
    """Values (5, m, g) at evenly spaced stations (m, g), interpolated to stations (m, n)."""
    count = grid.shape[1]
    x = (stations - grid[:, :1]) * (count - 1) / (grid[:, -1:] - grid[:, :1])
    first = np.clip(x.astype(int) - 1, 0, count - 4)
    x = x - first
    row = np.arange(len(stations))[:, None]
    weights = (
        -(x - 1.0) * (x - 2.0) * (x - 3.0) / 6.0,
        x * (x - 2.0) * (x - 3.0) / 2.0,
        -x * (x - 1.0) * (x - 3.0) / 2.0,
        x * (x - 1.0) * (x - 2.0) / 6.0,
    )
    near = np.zeros((len(values), *stations.shape))
    for k, weight in enumerate(weights):
        near += weight * values[:, row, first + k]
    return near


@np.errstate(invalid="ignore", over="ignore", divide="ignore")
def _solve(
    own: Patch, other: Patch, gap: Array, start: Anchor, apart: Array, ahead: Array, aside: Array
) -> Array:
    """Solve the linearised equations of a valley for the changes (5, ...) of its unknowns.

    With δ the changes of the driver's parameters a, b, the driven flank's c, d and the gap t,

        (X_a + t n_a) δa + (X_b + t n_b) δb − Y_c δc − Y_d δd + n δt = apart,
        (X_a δa + X_b δb)·e_major = ahead,
        (n_a δa + n_b δb + m_c δc + m_d δd)·e_minor = aside.

    The first three give δc and δd by δa and δb, for which two equations are left.
    """
    ray_a, ray_b = rays = own.rays + gap[..., None] * own.bends
    # Rows that read δc, δd and −δt off Y_c δc + Y_d δd − n δt, once divided by the determinant.
    basis = np.concatenate([other.rays, own.normal[None]])
    reads = cross(basis[[1, 2, 0]], basis[[2, 0, 1]])
    over = 1.0 / dot(reads[2], own.normal)
    turns = dot(other.bends, start.minor) * over
    lean = turns[0][..., None] * reads[0] + turns[1][..., None] * reads[1]
    rows = dot(own.rays, start.major), dot(own.bends, start.minor) + dot(lean, rays)
    a, b = solve_2(*rows, ahead, aside + dot(lean, apart))
    left = ray_a * a[..., None] + ray_b * b[..., None] - apart
    step = np.empty((5, *gap.shape))
    step[0], step[1] = a, b
    step[2:] = dot(reads, left) * over
    step[4] *= -1.0
    return step
