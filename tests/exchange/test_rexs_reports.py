"""Reports on what the import of REXS files assumes, leaves out or refuses."""

from __future__ import annotations

import math

import pytest
from tests.exchange.units import (
    changed,
    joint,
    planetary,
    section,
    teeth,
    two_pinions,
    two_stages,
    xml,
)

from loadshare.errors import CaseError
from loadshare.exchange.rexs import import_rexs

MM, NONE, MODULUS = "mm", "none", "N / mm^2"


def made_of(part: int, **material: object):
    """Return two stages; one part has a material."""
    components, relations = two_stages()
    components.append((88, "material", "", material))
    return components, [*relations, ("reference", {"origin": part, "referenced": 88})]


@pytest.mark.parametrize(
    ("material", "shear", "word"),
    [
        (None, 79.3e9, "no material is given"),
        ({}, 79.3e9, "gives no modulus"),
        ({"elastic_modulus": (70000.0, MODULUS)}, 70e9 / 2.6, "0.3 is assumed"),
        (
            {"elastic_modulus": (70000.0, MODULUS), "poisson_ratio": (0.33, NONE)},
            70e9 / 2.66,
            None,
        ),
    ],
)
@pytest.mark.parametrize("part", [11, 50])
def test_a_shear_modulus_that_is_assumed_is_reported(written, part, material, shear, word) -> None:
    """It is that of a shaft's material, or its section's."""
    parts = two_stages() if material is None else made_of(part, **material)
    found = import_rexs(written(xml(*parts)))
    polar = math.pi / 32.0 * (0.04**4 - 0.02**4)
    stiffness = found.case().shafts["gear_21-gear_22"].stiffness.si
    assert stiffness == pytest.approx(shear * polar / 0.1)
    notes = [line for line in found.assumed if "shaft gear_21-gear_22" in line]
    assert notes == [] if word is None else word in notes[0]
    assert not any("material" in line for line in found.left_out)


@pytest.mark.parametrize(("modulus", "reported"), [(70000.0, True), (210000.0, False)])
def test_a_gear_that_is_not_of_steel_is_reported(written, modulus, reported) -> None:
    found = import_rexs(written(xml(*made_of(20, elastic_modulus=(modulus, MODULUS)))))
    assert any("gear_20: treated as steel" in line for line in found.assumed) is reported


def flanked(left: dict, right: dict):
    """Return two stages whose gear 20 has two flanks."""
    components, relations = two_stages()
    components += [(901, "flank_geometry", "", left), (902, "flank_geometry", "", right)]
    return components, [*relations, ("flank", {"gear": 20, "left": 901, "right": 902})]


@pytest.mark.parametrize(
    ("name", "left", "right"),
    [
        ("normal_pressure_angle", (20.0, "deg"), (25.0, "deg")),
        ("profile_shift_coefficient", (0.1, NONE), (0.2, NONE)),
    ],
)
def test_flanks_that_differ_are_reported(written, name, left, right) -> None:
    for other, reported in ((right, True), (left, False)):
        found = import_rexs(written(xml(*flanked({name: left}, {name: other}))))
        assert any(f"gear_20: {name}" in line for line in found.assumed) is reported


@pytest.mark.parametrize(
    ("second", "rigid", "why"),
    [
        (section(200.0, 40.0), True, "overlap"),
        (section(90.0, 40.0) | {"u_coordinate_on_shaft": (60.0, MM)}, True, "overlap"),
        (section(90.0, 40.0) | {"u_coordinate_on_shaft": (110.0, MM)}, True, "cover"),
        (section(90.0, 40.0) | {"u_coordinate_on_shaft": (100.0, MM)}, False, "steel"),
    ],
)
def test_sections_that_overlap_do_not_say_what_the_shaft_is(written, second, rigid, why) -> None:
    """The first covers the shaft up to 100 mm; the gears are at 25 and 125 mm."""
    components, relations = changed(two_stages(), _50=section(100.0, 40.0))
    components.append((51, "shaft_section", "", second))
    relations = [*relations, ("assembly", {"assembly": 11, "part": 51})]
    found = import_rexs(written(xml(components, relations)))
    assert (found.case().shafts["gear_21-gear_22"].stiffness == "rigid") is rigid
    assert any("shaft gear_21-gear_22" in line and why in line for line in found.assumed)


