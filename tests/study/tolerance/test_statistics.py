"""Intervals cover what they state, and shares of variance agree with closed forms."""

import numpy as np
import pytest
from scipy import special, stats

from loadshare.settings import TOLERANCE
from loadshare.study.tolerance.statistics import exceedance, quantile, shares, summary, wilson


@pytest.mark.parametrize(
    ("hits", "count", "low", "high"),
    [
        (81, 263, 0.2553, 0.3662),
        (15, 148, 0.0624, 0.1605),
        (0, 20, 0.0, 0.1611),
        (1, 29, 0.0061, 0.1718),
    ],
)
def test_wilson_is_the_published_interval(hits, count, low, high):
    """Newcombe, Statistics in Medicine 17 (1998), table I, method 3; printed to 4 digits."""
    found = wilson(hits, count)
    assert found.value == hits / count
    assert (found.low, found.high) == pytest.approx((low, high), abs=5e-5)


def test_wilson_covers_as_often_as_it_says():
    """Its exact coverage, from the binomial distribution, oscillates about 95 %, its average."""
    count = 60
    ends = np.array([(e.low, e.high) for e in (wilson(k, count) for k in range(count + 1))])
    truth = np.linspace(0.02, 0.98, 193)
    chance = stats.binom.pmf(np.arange(count + 1), count, truth[:, None])
    inside = (ends[:, 0] <= truth[:, None]) & (truth[:, None] <= ends[:, 1])
    coverage = (chance * inside).sum(axis=1)
    assert coverage.mean() == pytest.approx(0.95, abs=0.01)
    assert coverage.min() > 0.89


def test_intervals_of_quantile_and_mean_cover_the_truth():
    """Of 400 intervals at 95 %, 380 ± 4.4 contain the truth: five sigma are 22. Order statistics
    are discrete, and so cover slightly more.
    """
    rng = np.random.default_rng(5)
    level, inside = 0.9, {"quantile": 0, "mean": 0}
    for _ in range(400):
        values = rng.standard_normal(300)
        found = quantile(np.sort(values), level, None)
        inside["quantile"] += found.low <= special.ndtri(level) <= found.high
        figures = summary(values, (level,), replicated=False)
        inside["mean"] += figures.mean.low <= 0.0 <= figures.mean.high
    assert all(358 <= hits <= 400 for hits in inside.values()), inside


def test_intervals_of_replicates_cover_the_truth():
    """Sequences differ by chance alone, each with its own error: Student's interval."""
    rng = np.random.default_rng(6)
    inside = 0
    for _ in range(400):
        shift = 0.1 * rng.standard_normal(TOLERANCE.sequences)
        # Within a sequence, the scatter adds up to zero.
        ramp = np.linspace(-1.0, 1.0, 8)[:, None]
        figures = summary((ramp + shift).reshape(-1), (0.5,), replicated=True)
        inside += figures.mean.low <= 0.0 <= figures.mean.high
    assert 358 <= inside <= 400


def test_what_no_sequence_tells_falls_back_on_wilson():
    values = np.zeros(TOLERANCE.sequences * 4)
    assert exceedance(values, 1.0, replicated=True) == wilson(0, len(values))
    values[: TOLERANCE.sequences] = 2.0
    assert exceedance(values, 1.0, replicated=True) == wilson(TOLERANCE.sequences, len(values))
    values[1] = 0.0
    assert exceedance(values, 1.0, replicated=True) != wilson(TOLERANCE.sequences - 1, len(values))


def test_samples_without_a_figure_are_in_no_statistic():
    values = np.array([1.0, np.nan, 3.0])
    found = summary(values, (0.5,), replicated=False)
    assert (found.count, found.mean.value, found.lowest, found.highest) == (2, 2.0, 1.0, 3.0)
    assert exceedance(values, 2.0, replicated=False).value == 0.5
    assert summary(np.array([np.nan]), (0.5,), replicated=False) is None
    assert exceedance(np.array([np.nan]), 2.0, replicated=False) is None


def _pick_freeze(figure, width: int, rows: int, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    a, b = rng.random((2, rows, width))
    mixed = []
    for k in range(width):
        one = a.copy()
        one[:, k] = b[:, k]
        mixed.append(figure(one))
    return np.array([figure(a), figure(b), *mixed])


def test_shares_of_the_ishigami_function():
    """T. Ishigami and T. Homma (1990): sin x1 + 7 sin² x2 + 0.1 x3⁴ sin x1 over ±π. Its first-order
    shares are 0.3139, 0.4424, 0, its total ones 0.5576, 0.4424, 0.2437.
    """

    def ishigami(u):
        x = np.pi * (2.0 * u - 1.0)
        return np.sin(x[:, 0]) * (1.0 + 0.1 * x[:, 2] ** 4) + 7.0 * np.sin(x[:, 1]) ** 2

    found = shares(_pick_freeze(ishigami, 3, 8192, 1), ("x1", "x2", "x3"), 0)
    for share, first, total in zip(
        found, (0.3139, 0.4424, 0.0), (0.5576, 0.4424, 0.2437), strict=True
    ):
        for estimate, truth in ((share.first, first), (share.total, total)):
            # The interval is at 95 %: 1.5 times its half-width covers three sigma.
            room = 0.75 * (estimate.high - estimate.low)
            assert estimate.value == pytest.approx(truth, abs=room)
            assert 0.0 < estimate.high - estimate.low < 0.15


def test_bootstrap_intervals_cover_the_truth():
    """x1 + 2 x2 has the shares 1/5 and 4/5. Of 60 intervals, 57 ± 1.7 contain the truth."""
    inside = np.zeros(2)
    for seed in range(60):
        design = _pick_freeze(lambda u: u[:, 0] + 2.0 * u[:, 1], 2, 256, seed)
        found = shares(design, ("a", "b"), seed)
        inside += [e.low <= 0.2 <= e.high for e in (found[0].first, found[0].total)]
    assert (inside >= 49).all(), inside


def test_what_does_not_vary_has_no_shares():
    figures = np.full((4, 100), 1.0) + 1e-15 * np.random.default_rng(0).random((4, 100))
    assert shares(figures, ("a", "b"), 0) == ()


def test_a_figure_of_which_one_row_differs_has_shares():
    """Of sixteen rows, one resample in three leaves out the only one that differs."""
    figures = np.ones((4, 16))
    figures[0, 3] = figures[2, 3] = 2.0
    for share in shares(figures, ("one", "other"), 0):
        for found in (share.first, share.total):
            assert np.isfinite([found.value, found.low, found.high]).all()
