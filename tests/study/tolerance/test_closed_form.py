"""Two paths with clocked shafts: Ω is linear in the clockings, and everything is known."""

import math

import numpy as np
import pytest
from scipy import special
from tests.support import shipped

import loadshare as ls
from loadshare.study.tolerance import study as room

A, B = 'shafts."wheelA-pinionA".clocking', 'shafts."wheelB-pinionB".clocking'
MEAN = 1.2
"""Mean of the first clocking [mrad]; the second one scatters about zero."""


def normal(mean: float, deviation: float) -> dict:
    return {"distribution": "normal", "mean": f"{mean} mrad", "deviation": f"{deviation} mrad"}


@pytest.fixture(scope="module")
def slope() -> float:
    """Return the slope of Ω over the difference of the clockings, first minus second [1/mrad]."""
    return (ls.solve(shipped("two_path/clocking_error")).omega["system"] - 1.0) / MEAN


def study(**settings):
    given = {"samples": 4096, "indices": 0, "worst": False, "engine": "vectorised", **settings}
    inputs = given.pop("inputs", {A: normal(MEAN, 0.1), B: normal(0.0, 0.05)})
    return ls.tolerance(shipped("two_path/clocking_error"), inputs, **given)


DEVIATION = math.hypot(0.1, 0.05)


@pytest.mark.parametrize("sampling", ["random", "sobol"])
def test_moments_and_probability(slope, sampling):
    """For n samples, the errors are σ/√n of the mean, σ/√(2n) of the deviation and √(pq/n) of a
    probability, all within 4.5 sigma; for Sobol points they are far smaller, within a tenth of
    that.
    """
    limit = 1.0 + slope * (MEAN + DEVIATION)
    found = study(sampling=sampling, seed=11, limit=limit)
    assert (found.samples, found.refused, found.messages) == (4096, 0, {})
    assert found.residual < 1e-9
    one = found.of("II")
    room = 4.5 / math.sqrt(found.samples) * (0.1 if sampling == "sobol" else 1.0)
    figures = one.summary
    assert figures.mean.value == pytest.approx(1.0 + slope * MEAN, abs=room * slope * DEVIATION)
    assert figures.deviation == pytest.approx(slope * DEVIATION, rel=room)
    above = 1.0 - special.ndtr(1.0)
    assert one.exceedance.value == pytest.approx(above, abs=room * math.sqrt(above))
    assert one.exceedance.low < above < one.exceedance.high
    for level, quantile in figures.quantiles.items():
        truth = 1.0 + slope * (MEAN + DEVIATION * special.ndtri(level))
        assert quantile.low <= truth <= quantile.high, level
    assert figures.counts.sum() == found.samples


def test_every_sample_is_the_linear_answer(slope):
    found = study(samples=512, seed=2)
    frame = found.to_frame()
    assert frame["sample"].tolist() == list(range(512))
    apart = frame[f"{A} [mrad]"] - frame[f"{B} [mrad]"]
    assert np.allclose(frame["omega.system"], 1.0 + slope * apart, rtol=0.0, atol=1e-10)
    # Torque follows Ω: of 367 N·m, half is in the mean path.
    largest = frame[["torque.in-wheelA [N*m]", "torque.in-wheelB [N*m]"]].max(axis=1)
    assert np.allclose(largest, 367.0 / 2.0 * frame["omega.I"], rtol=1e-10)


def test_shares_of_variance(slope):
    """Variances add: 0.8 and 0.2, both first-order and total, because nothing interacts."""
    found = study(indices=2048, samples=64)
    shares = {s.unit: s for s in found.of("system").shares}
    for unit, truth in ((A, 0.8), (B, 0.2)):
        for estimate in (shares[unit].first, shares[unit].total):
            assert estimate.value == pytest.approx(truth, abs=0.75 * (estimate.high - estimate.low))
            assert estimate.high - estimate.low < 0.2
    assert found.design_refused == 0


