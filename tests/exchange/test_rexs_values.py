"""Values of REXS files: units, arrays, loads, and open couplings."""

from __future__ import annotations

import json
import zipfile

import pytest
from tests.exchange.units import at, changed, joint, planetary, rexsj, two_pinions, two_stages, xml

import loadshare as ls
from loadshare.errors import CaseError
from loadshare.exchange.rexs import import_rexs

MM, NONE = "mm", "none"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"_20": {"helix_angle_reference_diameter": (12.0, "grad")}},
            "= 12 grad: is in a unit that is not known",
        ),
        ({"_20": {"helix_angle_reference_diameter": (12.0, MM)}}, "deg, °, rad"),
        ({"_61": {"radial_stiffness": (1e8, "N / furlong")}}, "N / m"),
        ({"_20": {"normal_module": (2.0, NONE)}}, "normal_module = 2: has no unit"),
        ({"_20": {"normal_module": ("two", MM)}}, "normal_module = two mm: is not a number"),
        ({"_20": {"number_of_teeth": (20, MM)}}, "number_of_teeth = 20 mm"),
        ({"_61": {"radial_stiffness": (-1e8, "N / m")}}, "is less than zero"),
        ({"_50": {"length": (1e300, MM)}}, "is not a number of a usable size"),
        ({"_11": {"support_vector": ([1.0, 2.0], MM)}}, "is not three numbers"),
    ],
)
@pytest.mark.parametrize("form", ["xml", "json"])
def test_what_is_no_number_in_a_unit_of_its_kind_is_refused(
    written, form, changes, message
) -> None:
    parts = changed(two_stages(), **changes)
    content = xml(*parts) if form == "xml" else rexsj(*parts, "2.0")
    with pytest.raises(CaseError) as caught:
        import_rexs(written(content))
    assert message in str(caught.value)
    assert len(caught.value.problems) == 1


@pytest.mark.parametrize(
    ("unit", "value"), [("N / mum", 1e2), ("N/mum", 1e2), ("kN / mm", 1e2), ("N / mm", 1e5)]
)
def test_stiffnesses_are_read_in_units_of_all_spellings(written, unit, value) -> None:
    parts = changed(two_stages(), _61={"radial_stiffness": (value, unit)})
    plain = import_rexs(written(xml(*two_stages()))).data["gears"]
    assert import_rexs(written(xml(*parts))).data["gears"] == plain


@pytest.mark.parametrize("unit", ["kNm", "kN m", "kN*m"])
def test_kilonewton_metres_are_torques(written, unit) -> None:
    parts = changed(two_stages(), _30={"torque_around_u_axis": (0.1, unit)})
    assert import_rexs(written(xml(*parts))).case().operating.torque.si == pytest.approx(100.0)


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (4.724562306435156, "N m", "4.724562306435156 N*m"),
        (0.3, "kN m", "300 N*m"),
        (0.1234567890123456, "N m", "0.1234567890123456 N*m"),
    ],
)
def test_a_torque_keeps_all_its_digits(written, value, unit, text) -> None:
    """Nor does it get any round-off from its unit."""
    parts = changed(two_stages(), _30={"torque_around_u_axis": (value, unit)})
    assert import_rexs(written(xml(*parts))).data["operating"]["torque"] == text


def test_an_empty_unit_is_none(written) -> None:
    text = xml(*two_stages()).decode()
    plain = import_rexs(written(text.encode())).data
    assert import_rexs(written(text.replace('unit="none"', 'unit=""').encode())).data == plain
    held = json.loads(rexsj(*two_stages(), "1.1"))
    for component in held["model"]["components"]:
        for attribute in component["attributes"]:
            attribute["unit"] = None if attribute["unit"] == NONE else attribute["unit"]
    assert import_rexs(written(json.dumps(held).encode())).data["gears"] == plain["gears"]


