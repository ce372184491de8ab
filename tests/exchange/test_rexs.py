"""Units from REXS files: what is imported, what is assumed, and files that are not REXS."""

from __future__ import annotations

import json
import math
import random
import re
import zipfile
from pathlib import Path

import numpy as np
import pytest
from tests.exchange.units import planetary, rexsj, two_stages, xml

import loadshare as ls
from loadshare.errors import CaseError, Refused
from loadshare.exchange.rexs import export_rexs, import_rexs
from loadshare.exchange.rexs.reading import read_model
from loadshare.study.parameter import read_value


def test_a_planetary_set_is_the_set_that_it_says(written) -> None:
    """Torques by Willis; planets are on the carrier, the ring is held, a pin bearing is offset."""
    found = import_rexs(written(xml(*planetary())))
    case = found.case()
    assert case.gears["carrier_3"].type == "carrier"
    assert case.gears["gear_58"].held
    assert {case.gears[f"gear_{k}"].carrier for k in (247, 248, 249)} == {"carrier_3"}
    assert case.operating.input == "gear_53"
    assert case.operating.output == "carrier_3"
    assert case.gears["gear_53"].support == "free"
    # The outer ring is off by 15 um in the planet, so the planet settles by as much the other way.
    assert [v.si for v in case.errors["gear_248"].installation] == pytest.approx([0.0, -15e-6, 0.0])
    assert any("lubricant" in line for line in found.left_out)
    assert any("iso" in line for line in found.assumed)
    result = ls.solve(case)
    loads = result.positions[0].loads.gears
    assert loads["gear_58"] == pytest.approx(1591.549 * 61 / 17, rel=1e-9)
    assert loads["carrier_3"] == pytest.approx(-1591.549 * 78 / 17, rel=1e-9)
    assert {len(stage) for stage in result.stages.values()} == {3}


def test_all_forms_say_the_same(written, tmp_path) -> None:
    parts = planetary()
    whole = import_rexs(written(xml(*parts))).data
    coded = import_rexs(written(xml(*parts, coded=True), "coded.rexs")).data
    json = import_rexs(written(rexsj(*parts, "2.0"), "unit.rexsj")).data
    with zipfile.ZipFile(tmp_path / "unit.rexsz", "w") as archive:
        archive.writestr("unit.rexs", xml(*parts))
    packed = import_rexs(tmp_path / "unit.rexsz").data
    for other in (coded, json, packed):
        assert other["gears"] == whole["gears"]
        assert other["meshes"] == whole["meshes"]


def test_shafts_bearings_and_stiffness_are_taken_by_their_formulas(written) -> None:
    case = import_rexs(written(xml(*two_stages()))).case()
    polar = math.pi / 32.0 * (0.04**4 - 0.02**4)
    assert case.shafts["gear_21-gear_22"].stiffness.si == pytest.approx(79.3e9 * polar / 0.1)
    # Gears at 25 mm and 125 mm (centres of their widths), between bearings 200 mm apart.
    for gear, at in (("gear_21", 0.025), ("gear_22", 0.125)):
        yields = ((0.2 - at) / 0.2) ** 2 / 1e8 + (at / 0.2) ** 2 / 3e8
        assert case.gears[gear].support.si == pytest.approx(1.0 / yields)
    assert case.gears["gear_20"].support == "rigid"
    assert case.bearings["gear_23"].clearance.si == pytest.approx(20e-6)
    assert case.bearings["gear_23"].stiffness.si == pytest.approx(5e8)
    radius = 0.5 * 2e-3 * 20 * math.cos(math.radians(20.0))
    stiffness = case.meshes["gear_22-gear_23"].stiffness
    assert stiffness.si == pytest.approx(20e9 * 0.05 * radius**2)
    assert case.operating.running == "clockwise"
    assert ls.solve(case).positions[0].loads.gears["gear_23"] == pytest.approx(600.0, rel=1e-9)


