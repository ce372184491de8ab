"""Shares of variance: first-order and total Sobol indices, with bootstrap intervals."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from loadshare.array_types import Array
from loadshare.settings import TOLERANCE
from loadshare.study.tolerance.statistics import Estimate


@dataclass(frozen=True, slots=True)
class Share:
    """What a unit of inputs contributes to the variance of a figure.

    Attributes
    ----------
    unit : str
        An input, or correlated ones joined by `` + ``.
    first : Estimate
        Share that goes if the unit becomes exact, the others scattering.
    total : Estimate
        Share that stays if all others become exact: with all its interactions.
    """

    unit: str
    first: Estimate
    total: Estimate


def shares(figures: Array, units: tuple[str, ...], seed: int) -> tuple[Share, ...]:
    """Return the shares of all units.

    Parameters
    ----------
    figures : ndarray, shape (2 + units, rows)
        Of the matrices A, B, and A with each unit taken from B. A row of which one figure is
        missing is left out.
    units : tuple of str
    seed : int
        Of the bootstrap.

    Returns
    -------
    tuple of Share
        Empty where the figure does not vary, or too few rows are left.

    Notes
    -----
    First order: A. Saltelli et al., Computer Physics Communications 181 (2010), table 2 (b), on
    figures less their mean; total: M. J. W. Jansen, Computer Physics Communications 117 (1999).
    """
    whole = figures[:, ~np.isnan(figures).any(axis=0)]
    if whole.shape[1] < 8:
        return ()
    base = whole[:2]
    still = TOLERANCE.still * max(float(np.abs(base).max()), 1e-300)
    if base.std() <= still:
        return ()
    a, b, mixed = whole[0], whole[1], whole[2:]
    middle = base.mean()
    a, b, mixed = a - middle, b - middle, mixed - middle
    rows = len(a)
    # Every estimate is a ratio of means over rows: a resample only weighs the rows again.
    sums = np.concatenate([[a, b, a * a, b * b], b * (mixed - a), 0.5 * (a - mixed) ** 2])
    first, total = _ratios(sums.mean(axis=1)[:, None], len(units), still)
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(0, 2)))
    even = np.full(rows, 1.0 / rows)
    drawn = [sums @ rng.multinomial(rows, even) / rows for _ in range(TOLERANCE.resamples)]
    again = _ratios(np.stack(drawn, axis=1), len(units), still)
    tail = (1.0 - TOLERANCE.confidence) / 2.0
    found = []
    for k, unit in enumerate(units):
        estimates = []
        for value, resampled in zip((first, total), again, strict=True):
            low, high = np.quantile(resampled[k], [tail, 1.0 - tail])
            estimates.append(Estimate(float(value[k, 0]), float(low), float(high)))
        found.append(Share(unit, *estimates))
    return tuple(found)


def _ratios(means: Array, units: int, still: float) -> tuple[Array, Array]:
    """First-order and total indices, (units, resamples), from means of the terms.

    Resamples in which nothing varies, as a few rows may have, are left out.
    """
    variance = 0.5 * (means[2] + means[3]) - (0.5 * (means[0] + means[1])) ** 2
    varies = variance > (0.5 * still) ** 2
    means, variance = means[:, varies], variance[varies]
    return means[4 : 4 + units] / variance, means[4 + units :] / variance
