"""A pinion whose branch carries nothing has no determined place: this is reported, with its range.

Sources: the closed forms in each test; formulation, sections 4 to 6.
"""

import math
from pathlib import Path

import numpy as np
import pytest

import loadshare as ls

HERE = Path(__file__).parent
FILES = ("undetermined_float", "undetermined_float_2", "undetermined_float_full")
PLAY = 50e-6
"""Clearance of the pinion's spline, or radius of its ring [m], in all three cases."""
WAYS = {
    "fast method": {},
    "compiled": {"engine": "compiled"},
    "clarabel": {"solver": "clarabel"},
    "cvxpy": {"solver": "cvxpy"},
    "whole scene": {"reduce": False},
    "picard": {"method": "picard"},
    "power": {"method": "power"},
}


def case_of(name: str) -> ls.Case:
    return ls.load_case(HERE / f"{name}.toml")


@pytest.mark.parametrize("name", FILES)
def test_the_unloaded_pinion_is_undetermined(name):
    """Its reported place is the centre, and its range is the clearance in every direction."""
    found = ls.solve(case_of(name)).positions[0]
    assert found.certificate.passed
    assert found.torque["q2-o"] == 0.0
    for axis in "xy":
        assert found.undetermined[f"gear q2 {axis}"] == pytest.approx((-PLAY, PLAY), rel=1e-12)
    assert math.hypot(*found.displacement["q2"]) < 1e-12 * PLAY
    rest = found.floats["q2"]
    assert rest.state == "undetermined"
    assert rest.boundary is None
    assert rest.spline in (None, "slip")
    assert not any(touch.touching for touch in rest.boundaries)


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("name", FILES)
@pytest.mark.quick(4)
def test_every_way_gives_the_same_place_and_ranges(name, way):
    case = case_of(name)
    one, other = (ls.solve(case, **options).positions[0] for options in ({}, WAYS[way]))
    assert other.undetermined.keys() == one.undetermined.keys()
    for coordinate, ends in one.undetermined.items():
        assert other.undetermined[coordinate] == pytest.approx(ends, rel=1e-9)
    for gear, moved in one.displacement.items():
        assert other.displacement[gear] == pytest.approx(moved, rel=1e-9, abs=1e-9 * PLAY)
        size = max(abs(v) for v in one.rotation.values())
        assert other.rotation[gear] == pytest.approx(one.rotation[gear], abs=1e-9 * size)


@pytest.mark.parametrize("name", FILES[:2])
def test_a_branch_without_contact_turns_from_flank_to_flank(name):
    """The drive flank of the input gear limits the wheel on one side, the flank of the output its
    pinion on the other: r_w φ ≥ r_a (φ_a − a) and r_q φ ≤ |push| R + n·c_o, where n is the
    direction of the push on the output gear.
    """
    case = case_of(name)
    found = ls.solve(case).positions[0]
    data = case.to_dict()

    def figure(*path: str) -> float:
        value = data
        for key in path:
            value = value[key]
        return float(str(value).split()[0])

    low, high = found.undetermined["gear q2 rotation"]
    assert found.undetermined["gear w2 rotation"] == pytest.approx((low, high), rel=1e-12)
    a = figure("meshes", "a-w2", "law", "a")
    behind = figure("gears", "a", "base_radius") * (found.rotation["a"] - a)
    assert low == pytest.approx(behind / figure("gears", "w2", "base_radius"), rel=1e-12)

    pinion, output = (
        np.array([float(v.split()[0]) for v in data["gears"][g]["centre"]]) for g in ("q2", "o")
    )
    # The input turns in the sense of `running`, the wheel and its pinion in the other.
    sense = -1.0 if data["operating"]["running"] == "counter-clockwise" else 1.0
    internal = data["gears"]["o"].get("type") == "internal"
    radial = (output - pinion) / np.linalg.norm(output - pinion) * (-1.0 if internal else 1.0)
    along = sense * np.array([-radial[1], radial[0]])
    angle = figure("meshes", "q2-o", "pressure_angle")
    push = math.cos(angle) * along + math.sin(angle) * radial
    error = data["errors"]["o"]
    offset = np.array([float(v.split()[0]) for v in error["installation"]])
    if "eccentricity" in error:
        turned = figure("errors", "o", "eccentricity", "direction")
        turned += figure("errors", "o", "eccentricity", "phase")
        amount = figure("errors", "o", "eccentricity", "amount")
        offset = offset + amount * np.array([math.cos(turned), math.sin(turned)])
    before = PLAY + float(push @ offset)
    assert high == pytest.approx(before / figure("gears", "q2", "base_radius"), rel=1e-9)


@pytest.mark.parametrize("name", FILES)
@pytest.mark.quick(1)
def test_it_is_reported_in_every_form(name, tmp_path):
    result = ls.solve(case_of(name))
    expected = [-PLAY, PLAY]
    document = result.to_dict()["positions"][0]["undetermined"]
    assert document["gear q2 x"] == pytest.approx(expected, rel=1e-12)
    arrays = result.dataset.isel(position=0)
    assert arrays.displacement_range.sel(gear="q2", component="y").values.tolist() == pytest.approx(
        expected, rel=1e-12
    )
    assert np.isnan(arrays.displacement_range.sel(gear="a")).all()
    turned = dict(result.positions[0].undetermined).get("gear q2 rotation", (np.nan, np.nan))
    np.testing.assert_array_equal(arrays.rotation_range.sel(gear="q2"), turned)
    for file in ("result.json", "result.nc"):
        path = tmp_path / file
        (result.to_json if file.endswith("json") else result.to_netcdf)(path)
        assert ls.load_result(path).positions[0].undetermined == result.positions[0].undetermined


@pytest.mark.parametrize("name", FILES)
def test_samples_say_so_too(name):
    """In the last of three samples the pinion is loaded: its wheel's mesh is moved closer."""
    # Only the gap of the drive flank changes: that of a law would close the coast flank as well.
    case = case_of(name).replace({"meshes.a-w2.law.a": None, "meshes.a-w2.gap": "0.6e-3 rad"})
    samples = {'meshes."a-w2".gap [rad]': [0.6e-3, 0.5e-3, -0.02]}
    found = ls.solve_many(case, samples, keep="displacement", least_norm=True)
    assert found.certified.all()
    assert found.determined.values[:2].ravel().tolist() == [False, False]
    alone = ls.solve(case.replace({"meshes.a-w2.gap": "-0.02 rad"})).positions[0]
    assert bool(found.determined[2, 0]) == (not alone.undetermined)
    assert "gear q2 x" not in alone.undetermined
    moved = found.displacement.sel(gear="q2").values[:2]
    assert np.abs(moved).max() < 1e-12 * PLAY
