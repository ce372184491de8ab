"""Marches with friction that follows the torque, with any room for slip that torques decide.

Source: formulation, section 5. From zero slip, the law with memory is the one without; if the
torque is not shared, friction is the same as when it is fixed.
"""

from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from tests.certify.oracle import ClaimedState
from tests.certify.test_bound_following import two_shafts
from tests.support import mostly_slow

import loadshare as ls
from benchmarks import families
from loadshare.study.memory.step import stepped
from loadshare.study.positions import certified
from loadshare.train import Train

LOADS = (1000.0, 1400.0, 700.0, 701.0, 1300.0)
"""Input torque of every step [N·m]."""


def with_splines(load: float, friction: float, rooms: dict[str, float]) -> Train:
    """Return two shafts with floating gears; room [m] is left beyond the friction at 400 N·m."""
    train = two_shafts(friction, f"{load!r} N*m")
    (spline,) = train.splines.values()
    needs = spline.bound(400.0) / spline.bending_stiffness
    splines = {g: replace(spline, gear=g, clearance=max(needs + r, 0.0)) for g, r in rooms.items()}
    gears = {
        g: train.gears["a"].support if g in rooms else v.support for g, v in train.gears.items()
    }
    moving = {n: replace(g, support=gears[n]) for n, g in train.gears.items()}
    return replace(train, gears=moving, splines=splines)


ROOMS = [
    {"a": -1.0},
    {"a": 0.0},
    {"a": 1e-6},
    {"a": 2e-5},
    {"a": -1.0, "b": -1.0},
    {"a": 0.0, "b": 3e-5},
    {"a": 1e-6, "b": -1.0, "b2": 5e-6},
]


@pytest.mark.parametrize("rooms", ROOMS)
@pytest.mark.parametrize("friction", [0.002, 0.05, 0.3])
@pytest.mark.quick(4)
def test_from_no_slip_the_law_is_the_one_without_memory(friction, rooms):
    train = with_splines(1000.0, friction, rooms)
    alone = certified(train, 1).equilibrium
    answer = stepped(train.remembering({g: np.zeros(3) for g in rooms}), 1)
    assert answer.certificate.passed
    for flank, force in answer.equilibrium.flank_force.items():
        assert force == pytest.approx(alone.flank_force[flank], abs=1e-5)


@pytest.mark.parametrize(
    ("friction", "rooms"),
    mostly_slow(
        product((0.002, 0.05, 0.3), ROOMS),
        [*product((0.002, 0.05, 0.3), ROOMS[:-1]), (0.3, ROOMS[-1])],
    ),
)
@pytest.mark.quick(5)
def test_every_step_is_within_what_its_own_torque_allows(friction, rooms):
    before = {g: np.zeros(3) for g in rooms}
    for load in LOADS:
        train = with_splines(load, friction, rooms).remembering(before)
        answer = stepped(train, 1)
        assert answer.certificate.passed
        state, found = ClaimedState(train, answer.equilibrium), answer.equilibrium
        for gear, spline in train.splines.items():
            bound = spline.bound(state.transmitted(gear))
            room = max(spline.clearance - bound / spline.bending_stiffness, 0.0)
            slip, held = state.slip(spline), found.radial_reaction[spline.name]
            assert np.linalg.norm(slip) <= room + 1e-12
            assert np.linalg.norm(held) <= bound * (1.0 + 1e-9) + 1e-5
            if (way := np.linalg.norm(slip - before[gear])) > 1e-10:
                assert held == pytest.approx(-bound / way * (slip - before[gear]), abs=1e-3)
            before[gear] = slip


def test_a_spline_without_friction_reaches_without_end():
    """With memory, before it meets its stop: the load is reversed and almost vanishes."""
    found = ls.march(Path(__file__).with_name("turned_back.toml"))
    assert found.result.passed
    first, last = ([p.torque["4-6"], p.torque["4-7"]] for p in found.result.positions)
    assert first == pytest.approx([-718.7, -718.7], rel=2e-3)
    # At so light a load, one of the branches loses contact.
    assert last == pytest.approx([0.0, 1.0], abs=1e-9)
    assert found.dissipated == 0.0


def on_one_spline(**friction: object) -> ls.Case:
    """Return a star whose sun carries the whole torque over a spline with little room."""
    data = families.star(4).to_dict()
    for mesh in data["meshes"].values():
        mesh.pop("gap", None)
    data["gears"]["sun"].pop("support")
    spline = {"bending_stiffness": "4e8 N/m", "clearance": "20 um"}
    data["splines"] = {"sun": spline | friction}
    data["errors"] = {
        planet: {"eccentricity": {"amount": "40 um", "direction": direction}}
        for planet, direction in (("planet1", "90 deg"), ("planet2", "0 deg"))
    }
    return ls.Case(data, name="star on a spline")


def test_a_slip_that_stays_at_the_end_of_its_room_is_as_with_fixed_friction():
    """The load alone determines the torque of the sun, and so its friction."""
    turn = {"gear": "planet2", "revolutions": 1.0, "steps": 4}
    fixed = ls.march(on_one_spline(friction_force="5000 N"), **turn)
    found = ls.march(on_one_spline(friction=0.15, radius="30 mm"), **turn)
    stages = [step["sun"].stage for step in found.slips]
    assert stages == [step["sun"].stage for step in fixed.slips] == 2 * ["stop", "stick"]
    for one, other in zip(found.result.positions, fixed.result.positions, strict=True):
        assert one.torque == pytest.approx(other.torque, rel=1e-9)
