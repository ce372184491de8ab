"""Sweeps: every point equals an independent solve, and none ends the sweep."""

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st
from tests.support import shipped

import loadshare as ls
from loadshare.study.parameter import grid, read_parameter, split_outside


def test_every_point_is_a_solve_of_its_own():
    case = shipped("fgfbstts/limit_ring")
    found = ls.sweep(case, {("rings.4.float", "rings.5.float"): "0 um:10 um:3"})
    assert found.passed
    name = "rings.4.float=rings.5.float"
    arrays = found.dataset
    assert arrays[name].attrs["units"] == "um"
    assert arrays[name].values.tolist() == [0.0, 5.0, 10.0]
    changed = case.replace({"rings.4.float": "5 um", "rings.5.float": "5 um"})
    alone = ls.solve(changed)
    here = arrays.sel({name: 5.0})
    # Both are at round-off; a point of a sweep starts elsewhere, at the previous point.
    room = {"torque": 1e-9, "share": 1e-13, "pair_share": 1e-13}
    room |= {"displacement": 1e-16, "margin": 1e-16, "reaction": 1e-9}
    for kind, least in room.items():
        assert np.allclose(here[kind], alone.dataset[kind], 1e-12, least, equal_nan=True), kind
    omega = float(here["pair_omega"].sel(stage="system"))
    assert omega == pytest.approx(alone.pair_omega["system"], rel=1e-13)
    assert here["rest"].sel(position=1, float="4") == alone.floats[0]["4"].boundary
    assert here["rest"].sel(position=1, float="1") == "undetermined"


def test_points_begin_where_the_first_one_ended():
    """If all have one active set, none needs a search, and none delays the others."""
    case = shipped("fgfbstts/limit_ring")
    alone = ls.solve(case.replace({"rings.4.float": "3 um"})).positions
    assert {p.effort.rounds for p in alone} == {3}
    found = ls.sweep(case, {"rings.4.float": "3 um:4 um:3"})
    rounds = [{p.effort.rounds for p in point.result.positions} for point in found.points]
    assert rounds == [{1}, {1}, {1}]
    # An invalid point and one with other elements in between do not delay the others.
    over = {"rings.4.float": ["3 um", "-1 um", "3.5 um", "0 um", "4 um"]}
    broken = ls.sweep(case, over)
    assert [p.status for p in broken.points] == ["certified", "invalid", *["certified"] * 3]
    last = {p.torque["7-10"] for p in broken.points[-1].result.positions}
    assert last.pop() == pytest.approx(
        found.points[-1].result.positions[0].torque["7-10"], rel=1e-13
    )


@pytest.mark.parametrize(
    ("name", "over", "positions"),
    [
        ("fgfbstts/all_elements", {"operating.power": "1000 kW:2000 kW:2"}, [1, 3]),
        ("planetary/four_planets", {"operating.torque": ["500 N*m", "1 kN*m"]}, None),
        (
            "fgfbstts/limit_ring",
            {"rings.4.float": "2 um, 9 um", "operating.power": "1 MW, 2 MW"},
            [2],
        ),
        ("two_path/nasa", {"operating.torque": ["60 N*m", "90 N*m"]}, None),
    ],
)
def test_arrays_say_what_the_results_of_the_points_say(name, over, positions):
    """Figures are computed for all points at once; each point can be solved and judged alone."""
    found = ls.sweep(shipped(name), over, positions=positions)
    arrays = found.dataset
    shape = [len(values) for values in found.grids]
    for number, point in enumerate(found.points):
        at = dict(zip(arrays["status"].dims, np.unravel_index(number, shape), strict=True))
        here, alone = arrays.isel(at), point.result.dataset
        assert point.result.passed
        for kind, variable in alone.items():
            if kind in ("residual", "torque_bound"):
                continue
            size = np.abs(variable.values[np.isfinite(variable.values)]).max(initial=0.0)
            least = max(1e-12 * size, 1e-16)
            assert np.allclose(here[kind], variable, 1e-11, least, equal_nan=True), kind
        rests = [[f.boundary or f.state for f in r.values()] for r in point.result.floats]
        assert here["rest"].values.tolist() == rests
        omegas = point.result.omega.values()
        assert here["omega"].values.tolist() == pytest.approx([*omegas], rel=1e-13, nan_ok=True)


