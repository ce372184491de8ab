"""The value at which the first of several gauges vanishes.

Beyond it a set no longer holds, and its gauges may continue with other slopes: chords across the
zero then converge slowly, always from one side. So a bracket is narrowed by chords across, before
and beyond the zero, whichever is nearest.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from loadshare.array_types import Array
from loadshare.settings import FOLLOW

_AROUND = np.array(FOLLOW.around)


def first_zero(
    of: Callable[[Array], Array | None], values: Array, gauges: Array, beyond: int
) -> float | None:
    """Return the first value at which a gauge is no longer positive.

    Parameters
    ----------
    of : callable
        Returns gauges (k, n) at values (k,), or None where there are none.
    values : ndarray, shape (m,)
        Rising or falling.
    gauges : ndarray, shape (m, n)
        At these values; all are positive before `beyond`.
    beyond : int
        Index of the first value at which one is negative.

    Returns
    -------
    float or None
        None if the gauges end on the way, or the bracket does not converge.
    """
    largest = float(np.abs(values).max())
    for _ in range(FOLLOW.refinements):
        low, high = values[beyond - 1], values[beyond]
        if gauges[beyond].min() == 0.0 or abs(high - low) <= FOLLOW.adjacent * abs(high):
            return float(high)
        inner = _inner(values, gauges, beyond)
        if not len(inner):
            return float(high)
        found = of(inner)
        if found is None:
            return None
        near = slice(max(beyond - 2, 0), beyond + 2)
        values, gauges = np.append(values[near], inner), np.vstack([gauges[near], found])
        order = np.argsort(values if high > low else -values, kind="stable")
        values, gauges = values[order], gauges[order]
        beyond = int(np.flatnonzero(gauges.min(axis=1) <= 0.0)[0])
    return float(high) if abs(high - low) <= FOLLOW.exact * largest else None


def _inner(values: Array, gauges: Array, beyond: int) -> Array:
    """Return the values inside a bracket that are evaluated next."""
    low, high = values[beyond - 1], values[beyond]
    guesses = np.array(list(_guesses(values, gauges, beyond)))
    inner = np.append(guesses[:, None] + (high - low) * _AROUND, 0.5 * (low + high))
    return np.unique(inner[(inner - low) * (high - inner) > 0.0])


def _guesses(values: Array, gauges: Array, beyond: int) -> Iterator[float]:
    """Yield where the first gauge vanishes, by chords before, across and beyond the zero."""
    low, high = values[beyond - 1], values[beyond]
    for k in (beyond - 1, beyond, beyond + 1):
        if not 1 <= k < len(values):
            continue
        with np.errstate(divide="ignore", invalid="ignore"):
            parts = gauges[k - 1] / (gauges[k - 1] - gauges[k])
        zeros = (values[k - 1] + parts * (values[k] - values[k - 1]) - low) / (high - low)
        inside = zeros[(zeros > 0.0) & (zeros < 1.0)]
        if len(inside):
            yield low + float(inside.min()) * (high - low)
