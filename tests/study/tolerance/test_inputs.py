"""Which inputs scatter, how, and which of them together."""

import math

import numpy as np
import pytest
from scipy import stats
from tests.support import shipped

import loadshare as ls
from loadshare.case.study import Spread
from loadshare.settings import TOLERANCE
from loadshare.study.parameter import table_of
from loadshare.study.tolerance.design import uniforms
from loadshare.study.tolerance.distribution import Distribution, read_distribution
from loadshare.study.tolerance.inputs import ScatteredInputs, read_inputs

NORMAL = {"distribution": "normal", "mean": "0 um", "deviation": "10 um"}
COUNT = 40_000
POINTS = (np.arange(COUNT) + 0.5) / COUNT


def drawn(spread: dict) -> Distribution:
    found = read_distribution(Spread(**spread))
    assert isinstance(found, Distribution)
    return found


@pytest.mark.parametrize(
    ("spread", "mean", "deviation", "ends"),
    [
        ({"distribution": "normal", "mean": "1 mm", "deviation": "20 um"}, 1.0, 0.02, None),
        (
            {"distribution": "uniform", "low": "2 um", "high": "8 um"},
            5.0,
            6.0 / math.sqrt(12.0),
            (2.0, 8.0),
        ),
        (
            {"distribution": "rayleigh", "scale": "10 um"},
            10.0 * math.sqrt(math.pi / 2.0),
            10.0 * math.sqrt(2.0 - math.pi / 2.0),
            None,
        ),
        ({"distribution": "uniform phase"}, 180.0, 360.0 / math.sqrt(12.0), (0.0, 360.0)),
        # Truncated at ± one deviation: the variance is 1 - 2 φ(1) / (2 Φ(1) - 1).
        (
            {
                "distribution": "truncated normal",
                "mean": 5.0,
                "deviation": 1.0,
                "low": 4.0,
                "high": 6.0,
            },
            5.0,
            math.sqrt(1.0 - 2.0 * stats.norm.pdf(1.0) / (2.0 * stats.norm.cdf(1.0) - 1.0)),
            (4.0, 6.0),
        ),
    ],
)
def test_distributions_have_their_moments(spread, mean, deviation, ends):
    """The grid of probabilities is fine and even; its ends cost 1e-4 of a normal variance."""
    found = drawn(spread)
    values = found.at(POINTS)
    assert values.mean() == pytest.approx(mean, rel=1e-4)
    assert values.std() == pytest.approx(deviation, rel=5e-4)
    low, high = found.ends()
    if ends is not None:
        assert (low, high) == ends
    else:
        assert found.frozen.cdf(high) == pytest.approx(0.99865, abs=1e-9)


def test_a_rayleigh_amount_has_no_lower_end_but_zero():
    found = drawn({"distribution": "rayleigh", "scale": "10 um"})
    assert found.ends()[0] == 0.0


def test_a_star_draws_each_key_and_equal_signs_tie():
    case = shipped("fgfbstts/tolerance")
    inputs = read_inputs(case, "errors")
    assert len(inputs.every) == 4 * 4 + 2
    tied = case.replace(
        {
            "study.errors.inputs": {
                "rings.4.float=rings.5.float": {
                    "distribution": "uniform",
                    "low": "2 um",
                    "high": "3 um",
                }
            }
        }
    )
    (one,) = read_inputs(tied, "errors").every
    assert one.keys == ("rings.4.float", "rings.5.float")
    assert list(table_of([one], np.ones((2, 1)))) == ["rings.4.float [um]", "rings.5.float [um]"]
    again = ScatteredInputs.from_plain(inputs.to_plain())
    assert again.every == inputs.every


def correlated(correlation, *more, inputs=("errors.6.*", "errors.9.installation[1]")):
    keys = ("errors.6.installation[0]", "errors.6.installation[1]", "errors.9.installation[1]")
    return shipped("fgfbstts/limit_ring").replace(
        {
            "study.t": {
                "kind": "tolerance",
                "inputs": dict.fromkeys(keys, NORMAL) | dict(more),
                "groups": [{"inputs": list(inputs), "correlation": correlation}],
            }
        }
    )


