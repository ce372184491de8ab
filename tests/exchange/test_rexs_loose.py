"""Loose gears of gearboxes that shift, and shafts that are supported by others."""

from __future__ import annotations

import numpy as np
import pytest
from tests.exchange.units import along_both, at, bearing, changed, joint, planetary, teeth, xml

import loadshare as ls
from loadshare.errors import CaseError
from loadshare.exchange.rexs import export_rexs, import_rexs
from loadshare.exchange.rexs.reading import read_model

MM, NONE = "mm", "none"


def gearbox(shift: int, final: bool = False):
    """Return gears 20 and 22 of a shaft that mesh with 21 and 23, which are loose on main shaft 12.

    Each of these is on a hollow shaft with a needle bearing on the main shaft, at 40 and at 110 mm
    of its 150 mm, and is coupled to it in one gear. A final gear 24 may be on the main shaft, at
    140 mm.
    """
    components = [
        (1, "gear_unit", "", at(0.0, 0.0, 0.0) | {"gear_shift_index": (shift, NONE)}),
        (2, "gear_casing", "", {}),
        (10, "shaft", "in", at(0.0, 0.0, 0.0)),
        (12, "shaft", "main", at(0.0, 90.0, 0.0)),
        (50, "shaft", "", at(30.0, 90.0, 0.0)),
        (51, "shaft", "", at(100.0, 90.0, 0.0)),
        (30, "external_load", "", {"torque_around_u_axis": (100.0, "N m")}),
        (31, "external_load", "", {"u_coordinate_on_shaft": (150.0, MM)}),
        (40, "cylindrical_stage", "", {}),
        (41, "cylindrical_stage", "", {}),
    ]
    relations = [
        ("assembly", {"assembly": 10, "part": 30}),
        ("assembly", {"assembly": 12, "part": 31}),
        ("stage", {"stage": 40, "gear_1": 20, "gear_2": 21}),
        ("stage", {"stage": 41, "gear_1": 22, "gear_2": 23}),
    ]
    for gear, shaft, number, x, y in (
        (20, 10, 30, 40.0, 0.0),
        (21, 50, 60, 40.0, 90.0),
        (22, 10, 40, 110.0, 0.0),
        (23, 51, 50, 110.0, 90.0),
    ):
        components.append((gear, "cylindrical_gear", "", teeth(number, 2.0) | at(x, y, 0.0)))
        relations.append(("assembly", {"assembly": shaft, "part": gear}))
    for id_, inner, outer, place, stiffness in (
        (60, 10, 2, at(0.0, 0.0, 0.0), 2e8),
        (61, 10, 2, at(150.0, 0.0, 0.0), 2e8),
        (62, 12, 2, at(0.0, 90.0, 0.0), 2e8),
        (63, 12, 2, at(150.0, 90.0, 0.0), 2e8),
        (64, 12, 50, at(40.0, 90.0, 0.0), 5e8),
        (65, 12, 51, at(110.0, 90.0, 0.0), 5e8),
    ):
        components.append((id_, "concept_bearing", "", bearing(stiffness) | place))
        relations.append(joint(id_, inner, outer))
    for id_, shaft, x, engaged in ((70, 50, 60.0, [True, False]), (71, 51, 90.0, [False, True])):
        attributes = at(x, 90.0, 0.0) | {"is_engaged": (engaged, NONE)}
        components.append((id_, "switchable_coupling", "", attributes))
        relations.append(joint(id_, 12, shaft))
    if final:
        components += [
            (13, "shaft", "", at(0.0, 210.0, 0.0)),
            (24, "cylindrical_gear", "", teeth(30, 2.0) | at(140.0, 90.0, 0.0)),
            (25, "cylindrical_gear", "", teeth(90, 2.0) | at(140.0, 210.0, 0.0)),
            (42, "cylindrical_stage", "", {}),
            (66, "concept_bearing", "", bearing(3e8) | at(140.0, 210.0, 0.0)),
        ]
        relations = [r for r in relations if r[1].get("part") != 31]
        relations += [
            ("assembly", {"assembly": 13, "part": 31}),
            ("assembly", {"assembly": 12, "part": 24}),
            ("assembly", {"assembly": 13, "part": 25}),
            ("stage", {"stage": 42, "gear_1": 24, "gear_2": 25}),
            joint(66, 13, 2),
        ]
    return components, relations


