"""The part of a line that lies within all edges of both flanks."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from loadshare.tooth.body import Array

# Stations of the first grid, and of those that close in on either end.
FIRST, FINER = 33, 9
# The last grid's spacing is 1/1024 of the reach; linear interpolation within it leaves an error of
# the margin's curvature times the square of that, nanometres for teeth of centimetres.
LEVELS = 2


def span(margin: Callable[[Array], Array], reach: Array) -> tuple[NDArray[np.bool_], Array, Array]:
    """Ends of the stretch on which a margin is positive, on m lines at once.

    Parameters
    ----------
    margin : callable
        From stations (m, n) to the distance from the nearest edge [m], negative outside.
    reach : array (m,)
        The stretch lies between −reach and reach [m].

    Returns
    -------
    found : array (m,) of bool
        Whether the line has a positive station on the first grid.
    start, end : array (m,)
        First and last station of the stretch [m], meaningful where `found`.
    """
    line = np.arange(len(reach))
    stations = reach[:, None] * np.linspace(-1.0, 1.0, FIRST)
    values = margin(stations)
    best = np.argmax(values, axis=1)
    found = values[line, best] > 0.0
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

    share = np.linspace(0.0, 1.0, FINER)
    for _ in range(LEVELS):
        grid = good[..., None] + (bad - good)[..., None] * share
        values = margin(grid.transpose(1, 0, 2).reshape(len(reach), -1))
        values = values.reshape(len(reach), 2, -1).transpose(1, 0, 2)
        values[..., -1] = np.minimum(values[..., -1], 0.0)
        after = np.maximum(np.argmax(values <= 0.0, axis=-1), 1)[..., None]
        good, bad, value_good, value_bad = (
            np.take_along_axis(table, at, -1)[..., 0]
            for table, at in (
                (grid, after - 1),
                (grid, after),
                (values, after - 1),
                (values, after),
            )
        )
    drop = np.where(value_good > value_bad, value_good - value_bad, 1.0)
    ends = good + (bad - good) * np.clip(value_good / drop, 0.0, 1.0)
    return found, ends[0], ends[1]