def test_a_coupling_or_load_without_a_place_is_reported(written) -> None:
    nowhere = {f"u_coordinate_on_shaft_{side}_side": None for side in ("inner", "outer")}
    found = import_rexs(written(xml(*changed(two_pinions(), _70=nowhere)))).assumed
    assert any("coupling 70 (flange): at the start of shaft 14 (pinions)" in s for s in found)
    assert any("external_load 31: at the start of shaft 15 (out)" in s for s in found)
    # The shaft of load 30 has only one gear, and nothing that twists.
    assert not any("external_load 30" in s for s in found)
    found = import_rexs(written(xml(*two_pinions()))).assumed
    assert not any("coupling 70 (flange): at the start" in s for s in found)


def test_a_gear_has_whole_teeth_and_one_shaft(written) -> None:
    components, relations = changed(two_stages(), _20={"number_of_teeth": (20.4, NONE)})
    relations = [*relations, ("assembly", {"assembly": 12, "part": 22})]
    with pytest.raises(CaseError) as caught:
        import_rexs(written(xml(components, relations)))
    message = str(caught.value)
    assert "cylindrical_gear 20, number_of_teeth = 20.4: is not a whole number" in message
    assert "cylindrical_gear 22: is on 2 shafts: 11, 12" in message


def test_preload_is_no_clearance(written) -> None:
    """The mean clearance of bearings with 40 um and with -20 um is 20 um."""
    parts = changed(
        two_stages(),
        _61={"radial_clearance": (40.0, "mum")},
        _62={"radial_clearance": (-20.0, "mum")},
    )
    found = import_rexs(written(xml(*parts)))
    assert found.case().bearings["gear_21"].clearance.si == pytest.approx(10e-6)
    assert any("concept_bearing 62" in line and "-20 um" in line for line in found.assumed)


def test_what_would_matter_and_is_not_read_is_listed(written) -> None:
    parts = changed(
        two_stages(),
        _20={"runout_deviation_iso_1328_2013": (30.0, "mum")},
        _21=teeth(40, 2.0),
        _40={"maximum_normal_backlash": (0.3, MM)},
        _41={"maximum_normal_backlash": (0.0, MM)},
        _60={"angular_misalignment_around_v_axis": (0.1, "deg")},
    )
    components = [*parts[0], (91, "stage_gear_data", "", {})]
    left = import_rexs(written(xml(components, parts[1]))).left_out
    for line in (
        "maximum_normal_backlash of 1 cylindrical_stage",
        "runout_deviation_iso_1328_2013 of 1 cylindrical_gear",
        "angular_misalignment_around_v_axis of 1 concept_bearing",
        "1 stage_gear_data",
    ):
        assert line in left


@pytest.mark.parametrize(
    ("left", "why"),
    [
        ({"outer_diameter_end": None}, "the outer diameter of a section is that of the one end"),
        ({"inner_diameter_begin": None}, "the inner diameter of a section is that of the one end"),
    ],
)
def test_a_section_with_one_diameter_is_a_cylinder(written, left, why) -> None:
    stiffness = {}
    for given in ({}, left):
        found = import_rexs(written(xml(*changed(two_stages(), _50=given))))
        shaft = found.case().shafts["gear_21-gear_22"]
        stiffness[bool(given)] = shaft.stiffness.si
        assert any(why in line for line in found.assumed) is bool(given)
    assert stiffness[True] == pytest.approx(stiffness[False])


def test_what_gears_and_speeds_do_not_give_is_reported(written) -> None:
    left = {"helix_angle_reference_diameter": None}
    found = import_rexs(written(xml(*changed(two_stages(), _20=left)))).assumed
    for why in ("gear_20: no helix angle", "no speed is given"):
        assert any(why in line for line in found)


