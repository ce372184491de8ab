"""The part of a line that lies within all edges of both flanks."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from loadshare.tooth.geometry.body import Array

# Stations of the first grid, and of those that close in on either end.
FIRST, FINER = 33, 9
# The last grid's spacing is 1/1024 of the reach; linear interpolation within it leaves an error of
# the margin's curvature times the square of that, nanometres for teeth of centimetres.
LEVELS = 2


class Margin(Protocol):
    """Distance from the nearest edge [m] at stations (k, n) on lines (k,), negative outside."""

    def __call__(self, stations: Array, lines: NDArray[np.int64], *, near: bool = False) -> Array:
        """The margin (k, n); where `near`, what is known from earlier calls may stand for it."""
        ...


def span(margin: Margin, reach: Array) -> tuple[NDArray[np.int64], Array, Array]:
    """Ends of the stretch on which a margin is positive, on m lines at once.

    Parameters
    ----------
    margin : Margin
        Of the lines by their numbers.
    reach : array (m,)
        The stretch lies between −reach and reach [m].

    Returns
    -------
    found : array (k,) of int
        Lines with a positive station on the first grid.
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
        inside.append(stations[line, np.clip(out - side, 0, FIRST - 1)])
    good, bad = np.array(inside), np.array(outside)

    def both_ends(grid: Array, *, near: bool = False) -> Array:
        """Margins at stations (2, k, n)."""
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
    # The edge may lie beside the cell by what the grids' values were off.
    fall = np.maximum(within - beyond, np.finfo(float).tiny)
    ends = good + (bad - good) * np.clip(within / fall, -1.0, 2.0)
    start, end = np.clip(ends, -reach[found], reach[found])
    return found, start, end