def test_the_picture_shows_only_gears_that_can_move():
    case = shipped("fgfbstts/limit_ring")
    over = {f"rings.{gear}.float": "0 um:2 um:2" for gear in (4, 5)}
    found = ls.sweep(case, over, positions=[1])
    panels = found.plot("displacement").spec["concat"]
    assert [panel["title"]["text"] for panel in panels] == ["Gear 1", "Gear 4", "Gear 5"]
    named = found.plot("displacement", names=["6"]).spec["concat"]
    assert [panel["title"]["text"] for panel in named] == ["Gear 6"]


@pytest.mark.slow
def test_the_picture_is_that_of_the_arrays(tmp_path):
    case = shipped("fgfbstts/limit_ring")
    found = ls.sweep(case, {"rings.*.float": "0 um:12 um:4"}, positions=[1])
    events = ls.critical(case, "rings.*.float", "0 um", "12 um", positions=[1]).marks()
    figure = found.plot("pair_omega", names=["II"], events=events)
    rows = [row for rows in figure.spec["datasets"].values() for row in rows]
    shown = {r["x"]: r["y"] for r in rows if "y" in r}
    arrays = found.dataset["pair_omega"].sel(stage="II")
    assert shown == dict(zip([0.0, 4.0, 8.0, 12.0], arrays.values.tolist(), strict=True))
    labels = {r["text"]: r["x"] for r in rows if "text" in r}
    assert labels == {event: value for value, event in events}
    assert set(labels) == {"gear 4: float leaves boundary", "gear 5: float leaves boundary"}
    text = found.plot().save(tmp_path / "sweep.svg").read_text(encoding="utf-8")
    assert "Limit rings on the floating pinions" in text
    with pytest.raises(ls.LoadshareError, match="no variable 'colour'"):
        found.plot("colour")


def test_a_star_ties_all_that_it_means():
    case = shipped("fgfbstts/limit_ring")
    parameter = read_parameter(case, "rings.*.float", "um")
    assert parameter.keys == ("rings.4.float", "rings.5.float")
    assert parameter.changes(2.5) == dict.fromkeys(parameter.keys, "2.5 um")
    # A key that is missing in the tables may be set in all of them.
    assert read_parameter(case, "rings.*.stiffness", "N/m").keys[1] == "rings.5.stiffness"


def test_two_parameters_and_a_point_that_cannot_be(tmp_path):
    case = shipped("fgfbstts/limit_ring")
    over = {"rings.4.float": ["-1 um", "0 um"], "operating.power": ["1 MW", "2000 kW"]}
    reported = []
    found = ls.sweep(case, over, positions=[1], progress=lambda *done: reported.append(done))
    assert reported[-1] == (2, 2)
    assert [p.status for p in found.points] == ["invalid", "invalid", "certified", "certified"]
    assert "is negative" in found.points[0].message
    arrays = found.dataset
    assert arrays["torque"].dims[:2] == ("rings.4.float", "operating.power")
    assert arrays["operating.power"].values.tolist() == [1.0, 2.0]
    assert np.isnan(arrays["torque"].sel({"rings.4.float": -1.0})).all()
    assert not np.isnan(arrays["torque"].sel({"rings.4.float": 0.0})).any()
    found.to_netcdf(tmp_path / "sweep.nc")
    with xr.open_dataset(tmp_path / "sweep.nc", engine="h5netcdf") as saved:
        assert saved["status"].values.tolist() == arrays["status"].values.tolist()
        assert np.array_equal(saved["torque"], arrays["torque"], equal_nan=True)
    found.to_csv(tmp_path / "sweep.csv")
    lines = (tmp_path / "sweep.csv").read_text().splitlines()
    assert lines[0].startswith("rings.4.float [um],operating.power [MW],position,mesh,torque")
    assert len(lines) == 1 + 2 + 2 * len(case.meshes)