@pytest.mark.parametrize("final", [False, True])
@pytest.mark.parametrize(("shift", "driven", "other"), [(1, 21, 23), (2, 23, 21)])
def test_only_the_gear_that_is_engaged_is_in_the_case(written, final, shift, driven, other) -> None:
    found = import_rexs(written(xml(*gearbox(shift, final))))
    gears = found.data["gears"]
    assert f"gear_{driven}" in gears
    assert f"gear_{other}" not in gears
    assert any("turns freely" in line for line in found.left_out)
    ratio = 60 / 30 if shift == 1 else 50 / 40
    loads = ls.solve(found.case()).positions[0].loads.gears
    last = ("gear_25", -3.0 * ratio) if final else (f"gear_{driven}", ratio)
    assert found.data["operating"]["output"] == last[0]
    assert abs(loads[last[0]]) == pytest.approx(100.0 * abs(last[1]), rel=1e-9)


@pytest.mark.parametrize("final", [False, True])
def test_a_gear_on_a_turning_shaft_yields_with_that_shaft(written, final) -> None:
    """The needle bearing, and the main shaft's bearings at 0 and 150 mm with their levers."""
    unit = written(xml(*gearbox(1, final)))
    found = import_rexs(unit)
    yields = 1.0 / 5e8 + ((110 / 150) ** 2 + (40 / 150) ** 2) / 2e8
    assert found.case().gears["gear_21"].support.si == pytest.approx(1.0 / yields)
    result = ls.solve(found.case())
    bearings = read_model(written(export_rexs(result, unit).encode(), "copy.rexs")).components
    pushed = {
        name: np.array(force)[:] @ np.array(result.frames[name])
        for name, force in result.positions[0].loads.bearings.items()
    }
    first = 110 / 150 * pushed["gear_21"]
    if final:
        first = first + 10 / 150 * pushed["gear_24"]
    exported = [bearings["62"].number(f"force_acting_on_outer_component_{a}") for a in "vw"]
    assert exported == pytest.approx(first[1:], rel=1e-6)


def test_what_carries_a_gears_shaft_adds_its_clearance_and_offset(written) -> None:
    """Main shaft bearings: mean clearance 20 um, first offset by 15 um, 11 um at 40 of 150 mm."""
    parts = changed(
        gearbox(1),
        _62={"radial_clearance": (40.0, "mum"), "misalignment_in_w_direction": (15.0, "mum")},
        _64={"radial_clearance": (30.0, "mum")},
    )
    found = import_rexs(written(xml(*parts)))
    case = found.case()
    assert case.bearings["gear_21"].clearance.si == pytest.approx(15e-6 + 10e-6)
    assert case.errors["gear_21"].installation[2].si == pytest.approx(11e-6)
    assert any("and half that of what carries" in line for line in found.assumed)


def test_gears_none_of_which_is_engaged_are_refused(written) -> None:
    parts = changed(
        gearbox(1), **{f"_{k}": {"is_engaged": ([False, False], NONE)} for k in (70, 71)}
    )
    with pytest.raises(CaseError, match="no cylindrical stage whose gears are engaged"):
        import_rexs(written(xml(*parts)))


def test_slide_bearings_hold(written) -> None:
    components, relations = gearbox(1)
    parts = [(i, "slide_bearing" if i in (60, 61) else k, n, a) for i, k, n, a in components]
    plain = import_rexs(written(xml(components, relations))).data["gears"]
    assert import_rexs(written(xml(parts, relations))).data["gears"] == plain


@pytest.mark.parametrize("first", [True, False])
def test_a_shaft_on_which_planets_sit_is_their_pin(written, first) -> None:
    """The relation for pins is missing, and the shaft is anywhere among a carrier's parts."""
    components, relations = changed(planetary(), _65=along_both(0.0))
    plain = import_rexs(written(xml(components, relations))).data
    pins = [r for r in relations if r[1].get("part") in (235, 236, 237)]
    others = [r for r in relations if r not in pins and r[0] != "planet_pin"]
    relations = [*pins, *others] if first else [*others, *pins]
    assert import_rexs(written(xml(components, relations))).data == plain
