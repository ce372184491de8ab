"""Moments, quantiles, probabilities and shares of variance, with their confidence intervals.

They describe how Ω of every stage and of the system scatters over samples, over both means.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from loadshare.array_types import Array
from loadshare.equality import Comparable
from loadshare.libraries import special, stats
from loadshare.settings import TOLERANCE
from loadshare.study.tolerance.figures import KINDS, SYSTEM

ROUND_OFF = 1e-12
"""Deviation, over the mean, up to which it is round-off."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """A figure and its confidence interval.

    Attributes
    ----------
    value, low, high : float
    """

    value: float
    low: float
    high: float

    def text(self, form: str) -> str:
        """Return the figure and its interval; an end that is not known is left open."""
        low, high = (f"{end:{form}}" if math.isfinite(end) else "" for end in (self.low, self.high))
        return f"{self.value:{form}} ({f'{low} … {high}'.strip()})"


@dataclass(frozen=True, slots=True, eq=False)
class Summary(Comparable):
    """Statistics of a figure over the samples.

    Attributes
    ----------
    count : int
        Number of samples that have it.
    mean : Estimate
    deviation : float
        Standard deviation.
    lowest, highest : float
    quantiles : mapping of level to Estimate
    edges, counts : ndarray, shape (TOLERANCE.bins + 1,), (TOLERANCE.bins,)
        Histogram.
    """

    count: int
    mean: Estimate
    deviation: float
    lowest: float
    highest: float
    quantiles: dict[float, Estimate]
    edges: Array
    counts: NDArray[np.int64]

    @property
    def spread(self) -> float:
        """Standard deviation; 0 where it is round-off of the mean."""
        return self.deviation if self.deviation > ROUND_OFF * abs(self.mean.value) else 0.0


def summary(values: Array, levels: Sequence[float], replicated: bool) -> Summary | None:
    """Return the statistics of a figure; None if no sample has it.

    Parameters
    ----------
    values : ndarray, shape (S,)
        By sample; NaN where a sample has none.
    levels : sequence of float
        Of the quantiles.
    replicated : bool
        Whether the samples are of several sequences in turn, whose scatter then gives the
        intervals.
    """
    known = values[~np.isnan(values)]
    if not len(known):
        return None
    replicates = _replicates(values) if replicated else None
    ordered = np.sort(known)
    deviation = float(np.std(known, ddof=1)) if len(known) > 1 else math.nan
    counts, edges = np.histogram(known, bins=TOLERANCE.bins, range=_range(ordered))
    return Summary(
        count=len(known),
        mean=_mean(known, deviation, replicates),
        deviation=deviation,
        lowest=float(ordered[0]),
        highest=float(ordered[-1]),
        quantiles={level: quantile(ordered, level, replicates) for level in levels},
        edges=edges,
        counts=counts,
    )


def _range(ordered: Array) -> tuple[float, float]:
    """Return the ends of a histogram: those of the values, with some room if they hardly differ."""
    low, high = float(ordered[0]), float(ordered[-1])
    least = TOLERANCE.least_width * max(abs(low), abs(high), 1e-300)
    if high - low < least:
        low, high = low - least, high + least
    return low, high


def _replicates(values: Array) -> list[Array]:
    """Split samples into the sequences from which they come, leaving out those without a figure."""
    parts = [values[r :: TOLERANCE.sequences] for r in range(TOLERANCE.sequences)]
    return [known for part in parts if len(known := part[~np.isnan(part)])]


def _from_replicates(value: float, found: Sequence[float]) -> Estimate:
    """Return Student's interval from independent estimates of one figure."""
    count = len(found)
    if count < 2:
        return Estimate(value, math.nan, math.nan)
    factor = float(special.stdtrit(count - 1, 0.5 + TOLERANCE.confidence / 2.0))
    half = factor * float(np.std(found, ddof=1)) / math.sqrt(count)
    return Estimate(value, value - half, value + half)


def _mean(known: Array, deviation: float, replicates: list[Array] | None) -> Estimate:

    value = float(known.mean())
    if replicates is not None:
        return _from_replicates(value, [float(part.mean()) for part in replicates])
    score = float(special.ndtri(0.5 + TOLERANCE.confidence / 2.0))
    half = score * deviation / math.sqrt(len(known))
    return Estimate(value, value - half, value + half)


def quantile(ordered: Array, level: float, replicates: list[Array] | None) -> Estimate:
    """Return a quantile, with an interval from order statistics or from replicates.

    Parameters
    ----------
    ordered : ndarray
        Figures in rising order.
    level : float
    replicates : list of ndarray or None
        Their own quantiles would be biased far out in a tail. The scatter of their shares at or
        below the common quantile instead gives the levels for which that quantile may stand.
    """
    value = float(np.quantile(ordered, level))
    shares = [float((part <= value).mean()) for part in replicates or ()]
    if len(set(shares)) > 1:
        span = _from_replicates(level, shares)
        low = float(np.quantile(ordered, span.low)) if span.low > 0.0 else -math.inf
        high = float(np.quantile(ordered, span.high)) if span.high < 1.0 else math.inf
        return Estimate(value, low, high)

    # The number of samples below the true quantile is binomial.
    tail = (1.0 - TOLERANCE.confidence) / 2.0
    count = len(ordered)
    below, above = (int(stats.binom.ppf(p, count, level)) for p in (tail, 1.0 - tail))
    low = float(ordered[below - 1]) if below >= 1 else -math.inf
    high = float(ordered[above]) if above < count else math.inf
    return Estimate(value, low, high)


