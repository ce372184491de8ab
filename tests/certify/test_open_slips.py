"""Friction that is exactly used up: forces are bounded, however far the gear has slipped.

The pinion of one path is pushed with T/r_b, and friction holds up to τ T/radius: at radius = τ r_b
they are equal under any load. With a slightly smaller radius the pinion sticks, with a larger one
it slips as far as its clearance. Source: formulation, section 5.
"""

from dataclasses import replace

import numpy as np
import pytest

import loadshare as ls
from benchmarks import families
from loadshare.certify import certify
from loadshare.certify.bound.claim import Claim
from loadshare.certify.bound.columns import Columns
from loadshare.certify.bound.open_slips import is_inside, open_slips
from loadshare.job.machine import Machine
from loadshare.solver.hot import vectorised
from loadshare.train import build_train

FRICTION, BESIDE = 0.1, 1e-6


def two_path(gap: float = 30.0, torque: float = 10.0, **spline: object) -> ls.Case:
    """Return two paths with a gap in B; the pinion of A floats in a spline."""
    late = {'meshes."in-wheelB".gap': f"{gap} mrad", "operating.torque": f"{torque!r} N*m"}
    given = {"bending_stiffness": "2e7 N/m", "clearance": "0.2 mm", "friction": FRICTION, **spline}
    floating = {"gears.pinionA.support": "free", "splines": {"pinionA": given}}
    return families.two_path("0 mrad").replace({**late, **floating})


def used_up(more: float = 1.0, **given: object) -> ls.Case:
    """Return a case in which friction equals the force, or differs from it by some fraction."""
    radius = build_train(families.two_path("0 mrad")).gears["pinionA"].base_radius
    return two_path(radius=f"{FRICTION * radius * more!r} m", **given)


def held_with(force: float, **given: object) -> ls.Case:
    """Return the same with a fixed friction."""
    return two_path(normal_force=f"{force / FRICTION!r} N", **given)


def covered(claimed: ls.Case, *others: ls.Case) -> None:
    """Check that other answers are within the bounds of a claim."""
    here = ls.solve(claimed).positions[0]
    bound = here.certificate.bound
    for case in others:
        there = ls.solve(case).positions[0]
        for mesh, torque in here.torque.items():
            off = abs(there.torque[mesh] - torque)
            assert off <= bound.torque[mesh] + there.certificate.bound.torque[mesh]
        for k, axis in enumerate("xy"):
            off = abs(there.displacement["pinionA"][k] - here.displacement["pinionA"][k])
            assert off <= bound.place[f"pinionA {axis}"] * (1.0 + BESIDE)
        off = abs(there.rotation["in"] - here.rotation["in"])
        assert off <= bound.place["in rotation"] * (1.0 + BESIDE)
        size = there.floats["pinionA"].spline_force
        assert size == pytest.approx(here.floats["pinionA"].spline_force, rel=1e-12)


@pytest.mark.parametrize("torque", [1e-3, 10.0, 15.0])
@pytest.mark.parametrize("stiffness", ["2e6 N/m", "2e7 N/m", "1e9 N/m"])
@pytest.mark.quick(2)
def test_both_ends_of_a_slip_lie_within_the_bound(torque, stiffness):
    given = {"torque": torque, "bending_stiffness": stiffness, "clearance": "1 mm", "gap": 200.0}
    found = ls.solve(used_up(**given)).positions[0]
    assert found.certificate.bound.relative < 1e-12
    covered(used_up(**given), used_up(1.0 - BESIDE, **given), used_up(1.0 + BESIDE, **given))


@pytest.mark.parametrize("stick", ["0 um", "20 um"])
def test_a_force_that_steps_up_to_friction(stick):
    """Any place beyond S1 is an equilibrium, wherever the force begins to step."""
    train = build_train(used_up())
    machine = Machine(train)
    answer = machine.answer(machine.situations([1]), 1e-9, vectorised.settle).equilibria.one(0, 1)
    found = certify(build_train(used_up(stick_limit=stick)), answer)
    assert found.passed
    assert found.bound.relative < 1e-12


def test_friction_that_is_given():
    force = ls.solve(used_up()).positions[0].floats["pinionA"].spline_force
    covered(held_with(force), held_with(force * (1.0 - BESIDE)), held_with(force * (1.0 + BESIDE)))


@pytest.mark.parametrize("gap", [10.0, 26.0])
@pytest.mark.quick(1)
def test_a_slip_that_lets_another_path_carry_is_not_bounded(gap):
    """From 27 mrad on B carries nothing, however far the pinion of A slips; below, it may carry."""
    assert ls.solve(used_up(1.0 + 1e-6, gap=26.0)).positions[0].torque["in-wheelB"] > 1.0
    with pytest.raises(ls.Refused, match="not proved at all"):
        ls.solve(used_up(gap=gap))
    assert ls.solve(used_up(gap=27.5)).positions[0].torque["in-wheelB"] == 0.0


@pytest.mark.parametrize(("gap", "proved"), [(10.0, False), (26.0, False), (27.5, True)])
def test_a_slip_that_pushes_what_is_loose(gap, proved):
    """B is 1 nm from the output; a slip of A turns the input, which closes that gap too."""
    case = used_up(1.0 - 1e-12, gap=gap)
    machine = Machine(build_train(case))
    stuck = machine.answer(machine.situations([1]), 1e-9, vectorised.settle).equilibria.one(0, 1)
    assert stuck.flank_force["in-wheelB"] == 0.0
    turned = -1e-9 / machine.train.gears["pinionB"].base_radius
    claim = replace(stuck, rotation=stuck.rotation | {"wheelB": turned, "pinionB": turned})
    assert certify(machine.train, claim).passed
    found = certify(build_train(used_up(gap=gap)), claim)
    assert (found.bound.relative < 1e-12) is proved
    assert found.passed is proved


def test_errors_of_forces_beyond_the_margin_prove_nothing():
    train = build_train(used_up())
    machine = Machine(train)
    here = machine.situations([1])
    claim = Claim(Columns(train), here, machine.answer(here, 1e-9, vectorised.settle).equilibria)
    (slip,) = open_slips(claim)
    assert slip.gear == "pinionA"
    none = np.zeros(len(claim.answers.flank_force[0]))
    for error, holds in ((1e-9, True), (1e-2, False)):
        assert is_inside(claim, slip, none + error) is holds
    shifted = replace(claim.answers, radial_reaction=claim.answers.radial_reaction * 0.999)
    assert not open_slips(replace(claim, answers=shifted))
