"""Results: coefficients, labels, and files that give back every bit.

Source: formulation, section 10.
"""

import json
import math
import pickle

import numpy as np
import pytest
from tests.support import CASES, shipped

import loadshare as ls
from loadshare.certify import Claims, certified
from loadshare.results.share import MeshTorques, shares
from loadshare.settings import CERTIFY
from loadshare.train.elements import Stage

NAMES = ("fgfbstts/all_elements", "fgfbstts/limit_ring", "star/floating_sun_4")


@pytest.fixture(scope="module", params=NAMES)
def result(request):
    return ls.solve(shipped(request.param), positions=None)


def without_bounds(result):
    """Return the text of a result without its bounds, which loading computes by another method."""
    document = result.to_dict()
    del document["digest"]
    for position in document["positions"]:
        position["certificate"].pop("bound", None)
    return json.dumps(document)


@pytest.mark.parametrize("ending", ["json", "nc"])
@pytest.mark.quick(2)
def test_a_result_survives_its_file_bit_for_bit(result, ending, tmp_path):
    path = tmp_path / "deep" / f"result.{ending}"
    (result.to_json if ending == "json" else result.to_netcdf)(path)
    again = ls.load_result(path)
    assert again == result
    assert without_bounds(again) == without_bounds(result)
    assert again.positions == result.positions
    assert list(path.parent.iterdir()) == [path]


def test_a_file_that_an_editor_saved_again_is_still_read(tmp_path):
    """The file has a UTF-8 byte order mark and other line ends, as on Windows."""
    result = ls.solve(shipped("star/floating_sun_3"))
    text = result.to_json().replace("\n", "\r\n")
    (tmp_path / "saved.json").write_bytes(text.encode("utf-8-sig"))
    assert ls.load_result(tmp_path / "saved.json") == result


def test_positions_are_looked_at_in_groups_and_alone_with_the_same_digits(result):
    positions = result.positions
    for p in positions:
        beside = p.certificate.claims
        assert beside.positions[p.row] == p.position
        assert len(beside.positions) <= CERTIFY.side_by_side
        (alone,) = certified(Claims.of(p.train, [p.equilibrium]), result.stamp.tolerance)
        assert alone == p.certificate
        assert alone.bound.relative <= 1e-9
    groups = {id(p.certificate.claims) for p in positions}
    assert len(groups) == math.ceil(len(positions) / CERTIFY.side_by_side)


def test_a_result_is_stamped(result):
    stamp = result.stamp
    assert stamp.version == ls.__version__
    assert len(stamp.case_hash) == 64
    assert (stamp.solver, stamp.method, stamp.reduce) == ("auto", "newton", True)
    assert stamp.tolerance == 1e-9
    attributes = result.dataset.attrs
    assert attributes["case_hash"] == stamp.case_hash
    assert attributes["loadshare_version"] == ls.__version__


def test_the_stamp_tells_cases_apart():
    case = shipped("fgfbstts/base")
    other = case.replace({'meshes."4-6".stiffness': "4.2750001e6 N*m/rad"})
    hashes = {ls.solve(c, positions=[1]).stamp.case_hash for c in (case, other)}
    assert len(hashes) == 2


def test_labelled_arrays_hold_the_same_figures(result):
    data = result.dataset
    for position in result.positions:
        here = data.sel(position=position.position)
        for mesh, torque in position.torque.items():
            assert float(here["torque"].sel(mesh=mesh)) == torque
        for gear, moved in position.displacement.items():
            assert tuple(here["displacement"].sel(gear=gear).values) == moved
        for gear, state in position.floats.items():
            on_boundary = bool(here["on_boundary"].sel(float=gear))
            assert on_boundary == (state.state == "on boundary")
    assert all(v.attrs["units"] and v.attrs["long_name"] for v in data.data_vars.values())


@pytest.mark.quick(1)
def test_labelled_arrays_do_not_change_the_result(result, tmp_path):
    arrays = result.dataset
    with pytest.raises(ValueError, match="read-only"):
        arrays["torque"] /= 1000.0
    arrays["mine"] = 2.0 * arrays["torque"]
    assert "mine" not in result.dataset
    result.to_netcdf(tmp_path / "result.nc")
    assert ls.load_result(tmp_path / "result.nc") == result


def test_a_table_has_one_row_per_position_and_mesh(result):
    table = result.to_frame()
    assert len(table) == len(result.positions) * len(result.positions[0].torque)
    row = table.iloc[-1]
    assert row["torque"] == result.positions[-1].torque[row["mesh"]]
    assert table["worst_residual"].max() == result.certificate.worst


def test_json_is_plain_and_self_contained(result):
    document = json.loads(result.to_json())
    assert document["positions"][0]["certificate"]["passed"] is True
    assert document["stamp"]["version"] == ls.__version__
    assert document == json.loads(json.dumps(result.to_dict()))