def test_correlated_inputs_share_as_one(slope):
    """With ρ = 0.9 between both, Var(a - b) = σ²(2 - 1.8), all of which belongs to the group."""
    inputs = {A: normal(MEAN, 0.1), B: normal(0.0, 0.1)}
    group = {"inputs": [A, B], "correlation": 0.9}
    found = study(inputs=inputs, groups=[group], indices=512, sampling="sobol")
    one = found.of("system")
    assert one.summary.deviation == pytest.approx(slope * 0.1 * math.sqrt(0.2), rel=0.01)
    (share,) = one.shares
    assert share.unit == f"{A} + {B}"
    assert share.total.value == pytest.approx(1.0, abs=0.15)


def test_the_worst_case_is_at_the_vertex(slope):
    inputs = {
        A: {"distribution": "uniform", "low": "1.0 mrad", "high": "1.4 mrad"},
        B: {"distribution": "uniform", "low": "-0.2 mrad", "high": "0.1 mrad"},
    }
    (worst,) = study(inputs=inputs, samples=64, worst=True).worst
    assert worst.over == "stage"
    assert worst.at == {A: "high", B: "low"}
    assert worst.inputs == {A: 1.4, B: -0.2}
    assert worst.omega == pytest.approx(1.0 + slope * 1.6, abs=1e-10)
    again = ls.solve(shipped("two_path/clocking_error").replace(worst.changes))
    assert again.omega["system"] == worst.omega


def test_the_worst_case_is_not_sought_again(slope, tmp_path, monkeypatch):
    """It is stored with its study, and sought again if the file is unusable."""
    options = {"samples": 64, "worst": True, "out": tmp_path / "study"}
    first = study(**options).worst
    searches = []
    search = room.sought
    monkeypatch.setattr(room, "sought", lambda *a: searches.append(a) or search(*a))
    assert study(**options).worst == first
    assert searches == []
    file = tmp_path / "study" / "worst.json"
    kept = file.read_text(encoding="utf-8")
    other = kept.replace(study(samples=64, out=tmp_path / "study").folder.job.hash, "another")
    for useless in (other, kept[:-20], kept.replace('"solved"', '"seen"')):
        file.write_text(useless, encoding="utf-8")
        assert study(**options).worst == first
        assert file.read_text(encoding="utf-8") == kept
    assert len(searches) == 3


def test_the_worst_phase_is_between(slope):
    """A phase has no vertex. Two equal eccentricities add up most between its limits, or cancel."""
    case = shipped("fgfbstts/base").replace(
        {
            "errors.6.eccentricity": {"amount": "20 um", "direction": "0 deg"},
            "operating.rotation": "neglected",
        }
    )
    phase = {"errors.6.eccentricity.phase": {"distribution": "uniform phase"}}
    found = ls.tolerance(
        case, phase, samples=1024, indices=0, sampling="sobol", positions=[1], engine="vectorised"
    )
    stage = found.worst[0]
    assert stage.at == {"errors.6.eccentricity.phase": "between"}
    # Over 1024 even phases, the largest is below the maximum by less than (π/1024)²/2 of its
    # amplitude.
    top = found.of("system").summary.highest
    assert top <= stage.omega + 1e-12
    assert stage.omega - top < 1e-5 * (stage.omega - 1.0)


def test_dataset_and_picture(slope, tmp_path):
    found = study(samples=256, indices=64, limit=1.06)
    arrays = found.dataset
    one = found.of("II", "group")
    here = arrays.sel(over="group", stage="II")
    assert here["mean"] == one.summary.mean.value
    assert here["exceedance_high"] == one.exceedance.high
    assert here["quantile"].sel(level=0.9) == one.summary.quantiles[0.9].value
    assert here["total_order"].sel(input=A) == one.shares[0].total.value
    assert here["edge"].values.tolist() == one.summary.edges.tolist()
    assert arrays.attrs["limit"] == 1.06
    figures = [arrays[name] for name in (*arrays.data_vars, "edge", "level")]
    assert {figure.attrs["units"] for figure in figures} == {"1"}
    assert len({figure.attrs["long_name"] for figure in figures}) == len(figures)
    picture = found.plot("II").save(tmp_path / "tolerance.svg")
    text = picture.read_text(encoding="utf-8")
    assert "Distribution of Ω of stage II" in text
    assert "256 samples" in text
    assert "torque over the mean of its stage" in text
    assert found.dataset.attrs["title"] in text
    with pytest.raises(KeyError, match="stage 'III'"):
        found.of("III")
