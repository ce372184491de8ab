"""Radial support by REXS bearings and couplings: which parts, their stiffness, and their places."""

from __future__ import annotations

import pytest
from tests.exchange.units import (
    at,
    bearing,
    changed,
    joint,
    planetary,
    two_stages,
    xml,
)

import loadshare as ls
from loadshare.exchange.rexs import export_rexs, import_rexs
from loadshare.exchange.rexs.reading import read_model

MM, NONE, STIFFNESS = "mm", "none", "N / m"


def with_joints(parts, *joints):
    """Return a unit with more bearings or couplings: type, attributes, inner and outer part."""
    components, relations = parts
    for number, (kind, attributes, inner, outer) in enumerate(joints, 500):
        components = [*components, (number, kind, "", attributes)]
        relations = [*relations, joint(number, inner, outer)]
    return components, relations


def test_a_bearing_between_shafts_that_turn_holds_neither(written) -> None:
    """The sun has a bearing in the carrier, the carrier one in the casing: only that supports."""
    parts = with_joints(
        planetary(),
        ("concept_bearing", bearing(1e8), 34, 4),
        ("concept_bearing", bearing(1e7), 4, 2),
    )
    unit = written(xml(*parts))
    found = import_rexs(unit)
    case = found.case()
    assert case.gears["gear_53"].support == "free"
    assert case.gears["carrier_3"].support.si == pytest.approx(1e7)
    assert any("concept_bearing 500" in line for line in found.left_out)
    written_back = read_model(written(export_rexs(ls.solve(case), unit).encode(), "copy.rexs"))
    assert "force_acting_on_inner_component_v" not in written_back.components["500"].attributes
    assert "force_acting_on_inner_component_v" in written_back.components["501"].attributes


def test_a_gear_on_a_fixed_axle_is_held_by_the_seats_of_the_axle(written) -> None:
    """Wheel 23 turns on bearings on an axle in the casing: both yield in series."""
    parts = with_joints(
        two_stages(),
        ("concept_bearing", bearing(4e8, 10.0), 99, 12),
        ("concept_bearing", bearing(4e8, 240.0), 99, 12),
        ("coupling", bearing(1e8, 0.0), 99, 2),
        ("coupling", bearing(1e8, 250.0), 99, 2),
    )
    components, relations = parts
    components.append((99, "shaft", "axle", at(0.0, 140.0, 0.0)))
    relations = [r for r in relations if r[1].get("assembly") != 63]
    case = import_rexs(written(xml(components, relations))).case()
    # All are in the middle, so two of each share the force.
    assert case.gears["gear_23"].support.si == pytest.approx(1.0 / (1.0 / 8e8 + 1.0 / 2e8))


def seated(stiffness: float, *places: float):
    """Return a planetary set whose pins are in side plates at given places along them [mm]."""
    components, relations = planetary()
    components = [*components, (67, "side_plate", "", at(125.0, 0.0, 0.0))]
    joints = [
        ("coupling", bearing(stiffness, place), pin, 67)
        for pin in (235, 236, 237)
        for place in places
    ]
    return with_joints((components, relations), *joints)


@pytest.mark.parametrize(("places", "both"), [((0.0,), 1e8), ((-20.0, 20.0), 2e8)])
def test_the_seats_of_a_pin_yield_with_its_bearings(written, places, both) -> None:
    found = import_rexs(written(xml(*seated(1e8, *places))))
    gear = found.case().gears["gear_248"]
    assert gear.support.si == pytest.approx(1.0 / (1.0 / 1e9 + 1.0 / both))
    assert not any("coupling" in line for line in found.left_out)


def test_pins_without_seats_are_rigid_and_that_is_reported(written) -> None:
    found = import_rexs(written(xml(*planetary())))
    assert found.case().gears["gear_248"].support.si == pytest.approx(1e9)
    assert any("pins" in line for line in found.assumed)


@pytest.mark.parametrize("held", [3, 53, 58])
def test_a_bearing_on_no_shaft_is_told_so(written, held) -> None:
    """On a carrier or a gear itself; that it holds neither would be false."""
    parts = with_joints(planetary(), ("concept_bearing", bearing(1e8), held, 2))
    left = import_rexs(written(xml(*parts))).left_out
    assert "concept_bearing 500: none of its sides is a shaft" in left


