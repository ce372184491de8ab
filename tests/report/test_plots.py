"""The interface of drawing: results and studies offer pictures, and `loadshare.plot` draws them."""

import pytest

import loadshare as ls
from loadshare.report.plots import Plots


def test_a_result_and_the_package_draw_alike(limit_ring):
    assert limit_ring.plot == ls.plot(limit_ring) == Plots(limit_ring)
    assert ls.plot(limit_ring).torque().spec == limit_ring.plot.torque().spec


def test_a_study_is_drawn_as_its_settings_say(limit_ring):
    found = ls.sweep(limit_ring.case, {"rings.4.float": ["0 um", "8 um"]}, positions=[1])
    assert ls.plot(found, "torque").spec == found.plot("torque").spec
    assert found.plot("torque").spec != found.plot("omega").spec


def test_what_a_study_has_not_found_is_reported(limit_ring):
    case = limit_ring.case
    rates = ls.sensitivity(case, ["rings.4.float"], positions=[1])
    inputs = {"rings.4.float": {"distribution": "uniform", "low": "0 um", "high": "9 um"}}
    scatter = ls.tolerance(case, inputs, samples=64, indices=0, worst=False, positions=[1])
    for found in (rates, scatter):
        with pytest.raises(ls.LoadshareError, match=r"no stage 'III'\. Allowed: I, II, system"):
            found.plot("III")
        with pytest.raises(ValueError, match="unknown over 'mesh'; allowed: stage, group"):
            found.plot("II", "mesh")
    with pytest.raises(ValueError, match="no column omega; allowed: sample, rings"):
        scatter.to_frame("omega")
    assert scatter.to_frame("omega.II").columns.tolist() == ["omega.II"]


def test_a_sweep_without_any_answer_is_reported(limit_ring):
    contradicting = {
        "rings.4.measured": "nominal",
        "rings.4.clearance": "10 um",
        "errors.6.installation": {"amount": "30 um", "direction": "131.17 deg"},
    }
    case = limit_ring.case.replace(contradicting)
    found = ls.sweep(case, {"operating.power": ["1000 kW", "2000 kW"]}, positions=[1])
    with pytest.raises(ls.LoadshareError, match="no point of the sweep has an answer"):
        found.plot()


def test_what_has_no_pictures_is_reported():
    with pytest.raises(TypeError, match="no pictures of dict"):
        ls.plot({})


def test_the_package_lists_what_is_public():
    assert dir(ls) == sorted(ls.__all__)
    assert all(getattr(ls, name) is not None for name in dir(ls))