@pytest.mark.parametrize(
    ("unit", "factor"), [("N mm", 1e3), ("kN m", 1e-3), ("Nm", 1.0), ("kN*m", 1e-3)]
)
def test_units_that_the_standard_does_not_use_are_read(written, unit, factor) -> None:
    parts = two_stages()
    text = xml(*parts).decode()
    torque = re.search(r'unit="N m">([^<]+)<', text)
    assert torque is not None
    other = text.replace(torque[0], f'unit="{unit}">{float(torque[1]) * factor!r}<')
    plain, found = (import_rexs(written(t.encode(), "unit.rexs")).data for t in (text, other))
    assert read_value(found["operating"]["torque"]).si == pytest.approx(
        read_value(plain["operating"]["torque"]).si, rel=1e-12
    )


def test_a_number_in_an_unknown_unit_is_none(written) -> None:
    text = xml(*two_stages()).decode().replace('unit="N m"', 'unit="furlong"')
    with pytest.raises(ls.CaseError, match="torque"):
        import_rexs(written(text.encode(), "unit.rexs"))


def test_the_first_load_case_counts(written) -> None:
    components, relations = two_stages()
    cases = [
        [(30, "external_load", "", {"torque_around_u_axis": (torque, "N m")})]
        for torque in (70.0, 80.0)
    ]
    found = import_rexs(written(xml(components, relations, cases=cases)))
    assert found.case().operating.torque.si == 70.0
    assert any("first of 2 load cases" in line for line in found.assumed)


def test_the_written_case_says_what_it_is_worth(written, tmp_path) -> None:
    found = import_rexs(written(xml(*planetary())))
    path = tmp_path / "unit.toml"
    path.write_text(found.text, encoding="utf-8")
    assert ls.load_case(path).to_dict() == found.case().to_dict()
    assert found.text.startswith("# Assumed:")
    assert "# Left out:" in found.text


@pytest.mark.parametrize("form", ["xml", "json"])
def test_what_is_written_back_is_read_again_as_the_same_case(written, form) -> None:
    parts = planetary()
    unit = written(xml(*parts) if form == "xml" else rexsj(*parts, "2.0"), f"unit.{form}")
    case = import_rexs(unit).case().replace({"operating.positions": 2})
    result = ls.solve(case)
    copy = written(export_rexs(result, unit).encode(), f"copy.{form}")
    again = import_rexs(copy)
    for section in ("operating", "gears", "meshes", "errors", "stages"):
        assert again.data[section] == import_rexs(unit).data[section]
    stage = read_model(copy).components["211"]
    share = max(p.share["gear_53-gear_247"] for p in result.positions)
    assert stage.number("mesh_load_factor_iso_6336_2019") == pytest.approx(share)
    law = result.positions[0].train.meshes["gear_53-gear_247"].laws[0]
    stiffness = stage.attributes["meshing_stiffness_characteristic"]
    assert stiffness == pytest.approx((1.0 / law.b, 1.0 / law.b))
    # A second export replaces each attribute instead of adding one.
    assert export_rexs(result, copy) == copy.read_text()


def test_forces_and_displacements_are_written_back(written) -> None:
    """Two gears on one shaft between two bearings: levers apply, and no force is lost."""
    unit = written(xml(*two_stages()))
    result = ls.solve(import_rexs(unit).case())
    here = result.positions[0]
    found = read_model(written(export_rexs(result, unit).encode(), "copy.rexs")).components
    pushed = {name: np.array(force) for name, force in here.loads.bearings.items()}
    # At 25 mm and 125 mm between bearings at 0 and 200 mm.
    first = 0.875 * pushed["gear_21"] + 0.375 * pushed["gear_22"]
    both = pushed["gear_21"] + pushed["gear_22"]
    # v is y and w is z in the gears' frames here: both axes are x.
    for id_, force in (("61", first), ("62", both - first), ("63", pushed["gear_23"])):
        for axis, value in zip("vw", force, strict=True):
            exported = found[id_].number(f"force_acting_on_outer_component_{axis}")
            assert exported == pytest.approx(value, rel=1e-12)
            exported = found[id_].number(f"force_acting_on_inner_component_{axis}")
            assert exported == pytest.approx(-value, rel=1e-12)
    assert np.abs(pushed["gear_23"]).max() > 1e3, "a bearing with clearance carries as well"
    stage = found["41"].attributes
    mesh = "gear_22-gear_23"
    assert stage["custom_loadshare_normal_force"] == pytest.approx((here.loads.meshes[mesh],))
    error = here.elastic.mesh_transmission_error[mesh]
    # Micrometres are read back as metres.
    assert stage["custom_loadshare_transmission_error"] == pytest.approx((error,))
    moved = found["23"].attributes["custom_loadshare_displacement"]
    assert moved == pytest.approx(here.claim.displacement["gear_23"])
    assert found["23"].attributes["custom_loadshare_force_on_bearings"][1:] == pytest.approx(
        pushed["gear_23"]
    )


