"""Export of results into REXS files with load cases, with shared stages and with pins."""

from __future__ import annotations

import json
import zipfile
from types import SimpleNamespace

import numpy as np
import pytest
from tests.cli.conftest import on_a_screen_of
from tests.exchange.test_rexs_places import geared_carrier
from tests.exchange.units import at, bearing, joint, planetary, rexsj, two_stages, xml

import loadshare as ls
from loadshare.exchange.rexs import export_rexs, import_rexs, in_form_of
from loadshare.exchange.rexs.reading import read_model

FACTOR, PUSHED = "mesh_load_factor_iso_6336_2019", "force_acting_on_inner_component_v"


def with_cases(form: str) -> bytes:
    """Return two stages with two load cases, both with results of another program."""
    components, relations = two_stages()
    old = {PUSHED: (111.0, "N")}
    cases = [
        [
            (30, "external_load", "", {"torque_around_u_axis": (torque, "N m")}),
            (63, "concept_bearing", "", old),
        ]
        for torque in (70.0, 80.0)
    ]
    if form == "xml":
        return xml(components, relations, cases=cases)
    held = json.loads(rexsj(components, relations, "2.0"))
    parts = [json.loads(rexsj(case, [], "2.0"))["model"]["components"] for case in cases]
    held["model"]["load_spectrum"] = {
        "id": 1,
        "load_cases": [{"id": k, "components": part} for k, part in enumerate(parts)],
    }
    return json.dumps(held).encode()


@pytest.mark.parametrize("form", ["xml", "json"])
def test_results_are_those_of_the_first_load_case(written, form) -> None:
    unit = written(with_cases(form), f"unit.{form}")
    result = ls.solve(import_rexs(unit).case())
    text = export_rexs(result, unit)
    copy = written(text.encode(), f"copy.{form}")
    found = read_model(copy).components
    force = result.positions[0].loads.bearings["gear_23"][0]
    assert found["63"].number(PUSHED) == pytest.approx(-force)
    assert found["23"].attributes["custom_loadshare_displacement"] is not None
    assert found["23"].type == "cylindrical_gear"
    assert text.count("111.0") == 1, "the second load case keeps its own"
    assert text.count("custom_loadshare_normal_force") == 2, "one for each stage, in one place"
    assert import_rexs(copy).data["operating"] == import_rexs(unit).data["operating"]
    assert export_rexs(result, copy) == text


