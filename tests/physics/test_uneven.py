"""Sets that turn in surroundings that differ with direction."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.physics.test_planetary import CHOICES, planetary
from tests.support import shipped

import loadshare as ls
from loadshare.job.ladder import climb_all
from loadshare.job.machine import Machine
from loadshare.results.derive import positions_of
from loadshare.settings import CERTIFY
from loadshare.solver import Options
from loadshare.train import build_train

STEPS, TURNS = 5, 0.7
ERRORS = {
    "sun": {"eccentricity": {"amount": "12 um", "direction": "20 deg"}},
    "ring": {"installation": ["9 um", "-4 um"]},
    "carrier": {
        "installation": ["-5 um", "3 um"],
        "eccentricity": {"amount": "8 um", "direction": "75 deg"},
    },
    "p0": {"pin": {"tangential": "20 um", "radial": "-6 um"}},
    "p2": {"eccentricity": {"amount": "10 um", "direction": "10 deg"}},
}
MOUNTED: dict[str, Any] = {
    "gears.sun.support": [["2e8 N/m", "0.6e8 N/m"], ["0.6e8 N/m", "1e8 N/m"]],
    "gears.ring.support": ["3e9 N/m", "5e8 N/m"],
    "gears.p1.support": ["4e9 N/m", "1e9 N/m"],
    "bearings.carrier": {"clearance": "10 um", "stiffness": "1e9 N/m", "offset": ["4 um", "3 um"]},
    "bearings.p2": {"clearance": "2 um", "stiffness": "2e9 N/m", "offset": ["1 um", "-1 um"]},
    "operating.forces": {"carrier": ["0 N", "-3 kN"], "p3": ["0 N", "-400 N"]},
}


def mounted(load: str = "sun", output: str = "carrier", held: str = "ring") -> ls.Case:
    """Return a set with a support, a mount, a bearing and pins that depend on direction."""
    return planetary(4, load, output, held, errors=ERRORS).replace(MOUNTED)


def marched(case: ls.Case, **march: Any) -> ls.Case:
    """Return the case over part of a revolution of its input."""
    assert case.operating is not None
    return case.replace(
        {"march": {"gear": case.operating.input, "revolutions": TURNS, "steps": STEPS} | march}
    )


def turned(angle: float) -> np.ndarray:
    """Return the matrix that rotates a vector (2,)."""
    return np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])


@pytest.mark.parametrize(("load", "output", "held"), CHOICES)
@pytest.mark.quick(2)
def test_every_step_is_the_set_placed_anew(load: str, output: str, held: str) -> None:
    """Explicitly: planets, parts on the carrier, and eccentricities are placed as in the step."""
    pin = {"radial": "3e9 N/m", "tangential": "8e8 N/m"}
    case = mounted(load, output, held).replace({"gears.p3.support": pin})
    if held == "carrier":
        case = case.replace({"bearings.carrier": None, "operating.forces": None})
    found = ls.solve(marched(case))
    gears = build_train(case).gears
    for k, position in enumerate(found.positions):
        angle = {
            name: g.sense * g.ratio * 2.0 * math.pi * TURNS * k / STEPS for name, g in gears.items()
        }
        goes = turned(angle["carrier"])
        changes: dict[str, Any] = {
            f"errors.{name}.eccentricity.phase": f"{angle[name]:.17g} rad"
            for name, error in ERRORS.items()
            if "eccentricity" in error
        }
        for p in range(4):
            there = 0.5 * math.pi * p + angle["carrier"]
            changes[f"gears.p{p}.centre.angle"] = f"{there:.17g} rad"
        matrix = goes @ np.diag([4e9, 1e9]) @ goes.T
        matrix = 0.5 * (matrix + matrix.T)
        changes["gears.p1.support"] = [[f"{v:.17g} N/m" for v in row] for row in matrix]
        offset = goes @ [1.0, -1.0]
        changes["bearings.p2.offset"] = [f"{v:.17g} um" for v in offset]
        again = ls.solve(case.replace(changes)).positions[0]
        assert position.torque == pytest.approx(again.torque, rel=1e-9)
        size = max(np.hypot(*p) for p in again.displacement.values())
        for name, moved in again.displacement.items():
            # Displacements are given as seen from the carrier.
            seen = goes.T @ moved
            assert position.displacement[name] == pytest.approx(seen, abs=1e-9 * size)
        for name, force in again.loads.bearings.items():
            seen = goes.T @ force
            assert position.loads.bearings[name] == pytest.approx(seen, abs=1e-6)


@pytest.mark.parametrize("engine", ["vectorised", "compiled"])
def test_places_of_bearings_vary_in_a_batch_as_in_cases_solved_alone(engine: str) -> None:
    """One bearing is fixed in the housing, the other on the carrier."""
    case = marched(mounted())
    samples = {
        "bearings.carrier.offset[0] [um]": [4.0, -5.0, 1.0],
        "bearings.p2.offset[1] [um]": [-1.0, 2.0, 1.5],
    }
    many = ls.solve_many(case, samples, engine=engine)
    for k in range(3):
        changes = {key[:-5]: f"{values[k]} um" for key, values in samples.items()}
        alone = ls.solve(case.replace(changes))
        assert many.torque[k].values == pytest.approx(alone.torque.values, rel=1e-9)
    assert np.ptp(many.torque.values, axis=0).max() > 1e-3 * many.torque.values.max()


def test_even_surroundings_placed_anew_are_those_seen_from_the_carrier() -> None:
    """Both methods agree where both apply, including thin rim and clearances."""
    case = marched(
        shipped("planetary/four_planets").replace(
            {
                "gears.ring.ovalisation": ["3e8 N/m", "9e8 N/m"],
                "gears.carrier.support": "free",
                "bearings.carrier": {"clearance": "10 um", "stiffness": "1e9 N/m"},
                "operating.forces": {"carrier": ["0 N", "-3 kN"]},
                "errors.carrier": ERRORS["carrier"],
                "errors.ring": ERRORS["ring"],
            }
        )
    )
    train = build_train(case)
    assert not train.uneven
    ways = []
    for uneven in (False, True):
        machine = Machine(replace(train, uneven=uneven))
        found = list(climb_all(machine, range(1, STEPS + 1), Options(), CERTIFY.tolerance))
        ways.append(positions_of([(a.train, a.index, a.flank_force, a) for a in found]))
    for one, other in zip(*ways, strict=True):
        assert one.torque == pytest.approx(other.torque, rel=1e-10)
        size = max(np.hypot(*p) for p in one.displacement.values())
        for name, moved in one.displacement.items():
            assert moved == pytest.approx(other.displacement[name], abs=1e-10 * size)


def common_sun(**changes: Any) -> ls.Case:
    """Return two sets with one floating sun, and carriers that turn at different speeds."""
    module = 5.0 * math.cos(math.radians(20.0))
    gears: dict[str, Any] = {"sun": {"base_radius": f"{9 * module} mm", "centre": ["0 mm", "0 mm"]}}
    meshes: dict[str, Any] = {}
    for stage, (teeth, ring) in {"a": (36, 90), "b": (24, 66)}.items():
        gears[f"carrier_{stage}"] = {"type": "carrier", "centre": ["0 mm", "0 mm"]}
        gears[f"ring_{stage}"] = {
            "type": "internal",
            "base_radius": f"{0.5 * ring * module} mm",
            "centre": ["0 mm", "0 mm"],
            "held": True,
        }
        for k in range(3):
            planet = gears[f"{stage}{k}"] = {
                "base_radius": f"{0.5 * teeth * module} mm",
                "carrier": f"carrier_{stage}",
                "centre": {
                    "distance": f"{2.5 * (18 + teeth)} mm",
                    "angle": f"{120.0 * k + (10.0 if stage == 'b' else 0.0)} deg",
                },
            }
            assert planet
            meshes[f"sun-{stage}{k}"] = {"stiffness": "2e7 N*m/rad"}
            meshes[f"{stage}{k}-ring_{stage}"] = {"stiffness": "9e7 N*m/rad"}
    gears["sun"]["support"] = "1e7 N/m"
    errors = {
        "sun": {"eccentricity": {"amount": "15 um", "direction": "40 deg"}},
        "a0": {"pin": {"tangential": "25 um"}},
        "b1": {"pin": {"tangential": "-30 um", "radial": "5 um"}},
    }
    operating = {
        "input": "sun",
        "output": "carrier_a",
        "torque": "1000 N*m",
        "external": {"carrier_b": "-1500 N*m"},
    }
    return ls.Case(operating=operating, gears=gears, meshes=meshes, errors=errors).replace(changes)


def test_a_sun_of_two_sets_is_seen_from_the_housing() -> None:
    case = common_sun()
    found = ls.solve(marched(case))
    gears = build_train(case).gears
    assert gears["carrier_a"].ratio != pytest.approx(gears["carrier_b"].ratio, rel=0.1)
    for k, position in enumerate(found.positions):
        angle = {n: g.sense * g.ratio * 2.0 * math.pi * TURNS * k / STEPS for n, g in gears.items()}
        changes = {"errors.sun.eccentricity.phase": f"{angle['sun']:.17g} rad"}
        for stage, first in (("a", 0.0), ("b", 10.0)):
            for p in range(3):
                there = math.radians(120.0 * p + first) + angle[f"carrier_{stage}"]
                changes[f"gears.{stage}{p}.centre.angle"] = f"{there:.17g} rad"
        again = ls.solve(case.replace(changes)).positions[0]
        assert position.torque == pytest.approx(again.torque, rel=1e-9)


TORQUES = np.array([500.0, 1000.0, 2000.0])
OFFSETS = np.array([4.0, 0.0, -4.0])


@pytest.fixture(scope="module")
def alone() -> list[ls.Result]:
    """Return one solution of a marched set for each torque and offset of its carrier."""
    case, load, place = marched(mounted()), "operating.torque", "bearings.carrier.offset[0]"
    values = zip(TORQUES, OFFSETS, strict=True)
    return [ls.solve(case.replace({load: f"{t} N*m", place: f"{x} um"})) for t, x in values]


@pytest.mark.parametrize("engine", ["compiled", "vectorised"])
def test_batches_have_it(alone: list[ls.Result], engine: str) -> None:
    case = marched(mounted())
    samples = {"operating.torque [N*m]": TORQUES, "bearings.carrier.offset[0] [um]": OFFSETS}
    keep = "torque", "displacement"
    batch = ls.solve_many(case, samples, keep=keep, engine=engine, least_norm=True)
    assert batch.certified.all()
    for k, single in enumerate(alone):
        for p, position in enumerate(single.positions):
            for mesh, value in position.torque.items():
                got = float(batch.torque.sel(sample=k, mesh=mesh).values[p])
                assert got == pytest.approx(value, rel=1e-8, abs=1e-6)
            for gear in batch.gear.values.tolist():
                got = batch.displacement.sel(sample=k, gear=gear).values[p]
                assert got == pytest.approx(position.displacement[gear], abs=1e-12)


def test_studies_have_it() -> None:
    """Rates agree with differences; the answers before and after a critical value differ."""
    case = marched(mounted())
    key = "bearings.carrier.offset[0]"
    rates = ls.sensitivity(case, key, positions=[3]).rates[3, key, "rising"]
    step = 0.01
    ends = [
        ls.solve(case.replace({key: f"{4.0 + s} um"}), positions=[3]).positions[0].torque
        for s in (-step, step)
    ]
    for mesh, rate in rates.torque.items():
        slope = (ends[1][mesh] - ends[0][mesh]) / (2e-6 * step)
        assert rate == pytest.approx(slope, rel=1e-5, abs=1e3)
    key = "bearings.carrier.clearance"
    found = ls.critical(case, key, "38 um", "42 um", positions=[2])
    (event,) = found.of("leaves boundary")
    rests = [
        ls.solve(case.replace({key: f"{event.value + s} um"}), positions=[2]).positions[0].floats
        for s in (-1e-3, 1e-3)
    ]
    assert event.gear == "carrier"
    assert [r["carrier"].boundary for r in rests] == ["outer race", None]


def test_results_are_kept_and_judged_again(tmp_path: Any) -> None:
    result = ls.solve(marched(mounted()))
    path = tmp_path / "found.json"
    result.to_json(path)
    again = ls.load_result(path)
    assert again.positions == result.positions
    document = json.loads(path.read_text())
    document["positions"][2]["claim"]["flank_force"]["sun-p1"] *= 1.001
    path.write_text(json.dumps(document))
    with pytest.raises(ls.ResultError):
        ls.load_result(path)


@pytest.mark.parametrize("mount", ["1e9 N/m", ["1e9 N/m", "3e8 N/m"]])
def test_a_slip_is_handed_from_step_to_step(mount: Any, tmp_path: Any) -> None:
    """Seen from the carrier it turns back, in the housing it stays; a loaded file has either."""
    case = shipped("planetary/four_planets").replace(
        {
            "gears.sun.support": None,
            "gears.ring.support": mount,
            "splines.sun": {
                "bending_stiffness": "1e7 N/m",
                "clearance": "200 um",
                "friction": 0.1,
                "normal_force": "3 kN",
            },
            "errors.sun": {"eccentricity": {"amount": "40 um", "direction": "0 deg"}},
            "errors.planet1.pin": {"tangential": "40 um"},
            "march": {"gear": "sun", "revolutions": 1.3, "steps": 4},
        }
    )
    found = ls.march(case)
    assert found.dissipated > 0.0
    path = tmp_path / "march.json"
    found.result.to_json(path)
    assert ls.load_result(path).positions == found.result.positions
