"""A law that was computed from teeth is not used for other teeth, however the case is read back."""

from __future__ import annotations

from dataclasses import replace

import pytest

import loadshare as ls
from loadshare.case.checks.law_origin import teeth_digest
from loadshare.exchange.spreadsheet.exporting import export_tables
from loadshare.exchange.spreadsheet.importing import import_tables
from loadshare.results.laws import law_lines

CASE = "cases/planetary/four_planets.toml"
GEARS = ("sun", "ring", "planet1", "planet2", "planet3", "planet4")
NARROW = {f"gears.{gear}.face_width": "30 mm" for gear in GEARS}


@pytest.fixture(scope="module")
def found() -> ls.Result:
    return ls.solve(CASE)


def stiffness(result: ls.Result) -> float:
    return result.positions[0].elastic.mesh_stiffness["sun-planet1"]


def test_light_loads_of_several_meshes_are_one_warning(found) -> None:
    """A set of thirteen meshes used to give as many warnings."""
    meshes = "meshes sun-planet2, sun-planet4, planet2-ring, planet4-ring, each"
    assert [line for line in law_lines(found.laws) if line.startswith("WARNING")] == [
        f"WARNING: {meshes}: 172.1 to 344.2 N·m lies below the 270 to 540 N·m from which the law "
        "holds; it carries 63.7 N per mm of face width at most."
    ]
    assert found.laws["sun-planet2"].note.startswith("172.1 N·m lies below the 270 N·m")
    one = {
        "sun-planet2": found.laws["sun-planet2"],
        "free": replace(found.laws["sun-planet2"], note=""),
    }
    assert law_lines(one)[-1].startswith("WARNING: mesh sun-planet2: 172.1 N·m lies below")


def test_changed_teeth_of_a_result_s_case_have_their_own_law(found) -> None:
    """The stiffness of ISO 6336-1 is per face width: half the width, half the stiffness."""
    narrow = ls.solve(found.case.replace(NARROW))
    assert stiffness(narrow) == pytest.approx(0.5 * stiffness(found), rel=1e-9)
    assert narrow.omega == ls.solve(ls.load_case(CASE).replace(NARROW)).omega


def test_a_march_gives_back_its_case() -> None:
    made = ls.march(CASE, gear="sun", revolutions=0.1, steps=2)
    assert made.result.case.meshes["sun-planet1"].law == "iso"


def test_tables_of_a_result_hold_the_case_as_it_is_written(found, tmp_path) -> None:
    for name, text in export_tables(found).items():
        (tmp_path / f"{name}.csv").write_text(text, encoding="utf-8")
    assert import_tables(tmp_path).case().hash == ls.load_case(CASE).hash


def test_a_saved_result_refuses_other_teeth(found, tmp_path) -> None:
    found.to_json(tmp_path / "found.json")
    case = ls.load_result(tmp_path / "found.json").case
    assert case.hash == found.stamp.case_hash
    with pytest.raises(ls.CaseError, match="computed from teeth other than") as refused:
        case.replace(NARROW)
    assert len(refused.value.problems) == len(case.meshes)
    again = {f'meshes."{name}".law': "iso" for name in case.meshes}
    assert stiffness(ls.solve(case.replace(NARROW | again))) == pytest.approx(
        0.5 * stiffness(found), rel=1e-9
    )
    kept = {f'meshes."{name}".law.teeth': None for name in case.meshes}
    assert stiffness(ls.solve(case.replace(NARROW | kept))) == pytest.approx(
        stiffness(found), rel=1e-9
    )


def test_what_no_law_follows_from_may_change(found, tmp_path) -> None:
    """Loads and allowances do not change the law; nor does turning the whole train."""
    found.to_json(tmp_path / "found.json")
    case = ls.load_result(tmp_path / "found.json").case
    torque = case.operating.torque.si
    half = case.replace(
        {"operating.torque": f"{0.5 * torque} N*m", "gears.sun.density": "7800 kg/m^3"}
    )
    assert ls.solve(half).passed
    placed = {n: case.gears[n].centre.angle.si for n in GEARS if n.startswith("planet")}
    turned = {f"gears.{n}.centre.angle": f"{a + 0.3} rad" for n, a in placed.items()}
    assert ls.solve(case.replace(turned)).passed


def test_what_teeth_have_anyway_may_be_written_out(found, tmp_path) -> None:
    """Laws that were marked with explicit defaults also remain those of their teeth."""
    found.to_json(tmp_path / "found.json")
    case = ls.load_result(tmp_path / "found.json").case
    usual = {"pressure_angle": "20 deg", "profile_shift": 0.0, "dedendum": 1.25}
    out = case.replace({f"gears.{gear}.{key}": v for gear in GEARS for key, v in usual.items()})
    assert stiffness(ls.solve(out)) == stiffness(found)
    marks = {
        f'meshes."{name}".law.teeth': teeth_digest(mesh, out.gears, out.centres(), written=True)
        for name, mesh in out.meshes.items()
    }
    assert marks[f'meshes."{next(iter(out.meshes))}".law.teeth'] not in str(case.to_dict())
    assert stiffness(ls.solve(out.replace(marks))) == stiffness(found)
    with pytest.raises(ls.CaseError, match="computed from teeth other than"):
        case.replace({f"gears.{gear}.pressure_angle": "20.5 deg" for gear in GEARS})