def test_a_file_in_an_archive_may_have_its_ending_in_capitals(written, tmp_path) -> None:
    with zipfile.ZipFile(tmp_path / "unit.rexsz", "w") as archive:
        archive.writestr("Z.REXS", xml(*two_stages()))
    assert import_rexs(tmp_path / "unit.rexsz").case().gears


# Couplings ----------------------------------------------------------------------------------------


def shifted(engaged: list[bool], **unit: object):
    """Return a planetary set whose brake is engaged in some gears."""
    parts = changed(planetary(), _65={"is_engaged": (engaged, NONE)})
    return changed(parts, _1={key: (value, NONE) for key, value in unit.items()})


@pytest.mark.parametrize("form", ["xml", "json"])
@pytest.mark.parametrize(
    ("engaged", "unit", "held"),
    [
        ([True], {}, True),
        ([False], {}, False),
        ([False, True], {"gear_shift_index": 2}, True),
        ([False, True], {"gear_shift_index": 1}, False),
        ([True, False], {}, True),
    ],
)
def test_a_brake_is_engaged_as_in_the_gear_of_the_unit(written, form, engaged, unit, held) -> None:
    parts = shifted(engaged, **unit)
    content = xml(*parts) if form == "xml" else rexsj(*parts, "1.4")
    if form == "json":
        content = content.replace(b'floating_point_array": [true', b'boolean_array": [true')
    found = import_rexs(written(content))
    assert found.data["gears"]["gear_58"].get("held", False) is held
    assert any("open" in line for line in found.left_out) is not held
    assert any("engaged as in gear" in line for line in found.assumed) is (len(engaged) > 1)


def test_a_key_beside_the_value_of_an_attribute_is_not_its_value(written) -> None:
    plain = rexsj(*planetary(), "1.4")
    noted = plain.replace(b'"unit": ', b'"comment": "measured", "unit": ')
    assert noted != plain
    one, other = (import_rexs(written(content)) for content in (plain, noted))
    assert other.data == one.data


def test_a_gear_for_which_a_coupling_says_nothing_is_refused(written) -> None:
    with pytest.raises(
        CaseError, match="is for 2 gears, but gear_shift_index of the gear unit is 7"
    ):
        import_rexs(written(xml(*shifted([True, False], gear_shift_index=7))))


@pytest.mark.parametrize(
    ("part", "name", "value"),
    [
        (62, "radial_force_absorption", 0),
        (62, "radial_force_absorption", "no"),
        (31, "transmits_torque", 0),
        (30, "defines_torque", [True, False]),
        (70, "is_engaged", 1),
        (70, "is_engaged", [1, 0]),
    ],
)
def test_what_is_neither_true_nor_false_is_refused(written, part, name, value) -> None:
    """A bearing that absorbs no force by the word of a ``0`` used to hold its shaft."""
    components, relations = two_stages()
    unit = [*components, (70, "coupling", "", {})], [*relations, joint(70, 10, 11)]
    with pytest.raises(CaseError, match=rf"{part}, {name} = .*: is neither true nor false"):
        import_rexs(written(xml(*changed(unit, **{f"_{part}": {name: (value, NONE)}}))))


def test_true_and_false_may_be_texts(written) -> None:
    unit = changed(two_stages(), _62={"radial_force_absorption": ("False", NONE)})
    found = import_rexs(written(rexsj(*unit, "1.4")))
    assert any("62: it takes no load across the axis" in line for line in found.left_out)


@pytest.mark.parametrize("name", ["u_axis_vector", "w_axis_vector", "support_vector"])
@pytest.mark.parametrize("form", ["words", "base64", "code"])
def test_an_array_that_cannot_be_read_is_not_one_that_is_missing(written, name, form) -> None:
    """Directions used to be assumed as if the file gave none."""
    unit = changed(two_stages(), _21={name: ([1.0, 2.0, 3.0], MM)})
    content = xml(*unit, coded=form != "words")
    at = content.index(f'id="{name}"'.encode(), content.index(b'component id="21"'))
    old, new = {
        "words": (b"2.0</c>", b"two</c>"),
        "base64": (b"AAAA", b"AAA"),
        "code": (b"float64", b"float16"),
    }[form]
    content = content[:at] + content[at:].replace(old, new, 1)
    with pytest.raises(CaseError, match=rf"gear 21, {name} = .*: is not"):
        import_rexs(written(content))