@pytest.mark.parametrize("version", ["1.0", "1.7", "1.1.0", "2.0.0", "2.0"])
def test_a_known_version_is_nothing_to_report(written, version) -> None:
    assert not any(
        "version" in s for s in import_rexs(written(xml(*two_stages(), version))).assumed
    )


@pytest.mark.parametrize("version", ["9.7", "1.71", "latest", ""])
def test_an_unknown_version_is_reported(written, version) -> None:
    found = import_rexs(written(xml(*two_stages(), version))).assumed
    assert any(
        (version or "no version") in s and "read as a version from 1.1 to 2.0" in s for s in found
    )


def test_a_relation_that_is_given_twice_counts_once(written) -> None:
    """Twice, it used to double torques and stiffnesses, and made sections overlap."""
    components, relations = two_stages()
    once, twice = (
        import_rexs(written(xml(components, given), name))
        for given, name in ((relations, "unit.rexs"), (relations + relations, "twice.rexs"))
    )
    about = ("title", "source")
    assert {k: v for k, v in twice.data.items() if k not in about} == {
        k: v for k, v in once.data.items() if k not in about
    }
    assert any(f"{len(relations)} left out" in line for line in twice.assumed)
    assert not any("more than once" in line for line in once.assumed)


def test_two_gears_mesh_in_one_stage(written) -> None:
    """A second stage of theirs used to replace the first without a message."""
    components, relations = two_stages()
    stiff = next(c for c in components if c[0] == 41)[3]
    components.append((42, "cylindrical_stage", "", stiff))
    relations.append(("stage", {"stage": 42, "gear_1": 21, "gear_2": 20}))
    found = import_rexs(written(xml(components, relations)))
    assert found.data["meshes"]["gear_20-gear_21"] == {"law": "iso"}
    assert any("stage 42" in line and "in stage 40" in line for line in found.left_out)


@pytest.mark.parametrize("roles", [None, {"gear_2": 248}, {"gear_1": 220, "gear_2": 248}])
def test_a_stage_that_joins_no_gears_is_reported(written, roles) -> None:
    """A planet without its sun used to be imported without a message."""
    components, relations = planetary()
    at = next(k for k, (_, both) in enumerate(relations) if both.get("stage") == 212)
    relations[at : at + 1] = [("stage", {"stage": 212, **roles})] if roles else []
    found = import_rexs(written(xml(components, relations)))
    assert [line for line in found.left_out if "stage" in line] == [
        "cylindrical_stage 212: it does not join two cylindrical gears"
    ]


@pytest.mark.parametrize(
    ("relation", "why"),
    [
        (joint(63, 11, 2), "bearing 63: has 2 connections: 11 and 2, 12 and 2"),
        (joint(70, 12, 2), "coupling 70: has 2 connections: 10 and 2, 12 and 2"),
        (("assembly", {"assembly": 11, "part": 30}), "external_load 30: is on 2 shafts: 10, 11"),
        (("assembly", {"assembly": 11, "part": 20}), "gear 20: is on 2 shafts: 10, 11"),
        (
            ("reference", {"origin": 50, "referenced": 89}),
            "shaft_section 50: has 2 materials: 88, 89",
        ),
    ],
)
def test_a_part_is_in_one_place(written, relation, why) -> None:
    """A bearing held two shafts, and a torque was applied twice."""
    components, relations = two_stages()
    components += [(70, "coupling", "", {}), (88, "material", "", {}), (89, "material", "", {})]
    steel = ("reference", {"origin": 50, "referenced": 88})
    unit = components, [*relations, joint(70, 10, 2), steel, relation]
    with pytest.raises(CaseError, match=why):
        import_rexs(written(xml(*unit)))


