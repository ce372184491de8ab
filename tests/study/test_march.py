"""Friction with memory: closed forms, conservation, and a certificate that includes the memory."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.support import CASES, mostly_slow, shipped

import loadshare as ls
from loadshare.certify import certify
from loadshare.study.memory.step import stepped
from loadshare.train import build_train
from loadshare.train.memory import slip_of

TURN = {"march": {"gear": "4", "revolutions": 1.0, "steps": 8}}


def floating(**changes: object) -> ls.Case:
    """Return the seed's full float, marching through a revolution of pinion 4."""
    return shipped("fgfbstts/full_float").replace({**TURN, **changes})


def both(key: str, value: str) -> dict[str, str]:
    """Return changes of a key of both splines."""
    return {f"splines.{g}.{key}": value for g in "45"}


def test_without_friction_there_is_nothing_to_remember():
    case = floating(**both("normal_force", "0 N"))
    found = ls.march(case)
    alone = ls.solve(case)
    assert found.dissipated == 0.0
    for here, there in zip(found.result.positions, alone.positions, strict=True):
        assert here.torque == pytest.approx(there.torque, rel=1e-9)


def test_a_spline_that_cannot_slip_is_a_spring():
    """Friction whose bound is never reached holds, so only the stiffness K_w remains."""
    found = ls.march(floating(**both("normal_force", "10 MN")))
    springs = {f"gears.{g}.support": "1.78e7 N/m" for g in "45"}
    spring = floating(splines=None, assumed=["errors.*"], **springs)
    alone = ls.solve(spring)
    assert found.dissipated == 0.0
    assert (found.dataset["stage"] == "stick").all()
    assert np.abs(found.dataset["slip"]).max() < 1e-18
    for here, there in zip(found.result.positions, alone.positions, strict=True):
        assert here.torque == pytest.approx(there.torque, rel=1e-9)


def test_the_first_step_is_the_holonomic_law():
    """From rest |s − 0| is |s|, so both laws are the same."""
    case = floating()
    found = ls.march(case, steps=1)
    alone = ls.solve(case, positions=[1])
    (here,), (there,) = found.result.positions, alone.positions
    assert here.torque == pytest.approx(there.torque, rel=1e-9)
    assert here.displacement["4"] == pytest.approx(there.displacement["4"], abs=1e-13)
    assert here.floats["4"].spline == there.floats["4"].spline == "slip"
    assert here.floats["4"].spline_force == pytest.approx(50.0, rel=1e-9)
    # s = p (1 − F_m / (K_w R)), so that F_m |s| is dissipated.
    radius = float(np.hypot(*there.displacement["4"]))
    slip = radius - 50.0 / 1.78e7
    assert np.linalg.norm(found.slips[0]["4"].slip) == pytest.approx(slip, rel=1e-7)
    assert found.slips[0]["4"].dissipated == pytest.approx(50.0 * slip, rel=1e-7)


def test_what_is_dissipated_is_friction_times_the_path_of_the_slip():
    found = ls.march(floating(), revolutions=2.0, steps=24)
    before = {g: np.zeros(2) for g in "45"}
    for step in found.slips:
        for gear, s in step.items():
            path = float(np.linalg.norm(s.slip - before[gear]))
            assert s.dissipated >= 0.0
            assert s.dissipated == pytest.approx(s.friction * path, abs=1e-14)
            assert (s.stage == "stick") == (path < 1e-15)
            before[gear] = s.slip
    assert found.dissipated > 0.0
    assert found.result.passed


def test_memory_matters():
    """With memory a float lags: at some step its position differs from that without memory."""
    case = floating()
    found, alone = ls.march(case), ls.solve(case)
    apart = np.abs(found.dataset["displacement"] - alone.dataset["displacement"]).max()
    assert apart > 1e-7


