"""Graphs of radial elements (formulation, section 5), for many samples.

Where `train.radial` has a chain of pieces, a graph has five figures here, so that all samples are
judged by the same few lines.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Graph(NamedTuple):
    """Force over radius of S samples: a rise, a level, and a rise or a stop.

    Attributes
    ----------
    first : ndarray, shape (S,)
        Slope of the first rise [N/m].
    stick : ndarray, shape (S,)
        Radius where it ends [m]; infinite where it goes on for ever.
    bound : ndarray, shape (S,)
        Force of the level [N].
    reach : ndarray, shape (S,)
        Radius where the level ends [m].
    last : ndarray, shape (S,)
        Slope from there on [N/m]; infinite for a rigid stop.
    """

    first: Array
    stick: Array
    bound: Array
    reach: Array
    last: Array


def interval(graph: Graph, radius: Array, band: Array) -> tuple[Array, Array]:
    """Forces [N] that a graph admits within the band [m] about a radius [m]."""
    first, stick, bound, reach, last = graph
    low, high = np.full(len(radius), np.inf), np.zeros(len(radius))
    level_end = np.maximum(reach, np.where(np.isinf(stick), 0.0, stick))
    pieces = (
        (np.zeros(len(radius)), stick, np.zeros(len(radius)), first, stick > 0.0),
        (stick, level_end, bound, np.zeros(len(radius)), (level_end > stick)),
        (
            level_end,
            np.full(len(radius), np.inf),
            bound,
            last,
            np.isfinite(last) & ~np.isinf(stick),
        ),
    )
    for begin, end, force, slope, there in pieces:
        on = there & (radius >= begin - band) & (radius <= end + band)
        rising = np.where(slope > 0.0, slope, 0.0)
        least, most = (np.clip(radius + side, begin, end) - begin for side in (-band, band))
        low = np.where(on, np.minimum(low, force + rising * least), low)
        high = np.where(on, np.maximum(high, force + rising * most), high)
    low = np.where(radius <= band, 0.0, low)
    stopped = np.isinf(last) & (radius >= reach - band)
    low = np.where(stopped, np.minimum(low, bound), low)
    high = np.where(stopped, np.inf, high)
    return low, high


def energy(graph: Graph, radius: Array) -> Array:
    """Strain energy [J] of a graph at a radius [m]."""
    first, stick, bound, reach, last = graph
    rise = np.minimum(radius, stick)
    throughout = np.isinf(stick)
    level = np.where(throughout, 0.0, np.clip(radius, stick, reach) - stick)
    beyond = np.where(throughout, 0.0, np.maximum(radius - reach, 0.0))
    rising = np.isfinite(last) & (beyond > 0.0)
    tail = np.where(rising, bound * beyond + 0.5 * np.where(rising, last, 0.0) * beyond**2, 0.0)
    return np.asarray(0.5 * first * rise**2 + bound * np.where(level > 0.0, level, 0.0) + tail)


def complementary(graph: Graph, force: Array) -> Array:
    """Conjugate energy [J] of a graph at a force [N]."""
    first, stick, bound, reach, last = graph
    throughout = np.isinf(stick)
    has_rise = first > 0.0
    stiff = np.where(has_rise, first, 1.0)
    end = np.where(throughout, np.inf, first * stick)
    under = np.minimum(force, end)
    total = np.where(has_rise, under**2 / (2.0 * stiff), 0.0)
    rest = np.where(throughout, 0.0, np.maximum(force - end, 0.0))
    total += np.where(rest > 0.0, rest * np.where(throughout, 0.0, stick), 0.0)
    over = np.where(throughout, 0.0, np.maximum(force - bound, 0.0))
    total += np.where(over > 0.0, over * (reach - np.where(throughout, 0.0, stick)), 0.0)
    rising = np.isfinite(last)
    tail = np.where(rising, over**2 / (2.0 * np.where(rising, last, 1.0)), 0.0)
    return np.asarray(total + tail)