def test_a_refused_point_keeps_its_message_and_the_sweep_goes_on():
    """The law of a spline drops because of its stick limit, so the equilibrium is not unique."""
    case = shipped("fgfbstts/full_float").replace(
        {
            "splines.4.normal_force": None,
            "splines.4.friction": 0.1,
            "splines.4.radius": "35 mm",
            "splines.4.stick_limit": "100 um",
        }
    )
    found = ls.sweep(case, {"operating.power": "20 kW:2000 kW:2"}, positions=[1])
    assert [p.status for p in found.points] == ["refused", "certified"]
    assert "would drop" in found.points[0].message
    assert "would drop" in str(found.dataset["message"].values[0])


def test_a_setting_makes_the_table_of_a_gears_errors():
    case = shipped("fgfbstts/base").replace({"errors.6.installation": ["0 um", "0 um"]})
    found = ls.sweep(case, {"errors.6.installation[0]": "0 um, 9 um"}, positions=[1])
    omega = found.dataset["omega"].sel(stage="II").values
    assert omega[0] == pytest.approx(1.0, abs=1e-12)
    assert omega[1] > 1.001
    with pytest.raises(ls.CaseError, match='"66" is not a gear'):
        case.replace({"errors.66.installation": ["0 um", "0 um"]})


@pytest.mark.parametrize(
    ("over", "message"),
    [
        ({}, "1 or 2 parameters"),
        ({"rings.4.flot": "0 um:1 um:3"}, "Did you mean float"),
        ({"rings.4.float": "0 um:1 um"}, "number of points"),
        ({"rings.4.float": "0 um:1 um:1"}, "number of points"),
        ({"rings.4.float": "0 um:1 um:²"}, "number of points"),
        ({"rings.4.float": f"0 um:1 um:{'9' * 5000}"}, "up to 20,000 points in all"),
        ({"rings.4.float": "0 um:1 um:20001"}, "is too fine"),
        ({"rings.4.float": "0 um:1 um:200", "rings.5.float": "0 um:1 um:101"}, "20200 points"),
        ({"rings.4.float": "little"}, "cannot be read"),
        ({"rings.4.float": "0 um:1e400 um:3"}, '"1e400 um" cannot be read'),
        ({"rings.4.float": ["0 um", "1 N"]}, "cannot be expressed in um"),
        ({"rings.4.float": ["0 um"], "rings.*.float": ["1 um"]}, "is set by"),
    ],
)
def test_what_cannot_be_swept_is_reported(over, message):
    with pytest.raises(ls.CaseError, match=message):
        ls.sweep(shipped("fgfbstts/limit_ring"), over)


@given(
    st.floats(-1e3, 1e3, allow_nan=False),
    st.floats(1e-3, 1e3),
    st.integers(2, 50),
)
def test_a_grid_has_its_ends_and_even_steps(low, width, count):
    values, unit = grid(f"{low!r} um : {low + width!r} um : {count}", "x")
    assert unit == "um"
    assert (values[0], values[-1], len(values)) == (low, low + width, count)
    assert np.diff(values) == pytest.approx(width / (count - 1), rel=1e-6, abs=1e-9)


def test_values_take_the_first_unit():
    assert grid(["1 mm", "2 um", "0 m"], "x") == ((1.0, pytest.approx(0.002), 0.0), "mm")
    assert grid(np.array([0.1, 0.2]), "x") == ((0.1, 0.2), "")
    assert grid("0:1:3", "x") == ((0.0, 0.5, 1.0), "")


def test_signs_in_quotes_do_not_split():
    assert split_outside('meshes."a=b".gap=x = 1', "=") == ['meshes."a=b".gap', "x", "1"]


def test_what_is_no_mapping_of_inputs_is_told_what_is():
    with pytest.raises(TypeError, match=r"inputs by key path are expected, .* not str"):
        ls.sweep(shipped("fgfbstts/limit_ring"), "rings.4.float")  # type: ignore[arg-type]