def test_every_revolution_is_like_the_one_before():
    """Only errors that turn with the pinion remain, so that memory repeats in every revolution."""
    only = {f"errors.{g}.eccentricity": None for g in ("1", "2", "3", "6", "7", "8", "9", "10")}
    steps = 12
    found = ls.march(floating(**only), revolutions=4.0, steps=4 * steps)
    torque = found.dataset["torque"].values.reshape(4, steps, -1)
    assert torque[2:] == pytest.approx(torque[1:3], rel=1e-9)
    slip = found.dataset["slip"].sel(spline="4").values.reshape(4, steps, 2)
    walked = np.diff(slip, axis=0)
    # Along the direction that the meshes leave free a float may drift, by the same amount in every
    # revolution.
    assert np.ptp(walked[1:], axis=(0, 1)).max() < 1e-12
    # The first revolution starts from rest, with no friction built up yet.
    assert np.abs(walked[0] - walked[1]).max() > 1e-7


@pytest.mark.parametrize(
    "name", mostly_slow(("spline_clearance", "all_elements"), ("spline_clearance",))
)
def test_a_clearance_that_is_used_up_holds_the_slip(name):
    """At the stop, the shares of friction and clearance are not unique, but their sum is."""
    changes = TURN if name == "spline_clearance" else {"march.steps": 3}
    case = shipped(f"fgfbstts/{name}").replace(changes)
    found = ls.march(case)
    assert found.result.passed
    assert "stop" in found.dataset["stage"].sel(spline="4").values
    train = build_train(case)
    for step in found.slips:
        for gear, s in step.items():
            spline = train.splines[gear]
            room = spline.clearance - s.friction / spline.bending_stiffness
            # The certificate allows 1e-9 of the deflection.
            assert np.linalg.norm(s.slip) <= room + 1e-12
            assert s.dissipated >= 0.0


def test_the_certificate_refuses_a_forgotten_slip():
    """The same answer is no equilibrium from another slip."""
    train = build_train(floating()).remembering({g: np.zeros(3) for g in "45"})
    answer = stepped(train, 2)
    assert answer.certificate.passed
    slip = {g: slip_of(s, answer.equilibrium) for g, s in train.splines.items()}
    moved = train.remembering({g: s + np.array([1e-6, -2e-6, 0.0]) for g, s in slip.items()})
    judged = certify(moved, answer.equilibrium)
    assert "cone_membership" in judged.failing


@pytest.mark.parametrize("share", [1.01, 0.5])
def test_the_certificate_refuses_another_friction(share):
    train = build_train(floating()).remembering({g: np.zeros(3) for g in "45"})
    found = stepped(train, 1).equilibrium
    wrong = dict(found.radial_reaction)
    wrong["spline 4"] = share * wrong["spline 4"]
    certificate = certify(train, replace(found, radial_reaction=wrong))
    assert {"force_balance", "cone_membership"} <= set(certificate.failing)


def test_a_law_that_jumps_has_no_memory():
    case = floating(**{"splines.4.stick_limit": "1 um"})
    with pytest.raises(ls.Refused, match="leave stick_limit out"):
        ls.march(case)


def test_a_case_without_a_march_is_reported():
    with pytest.raises(ls.CaseError, match=r"is missing.* gear and revolutions would do"):
        ls.march(shipped("fgfbstts/full_float"), steps=3)


def test_one_step_is_one_in_words():
    found = ls.march(shipped("fgfbstts/full_float"), gear="4", revolutions=1.0, steps=1)
    assert "way: 1 step, 0 revolutions of gear 4" in repr(found)


def test_a_refused_step_leaves_those_before_it(monkeypatch):
    from loadshare.study import march as room

    def fails(train, index, ways):
        if index > 2:
            raise ls.Refused(f"position {index}: for the test")
        return stepped(train, index, ways)

    complete = ls.march(floating())
    monkeypatch.setattr(room, "stepped", fails)
    with pytest.raises(ls.Refused, match="position 3") as caught:
        ls.march(floating())
    assert [p.position for p in caught.value.partial.positions] == [1, 2]
    left, whole = caught.value.study, complete
    assert (left.revolutions, left.gear) == (whole.revolutions[:2], whole.gear)
    assert left.slips == whole.slips[:2]
    assert list(left.dataset.position) == [1, 2]
    assert left.refused == "position 3: for the test"
    assert whole.refused == ""


