"""The gap between two flanks along the line on which they come closest."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from loadshare.errors import Refused
from loadshare.settings import TEETH
from loadshare.tooth.geometry.body import Array
from loadshare.tooth.geometry.flank import Patch, dot, solve_3

# Least number of parts of a line on which the least gap is searched for.
FEWEST = 15
# Stations of the second grid, which lies between the neighbours of the first grid's least gap.
FINER = 9


class NoContactError(Refused):
    """At some position of the mesh cycle no pair of teeth is within both active flanks."""


@dataclass(frozen=True, eq=False)
class Trace:
    """Points of contact lines, m lines with n stations each.

    Parameters
    ----------
    driver, driven : Patch
        Points of the driver's flank, and where its normals meet the driven flank, fixed frame.
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

        X + t n stays on the driven flank, so its derivative has no component along that normal.
        """
        across = self.driven.normal
        moving = self.tangent + self.gap[..., None] * self.driver.normal_change(self.tangent)
        slope: Array = -dot(moving, across) / dot(self.driver.normal, across)
        return slope

    def part(self, part: tuple[Any, Any]) -> Trace:
        """Return the trace of some of the lines at some of the stations."""
        own, other = (Patch(f.components[..., *part]) for f in (self.driver, self.driven))
        (a, b), (c, d) = self.driver_at, self.driven_at
        return Trace(
            driver=own,
            driven=other,
            driver_at=(a[part], b[part]),
            driven_at=(c[part], d[part]),
            gap=self.gap[part],
            tangent=self.tangent[part],
        )


@dataclass(frozen=True, eq=False)
class Extents:
    """Contact lines of several positions, and how far they reach on both active flanks.

    Parameters
    ----------
    position : array (m,) of int
        Index of each line's position among those requested.
    pairs : array (m,)
        Pairs of teeth.
    start, end : array (m,)
        First and last station of the lines [m].
    driver, driven : array (m,)
        Rotations of the gears [rad].
    trace : callable
        Function of stations (m, n) [m] that returns the `Trace` of the lines there.
    """

    position: NDArray[np.int64]
    pairs: Array
    start: Array
    end: Array
    driver: Array
    driven: Array
    trace: Callable[[Array], Trace]

    def rows(self, chosen: NDArray[np.int64]) -> Extents:
        """Return some of the lines."""

        def trace(stations: Array) -> Trace:
            middles = 0.5 * (self.start + self.end)
            every = np.repeat(middles[:, None], stations.shape[1], axis=1)
            every[chosen] = stations
            return self.trace(every).part(np.s_[chosen, :])

        named = ("position", "pairs", "start", "end", "driver", "driven")
        return replace(self, trace=trace, **{name: getattr(self, name)[chosen] for name in named})

    def spread(self, points: int) -> tuple[Array, slice]:
        """Return stations (m, n) of a first grid on the lines, and which of them are requested.

        Requested are the middles of `points` equal parts of every line. If these are few, the
        parts are divided further; the ends of the line are always included.
        """
        finer = -(-FEWEST // points) | 1  # odd, so that the middles of the parts stay
        middles = (np.arange(finer * points) + 0.5) / (finer * points)
        share = np.concatenate([[0.0], middles, [1.0]])
        stations = self.start[:, None] + (self.end - self.start)[:, None] * share
        return stations, slice(1 + finer // 2, -1, finer)


def least_gap(lines: Extents, points: int = FEWEST) -> tuple[Array, Array, Trace]:
    """Find the least gap on each line, ends included, and its station.

    Two grids find the place. Where the slope of the gap changes sign next to it, the station is
    refined by the secant of the slope or, for a kink such as that of end relief, by intersecting
    the tangents; the lower gap is taken.

    Returns
    -------
    gap, station : array (m,)
        Both in metres.
    trace : Trace
        The lines in the middles of `points` equal parts.
    """
    row = np.arange(len(lines.pairs))
    stations, wanted = lines.spread(points)
    trace = lines.trace(stations)
    middles = trace.part(np.s_[:, wanted])
    for last in (False, True):
        if not np.isfinite(trace.gap).all():
            raise NoContactError(
                "the flanks do not face each other along the whole contact line; "
                "make the misalignment or the modifications smaller"
            )
        at = np.argmin(trace.gap, axis=1)
        left, right = np.maximum(at - 1, 0), np.minimum(at + 1, stations.shape[1] - 1)
        if not last:
            low, high = stations[row, left], stations[row, right]
            stations = low[:, None] + (high - low)[:, None] * np.linspace(0.0, 1.0, FINER)
            trace = lines.trace(stations)
    least, station = trace.gap[row, at], stations[row, at]
    slope = trace.slope
    falling = slope[row, at] > 0.0
    left, right = np.where(falling, left, at), np.where(falling, at, right)
    before, after = slope[row, left], slope[row, right]
    turns = (before < 0.0) & (after > 0.0)
    if turns.any():
        length = stations[row, right] - stations[row, left]
        turn = np.where(turns, before - after, 1.0)
        rise = trace.gap[row, right] - trace.gap[row, left]
        steps = np.stack([before / turn * length, (rise - after * length) / turn])
        between = stations[row, left] + np.clip(steps, 0.0, length)
        between = np.where(turns, between, station).T
        found = lines.trace(between).gap
        lower = np.argmin(found, axis=1)
        found, between = found[row, lower], between[row, lower]
        better = found < least
        least, station = np.where(better, found, least), np.where(better, between, station)
    return least, station, middles


def meet(
    own: Patch,
    other_at: Callable[[Array, Array], Patch],
    start: tuple[Array, Array],
) -> tuple[Patch, tuple[Array, Array], Array]:
    """Follow normals of one flank to the other, by Newton's method.

    Parameters
    ----------
    own : Patch
        Points (m, n) of the first flank.
    other_at : callable
        Points of the other flank at its surface parameters.
    start : tuple of two arrays (m, n)
        Where to start on it.

    Returns
    -------
    other : Patch
        The other flank where the normals meet it.
    other_at : tuple of two arrays (m, n)
        Surface parameters there.
    gap : array (m, n)
        Distance along the normals [m], NaN where Newton's method found no point.
    """
    a, b = start
    other = other_at(a, b)
    gap = dot(other.point - own.point, own.normal)
    for _ in range(TEETH.meets):
        apart = own.point + gap[..., None] * own.normal - other.point
        step = solve_3(other.rays[0], other.rays[1], -own.normal, apart)
        a, b, gap = a + step[0], b + step[1], gap + step[2]
        other = other_at(a, b)
        moved = np.abs(apart).max(axis=-1)
        if moved.max(initial=0.0) < TEETH.last_step:
            break
    return other, (a, b), np.where(moved < TEETH.last_step, gap, np.nan)
