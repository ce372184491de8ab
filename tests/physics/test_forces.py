"""External forces and gravity: closed forms, forces through pins, 50 digits, rotating frames.

Source: formulation, sections 12 and 14.
"""

import math

import numpy as np
import pytest
from tests.physics.test_bearings import ALONG, FORCE, pair, planets_in_bearings
from tests.support import shipped

import loadshare as ls
from benchmarks.random_trains.run import SETS, case_of
from benchmarks.reference.solve import reference
from loadshare.train import build_train

ELASTIC = {"gears.a.support": ["1e8 N/m", "2e8 N/m"], "bearings": {}}


def test_a_force_moves_an_elastic_bearing_and_a_rigid_one_carries_it():
    case = pair().replace(
        {**ELASTIC, "operating.forces": {"a": ["300 N", "-70 N"], "b": ["5 N"] * 3}}
    )
    found = ls.solve(case).positions[0]
    expected = (FORCE * ALONG + [300.0, -70.0]) / [1e8, 2e8]
    assert found.displacement["a"] == pytest.approx(tuple(expected), rel=1e-12)
    assert found.loads.bearings["a"] == pytest.approx(tuple(FORCE * ALONG + [300, -70]), rel=1e-12)
    assert found.loads.bearings["b"] == pytest.approx(tuple(5.0 - FORCE * ALONG), rel=1e-12)


def test_weights_are_masses_times_gravity():
    masses = {"gears.a.mass": "12 kg", "gears.b.mass": "50 kg"}
    gravity = {"operating.gravity": ["0 m/s^2", "-9.81 m/s^2"]}
    case = pair().replace({**ELASTIC, **masses, **gravity})
    alone, found = (
        ls.solve(c).positions[0].loads.bearings for c in (pair().replace(ELASTIC), case)
    )
    for gear, mass in (("a", 12.0), ("b", 50.0)):
        weight = np.subtract(found[gear], alone[gear])
        assert weight == pytest.approx([0.0, -9.81 * mass], rel=1e-9, abs=1e-9)


def test_gravity_needs_masses():
    with pytest.raises(ls.CaseError, match=r"gears\.a\.mass: is missing") as caught:
        pair().replace({"operating.gravity": ["0 m/s^2", "-9.81 m/s^2"]})
    assert len(caught.value.problems) == 2


def test_light_loads_between_gravity_and_clearance_agree_with_50_digits():
    """Gravity holds planets at the bottom of their bearings until the load lifts them."""
    case = planets_in_bearings("5 um", "6e10 N/m^1.5", "ball_stiffness")
    weights = {p: ["3 N", "-40 N"] for p in case.bearings}
    for torque in ("0.05 N*m", "1 N*m", "40 N*m"):
        loaded = case.replace({"operating.forces": weights, "operating.torque": torque})
        found, exact = ls.solve(loaded).positions[0], reference(build_train(loaded))
        largest = max(map(abs, exact.torque.values()))
        for mesh, expected in exact.torque.items():
            assert found.torque[mesh] == pytest.approx(float(expected), abs=1e-10 * largest)
        assert found.certificate.proved < 1e-9


def pushed_set(**changes: object) -> ls.Case:
    """Return a set of three planets with masses and a floating sun."""
    case = shipped("planetary/four_planets")
    return case.replace({f"gears.{g}.mass": "4 kg" for g in case.gears}).replace(changes)


def test_pins_pass_weights_on_to_the_carrier():
    """A force on a planet acts on the carrier, about its axis, with the pin's arm."""
    case = pushed_set()
    planet = next(n for n, g in case.gears.items() if g.carrier)
    carrier = case.gears[planet].carrier
    train = build_train(case)
    seat = train.gears[planet].centre - train.gears[carrier].centre
    plain = ls.solve(case, positions=[1]).positions[0]
    pushed = ls.solve(
        case.replace({"operating.forces": {planet: ["0 N", "1000 N"]}}), positions=[1]
    ).positions[0]
    moment = seat[0] * 1000.0
    # All external torques and the moment of the force balance, as they did without it.
    senses = {n: g.sense for n, g in train.gears.items()}
    before, after = (sum(senses[n] * t for n, t in p.loads.gears.items()) for p in (plain, pushed))
    assert moment != 0.0
    assert after - before == pytest.approx(-moment, rel=1e-9)


@pytest.mark.parametrize("seed", [2, 4, 6, 8, 10, 14])
@pytest.mark.quick(2)
def test_forces_on_planetary_sets_agree_with_50_digits(seed):
    case = case_of(SETS, seed)
    drive = max(map(abs, ls.solve(case, positions=[1]).positions[0].loads.meshes.values()))
    sizes = np.random.default_rng(seed).normal(size=(len(case.gears), 2)) * 0.1 * drive
    written = [[f"{v!r} N" for v in size] for size in sizes.tolist()]
    case = case.replace({"operating.forces": dict(zip(case.gears, written, strict=True))})
    answer = ls.explain(case, 1)
    exact = reference(build_train(case), 1, answer.equilibrium)
    found = ls.solve(case, positions=[1]).positions[0]
    largest = max(map(abs, found.loads.gears.values()))
    for mesh, expected in exact.torque.items():
        assert abs(found.torque[mesh] - expected) <= found.certificate.proved * largest
    assert found.certificate.proved < 1e-10


def test_gravity_goes_round_backwards_as_a_carrier_turns():
    """In a marched set, the weight on a carrier's bearing rotates as seen from the carrier."""
    case = pushed_set(**{"operating.gravity": ["0 m/s^2", "-9.81 m/s^2"]})
    carrier = next(n for n, g in case.gears.items() if g.is_carrier)
    march = {"march": {"gear": carrier, "revolutions": 1.0, "steps": 4}}
    case = case.replace({f"gears.{carrier}.mass": "500 kg", **march})
    moved = []
    for mass in ("500 kg", "1500 kg"):
        result = ls.solve(case.replace({f"gears.{carrier}.mass": mass}))
        moved.append([p.loads.bearings[carrier] for p in result.positions])
    more = np.subtract(*moved[::-1]) / (1000 * 9.81)
    turns = np.arange(4) * math.pi / 2.0
    down = -np.stack([np.sin(turns), np.cos(turns)], axis=1)
    assert np.allclose(more, down, atol=1e-9) or np.allclose(more, down * [-1, 1], atol=1e-9)


def test_forces_are_samples_of_one_machine():
    case = pair().replace({**ELASTIC, "operating.forces": {"a": ["0 N", "0 N"]}})
    sizes = np.array([0.0, 10.0, -500.0])
    for engine in ("compiled", "vectorised"):
        samples = {"operating.forces.a[1] [N]": sizes}
        batch = ls.solve_many(case, samples, keep="displacement", engine=engine)
        assert batch.certified.all()
        moved = batch.displacement.sel(gear="a").values[:, 0, 1]
        assert moved == pytest.approx((FORCE * ALONG[1] + sizes) / 2e8, rel=1e-12)


def test_a_change_may_bring_the_first_force_or_torque_from_outside() -> None:
    case = shipped("planetary/four_planets")
    pushed = case.replace({"operating.forces.sun": ["0 N", "50 N"]})
    assert pushed.operating.forces["sun"][1].si == 50.0
    assert case.replace({"operating.external.sun": "3 N*m"}).operating.external["sun"].si == 3.0
    assert not case.operating.forces