def test_a_coupling_that_resists_no_twist_joins_nothing(written) -> None:
    parts = changed(two_pinions(), _70={"rotational_stiffness": (0.0, "N mm / rad")})
    found = import_rexs(written(xml(*parts)))
    assert set(found.data["shafts"]) == {"gear_24-gear_25", "gear_26-gear_27"}
    assert any("coupling 70 (flange): its torsional stiffness is zero" in s for s in found.left_out)


def test_what_couplings_do_that_a_case_does_not_have_is_listed(written) -> None:
    components, relations = two_stages()
    components += [
        (98, "shaft", "without gears", at(0.0, 0.0, 0.0)),
        (70, "coupling", "", {"rotational_stiffness": (1e6, "N mm / rad")}),
        (71, "coupling", "", {}),
        (72, "involute_spline_connection", "", {"maximum_normal_backlash": (0.1, MM)}),
        (73, "coupling", "", {"radial_backlash": (40.0, "mum")}),
    ]
    relations += [joint(70, 10, 98), joint(72, 12, 2), joint(73, 12, 2)]
    left = import_rexs(written(xml(components, relations))).left_out
    for id_, why in (
        ("70", "neither holds nor joins"),
        ("71", "joins nothing"),
        ("72", "its backlash"),
        ("73", "its backlash"),
    ):
        assert any(f" {id_}: " in line and why in line for line in left)


def test_a_rigid_coupling_of_shafts_that_ties_them_across_the_axis_is_listed(written) -> None:
    parts = changed(two_pinions(), _70={"radial_stiffness": (1e23, "N / m")})
    left = import_rexs(written(xml(*parts))).left_out
    assert any("coupling 70 (flange): its stiffness across" in line for line in left)


def test_a_coupling_between_two_gears_counts_at_the_nearest(written) -> None:
    parts = changed(two_pinions(), _70={"u_coordinate_on_shaft_outer_side": (120.0, MM)})
    found = import_rexs(written(xml(*parts)))
    assert "gear_21-gear_25" in found.data["shafts"]
    assert any("between two bodies" in line for line in found.assumed)


# Loads --------------------------------------------------------------------------------------------


def loaded(shaft: int, **attributes: object):
    """Return two stages with one more load."""
    components, relations = two_stages()
    components.append((32, "external_load", "more", attributes))
    relations.append(("assembly", {"assembly": shaft, "part": 32}))
    return components, relations


def test_loads_on_one_shaft_are_added(written) -> None:
    found = import_rexs(written(xml(*loaded(10, torque_around_u_axis=(-50.0, "N m")))))
    case = found.case()
    assert case.operating.torque.si == pytest.approx(150.0)
    assert any("the sum of the torques" in line for line in found.assumed)
    assert ls.solve(case).positions[0].loads.gears["gear_23"] == pytest.approx(900.0, rel=1e-9)


def test_loads_that_balance_are_refused(written) -> None:
    with pytest.raises(CaseError, match="no torque is left"):
        import_rexs(written(xml(*loaded(10, torque_around_u_axis=(100.0, "N m")))))


def test_a_load_without_torque_on_a_third_shaft_is_left_out_and_two_on_the_output_are_not(
    written,
) -> None:
    third = import_rexs(written(xml(*loaded(11, force_v_direction=(-20.0, "N"))))).left_out
    assert any("external_load 32" in line for line in third)
    turns = import_rexs(written(xml(*loaded(11, torque_around_u_axis=(-20.0, "N m"))))).case()
    taken = ls.solve(turns).positions[0].loads.gears["gear_23"]
    assert abs(taken) == pytest.approx(3.0 * (200.0 - 20.0), rel=1e-9)
    both = import_rexs(written(xml(*loaded(12, torque_around_u_axis=(-20.0, "N m"))))).left_out
    assert not any("external_load" in line for line in both)


