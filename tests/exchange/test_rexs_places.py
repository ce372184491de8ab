"""Places along shafts in REXS files: levers of bearings, and lengths that twist."""

from __future__ import annotations

import math

import numpy as np
import pytest
from tests.exchange.units import (
    along_both,
    at,
    bearing,
    changed,
    joint,
    planetary,
    section,
    teeth,
    two_pinions,
    two_stages,
    xml,
)

import loadshare as ls
from loadshare.errors import CaseError
from loadshare.exchange.rexs import export_rexs, import_rexs
from loadshare.exchange.rexs.reading import read_model

MM = "mm"
SHEAR = 79.3e9


def polar(diameter: float) -> float:
    """Return the polar moment of a solid shaft [m^4] from a diameter in mm."""
    return math.pi / 32.0 * (1e-3 * diameter) ** 4


def seen(place: float, *bearings: tuple[float, float]) -> float:
    """Return the stiffness of a beam at a place between two bearings (place, stiffness)."""
    (u, k), (v, m) = bearings
    part = (place - u) / (v - u)
    return 1.0 / ((1.0 - part) ** 2 / k + part**2 / m)


@pytest.mark.parametrize(("version", "first"), [("1.0", 0.0), ("1.1", 25.0), ("2.0", 25.0)])
@pytest.mark.parametrize("placed", [True, False])
def test_a_gear_sits_at_its_middle_in_all_versions(written, version, first, placed) -> None:
    """Version 1.0 gives the start of a gear, later versions its middle; the gear's centre is there.

    The places of gears are in the unit, or only coordinates along the shaft are given.
    """
    here = {} if placed else {"support_vector": None}
    parts = changed(
        two_stages(),
        _21={"u_coordinate_on_shaft": (first, MM), **here},
        _22={"u_coordinate_on_shaft": (first + 100.0, MM), **here},
    )
    case = import_rexs(written(xml(*parts, version=version))).case()
    for gear, place in (("gear_21", 25.0), ("gear_22", 125.0)):
        assert case.gears[gear].support.si == pytest.approx(seen(place, (0.0, 1e8), (200.0, 3e8)))
        assert case.gears[gear].centre[0].si == pytest.approx(1e-3 * place)
    twists = SHEAR * math.pi / 32.0 * (0.04**4 - 0.02**4) / 0.1
    assert case.shafts["gear_21-gear_22"].stiffness.si == pytest.approx(twists)


def test_places_in_the_unit_count_more_than_coordinates_along_shafts(written) -> None:
    """The centres of both gears are 100 mm apart, whatever their widths and coordinates."""
    parts = changed(two_stages(), _22={"face_width": (20.0, MM)}, _50=section(200.0, 40.0))
    case = import_rexs(written(xml(*parts, version="1.0"))).case()
    assert case.shafts["gear_21-gear_22"].stiffness.si == pytest.approx(SHEAR * polar(40.0) / 0.1)


def carried(*bearings, shafts=((4, 0.0),)):
    """Return a planetary set with planets at x = 125 mm, and these carrier shafts and bearings."""
    components, relations = changed(planetary(), _4=at(shafts[0][1], 0.0, 0.0))
    for id_, start in shafts[1:]:
        components.append((id_, "shaft", "", at(start, 0.0, 0.0)))
        relations.append(("assembly", {"assembly": 3, "part": id_}))
    for number, (shaft, along, stiffness) in enumerate(bearings, 400):
        components.append((number, "concept_bearing", "", bearing(stiffness, along)))
        relations.append(joint(number, shaft, 2))
    return components, relations


def test_a_carrier_overhangs_its_bearings(written) -> None:
    """Bearings are at 25 and 75 mm, the planets at 125 mm."""
    parts = carried((4, 25.0, 1e9), (4, 75.0, 1e9))
    case = import_rexs(written(xml(*parts))).case()
    assert case.gears["carrier_3"].support.si == pytest.approx(
        seen(125.0, (25.0, 1e9), (75.0, 1e9))
    )
    assert case.gears["carrier_3"].support.si == pytest.approx(2e8)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_bearings_on_two_shafts_of_a_carrier_have_levers_on_one_axis(written, way) -> None:
    """Bearings are at x = 75 and 175 mm, one on each shaft; the second shaft is reversed or not."""
    components, relations = carried(
        (4, 75.0, 1e9), (6, 25.0 * way, 3e9), shafts=((4, 0.0), (6, 150.0))
    )
    parts = changed((components, relations), _6={"u_axis_vector": ([way, 0.0, 0.0], MM)})
    case = import_rexs(written(xml(*parts))).case()
    right = seen(125.0, (75.0, 1e9), (175.0, 3e9))
    assert case.gears["carrier_3"].support.si == pytest.approx(right)


def geared_carrier(plate: bool):
    """Return a planetary set whose carrier shaft, 100 mm long, has gear 80 at 20 mm."""
    components, relations = carried((4, 10.0, 1e9), (4, 90.0, 1e9))
    components += [
        (80, "cylindrical_gear", "", teeth(40, 4.0) | at(20.0, 0.0, 0.0)),
        (81, "cylindrical_gear", "", teeth(40, 4.0) | at(20.0, 160.0, 0.0)),
        (82, "shaft", "", at(0.0, 160.0, 0.0)),
        (83, "cylindrical_stage", "", {}),
        (84, "shaft_section", "", section(100.0, 80.0)),
        (67, "side_plate", "", at(92.0, 0.0, 0.0)),
        (69, "coupling", "", {"rotational_stiffness": (8e9, "N mm / rad"), **along_both(96.0)}),
    ]
    relations += [
        ("assembly", {"assembly": 4, "part": 80}),
        ("assembly", {"assembly": 82, "part": 81}),
        ("assembly", {"assembly": 4, "part": 84}),
        ("stage", {"stage": 83, "gear_1": 80, "gear_2": 81}),
    ]
    return components, [*relations, joint(69, 4, 67)] if plate else relations