def test_what_solved_the_step_before_does_not_change_a_step(monkeypatch):
    """It is tried first; every step is the one that is found without it."""
    from loadshare.study import march as room

    rungs = []

    def both(train, index, ways):
        found = stepped(train, index, ways)
        rungs.append(found.rung)
        alone = stepped(train, index).equilibrium
        scale = max(alone.flank_force.values())
        for name, force in alone.flank_force.items():
            assert abs(found.equilibrium.flank_force[name] - force) <= 1e-10 * scale
        for name, place in alone.displacement.items():
            assert np.allclose(found.equilibrium.displacement[name], place, rtol=0, atol=1e-12)
        return found

    monkeypatch.setattr(room, "stepped", both)
    ls.march(CASES / "fgfbstts/all_elements.toml", steps=5)
    assert any("friction followed" in rung for rung in rungs)


def test_arrays_and_progress():
    reported = []
    found = ls.march(
        CASES / "fgfbstts/full_float.toml",
        gear="4",
        revolutions=0.5,
        steps=4,
        progress=lambda *done: reported.append(done),
    )
    assert reported == [(k, 4) for k in range(1, 5)]
    arrays = found.dataset
    assert arrays["slip"].dims == ("position", "spline", "component")
    assert arrays["revolutions"].values.tolist() == [0.0, 0.125, 0.25, 0.375]
    assert float(arrays["dissipated"].sum()) == pytest.approx(found.dissipated)
    assert not [v for v in arrays.data_vars if "long_name" not in arrays[v].attrs]
    assert arrays["friction"].attrs["units"] == "N"


def test_a_march_whose_displacements_are_too_large_is_refused():
    """`solve` refuses the same case without memory in the same way."""
    heavy = floating(**{"operating.power": "4e7 kW"})
    with pytest.raises(ls.Refused, match="displacements are too large"):
        ls.solve(heavy)
    with pytest.raises(ls.Refused, match="displacements are too large"):
        ls.march(heavy)


TWO_PATHS = {
    "operating": {"input": "1", "output": "4", "torque": "1000 N*m"},
    "gears": {
        "1": {"base_radius": "45 mm", "centre": ["0 mm", "0 mm"], "support": "free"},
        "2": {"base_radius": "100 mm", "centre": ["-150 mm", "0 mm"]},
        "3": {"base_radius": "100 mm", "centre": ["150 mm", "0 mm"]},
        "4": {"base_radius": "150 mm", "centre": ["0 mm", "-210 mm"]},
    },
    "meshes": {
        "1-2": {"stiffness": "1e6 N*m/rad"},
        "1-3": {"stiffness": "1e6 N*m/rad"},
        "2-4": {"stiffness": "4e6 N*m/rad"},
        "3-4": {"stiffness": "4e6 N*m/rad"},
    },
    "splines": {
        "1": {"bending_stiffness": "2e7 N/m", "clearance": "300 um", "friction_force": "20 N"}
    },
    "errors": {"2": {"installation": ["0 um", "150 um"]}},
}
"""A pinion on a spline between two wheels; one of them is out of place."""


def test_a_load_that_stays_leaves_a_spline_that_has_slipped_in_its_place():
    """Friction is used up, so rounding decides whether it sticks; the torques do not depend on it.

    The spline slips until its friction balances the remaining push of the meshes, which falls in
    proportion to the slip.
    """
    slips = []
    for friction in (1.0, 5.0, 20.0, 37.3, 100.0):
        case = ls.Case(TWO_PATHS).replace({"splines.1.friction_force": f"{friction} N"})
        found = ls.march(case, gear="1", revolutions=1.0, steps=4)
        first, *others = found.result.positions
        for step, position in zip(found.slips[1:], others, strict=True):
            assert position.torque == pytest.approx(first.torque, rel=1e-12)
            assert step["1"].dissipated == pytest.approx(0.0, abs=1e-12)
        slips.append(math.hypot(*found.slips[0]["1"].slip))
        assert found.slips[0]["1"].dissipated == pytest.approx(friction * slips[-1], rel=1e-9)
    line = np.polyfit([1.0, 100.0], [slips[0], slips[-1]], 1)
    np.testing.assert_allclose(slips, np.polyval(line, [1.0, 5.0, 20.0, 37.3, 100.0]), rtol=1e-9)
