"""Shipped cases from their teeth, or with each branch written once, against those in numbers."""

from pathlib import Path

import pytest
from tests.support import shipped

import loadshare as ls

CASES = Path(__file__).parents[2] / "cases"


def torques(path: str) -> dict[str, float]:
    return ls.solve(CASES / path).positions[0].torque


def test_the_split_path_box_from_its_teeth():
    """The boxes agree except for digits: angles are given to 1e-10 deg, centres to 10 nm."""
    given, teeth = torques("two_path/clocking_error.toml"), torques("two_path/from_teeth.toml")
    names = {
        "in-wheelA": "in-wheel1",
        "in-wheelB": "in-wheel2",
        "pinionA-out": "pinion1-out",
        "pinionB-out": "pinion2-out",
    }
    for one, other in names.items():
        assert teeth[other] == pytest.approx(given[one], rel=1e-7)
    old = ls.load_case(CASES / "two_path/clocking_error.toml").centres()
    new = ls.load_case(CASES / "two_path/from_teeth.toml").centres()
    for one, other in (("wheelA", "wheel1"), ("pinionB", "pinion2"), ("out", "out")):
        assert new[other] == pytest.approx(old[one], abs=1e-8)


def test_the_seeds_drive_with_each_branch_written_once():
    given, short = torques("fgfbstts/installation_error.toml"), torques("fgfbstts/short.toml")
    gears = {"1": "in", "2": "face1", "3": "face2", "4": "pinion1", "5": "pinion2", "10": "out"}
    gears |= {"6": "right1", "8": "right2", "7": "left1", "9": "left2"}
    assert len(given) == len(short) == 10
    for mesh, torque in given.items():
        other = "-".join(gears[end] for end in mesh.split("-"))
        assert short[other] == pytest.approx(torque, rel=1e-12)


def test_a_differential_halves_the_torque():
    """Each sun of 21 teeth takes half of the carrier's torque, shared by three planets."""
    result = ls.solve(CASES / "planetary/differential.toml")
    assert result.positions[0].loads.gears["left"] == pytest.approx(-500.0, rel=1e-12)
    meshes = result.positions[0].torque
    assert sum(meshes[f"right-second{k}"] for k in (1, 2, 3)) == pytest.approx(500.0, rel=1e-12)
    first = sum(meshes[f"first{k}-left"] for k in (1, 2, 3))
    assert first == pytest.approx(500.0 * 16.0 / 21.0, rel=1e-12)


@pytest.mark.parametrize("first", ["right", "first"])
def test_flanks_that_go_round_with_a_carrier_hang_on_no_order(first):
    """If no mesh rolls, no speed determines which flank is the drive flank."""
    case = shipped("planetary/differential")
    gears = case.to_dict()["gears"]
    before = [name for name in gears if name.startswith(first)]
    other = ls.Case(case.to_dict() | {"gears": {name: gears[name] for name in before} | gears})
    found = ls.solve(other).positions[0].torque
    assert found == pytest.approx(ls.solve(case).positions[0].torque, rel=1e-12)


@pytest.mark.parametrize("sun", ["left", "right"])
def test_a_sun_that_goes_round_with_its_carrier_drives_a_wheel_outside(sun):
    """Its drive flank is the one that the name implies, whose contact no backlash removes."""
    place = {"left": "-24.6 mm", "right": "24.6 mm"}[sun]
    case = ls.load_case(CASES / "planetary/differential.toml").to_dict()
    case["gears"]["wheel"] = {
        "teeth": 42,
        "module": "3 mm",
        "face_width": "0.6 mm",
        "centre": ["94.5 mm", "0 mm", place],
    }
    case["gears"]["right"].pop("support")
    case["operating"]["output"] = "wheel"
    case["operating"]["external"] = {{"left": "right", "right": "left"}[sun]: "-500 N*m"}
    found = []
    for play in ("0 um", "150 um"):
        case["meshes"][f"{sun}-wheel"] = {"stiffness": "1e6 N*m/rad", "backlash": play}
        found.append(ls.solve(ls.Case(case)).positions[0])
    for one in found:
        assert one.torque[f"{sun}-wheel"] == pytest.approx(500.0, rel=1e-12)
        assert one.rotation[sun] == pytest.approx(500.0 / 1e6, rel=1e-9)