@pytest.mark.parametrize(
    ("relation", "why"),
    [
        (
            ("assembly", {"assembly": 9, "part": 5}),
            "planetary_stage 9: has 2 planet carriers: 3, 5",
        ),
        (
            ("planet_shaft", {"planetary_stage": 10, "shaft": 229}),
            "shaft 229: is part of 2 planet carriers: 3, 5",
        ),
        (("assembly", {"assembly": 5, "part": 4}), "shaft 4: is part of 2 planet carriers: 3, 5"),
    ],
)
def test_a_part_of_a_set_is_of_one_carrier(written, relation, why) -> None:
    """The last carrier that the file named used to have it."""
    components, relations = planetary()
    components += [(5, "planet_carrier", "", {}), (10, "planetary_stage", "", {})]
    relations += [("assembly", {"assembly": 10, "part": 5}), relation]
    with pytest.raises(CaseError, match=why):
        import_rexs(written(xml(components, relations)))


def test_a_planet_shaft_may_be_in_two_sets_of_one_carrier(written) -> None:
    components, relations = planetary()
    components.append((10, "planetary_stage", "", {}))
    relations += [
        ("assembly", {"assembly": 10, "part": 3}),
        ("planet_shaft", {"planetary_stage": 10, "shaft": 229}),
    ]
    found = import_rexs(written(xml(components, relations)))
    assert found.data["gears"]["gear_247"]["carrier"] == "carrier_3"


def test_a_gear_on_no_shaft_is_reported(written) -> None:
    """It used to be held rigidly without a message; a ring in the casing is."""
    components, relations = planetary()
    free = [r for r in relations if r not in [("assembly", {"assembly": 62, "part": 58})]]
    in_casing = [*free, ("assembly", {"assembly": 2, "part": 58})]
    said = [
        [line for line in import_rexs(written(xml(components, r))).assumed if "no shaft" in line]
        for r in (relations, in_casing, free)
    ]
    assert said == [[], [], ["gear_58: it is on no shaft, and is held rigidly across its axis"]]


def test_an_id_is_that_of_one_component_of_a_load_case(written) -> None:
    """The last torque used to be taken, and that of an unknown load left out, without a message."""
    torque = [
        (id_, "external_load", "", {"torque_around_u_axis": (50.0, "N m")}) for id_ in (30, 99)
    ]
    found = import_rexs(written(xml(*two_stages(), cases=[torque])))
    assert any(line.startswith("external_load 99 of the load case") for line in found.assumed)
    with pytest.raises(CaseError, match="load case has 2 components with the id '30'"):
        import_rexs(written(xml(*two_stages(), cases=[torque[:1] * 2])))


def test_an_id_is_that_of_one_component(written) -> None:
    components, relations = two_stages()
    components.append((20, "cylindrical_gear", "other", teeth(25, 2.0)))
    with pytest.raises(CaseError, match="2 components with the id '20'"):
        import_rexs(written(xml(components, relations)))


@pytest.mark.parametrize(
    ("further", "is_read"),
    [(["2.0"], True), (["3.0"], False), (["3.0", "4.0"], False), (["two", "2.0"], False)],
)
def test_a_number_that_is_given_as_two_is_refused(written, further, is_read) -> None:
    """A third value used to be taken without a message."""
    one = b'<attribute id="normal_module" unit="mm">2.0</attribute>'
    every = one + b"".join(one.replace(b"2.0", value.encode()) for value in further)
    content = xml(*two_stages()).replace(one, every)
    if is_read:
        import_rexs(written(content))
        return
    with pytest.raises(CaseError, match=r"normal_module: is given several times.*3 more"):
        import_rexs(written(content))


@pytest.mark.parametrize("role", ["outer_part", "gear_2"])
def test_relations_to_components_that_are_missing_are_named(written, role) -> None:
    """A bearing in nothing is left out; behind a missing mesh there is no output."""
    components, relations = two_stages()
    kind, part = ("side", 61) if role == "outer_part" else ("stage", 41)
    for at, (given, roles) in enumerate(relations):
        if given == kind and part in roles.values():
            relations[at] = given, {**roles, role: 999}
    message = f"relations '{kind}': 1 left out, the file has no component '999'"
    if kind == "side":
        assert message in import_rexs(written(xml(components, relations))).left_out
        return
    with pytest.raises(CaseError, match=message):
        import_rexs(written(xml(components, relations)))


