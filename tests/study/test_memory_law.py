"""The parts of a spline with memory, and the scene that they form."""

import math

import numpy as np
import pytest
from tests.certify.oracle import interval
from tests.support import shipped

from loadshare.contact.radial import Piece, RadialLaw
from loadshare.scene import assemble
from loadshare.train import build_train
from loadshare.train.elements import Spline
from loadshare.train.memory import SlipFriction, SlipStop

SPLINE = Spline("4", 1e7, None, 40e-6, None, 0.1 / 0.035)


def test_friction_resists_with_its_bound_and_no_more():
    law = SlipFriction(SPLINE).law(70.0)
    assert interval(law, 0.0, 1e-12) == (0.0, pytest.approx(200.0))
    assert interval(law, 1e-6) == (pytest.approx(200.0), pytest.approx(200.0))
    assert law.strength == pytest.approx(200.0)
    assert math.isinf(RadialLaw((Piece(0.0, 1e7, math.inf, "stick"),)).strength)


def test_the_clearance_leaves_what_friction_bends():
    """S2 − F_m/K_w, or zero if friction alone needs more."""
    assert SlipStop(SPLINE).law(70.0).reach == pytest.approx(40e-6 - 20e-6)
    assert SlipStop(SPLINE).law(700.0).reach == 0.0


def test_both_follow_the_torque_if_the_spline_does():
    assert SlipFriction(SPLINE).friction_force is None
    fixed = Spline("4", 1e7, None, 40e-6, 50.0, 0.0)
    assert SlipStop(fixed).friction_force == 50.0
    assert SlipStop(fixed).law(1.0) == SlipStop(fixed).law(99.0)


def test_a_stick_limit_that_makes_no_jump_is_allowed():
    at_the_corner = Spline("4", 1e7, 20e-6, 40e-6, 200.0, 0.0)
    assert SlipFriction(at_the_corner).law(0.0).strength == 200.0
    before_it = Spline("4", 1e7, 10e-6, 40e-6, 200.0, 0.0)
    with pytest.raises(ValueError, match=r"no step from K_w S1 = 100 N to F_m = 200 N"):
        SlipFriction(before_it).law(0.0)


def test_the_scene_gets_two_coordinates_for_every_slip():
    train = build_train(shipped("fgfbstts/full_float"))
    plain = assemble(train, 1)
    slip = {g: np.array([1e-6, 2e-6, 0.0]) for g in "45"}
    scene = assemble(train.remembering(slip), 1)
    assert scene.size == plain.size + 4
    assert scene.coordinates[-4:] == tuple(f"spline {g} slip {a}" for g in "45" for a in "xy")
    friction, stop = (r for r in scene.radials if r.gear == "4")
    assert friction.centre.tolist() == [1e-6, 2e-6]
    assert stop.centre.tolist() == [0.0, 0.0]
    # The shaft bends by p − s, so a common displacement needs no force.
    together = np.zeros(scene.size)
    together[scene.displacement["4"]] = (1.0, 1.0)
    together[-4:-2] = (1.0, 1.0)
    assert together @ scene.stiffness @ together == 0.0
    assert train.slip is None