def test_a_copula_correlates_as_it_says():
    """For 65536 pairs, the error of a normal correlation is (1 - ρ²)/√n, 0.0014 here; that of ranks
    is similar. Four sigma are allowed. The rank correlation of a Gaussian copula is 6/π asin(ρ/2).
    """
    matrix = [[1.0, 0.8, -0.3], [0.8, 1.0, 0.1], [-0.3, 0.1, 1.0]]
    keys = ("errors.6.installation[0]", "errors.6.installation[1]", "errors.9.installation[1]")
    rayleigh = {"distribution": "rayleigh", "scale": "10 um"}
    case = correlated(matrix, (keys[2], rayleigh), inputs=keys)
    inputs = read_inputs(case, "t")
    points = np.concatenate([uniforms("random", 3, (), block, 3) for block in range(16)])
    values = inputs.values(points)
    room = 4.0 / math.sqrt(len(values))
    assert np.corrcoef(values[:, 0], values[:, 1])[0, 1] == pytest.approx(0.8, abs=room)
    ranks = stats.spearmanr(values).statistic
    for i, j in ((0, 1), (0, 2), (1, 2)):
        wanted = 6.0 / math.pi * math.asin(matrix[i][j] / 2.0)
        assert ranks[i, j] == pytest.approx(wanted, abs=room)
    # Each keeps its own distribution: Kolmogorov's distance at 1e-4 is 2.23/√n.
    for k, one in enumerate(inputs.every):
        distance = stats.kstest(values[:, k], one.distribution.frozen.cdf).statistic
        assert distance < 2.23 / math.sqrt(len(values))
    assert inputs.units == ((0, 1, 2),)


def test_a_star_in_a_group():
    case = correlated(0.5, inputs=("errors.*.installation[1]",))
    (copula,) = read_inputs(case, "t").copulas
    assert copula.members == (1, 2)
    assert read_inputs(case, "t").units == ((0,), (1, 2))


@pytest.mark.parametrize(
    ("correlation", "inputs", "message"),
    [
        (1.0, None, "not positive definite"),
        (-0.6, None, "not positive definite"),
        ([[1.0, 0.5], [0.5, 1.0]], None, "not a matrix of 3 rows"),
        ([[1.0, 0.5, 0.0], [0.4, 1.0, 0.0], [0.0, 0.0, 1.0]], None, "not symmetric"),
        ([[0.9, 0.5, 0.0], [0.5, 1.0, 0.0], [0.0, 0.0, 1.0]], None, "ones on its diagonal"),
        (0.5, ("errors.6.installation[0]",), "refers to a single input"),
        (0.5, ("errors.6.installation[0]", "rings.4.float"), "is not drawn"),
    ],
)
def test_a_group_that_cannot_be_is_reported(correlation, inputs, message):
    every = (
        "errors.6.installation[0]",
        "errors.6.installation[1]",
        "errors.9.installation[1]",
    )
    case = correlated(correlation, inputs=inputs or every)
    with pytest.raises(ls.CaseError, match=message):
        read_inputs(case, "t")


def test_all_that_is_wrong_is_reported_at_once():
    case = shipped("fgfbstts/limit_ring")
    inputs = {
        "rings.4.flot": {"distribution": "uniform", "low": "1 um", "high": "2 um"},
        "rings.9.*": {"distribution": "uniform", "low": "1 um", "high": "2 um"},
        "errors.6.installation[0]": {**NORMAL, "deviation": "-1 um"},
        "errors.6.installation[1]": {**NORMAL, "mean": "much"},
        "errors.9.installation[0]": {**NORMAL, "mean": "1 N"},
        "rings.*.float": {"distribution": "normal", "mean": "8 um", "deviation": "3 um"},
        "rings.5.float": {"distribution": "uniform", "low": "2 um", "high": "2 um"},
        "errors.9.installation[1]": {
            "distribution": "truncated normal",
            "mean": "0 um",
            "deviation": "1 um",
            "low": "20 um",
            "high": "30 um",
        },
        "shafts.2-4.stiffness": {
            "distribution": "truncated normal",
            "mean": "5e5 N*m/rad",
            "deviation": "1e12 N*m/rad",
            "low": "499900 N*m/rad",
            "high": "500100 N*m/rad",
        },
        "gears.1.teeth": {"distribution": "uniform", "low": 20, "high": 22},
    }
    with pytest.raises(ls.CaseError) as caught:
        ls.tolerance(case, inputs, samples=100, sampling="sobol")
    message = str(caught.value)
    for part in (
        "Did you mean float",
        "matches no key of the case",
        "is not positive",
        'mean = "much": cannot be read',
        "cannot be expressed in N",
        "is negative",
        "A truncated normal distribution stays within limits",
        "is already drawn by rings.*.float",
        "is not above low",
        "too far from its mean",
        "too close together for its deviation",
        "gears.1.teeth is a count",
        "cannot be divided among 16",
    ):
        assert part in message, part
    assert "study.tolerance.inputs" in message