def test_a_file_that_holds_no_result_is_refused(tmp_path):
    for name, text in (("a.json", "{}"), ("b.json", "not json"), ("c.nc", "not netCDF")):
        (tmp_path / name).write_text(text)
        with pytest.raises(ls.LoadshareError, match=f"{name}: contains no loadshare result"):
            ls.load_result(tmp_path / name)
    with pytest.raises(ls.LoadshareError, match="missing"):
        ls.load_result(tmp_path / "missing.json")


def test_coefficients():
    """Ω is the torque over the mean of its group; a group without load has none."""
    net = np.array([[1.0, 3.0, 0.0, 0.0, 2.0, -2.0 + 1e-15]])
    stages = [Stage(pair, tuple(pair), (tuple(pair),)) for pair in ("ab", "cd", "ef")]
    found = shares(MeshTorques(tuple("abcdef"), net, np.array([3.0])), stages)
    np.testing.assert_array_equal(found, [[0.5, 1.5, np.nan, np.nan, np.nan, np.nan]])


def test_an_unloaded_train_has_no_coefficients(tmp_path):
    case = shipped("fgfbstts/load").replace(
        {"operating.torque": "0 N*m", "errors": None, "assumed": None}
    )
    result = ls.solve(case, positions=[1])
    assert result.omega == {"I": None, "II": None, "system": None}
    assert np.isnan(result.share.values).any()
    result.to_json(tmp_path / "still.json")
    assert ls.load_result(tmp_path / "still.json") == result


def test_stages_that_carry_next_to_nothing_have_no_coefficients():
    """Branches brace one another where no torque passes; Ω must not be their round-off."""
    power = ["2000 kW"] * 3 + ["0 kW"] + ["2000 kW"] * 16
    case = shipped("fgfbstts/all_elements").replace({"operating.power": power})
    result = ls.solve(case)
    idle = result.positions[3]
    assert set(idle.share.values()) == set(idle.pair_share.values()) == {None}
    assert max(idle.coast_torque.values()) > 1.0
    assert result.omega == ls.solve(case, positions=range(5, 21)).omega
    table = ls.solve_many(case, {"rings.4.float [um]": [4.0]}, keep=["share", "pair_share"])
    for kept in (table.share, table.pair_share):
        assert np.isnan(kept.sel(position=4)).all()
        assert np.nanmax(kept) < 2.0


def test_the_worst_certificate_speaks_for_the_result(result):
    assert result.passed
    assert result.certificate.worst == max(p.certificate.worst for p in result.positions) <= 1e-9


def test_a_result_prints_on_a_few_lines(result):
    text = repr(result)
    assert len(text.splitlines()) == 2
    count = len(result.positions)
    assert f"{result.stamp.case}: {count} of {count} positions certified" in text
    assert all(f"{omega:.4f}" in text for omega in result.omega.values() if omega is not None)


def test_a_result_that_was_pickled_says_the_same_to_the_last_digit():
    """Also values that are computed on first access: loads of bearings, on axes that turn."""
    turning = {"operating.positions": 3, "gears.ring.support": ["1e9 N/m", "2e9 N/m"]}
    found = ls.solve(shipped("planetary/four_planets").replace(turning))
    again = pickle.loads(pickle.dumps(found))
    assert again.to_json() == found.to_json()
    first, second = found.positions[:2]
    for name in ("loads", "elastic"):
        assert getattr(again.positions[0], name) == getattr(first, name)
        assert getattr(second, name) != getattr(first, name)


def test_samples_have_the_names_and_units_of_results():
    case = shipped("fgfbstts/limit_ring")
    alone = ls.solve(case, positions=[1]).dataset
    names = "torque", "share", "pair_share", "displacement"
    samples = {"rings.4.float [um]": [8.24, 4.0]}
    many = ls.solve_many(case, samples, keep=names, positions=[1])
    for name in names:
        assert many[name].dims[1:] == alone[name].dims
        assert many[name].attrs == alone[name].attrs
        here = many[name].isel(sample=0)
        there = alone[name].sel({dim: here[dim].values for dim in here.dims})
        np.testing.assert_allclose(here, there, rtol=1e-9, atol=1e-15)
    assert all(v.attrs["units"] and v.attrs["long_name"] for v in many.data_vars.values())


@pytest.mark.parametrize(
    ("key", "stiffness"),
    [
        ('meshes."8-10".stiffness', "1e40 N*m/rad"),
        ('shafts."2-4".stiffness', "1e40 N*m/rad"),
        ("gears.6.support", "1e40 N/m"),
    ],
)
@pytest.mark.parametrize("engine", ["vectorised", "compiled"])
def test_what_is_all_but_rigid_is_certified_again(tmp_path, key, stiffness, engine):
    """The rounding of its length, times its stiffness, must not count as a claimed energy."""
    case = ls.load_case(CASES / "fgfbstts" / "base.toml").replace({key: stiffness})
    ls.solve(case, positions=[1], engine=engine).to_json(tmp_path / "found.json")
    assert ls.load_result(tmp_path / "found.json").passed
