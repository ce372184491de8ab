"""Contact lines of localised contact: valleys of the gap, and how far the flanks reach there."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import NamedTuple, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from loadshare.settings import TEETH
from loadshare.tooth.cylindrical.flank import HelicoidNumbers
from loadshare.tooth.face.flank import FaceNumbers
from loadshare.tooth.geometry.body import Array
from loadshare.tooth.geometry.flank import Patch, principal_directions
from loadshare.tooth.geometry.gap import Trace

# Stations of the first grid, and of the grids that narrow down either end.
FIRST, FINER = 33, 9
# The last grid's spacing is 1/1024 of the reach; linear interpolation within it leaves an error of
# the margin's curvature times the square of that, nanometres for teeth of centimetres.
LEVELS = 2

Index: TypeAlias = NDArray[np.int64] | NDArray[np.bool_]


class Flanks(NamedTuple):
    """Both flanks, as compiled code reads them; the driven gear's frame is at `origin`."""

    driver: HelicoidNumbers
    driven: FaceNumbers
    axes: Array  # (3, 3)
    origin: Array  # (3,)


class Anchor(NamedTuple):
    """Origins of the valleys of m pairs of teeth: points at which both flanks nearly touch."""

    at: Array  # (m, 4): surface parameters on the driver's and on the driven flank
    point: Array  # (m, 3): origin of the stations [m]
    major: Array  # (m, 3): direction of least relative curvature
    minor: Array  # (m, 3): direction of greatest relative curvature


class Known(NamedTuple):
    """Evenly spaced stations and the unknowns found there; empty if none were found yet."""

    stations: Array  # (m, g)
    found: Array  # (m, g, 5)


def anchor(
    driver_at: tuple[Array, Array], driven_at: tuple[Array, Array], flanks: tuple[Patch, Patch]
) -> Anchor:
    """Anchor the valleys at given points (m,), with the principal directions found there."""
    parts = flanks[0].point, *principal_directions(*flanks)
    at = np.stack([*driver_at, *driven_at], axis=-1)
    return Anchor(at, *(np.ascontiguousarray(part) for part in parts))


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
    flanks : Flanks
        The flanks of the gears.
    turns : array (m, 2)
        Rotations of the teeth of either gear [rad].
    start : Anchor
        Origins of the stations.
    known : Known
        Starting values of Newton's method.
    """

    flanks: Flanks
    turns: Array
    start: Anchor
    known: Known = field(repr=False)

    def rows(self, chosen: Index) -> Valleys:
        """Return the valleys of some pairs."""
        start, known = ([part[chosen] for part in parts] for parts in (self.start, self.known))
        return Valleys(self.flanks, self.turns[chosen], Anchor(*start), Known(*known))

    def knowing(self, stations: Array, found: Array) -> Valleys:
        """Return the same valleys with unknowns (m, g, 5) known at even stations (m, g)."""
        return replace(self, known=Known(stations, found))

    def guess(self, stations: Array) -> Array | None:
        """Interpolate the result of :meth:`find` to micrometres; None where values are missing."""
        from loadshare.tooth.geometry.compiled import interpolate

        near = np.empty((*stations.shape, 5))
        interpolate(self.known, stations, near)
        return near if np.isfinite(near).all() else None

    def find(self, stations: Array, last: float = TEETH.last_step) -> Array:
        """Find surface parameters on both flanks and gap (m, n, 5) at stations (m, n) [m].

        The gap is NaN where Newton's method finds no point; it ends with a step below `last` [m].
        """
        from loadshare.tooth.geometry.compiled import find

        found = np.empty((*stations.shape, 5))
        # The limits are arguments, because compiled code would keep an old value of a global.
        find(self.flanks, self.start, self.turns, self.known, stations, last, TEETH, found)
        return found

    def trace(self, stations: Array) -> Trace:
        """Return both flanks and the gap at stations (m, n) [m]."""
        from loadshare.tooth.geometry.compiled import trace

        found, shape = self.find(stations), stations.shape
        points, tangent = np.empty((2, 6, 3, stations.size)), np.empty((*shape, 3))
        trace(self.flanks, self.start, self.turns, found, points[0], points[1], tangent)
        own, other = (Patch(components) for components in points.reshape(2, 6, 3, *shape))
        a, b, c, d, gap = np.moveaxis(found, -1, 0)
        return Trace(own, other, (a, b), (c, d), gap, tangent)


class Margin(Protocol):
    """Distance from the nearest edge [m] at stations (k, n) on lines (k,), negative outside."""

    def __call__(self, stations: Array, lines: NDArray[np.int64], *, near: bool = False) -> Array:
        """Return the margin (k, n); if `near`, it may be interpolated from earlier calls."""
        ...


def span(margin: Margin, reach: Array) -> tuple[NDArray[np.int64], Array, Array]:
    """Find the ends of the stretch on which a margin is positive, on m lines at once.

    Parameters
    ----------
    margin : Margin
        Margin on the lines, which it takes by index.
    reach : array (m,)
        The stretch lies between −reach and reach [m].

    Returns
    -------
    found : array (k,) of int
        Lines with a positive margin on the first grid, and on more than a point.
    start, end : array (k,)
        First and last station of their stretches [m].
    """
    stations = reach[:, None] * np.linspace(-1.0, 1.0, FIRST)
    values = margin(stations, np.arange(len(reach)))
    found = np.flatnonzero(values.max(axis=1) > 0.0)
    stations, values, line = stations[found], values[found], np.arange(len(found))
    best = np.argmax(values, axis=1)
    steps = np.arange(FIRST) - best[:, None]
    inside, outside = [], []
    for side in (-1, 1):
        beyond = (values <= 0.0) & (side * steps > 0)
        beyond[:, 0 if side < 0 else -1] = True
        first = np.where(beyond, side * steps, FIRST)
        out = np.argmin(np.where(first < 0, FIRST, first), axis=1)
        outside.append(stations[line, out])
        # If the best station is itself the end of the reach, no station lies farther in.
        inside.append(stations[line, out - side * (out != best)])
    good, bad = np.array(inside), np.array(outside)

    def both_ends(grid: Array, *, near: bool = False) -> Array:
        """Return the margins at stations (2, k, n)."""
        stations = np.concatenate(list(grid), axis=1)
        return np.stack(np.split(margin(stations, found, near=near), 2, axis=1))

    share = np.linspace(0.0, 1.0, FINER)
    for _ in range(LEVELS):
        grid = good[..., None] + (bad - good)[..., None] * share
        values = both_ends(grid, near=True)
        values[..., -1] = np.minimum(values[..., -1], 0.0)
        after = np.maximum(np.argmax(values <= 0.0, axis=-1), 1)[..., None]
        good, bad = (np.take_along_axis(grid, at, -1)[..., 0] for at in (after - 1, after))
    within, beyond = np.moveaxis(both_ends(np.stack([good, bad], axis=-1)), -1, 0)
    # The edge may lie outside the cell, because the values on the grids were approximate.
    fall = np.maximum(within - beyond, np.finfo(float).tiny)
    ends = good + (bad - good) * np.clip(within / fall, -1.0, 2.0)
    start, end = np.clip(ends, -reach[found], reach[found])
    some = end - start > TEETH.shortest * reach[found]
    return found[some], start[some], end[some]