def test_what_the_case_reader_finds_is_reported_at_once():
    case = shipped("fgfbstts/limit_ring")
    with pytest.raises(ls.CaseError) as caught:
        ls.tolerance(
            case,
            {
                "rings.4.float": {"distribution": "norml"},
                "rings.5.float": {"distribution": "uniform", "low": "1 um", "scale": "2 um"},
            },
            groups=[{"inputs": ["rings.4.float"], "correlation": 1.5}],
            limit=-1.0,
        )
    message = str(caught.value)
    for part in (
        "Did you mean normal",
        "is missing",
        "does not apply to a uniform",
        "at most 1",
        "at least 1e-40",
    ):
        assert part in message, part


def test_a_study_must_be_found():
    case = shipped("fgfbstts/limit_ring")
    with pytest.raises(ls.CaseError, match="has no tolerance study"):
        ls.tolerance(case)
    with pytest.raises(ls.CaseError, match="is not a tolerance study"):
        ls.tolerance(shipped("fgfbstts/tolerance"), study="other")


def test_blocks_are_streams_of_their_own():
    one = uniforms("random", 7, (), 3, 5)
    assert np.array_equal(one, uniforms("random", 7, (), 3, 5))
    for other in (
        uniforms("random", 7, (), 4, 5),
        uniforms("random", 8, (), 3, 5),
        uniforms("random", 7, (1,), 3, 5),
    ):
        assert not np.isin(one, other).any()


def test_sobol_blocks_go_on_where_the_last_one_ended():
    """The first 512 points of each sequence, from two blocks, have one point in each 512th."""
    both = np.concatenate([uniforms("sobol", 1, (), block, 4) for block in (0, 1)])
    for r in range(TOLERANCE.sequences):
        cells = np.sort(np.floor(both[r :: TOLERANCE.sequences] * 512.0), axis=0)
        assert np.array_equal(cells, np.repeat(np.arange(512.0)[:, None], 4, axis=1))
    assert len(np.unique(both[:, 0])) > 8000
    assert both.min() > 0.0
    assert both.max() < 1.0


def with_class(**inputs) -> ls.Case:
    """Return a set of planets with eccentricities; the first has a finer class than the second."""
    case = shipped("planetary/four_planets")
    changes = {f"gears.planet{k}.tolerance_class": k + 4 for k in (1, 2)}
    changes |= {
        f"errors.planet{k}.eccentricity": {"amount": "1 um", "direction": "0 deg"}
        for k in (1, 2, 3)
    }
    return case.replace(changes | {"study.t": {"kind": "tolerance", "inputs": inputs}})


def test_runout_of_the_class_bounds_an_eccentricity():
    """F_rT/2 = 0.45 (0.002 d + 0.55 √d + 0.7 m + 12) µm in class 5, √2 times that in class 6."""
    spread = {"distribution": "uniform", "low": "0 um", "high": "class"}
    case = with_class(
        **{f"errors.planet{k}.eccentricity.amount": spread for k in (1, 2)},
    )
    one, two = (single.distribution for single in read_inputs(case, "t").every)
    half = 0.45 * (0.002 * 180.0 + 0.55 * math.sqrt(180.0) + 0.7 * 5.0 + 12.0)
    assert one.numbers["high"] == pytest.approx(half, rel=1e-12)
    assert two.numbers["high"] == pytest.approx(half * math.sqrt(2.0), rel=1e-12)
    assert one.unit == "um"


@pytest.mark.parametrize(
    ("key", "message"),
    [
        ("errors.planet*.eccentricity.amount", "gears.planet3 has no tolerance_class"),
        ("errors.planet2.pin.tangential", "does not follow from a tolerance class"),
        (
            "errors.planet1.eccentricity.amount=errors.planet2.eccentricity.amount",
            "is not the same for all keys",
        ),
    ],
)
def test_a_class_that_tells_nothing_is_reported(key: str, message: str):
    with pytest.raises(ls.CaseError, match=message) as caught:
        read_inputs(
            with_class(**{key: {"distribution": "uniform", "low": "0 um", "high": "class"}}), "t"
        )
    assert len(caught.value.problems) == 1