def test_a_bearing_that_hardly_holds_beside_a_stiff_one_is_not_lost(written) -> None:
    components, relations = two_stages()
    stiffness = {61: 1e14, 62: 1e-3}
    changed = [
        (i, kind, name, a | {"radial_stiffness": (stiffness[i], "N / m")} if i in stiffness else a)
        for i, kind, name, a in components
    ]
    case = import_rexs(written(xml(changed, relations))).case()
    for gear, at in (("gear_21", 0.025), ("gear_22", 0.125)):
        yields = ((0.2 - at) / 0.2) ** 2 / 1e14 + (at / 0.2) ** 2 / 1e-3
        assert case.gears[gear].support.si == pytest.approx(1.0 / yields)


def test_the_pins_of_planets_are_inside_of_their_bearings(written) -> None:
    unit = written(xml(*planetary()))
    result = ls.solve(import_rexs(unit).case())
    found = read_model(written(export_rexs(result, unit).encode(), "copy.rexs")).components
    for k in range(3):
        force = result.positions[0].loads.bearings[f"gear_{247 + k}"]
        exported = [
            found[f"{300 + k}"].number(f"force_acting_on_inner_component_{axis}") for axis in "vw"
        ]
        assert exported == pytest.approx(force)


def test_a_unit_of_another_case_is_refused(written) -> None:
    cases = Path(__file__).parents[2] / "cases"
    result = ls.solve(cases / "planetary" / "four_planets.toml")
    with pytest.raises(CaseError, match="has no mesh of this case"):
        export_rexs(result, written(xml(*planetary())))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "not valid XML"),
        (b"<model/>", "no components"),
        (b"<html/>", "first element is html"),
        (b'{"model": 3}', "no model"),
        (b"{", "not valid JSON"),
        (b"PK\x03\x04junk", "damaged archive"),
        (b'<!DOCTYPE a [<!ENTITY b "c">]><model>&b;</model>', "document type"),
        (b"<a>" * 1000 + b"</a>" * 1000, "nested too deeply"),
        (xml([(1, "gear_unit", "", {})], []), "no cylindrical stage"),
    ],
)
def test_what_is_no_unit_is_reported(written, content, message) -> None:
    with pytest.raises(CaseError) as caught:
        import_rexs(written(content))
    assert message in str(caught.value)


def test_a_carriers_bearing_keeps_its_clearance(written) -> None:
    components, relations = planetary()
    bearing = {"radial_stiffness": (2e9, "N / m"), "radial_clearance": (60.0, "mum")}
    bearing |= {"misalignment_in_w_direction": (7.0, "mum")}
    components.append((400, "concept_bearing", "", bearing))
    relations.append(("side", {"assembly": 400, "inner_part": 4, "outer_part": 2}))
    case = import_rexs(written(xml(components, relations))).case()
    assert case.bearings["carrier_3"].clearance.si == pytest.approx(30e-6)
    assert case.bearings["carrier_3"].stiffness.si == pytest.approx(2e9)
    assert case.errors["carrier_3"].installation[2].si == pytest.approx(7e-6)