@pytest.mark.parametrize(("plate", "length", "more"), [(True, 0.076, 1 / 8e6), (False, 0.08, 0.0)])
def test_a_carriers_shaft_twists_up_to_the_carrier(written, plate, length, more) -> None:
    """It twists up to the coupling with a side plate, which twists too, or to the shaft's end."""
    case = import_rexs(written(xml(*geared_carrier(plate)))).case()
    yields = length / (SHEAR * polar(80.0)) + more
    stiffness = case.shafts["gear_80-carrier_3"].stiffness.si
    assert stiffness == pytest.approx(1.0 / yields)


def test_a_coupling_drives_the_nearest_pinion(written) -> None:
    """The near pinion takes its part first; the shaft up to the coupling twists as well."""
    found = import_rexs(written(xml(*two_pinions())))
    shafts = found.case().shafts
    assert set(shafts) == {"gear_24-gear_25", "gear_26-gear_27", "gear_21-gear_25"}
    # Gear 25 is at 175 mm, the coupling at 250 mm.
    yields = 0.075 / (SHEAR * polar(30.0)) + 1e-6
    assert shafts["gear_21-gear_25"].stiffness.si == pytest.approx(1.0 / yields)


def test_a_brake_holds_the_gear_next_to_it(written) -> None:
    """Of two gears on a shaft, it is the one beside the coupling to the casing."""
    components, relations = two_stages()
    components.append((65, "coupling", "", along_both(120.0)))
    found = import_rexs(written(xml(components, [*relations, joint(65, 11, 2)])))
    gears = found.data["gears"]
    assert gears["gear_22"]["held"] is True
    assert "held" not in gears["gear_21"]


def test_forces_are_written_back_with_the_levers_of_the_import(written) -> None:
    """A carrier at 125 mm on bearings at 25 and 75 mm: the near one takes 2, the far one -1."""
    parts = carried((4, 25.0, 1e9), (4, 75.0, 1e9), (34, 0.0, 1e9), (62, 0.0, 1e9))
    unit = written(xml(*parts))
    result = ls.solve(import_rexs(unit).case())
    force = np.array(result.positions[0].loads.bearings["carrier_3"])
    found = read_model(written(export_rexs(result, unit).encode(), "copy.rexs")).components
    assert np.abs(force).max() > 1.0
    for id_, part in (("400", -1.0), ("401", 2.0)):
        exported = [found[id_].number(f"force_acting_on_outer_component_{axis}") for axis in "vw"]
        assert exported == pytest.approx(part * force, rel=1e-6)


# References ---------------------------------------------------------------------------------------

REFERENCE = "reference_component_for_position"


def test_places_may_refer_to_others_over_any_number_of_steps(written) -> None:
    """Beyond the seventh component, places used to be dropped without a message."""
    components, relations = two_stages()
    steps = range(100, 110)
    for id_ in steps:
        before = {REFERENCE: (id_ - 1 if id_ > steps[0] else 1, "none")}
        components.append((id_, "side_plate", "", at(1.0, 0.0, 0.0) | before))
    unit = changed((components, relations), _20={REFERENCE: (steps[-1], "none")})
    found = import_rexs(written(xml(*unit))).data["gears"]["gear_20"]["centre"]
    assert found == ["35 mm", "0 mm", "0 mm"]


@pytest.mark.parametrize("plate", [False, True])
def test_places_that_refer_in_a_circle_are_refused(written, plate) -> None:
    """Each place used to be added several times."""
    components, relations = two_stages()
    last = 99 if plate else 21
    components.append((98, "side_plate", "", at(1.0, 0.0, 0.0) | {REFERENCE: (99, "none")}))
    components.append((99, "side_plate", "", at(1.0, 0.0, 0.0) | {REFERENCE: (98, "none")}))
    both = {"_20": {REFERENCE: (last, "none")}, "_21": {REFERENCE: (1 if plate else 20, "none")}}
    way = "20, 99, 98, 99" if plate else "20, 21, 20"
    with pytest.raises(
        CaseError, match=rf"gear 20, {REFERENCE} = {last}: leads in a circle: {way}"
    ):
        import_rexs(written(xml(*changed((components, relations), **both))))


def test_a_reference_to_nothing_is_reported(written) -> None:
    unit = changed(two_stages(), _20={REFERENCE: (777, "none")}, _10={REFERENCE: (777, "none")})
    found = import_rexs(written(xml(*unit)))
    assert [line for line in found.assumed if "777" in line] == [
        "places of 2 components count from the unit: the file has no component '777', to which "
        "they refer"
    ]


def test_a_direction_of_length_zero_is_none(written) -> None:
    """The axis x used to be taken without a message."""
    zero = {"u_axis_vector": ([0.0, 0.0, 0.0], "mm")}
    found = import_rexs(written(xml(*changed(two_stages(), _20=zero, _10=zero))))
    assert "gear_20: no direction of its axis is given; x is assumed" in found.assumed
