"""Laws computed from the teeth follow what a study varies, as in a case with that value."""

import numpy as np
import pytest
from tests.support import CASES

import loadshare as ls

CASE = ls.load_case(CASES / "planetary" / "four_planets.toml")
WIDTH = "gears.sun.face_width"
LAW = 'meshes."sun-planet1".law.b'


def omega(width: float) -> float:
    found = ls.solve(CASE.replace({WIDTH: f"{width!r} mm"}), positions=[1])
    assert found.omega["system"] is not None
    return found.omega["system"]


def test_a_sweep_is_what_each_case_gives() -> None:
    found = ls.sweep(CASE, {WIDTH: ["50 mm", "55 mm"]}, positions=[1]).dataset.omega
    values = found.sel(stage="system").values
    np.testing.assert_allclose(values, [omega(50.0), omega(55.0)], rtol=1e-12)
    assert values[0] != values[1]


def test_a_sensitivity_is_that_of_the_cases() -> None:
    case = CASE.replace({WIDTH: "50 mm"})
    found = ls.sensitivity(case, [WIDTH], positions=[1])
    step = 1e-3
    expected = (omega(50.0 + step) - omega(50.0 - step)) / (2.0 * step)
    for side in ("falling", "rising"):
        assert 1e-3 * found.omega[WIDTH, side]["system"] == pytest.approx(expected, rel=1e-6)


def test_samples_scatter_as_the_cases_do() -> None:
    spread = {"distribution": "uniform", "low": "50 mm", "high": "60 mm"}
    found = ls.tolerance(CASE, {WIDTH: spread}, samples=64, indices=0, worst=False, positions=[1])
    summary = found.of("system").summary
    ends = sorted((omega(50.0), omega(60.0)))
    assert ends[0] <= summary.lowest < summary.highest <= ends[1]
    assert summary.highest - summary.lowest > 0.9 * (ends[1] - ends[0])


def test_a_fit_finds_the_width_back() -> None:
    measured = {"omega": {"system": omega(50.0)}, "position": 1, "uncertainty": 1e-3}
    found = ls.fit(CASE.replace({"measured.bench": measured}), {WIDTH: ("40 mm", "58 mm")})
    assert found.unknowns[0].value == pytest.approx(50.0, rel=1e-6)


def test_a_fitted_case_keeps_the_laws_of_its_teeth() -> None:
    """They can then follow the next change; but a number that was fitted is not the teeth's."""
    measured = {"share": {"sun-planet1": 1.01}, "position": 1, "uncertainty": 1e-3}
    case = CASE.replace({"measured.bench": measured})
    found = ls.fit(case, {"errors.planet1.pin.tangential": ("-90 um", "90 um")})
    assert {mesh.law for mesh in found.case.meshes.values()} == {"iso"}
    found = ls.fit(case, {LAW: ("1e-7 rad/(N*m)", "2e-6 rad/(N*m)")})
    laws = {name: mesh.law for name, mesh in found.case.meshes.items()}
    fitted = laws.pop("sun-planet1")
    assert fitted.b.si == found.unknowns[0].value
    assert not fitted.basis
    assert not fitted.teeth
    assert set(laws.values()) == {"iso"}
    assert ls.compare(found.case).chi_square == pytest.approx(found.chi_square, abs=1e-12)


def test_a_number_of_the_law_itself_is_varied_as_it_stands() -> None:
    """This also holds next to a width that other meshes follow."""
    found = ls.sensitivity(CASE, [LAW, WIDTH], positions=[1])
    assert [item.key for item in found.inputs] == [LAW, WIDTH]
    assert found.omega[LAW, "rising"]["system"] != 0.0
    grids = {LAW: ["5e-7 rad/(N*m)", "6e-7 rad/(N*m)"], WIDTH: ["50 mm", "60 mm"]}
    both = ls.sweep(CASE, grids, positions=[1])
    values = both.dataset.omega.sel(stage="system").values
    assert len(np.unique(values)) == 4


def test_a_file_of_teeth_must_agree_with_every_point() -> None:
    """Teeth in a file do not follow the case: a point is judged as a case with its values."""
    case = ls.load_case(CASES / "fgfbstts" / "from_geometry.toml")
    turned = {"gears.4.centre.angle": ["59.99 deg", "60.01 deg"]}
    found = ls.sweep(case, turned, positions=[1])
    assert [point.status for point in found.points] == ["certified"] * 2
    alone = ls.solve(case.replace({"gears.4.centre.angle": "60.01 deg"}), positions=[1])
    for mesh, torque in alone.positions[0].torque.items():
        _, second = found.dataset.torque.sel(mesh=mesh).values.ravel()
        assert second == pytest.approx(torque, rel=1e-12)
    angles = {'meshes."4-6".pressure_angle': ["18.5 deg", "18.67 deg"]}
    wrong = ls.sweep(case, angles, positions=[1])
    assert [point.status for point in wrong.points] == ["invalid", "certified"]
    assert "p46 has" in wrong.points[0].message


def test_a_batch_varies_a_number_of_a_law_as_a_sweep_does() -> None:
    """It used to refuse the key, because the law in the file is a word."""
    values = ["1e-7 rad/(N*m)", "2e-7 rad/(N*m)"]
    swept = ls.sweep(CASE, {LAW: values}, positions=[1]).dataset.torque
    many = ls.solve_many(CASE, {f"{LAW} [rad/(N*m)]": [1e-7, 2e-7]}, positions=[1]).torque
    np.testing.assert_allclose(many.values, swept.values, rtol=1e-12)
    assert (many.values[0] != many.values[1]).any()