def wilson(hits: int, count: int) -> Estimate:
    """Return a probability from independent trials with Wilson's score interval.

    Notes
    -----
    E. B. Wilson, Probable inference, the law of succession, and statistical inference, Journal of
    the American Statistical Association 22 (1927).
    """
    found = stats.binomtest(hits, count).proportion_ci(TOLERANCE.confidence, "wilson")
    return Estimate(hits / count, float(found.low), float(found.high))


def exceedance(values: Array, limit: float, replicated: bool) -> Estimate | None:
    """Return P(value > limit); None if no sample has the figure.

    Parameters
    ----------
    values : ndarray, shape (S,)
        By sample; NaN where a sample has none.
    limit : float
    replicated : bool
        As for `summary`. If all sequences agree, Wilson's interval is given, which is then too
        wide rather than too narrow.
    """
    known = values[~np.isnan(values)]
    if not len(known):
        return None
    found = wilson(int((known > limit).sum()), len(known))
    if not replicated:
        return found
    shares = [float((part > limit).mean()) for part in _replicates(values)]
    if len(set(shares)) < 2:
        return found
    spread = _from_replicates(found.value, shares)
    return Estimate(spread.value, max(spread.low, 0.0), min(spread.high, 1.0))


@dataclass(frozen=True, slots=True)
class Share:
    """The contribution of a unit of inputs to the variance of a figure.

    Attributes
    ----------
    unit : str
        An input, or correlated ones joined by `` + ``.
    first : Estimate
        Share of the variance that vanishes if the unit becomes exact while the others scatter.
    total : Estimate
        Share that remains if all others become exact; includes all interactions of the unit.
    """

    unit: str
    first: Estimate
    total: Estimate


def shares(figures: Array, units: tuple[str, ...], seed: int) -> tuple[Share, ...]:
    """Return the shares of variance of all units.

    Parameters
    ----------
    figures : ndarray, shape (2 + units, rows)
        Of the matrices A, B, and A with each unit taken from B. A row in which any figure is
        missing is left out.
    units : tuple of str
    seed : int
        Of the bootstrap.

    Returns
    -------
    tuple of Share
        Empty if the figure does not vary or too few rows are left.

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
    # Every estimate is a ratio of means over rows, so a resample only reweights the rows.
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
    """Return first-order and total indices, (units, resamples), from means of the terms.

    Resamples without variance, which can occur with few rows, are left out.
    """
    variance = 0.5 * (means[2] + means[3]) - (0.5 * (means[0] + means[1])) ** 2
    varies = variance > (0.5 * still) ** 2
    means, variance = means[:, varies], variance[varies]
    return means[4 : 4 + units] / variance, means[4 + units :] / variance


@dataclass(frozen=True, slots=True, eq=False)
class OmegaStatistics(Comparable):
    """Statistics of the largest Ω of a stage.

    Attributes
    ----------
    over : {"stage", "group"}
        Whose mean torque Ω is over.
    stage : str
        Stage, or "system".
    summary : Summary
    exceedance : Estimate or None
        P(Ω > limit); None without a limit.
    shares : tuple of Share
        Shares of variance; empty if none were requested or Ω does not vary.
    """

    over: str
    stage: str
    summary: Summary
    exceedance: Estimate | None
    shares: tuple[Share, ...]


Columns = Callable[[str], Array]
"""Function that returns a column of the samples' figures by its name."""


def omega_statistics(
    column: Columns,
    stages: Sequence[str],
    levels: Sequence[float],
    limit: float | None,
    replicated: bool,
) -> Iterator[OmegaStatistics]:
    """Yield the statistics of Ω, without shares of variance, for stages where a sample has it.

    Parameters
    ----------
    column : callable
        Figures by the name of their column, NaN where a sample has no answer.
    stages : sequence of str
        "system" among them.
    levels : sequence of float
        Of the quantiles.
    limit : float or None
    replicated : bool
        As for `summary`.
    """
    for (kind, over), stage in product(KINDS.items(), stages):
        values = column(f"{kind}.{stage}")
        found = summary(values, levels, replicated)
        if found is not None:
            above = None if limit is None else exceedance(values, limit, replicated)
            yield OmegaStatistics(over, stage, found, above, ())


def apart_kinds(column: Columns) -> list[str]:
    """Return the kinds of Ω that differ; if groups share alike, or there are none, only one."""
    one, other = (column(f"{kind}.{SYSTEM}") for kind in KINDS)
    same = np.allclose(one, other, rtol=TOLERANCE.same, atol=0.0, equal_nan=True)
    return list(KINDS)[:1] if same else list(KINDS)