def test_loads_on_both_shafts_of_a_carrier_are_on_one_body(written) -> None:
    """A load on the carrier's second shaft is not the output for one on its first."""
    components, relations = planetary()
    components += [
        (6, "shaft", "", at(150.0, 0.0, 0.0)),
        (39, "external_load", "", {"torque_around_u_axis": (500.0, "N m")}),
    ]
    parts = changed((components, relations), _61={"torque_around_u_axis": (700.0, "N m")})
    parts = changed(parts, _38={"torque_around_u_axis": None, "defines_torque": None})
    relations = [
        *relations,
        ("assembly", {"assembly": 3, "part": 6}),
        ("assembly", {"assembly": 6, "part": 39}),
    ]
    operating = import_rexs(written(xml(parts[0], relations))).data["operating"]
    assert (operating["input"], operating["output"]) == ("carrier_3", "gear_53")
    assert operating["torque"] == "1200 N*m"


def test_forces_of_loads_and_loads_beside_the_gears_are_listed(written) -> None:
    components, relations = loaded(98, torque_around_u_axis=(5.0, "N m"))
    components.append((98, "shaft", "without gears", at(0.0, 0.0, 0.0)))
    parts = changed((components, relations), _31={"force_v_direction": (20000.0, "N")})
    left = import_rexs(written(xml(*parts))).left_out
    assert any("external_load 31" in line and "force" in line for line in left)
    assert any("external_load 32" in line and "no shaft" in line for line in left)


def test_a_carriers_shaft_may_be_known_by_its_stage_alone(written) -> None:
    """The carrier's own relation to its shaft is missing."""
    components, relations = planetary()
    relations = [r for r in relations if r[1] != {"assembly": 3, "part": 4}]
    by_stage = ("planet_carrier_shaft", {"planetary_stage": 9, "shaft": 4})
    plain = import_rexs(written(xml(*planetary()))).data
    assert import_rexs(written(xml(components, [*relations, by_stage]))).data == plain


def test_planets_may_sit_in_a_shaft_that_is_part_of_their_carrier(written) -> None:
    """Without pins: a shaft that supports several planets belongs to the carrier in any case."""
    components, relations = planetary()
    seated = [
        (kind, {**roles, "inner_part": 4} if roles.get("inner_part") in (235, 236, 237) else roles)
        for kind, roles in relations
        if kind != "planet_pin" and roles.get("part") not in (235, 236, 237)
    ]
    components = [c for c in components if c[0] not in (235, 236, 237)]
    by_stage = ("planet_carrier_shaft", {"planetary_stage": 9, "shaft": 4})
    found = import_rexs(written(xml(components, seated))).data
    assert found == import_rexs(written(xml(components, [*seated, by_stage]))).data
    assert found["operating"]["output"] == "carrier_3"


def test_what_is_taken_for_the_width_of_a_mesh_is_listed(written) -> None:
    """If the file gives another width, or none."""
    density = {
        "mesh_stiffness_for_load_distribution_along_face_width": (20.0, "N / (mm mum)"),
        "common_face_width": None,
    }
    for changes, line in (
        ({"common_face_width": (30.0, "mm")}, "not over the common_face_width of 30 mm"),
        ({"common_face_width": (50.0, "mm")}, None),
        (density, "carries load over all of the narrower face, 50 mm"),
    ):
        found = import_rexs(written(xml(*changed(two_stages(), _40=changes)))).assumed
        lines = [one for one in found if one.startswith("mesh gear_20-gear_21: carries")]
        assert [one.endswith(line or "") for one in lines] == ([True] if line else []), changes


def test_a_negative_module_is_refused(written) -> None:
    parts = changed(two_stages(), _21={"normal_module": (-2.0, "mm")})
    with pytest.raises(CaseError, match="gear 21, normal_module = -2 mm: is negative"):
        import_rexs(written(xml(*parts)))