@pytest.mark.parametrize("form", ["xml", "json"])
def test_a_copy_of_an_archive_is_one(written, tmp_path, form) -> None:
    """It contains all other files unchanged, and is bit for bit the same each time."""
    command = on_a_screen_of(80)
    inside = f"unit.rexs{'j' if form == 'json' else ''}"
    with zipfile.ZipFile(tmp_path / "unit.rexsz", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(inside, with_cases(form))
        archive.writestr("notes/read me.txt", b"\x00\xff")
        archive.comment = b"as delivered"
    unit, copy = tmp_path / "unit.rexsz", tmp_path / "copy.rexsz"
    case = tmp_path / "unit.toml"
    command("import", str(unit), "-o", str(case))
    command("export", str(case), str(unit), "-o", str(copy))
    result = ls.solve(import_rexs(unit).case())
    text = export_rexs(result, unit)
    assert text == export_rexs(result, written(with_cases(form), inside))
    with zipfile.ZipFile(unit) as before, zipfile.ZipFile(copy) as after:
        assert after.read(inside).decode() == text
        assert after.read("notes/read me.txt") == b"\x00\xff"
        assert after.comment == before.comment
        for old, new in zip(before.infolist(), after.infolist(), strict=True):
            assert (old.filename, old.date_time) == (new.filename, new.date_time)
    assert copy.read_bytes() == in_form_of(unit, text) == in_form_of(copy, text)


def test_an_archive_with_more_than_can_be_copied_is_refused(tmp_path, monkeypatch) -> None:
    with zipfile.ZipFile(tmp_path / "unit.rexsz", "w") as archive:
        archive.writestr("unit.rexs", "<model/>")
        archive.writestr("film", b"0" * 2000)
    room = SimpleNamespace(other_bytes=2000)
    monkeypatch.setattr("loadshare.exchange.rexs.archive.ALLOWED", room)
    with pytest.raises(ls.CaseError, match="is larger than"):
        in_form_of(tmp_path / "unit.rexsz", "<model/>" * 100)


def test_a_stage_of_several_meshes_has_the_largest_factor(written) -> None:
    components, relations = planetary()
    for id_, shaft in ((401, 34), (402, 4), (403, 62)):
        components.append((id_, "concept_bearing", "", bearing(1e9)))
        relations.append(joint(id_, shaft, 2))
    relations = [
        (kind, {**roles, "stage": 211} if roles.get("stage") in (212, 213) else roles)
        for kind, roles in relations
    ]
    unit = written(xml(components, relations))
    result = ls.solve(import_rexs(unit).case())
    found = read_model(written(export_rexs(result, unit).encode(), "copy.rexs")).components
    shares = [result.positions[0].share[f"gear_53-gear_{k}"] for k in (247, 248, 249)]
    assert max(shares) > min(shares) + 1e-3
    assert found["211"].number(FACTOR) == pytest.approx(max(shares))
    assert "meshing_stiffness_characteristic" not in found["211"].attributes
    assert "meshing_stiffness_characteristic" in found["220"].attributes


def test_seats_of_pins_take_the_force_of_their_planets(written) -> None:
    """Seats 20 mm before and 60 mm behind the planet take 3/4 and 1/4."""
    components, relations = planetary()
    components.append((67, "side_plate", "", at(125.0, 0.0, 0.0)))
    for k in range(3):
        for number, place in ((500 + k, -20.0), (510 + k, 60.0)):
            components.append((number, "coupling", "", bearing(1e9, place)))
            relations.append(joint(number, 235 + k, 67))
    unit = written(xml(components, relations))
    result = ls.solve(import_rexs(unit).case())
    found = read_model(written(export_rexs(result, unit).encode(), "copy.rexs")).components
    for k in range(3):
        force = np.array(result.positions[0].loads.bearings[f"gear_{247 + k}"])
        for id_, part in ((500 + k, 0.75), (510 + k, 0.25), (300 + k, None)):
            sides = {
                side: [
                    found[str(id_)].number(f"force_acting_on_{side}_component_{axis}")
                    for axis in "vw"
                ]
                for side in ("inner", "outer")
            }
            # The pin is inside both its seats and the planet's bearing.
            if part is None:
                assert sides["inner"] == pytest.approx(force)
            else:
                assert sides["outer"] == pytest.approx(part * force)
                assert sides["inner"] == pytest.approx(-part * force)


def test_a_mesh_that_jams_has_the_stiffness_of_its_flank(written) -> None:
    """Force and compression are those of one flank, not the sum of both."""
    unit = written(xml(*two_stages()))
    law = {"b": "1e-6 rad/(N*m)", "c": "2e-5 rad/(N*m)^(2/3)"}
    mesh = "gear_20-gear_21"
    jammed = {
        f'meshes."{mesh}"': {"law": law, "backlash": "0 um"},
        "errors.gear_21": {"installation": ["0 um", "-60 um", "0 um"]},
    }
    result = ls.solve(import_rexs(unit).case().replace(jammed))
    forces = result.positions[0].equilibrium.flank_force
    force = max(forces[mesh], forces[f"{mesh} coast"])
    assert min(forces[mesh], forces[f"{mesh} coast"]) > 0.0
    flank = result.positions[0].train.meshes[mesh].law(1)
    found = read_model(written(export_rexs(result, unit).encode(), "copy.rexs")).components
    (stiffness,) = found["40"].attributes["meshing_stiffness_characteristic"]
    assert stiffness == pytest.approx(force / flank.compression(force), rel=1e-9)


def test_a_copy_is_not_named_as_another_form(written, tmp_path) -> None:
    command = on_a_screen_of(200)
    unit, case = written(xml(*planetary())), tmp_path / "unit.toml"
    case.write_text(import_rexs(unit).text, encoding="utf-8")
    for name in ("found.rexsz", "found.rexsj", "found.doc"):
        done = command("export", case, unit, "-o", tmp_path / name)
        assert done.exit_code == 2
        assert "give it the same ending, .rexs" in done.stderr
        assert not (tmp_path / name).exists()
    assert command("export", case, unit, "-o", tmp_path / "found.REXS").exit_code == 0


@pytest.mark.parametrize("names", [b'xmlns="http://x"', b'xmlns:x="http://x" x:y="1"', b'x:y="1"'])
def test_a_copy_keeps_names_and_comments(written, names) -> None:
    """Names of a namespace, declared or not, which the import ignores."""
    content = xml(*planetary()).replace(b"<model ", b"<model " + names + b" ")
    unit = written(content.replace(b"<relations>", b"<!-- as built --><relations>"))
    text = export_rexs(ls.solve(import_rexs(unit).case()), unit)
    assert names.decode() in text
    assert "<!-- as built -->" in text
    assert import_rexs(written(text.encode(), "copy.rexs")).data["gears"]


def test_a_copy_keeps_a_name_that_is_no_unicode(written, tmp_path) -> None:
    """The name ends in half a surrogate pair of JSON, from a program that truncates names."""
    content = rexsj(*planetary(), "2.0").replace(b'"planet 0"', b'"planet \\ud83d"')
    unit = written(content, "unit.rexsj")
    copy = in_form_of(unit, export_rexs(ls.solve(import_rexs(unit).case()), unit))
    assert b'"planet \\ud83d"' in copy
    assert import_rexs(written(copy, "copy.rexsj")).text


def test_a_case_without_all_gears_of_the_unit_is_refused(written) -> None:
    """Otherwise bearings would have too little force, and stages old results of another case."""
    unit = written(xml(*planetary()))
    text = import_rexs(unit).text.replace("gear_247", "planet_1")
    result = ls.solve(written(text.encode(), "unit.toml"))
    with pytest.raises(ls.CaseError, match="gear_247: is not in the case: gears must be named"):
        export_rexs(result, unit)
    case, copy = unit.with_name("unit.toml"), unit.with_name("copy.rexs")
    done = on_a_screen_of(200)("export", case, unit, "-o", copy)
    assert done.exit_code == 2
    assert done.stderr.endswith("nothing was written.\n")


def test_a_mesh_is_found_by_its_gears_and_without_a_stage_has_no_factor(written) -> None:
    unit = written(xml(*planetary()))
    imported = import_rexs(unit)
    copy = written(export_rexs(ls.solve(imported.case()), unit).encode(), "copy.rexs")
    assert read_model(copy).components["211"].number(FACTOR)
    mesh = {"driver": "gear_53", "driven": "gear_247", "law": "iso"}
    meshes = {"first": mesh, **imported.data["meshes"]}
    del meshes["gear_53-gear_247"]
    data = {key: value for key, value in imported.data.items() if key != "stages"}
    found = export_rexs(ls.solve(ls.Case({**data, "meshes": meshes})), copy)
    stage = read_model(written(found.encode(), "again.rexs")).components["211"]
    assert stage.number(FACTOR) is None
    assert "meshing_stiffness_characteristic" in stage.attributes


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_forces_on_the_housing_do_not_turn_with_the_carrier(written, way) -> None:
    """Bearings of a carrier and of a gear on its shaft, both under forces fixed in the housing."""
    unit = written(xml(*geared_carrier(plate=False)))
    forces = {"carrier_3": ["0 N", "0 N", "3000 N"], "gear_80": ["0 N", f"{3000 * way} N", "0 N"]}
    operating = {"operating.positions": 8, "operating.forces": forces}
    result = ls.solve(import_rexs(unit).case().replace(operating))
    found = read_model(written(export_rexs(result, unit).encode(), "copy.rexs")).components
    taken = found["3"].attributes["custom_loadshare_force_on_bearings"]
    assert taken == pytest.approx((0.0, 0.0, 3000.0), abs=1e-6)
    taken = [
        sum(found[id_].number(f"force_acting_on_outer_component_{axis}") for id_ in ("400", "401"))
        for axis in "vw"
    ]
    assert taken == pytest.approx([3000.0 * way, 3000.0], abs=1e-6)