def test_places_derived_from_other_components_are_reported(written) -> None:
    components, relations = two_stages()
    moved = [
        (i, kind, name, a | {"reference_component_for_position": (11, "none")} if i == 22 else a)
        for i, kind, name, a in components
    ]
    found = import_rexs(written(xml(moved, relations)))
    assert found.data["gears"]["gear_22"]["centre"][1] == "120 mm"
    assert any("taken from other components" in line for line in found.assumed)


@pytest.mark.parametrize("packed", [zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_damaged_archives_are_reported_or_read(written, tmp_path, packed) -> None:
    with zipfile.ZipFile(tmp_path / "good.rexsz", "w", packed) as archive:
        archive.writestr("unit.rexs", xml(*planetary()))
    good, dice = (tmp_path / "good.rexsz").read_bytes(), random.Random(3)
    for _ in range(150):
        path = written(mutated(good, dice), "unit.rexsz")
        try:
            import_rexs(path)
        except CaseError:
            continue


def test_what_is_odd_in_a_file_is_no_hindrance_to_writing_back(written) -> None:
    held = json.loads(rexsj(*planetary(), "2.0"))
    held["model"]["components"] += [3, {"id": 900, "attributes": "none"}, {"id": 901}]
    held["model"]["components"][0]["attributes"].append({"id": {}})
    held["model"]["about"] = math.nan
    unit = written(json.dumps(held).encode(), "odd.rexsj")
    result = ls.solve(import_rexs(unit).case())
    assert "mesh_load_factor_iso_6336_2019" in export_rexs(result, unit)


def test_what_a_unit_lacks_is_reported_all_at_once(written) -> None:
    components, relations = two_stages()
    poorer = [
        (i, kind, name, {k: v for k, v in a.items() if k not in dropped})
        for i, kind, name, a in components
        for dropped in [
            {
                20: ("number_of_teeth",),
                23: ("support_vector",),
                12: ("support_vector",),
                30: ("torque_around_u_axis",),
            }.get(i, ())
        ]
    ]
    with pytest.raises(CaseError) as caught:
        import_rexs(written(xml(poorer, relations)))
    message = str(caught.value)
    assert "cylindrical_gear 20: has no number_of_teeth" in message
    assert "cylindrical_gear 23: has no place" in message
    assert "torque_around_u_axis" in message


def mutated(content: bytes, dice: random.Random) -> bytes:
    """Change a few bytes, drop or repeat a piece, or replace numbers by other values."""
    data = bytearray(content)
    for _ in range(dice.randint(1, 4)):
        kind, here = dice.randrange(4), dice.randrange(len(data))
        if kind == 0:
            data[here] = dice.randrange(256)
        elif kind == 1:
            del data[here : here + dice.randint(1, 200)]
        elif kind == 2:
            there = dice.randrange(len(data))
            data[here:here] = data[there : there + dice.randint(1, 200)]
        else:
            values = (b"1e308", b"-1", b"0", b"nan", b"inf", b"true", b"1e-320", b"", b"9" * 400)
            word = dice.choice([b"4.0", b"17", b"125.0", b"1e9", b"1000000000.0", b"0.0", b"61"])
            at = data.find(word, here)
            if at >= 0:
                data[at : at + len(word)] = dice.choice(values)
        if not data:
            data = bytearray(b" ")
    return bytes(data)


@pytest.mark.parametrize("start", range(4))
def test_changed_files_are_reported_or_solved(written, start) -> None:
    """Any change of a file ends in a case, a list of problems, or a refusal."""
    forms = [
        xml(*planetary()),
        rexsj(*planetary(), "2.0"),
        xml(*two_stages()),
        rexsj(*two_stages(), "1.4"),
    ]
    dice = random.Random(start)
    outcomes = set()
    for _ in range(60):
        path = written(mutated(dice.choice(forms), dice))
        try:
            case = import_rexs(path).case()
        except CaseError:
            outcomes.add("reported")
            continue
        try:
            result = ls.solve(case)
            import_rexs(written(export_rexs(result, path).encode(), "copy"))
            outcomes.add("solved")
        except Refused:
            outcomes.add("refused")
    assert {"reported", "solved"} <= outcomes
