"""The bound if friction follows a spline's torque: it accounts for cancellation, and holds."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.support import bound_of

import loadshare as ls
from benchmarks.reference import reference
from loadshare.job.engines import engine_named
from loadshare.job.machine import Machine
from loadshare.study.memory.step import stepped
from loadshare.train import Train, build_train
from loadshare.train.equilibrium import Equilibrium


def two_idlers(friction: float, torque: str = "1000 N*m", backlash: str | None = None) -> Train:
    """Return a torque split over two idlers, one of which floats on a spline with friction.

    With backlash, the floating idler has such gaps that it carries nothing.
    """
    far = math.hypot(0.24, 0.15)
    angle = f"{math.acos(0.22 / far)!r} rad"
    centres = {"in": (0.0, 0.0), "a": (0.24, 0.15), "b": (0.24, -0.15), "out": (0.48, 0.0)}
    radii = {"in": 0.1, "a": 0.12, "b": 0.12, "out": 0.1}
    gears = {
        n: {"centre": [f"{x} m", f"{y} m"], "base_radius": f"{radii[n]} m"}
        for n, (x, y) in centres.items()
    }
    stiffness = {"in-a": "3e6", "in-b": "2e6", "a-out": "4e6", "b-out": "4e6"}
    meshes = {
        n: {"pressure_angle": angle, "stiffness": f"{k} N*m/rad"} for n, k in stiffness.items()
    }
    for n, mesh in meshes.items() if backlash else ():
        mesh |= {"backlash": backlash} | ({"gap": "0.01 rad"} if "a" in n.split("-") else {})
    return _train(gears, meshes, {}, "a", friction, torque)


def two_shafts(friction: float, torque: str = "1000 N*m") -> Train:
    """Return a torque split over two shafts; on one, a gear floats on a spline with friction."""
    far = math.hypot(0.24, 0.15)
    angle = f"{math.acos(0.22 / far)!r} rad"
    gears = {"in": {"centre": ["0 m", "0 m"], "base_radius": "0.1 m"}}
    for n, y in ("a", 0.15), ("b", -0.15):
        gears[n] = {"centre": ["0.24 m", f"{y} m"], "base_radius": "0.12 m"}
        gears[f"{n}2"] = {"centre": ["0.24 m", f"{y} m"], "base_radius": "0.08 m"}
    gears["out"] = {"centre": ["0.48 m", "0 m"], "base_radius": "0.14 m"}
    stiffness = {"in-a": "3e6", "in-b": "2e6", "a2-out": "4e6", "b2-out": "4e6"}
    meshes = {
        n: {"pressure_angle": angle, "stiffness": f"{k} N*m/rad"} for n, k in stiffness.items()
    }
    shafts = {"a-a2": {"stiffness": "1e6 N*m/rad"}, "b-b2": {"stiffness": "1e6 N*m/rad"}}
    return _train(gears, meshes, shafts, "a", friction, torque)


def _train(
    gears: dict, meshes: dict, shafts: dict, floating: str, friction: float, torque: str
) -> Train:
    ends = {"input": "in", "output": "out", "running": "counter-clockwise"}
    spline = {
        "bending_stiffness": "5e7 N/m",
        "clearance": "10 um",
        "friction": friction,
        "radius": "0.03 m",
    }
    data = {
        "title": "following",
        "operating": {**ends, "torque": torque, "positions": 1},
        "gears": gears,
        "meshes": meshes,
        "shafts": shafts,
        "splines": {floating: spline},
    }
    return build_train(ls.Case(data, name="following"))


def solved(train: Train) -> Equilibrium:
    machine = Machine(train)
    found = machine.answer(machine.situations([1]), 1e-9, engine_named("vectorised", 1))
    assert found.passed[0]
    return found.equilibria.one(0, 1)


@pytest.mark.parametrize("friction", [0.2, 1.0, 3.0])
def test_idler_takes_no_torque_over_its_spline_however_large_its_forces(friction: float) -> None:
    train = two_idlers(friction)
    assert bound_of(train, solved(train), rigorous=True).relative <= 1e-13


@pytest.mark.parametrize("force", [0.0, 1e-16, 1e-13])
def test_force_of_rounding_at_the_end_of_a_clearance_is_on_the_verge(force: float) -> None:
    train = two_idlers(0.1, backlash="3 mm")
    answer = solved(train)
    out = np.array([-0.6, 0.8, 0.0])
    pressed = replace(
        answer,
        displacement={**answer.displacement, "a": 10e-6 * out},
        radial_reaction={"spline a": -force * out},
        flank_force={**answer.flank_force, "in-a coast": force / 3.0},
    )
    assert bound_of(train, pressed, rigorous=True).relative <= 1e-13


@pytest.mark.parametrize("build", [two_idlers, two_shafts])
@pytest.mark.parametrize("friction", [0.02, 0.1, 0.5])
@pytest.mark.parametrize("off", [1e-10, 1e-7, 1e-5])
@pytest.mark.quick(8)
def test_bound_of_an_answer_for_another_load_holds(build, friction: float, off: float) -> None:
    train = build(friction)
    claim = solved(build(friction, f"{1000.0 * (1.0 + off)!r} N*m"))
    exact = reference(train, 1)
    bound = bound_of(train, claim)
    for name, mesh in train.meshes.items():
        error = abs(claim.flank_force[mesh.flank_name(True)] * mesh.radii[0] - exact.torque[name])
        assert error <= bound.torque[name] <= 1e3 * off * 1000.0


@pytest.mark.parametrize("friction", [0.02, 0.1])
def test_bound_on_friction_covers_what_follows(friction: float) -> None:
    train = two_shafts(friction)
    claim = solved(two_shafts(friction, "1000.0001 N*m"))
    pull = reference(train, 1).pull["spline a"]
    apart = claim.radial_reaction["spline a"][:2] - pull
    assert 0.0 < math.hypot(*apart) <= bound_of(train, claim).force["spline a"]


@pytest.mark.parametrize("friction", [0.02, 0.05, 0.1, 0.3])
@pytest.mark.parametrize("slip", [(0.0, 0.0, 0.0), (0.0, -8e-6, 0.0), (3e-6, 5e-6, 0.0)])
@pytest.mark.parametrize("off", [1e-9, 1e-7])
@pytest.mark.quick(6)
def test_room_of_a_slip_that_is_remembered_shrinks_with_the_torque(
    friction: float, slip: tuple[float, ...], off: float
) -> None:
    """With memory, against an answer that is itself known to within its bound."""
    _assert_bounds_hold(friction, slip, off)


@pytest.mark.parametrize("more", [-1e-5, -1e-8, -1e-10, -1e-12, 0.0, 1e-12, 1e-10, 1e-8])
@pytest.mark.parametrize("off", [-1e-7, -1e-9, 1e-9, 1e-7])
@pytest.mark.quick(5)
def test_room_that_the_torque_all_but_closes(more: float, off: float) -> None:
    """Friction needs all of the clearance, almost all, or slightly more than all."""
    held = solved(two_shafts(0.3))
    spline = two_shafts(1.0).splines["a"]
    needed = spline.bending_stiffness * spline.clearance
    train = two_shafts(1.0)
    friction = needed / spline.bound(train.transmitted("a", held.flank_force))
    _assert_bounds_hold(friction * (1.0 + more), (0.0, 0.0, 0.0), off)


def _assert_bounds_hold(friction: float, slip: tuple[float, ...], off: float) -> None:
    """Assert that the bound of an answer for another load covers its error."""
    before = {"a": np.array(slip)}
    train = two_shafts(friction).remembering(before)
    other = two_shafts(friction, f"{1000.0 * (1.0 + off)!r} N*m").remembering(before)
    right, claim = (stepped(t, 1).equilibrium for t in (train, other))
    known, bound = bound_of(train, right), bound_of(train, claim)
    assert known.relative <= 1e-9
    for name, mesh in train.meshes.items():
        flank, radius = mesh.flank_name(True), mesh.radii[0]
        error = abs(claim.flank_force[flank] - right.flank_force[flank]) * radius
        assert error <= bound.torque[name] + known.torque[name]
    for name, pull in right.radial_reaction.items():
        error = math.hypot(*(claim.radial_reaction[name] - pull)[:2])
        assert error <= bound.force[name] + known.force[name]
