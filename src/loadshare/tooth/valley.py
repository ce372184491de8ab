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
Vector: TypeAlias = tuple[Array, Array, Array, Array, Array]


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
            left, unknowns, wanted = left[going], unknowns[:, going], wanted[going]
            before = moved[going]
            here = here.rows(going)
        return found.reshape(5, *stations.shape)

    def trace(self, stations: Array) -> Trace:
        """Flanks and gap at stations (m, n) [m]."""
        a, b, c, d, gap = self.find(stations)
        line = np.repeat(np.arange(len(stations)), stations.shape[1]).reshape(stations.shape)
        here = self._points(line)
        own, other = here._flanks((a, b), (c, d))
        along = here._slopes(own, other, gap)
        tangent = along[0][..., None] * own.point_a + along[1][..., None] * own.point_b
        return Trace(own, other, (a, b), (c, d), gap, tangent)

    def _points(self, line: Index) -> Valleys:
        """The valley of every point, by the numbers of their lines."""
        return replace(self, known=None).rows(line)

    def _slopes(self, own: Patch, other: Patch, gap: Array) -> Array:
        """Derivatives (5, ...) of the unknowns over the station."""
        still, one = np.zeros_like(gap), np.ones_like(gap)
        return np.stack(_solve(own, other, gap, self.start, 0.0 * own.point, one, still))

    def _flanks(
        self, driver_at: tuple[Array, Array], driven_at: tuple[Array, Array]
    ) -> tuple[Patch, Patch]:
        return (
            self.lines.driver_patch(self.pairs, driver_at, self.driver),
            self.lines.driven_patch(self.pairs, driven_at, self.driven),
        )

    def _begin(self, stations: Array) -> Array:
        """First guesses (5, m, n): cubic interpolation of what is known, else the tangent."""
        if self.known is not None:
            near = _interpolated(*self.known, stations)
            if np.isfinite(near).all():
                return near
        a, b, c, d = self.start.at
        slopes = self._slopes(*self._flanks((a, b), (c, d)), np.zeros_like(a))
        start = slopes[:, :, None] * stations
        start[:4] += self.start.at[:, :, None]
        return start if self.known is None else np.where(np.isfinite(near), near, start)

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
        rays = (own.point_a, own.point_b, other.point_a, other.point_b)
        moved = [np.abs(s) * np.sqrt(dot(r, r)) for s, r in zip(step[:4], rays, strict=True)]
        return np.stack(step), np.max([*moved, np.abs(step[4])], axis=0)


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
) -> Vector:
    """Solve the linearised equations of a valley.

    With δ the changes of the driver's parameters a, b, the driven flank's c, d and the gap t,

        (X_a + t n_a) δa + (X_b + t n_b) δb − Y_c δc − Y_d δd + n δt = apart,
        (X_a δa + X_b δb)·e_major = ahead,
        (n_a δa + n_b δb + m_c δc + m_d δd)·e_minor = aside.

    The first three give δc and δd by δa and δb, for which two equations are left.
    """
    reach = gap[..., None]
    ray_a, ray_b = own.point_a + reach * own.normal_a, own.point_b + reach * own.normal_b
    c, d = other.point_a, other.point_b
    # Rows that read δc, δd and −δt off Y_c δc + Y_d δd − n δt, once divided by the determinant.
    read_c, read_d, read_t = cross(d, own.normal), cross(own.normal, c), cross(c, d)
    over = 1.0 / dot(read_t, own.normal)
    turn_c, turn_d = dot(other.normal_a, start.minor), dot(other.normal_b, start.minor)
    lean = (turn_c * over)[..., None] * read_c + (turn_d * over)[..., None] * read_d
    rows = (
        (dot(own.point_a, start.major), dot(own.point_b, start.major)),
        (
            dot(own.normal_a, start.minor) + dot(lean, ray_a),
            dot(own.normal_b, start.minor) + dot(lean, ray_b),
        ),
    )
    step_a, step_b = solve_2(*rows, ahead, aside + dot(lean, apart))
    left = ray_a * step_a[..., None] + ray_b * step_b[..., None] - apart
    return (
        step_a,
        step_b,
        dot(read_c, left) * over,
        dot(read_d, left) * over,
        -dot(read_t, left) * over,
    )