@pytest.mark.parametrize("bearer", [2, 236])
def test_a_planet_that_is_held_in_the_casing_is_reported(written, bearer) -> None:
    components, relations = planetary()
    relations = [joint(301, bearer, 230) if r[1].get("assembly") == 301 else r for r in relations]
    found = import_rexs(written(xml(components, relations)))
    assert found.case().gears["gear_248"].support.si == pytest.approx(1e9)
    said = "gear_248: its supports in the casing are assumed to be on its carrier"
    assert (said in found.assumed) is (bearer == 2)


@pytest.mark.parametrize(
    ("attributes", "why"),
    [
        ({"radial_force_absorption": (False, NONE)}, "no load"),
        (
            {"radial_force_absorption": (False, NONE), "radial_stiffness": (1e9, STIFFNESS)},
            "no load",
        ),
        ({"radial_stiffness": (0.0, STIFFNESS)}, "no load"),
    ],
)
def test_a_bearing_that_bears_no_radial_load_holds_nothing(written, attributes, why) -> None:
    plain = import_rexs(written(xml(*two_stages()))).case()
    parts = with_joints(two_stages(), ("concept_bearing", attributes, 11, 2))
    found = import_rexs(written(xml(*parts)))
    assert found.case().gears["gear_22"].support == plain.gears["gear_22"].support
    assert any(line.startswith("concept_bearing 500") and why in line for line in found.left_out)


def test_only_a_stiffness_that_is_not_given_is_assumed(written) -> None:
    parts = with_joints(
        two_stages(), ("concept_bearing", bearing(1e8) | {"radial_stiffness": None}, 11, 2)
    )
    found = import_rexs(written(xml(*changed(parts))))
    assert any("concept_bearing 500" in line and "rigid" in line for line in found.assumed)


def test_a_coupling_that_is_stiff_across_the_axis_holds_a_ring(written) -> None:
    """Two brakes of a ring in the casing, as calculation programs write them."""
    parts = changed(planetary(), _65=bearing(3e8, 0.0))
    case = import_rexs(written(xml(*parts))).case()
    assert case.gears["gear_58"].support.si == pytest.approx(3e8)


@pytest.mark.parametrize(
    ("given", "clearance"),
    [
        ({"radial_backlash": 60.0}, 30e-6),
        ({"radial_bearing_clearance": 60.0}, 30e-6),
        ({"mounted_radial_bearing_clearance": 40.0, "radial_bearing_clearance": 60.0}, 20e-6),
        ({"operating_radial_bearing_clearance": 20.0, "radial_bearing_clearance": 60.0}, 10e-6),
    ],
)
def test_clearances_have_the_names_of_all_versions(written, given, clearance) -> None:
    values = {key: (value, "mum") for key, value in given.items()}
    parts = changed(two_stages(), _63={"radial_clearance": None, **values})
    case = import_rexs(written(xml(*parts))).case()
    assert case.bearings["gear_23"].clearance.si == pytest.approx(clearance)


def test_an_offset_bearing_tilts_its_shaft(written) -> None:
    """Bearings at 0 and 200 mm, the first offset by 8 um: 7 um at 25 mm and 3 um at 125 mm."""
    parts = changed(two_stages(), _61={"misalignment_in_v_direction": (8.0, "mum")})
    case = import_rexs(written(xml(*parts))).case()
    for gear, moved in (("gear_21", 7e-6), ("gear_22", 3e-6)):
        along = [v.si for v in case.errors[gear].installation]
        assert along == pytest.approx([0.0, moved, 0.0])


def test_the_axes_of_a_bearing_are_its_shafts_if_it_gives_none(written) -> None:
    """A shaft along z with w = x has v = -y."""
    components, relations = two_stages()
    shaft = {"u_axis_vector": ([0.0, 0.0, 1.0], MM), "w_axis_vector": ([1.0, 0.0, 0.0], MM)}
    off = {
        "misalignment_in_v_direction": (10.0, "mum"),
        "misalignment_in_w_direction": (20.0, "mum"),
    }
    turned = {}
    for id_, *_, attributes in components:
        if "support_vector" in attributes:
            (x, y, z), unit = attributes["support_vector"]
            turned[f"_{id_}"] = {"support_vector": ([z, y, x], unit), **shaft}
    parts = changed((components, relations), **turned, _60=off)
    case = import_rexs(written(xml(*parts))).case()
    moved = [v.si for v in case.errors["gear_20"].installation]
    assert moved == pytest.approx([20e-6, -10e-6, 0.0])