@pytest.mark.parametrize(("distance", "reported"), [(60.0, False), (61.0, True)])
def test_another_distance_than_that_of_the_axes_is_reported(written, distance, reported) -> None:
    unit = changed(two_stages(), _40={"center_distance": (distance, MM)})
    lines = import_rexs(written(xml(*unit))).assumed
    said = "mesh gear_20-gear_21: the axes of its gears are 60 mm apart, not the"
    assert any(line.startswith(said) for line in lines) is reported


@pytest.mark.parametrize(("aside", "reported"), [(0.0, False), (1.0, True)])
def test_a_gear_off_the_axis_of_its_shaft_is_reported(written, aside, reported) -> None:
    unit = changed(two_stages(), _22={"support_vector": ([125.0, 60.0, aside], MM)})
    lines = import_rexs(written(xml(*unit))).assumed
    assert any("gear_22" in line and "1 mm off the axis" in line for line in lines) is reported


@pytest.mark.parametrize(("aside", "reported"), [(0.0, False), (0.03, True)])
@pytest.mark.parametrize("part", [236, 301])
def test_a_pin_or_bearing_beside_the_axis_of_its_planet_is_reported(
    written, part, aside, reported
) -> None:
    """Files give errors of pins as places, which move no planet that has a place of its own."""
    components, relations = planetary()
    x, y, z = next(a for id_, _, _, a in components if id_ == 230)["support_vector"][0]
    unit = changed(
        (components, relations), **{f"_{part}": {"support_vector": ([x, y, z + aside], MM)}}
    )
    lines = import_rexs(written(xml(*unit))).assumed
    said = "concept_bearing 301 (planet bearing 1): it and its shafts are assumed to be on one"
    assert any(line.startswith(said) and "0.03 mm" in line for line in lines) is reported


@pytest.mark.parametrize(("speed", "reported"), [(-1000.0 / 6.0, False), (-1000.0 / 5.0, True)])
def test_another_speed_than_the_teeth_make_is_reported(written, speed, reported) -> None:
    """20 to 40 teeth and 20 to 60: the output turns like the input, at a sixth of its speed."""
    speeds = {
        f"_{id_}": {"rotational_speed": (n, "1 / min")} for id_, n in ((10, -1e3), (12, speed))
    }
    lines = import_rexs(written(xml(*changed(two_stages(), **speeds)))).assumed
    said = [line for line in lines if "the teeth give -166.667 rpm" in line]
    assert bool(said) is reported
    assert not reported or said[0].startswith("gear_23: shaft 12 (out) is given a speed of -200")


@pytest.mark.parametrize(("speed", "reported"), [(1500.0 * 17.0 / 78.0, False), (1500.0, True)])
def test_the_speed_of_a_carrier_is_compared_as_the_set_turns(written, speed, reported) -> None:
    """Sun 17, held ring 61: the carrier turns at 17/(17 + 61) of the sun's speed."""
    unit = changed(planetary(), _4={"rotational_speed": (speed, "1 / min")})
    lines = import_rexs(written(xml(*unit))).assumed
    assert any("carrier_3: shaft 4" in line and "326.923" in line for line in lines) is reported


def test_speeds_of_a_differential_are_free(written) -> None:
    """If its ring is loose, a set has two speeds: that of the carrier does not follow."""
    components, relations = changed(
        planetary(),
        _4={"rotational_speed": (400.0, "1 / min")},
        _65={"is_engaged": (False, NONE)},
    )
    torque = {"torque_around_u_axis": (1591.549 * 61.0 / 17.0, "N m")}
    components.append((39, "external_load", "ring", torque))
    relations.append(("assembly", {"assembly": 62, "part": 39}))
    found = import_rexs(written(xml(components, relations)))
    assert "held" not in found.data["gears"]["gear_58"]
    assert not any("rpm" in line for line in found.assumed)
