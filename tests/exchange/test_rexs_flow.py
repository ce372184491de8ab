"""The path of torque through REXS units: senses, drivers, stages, loads behind couplings."""

from __future__ import annotations

import numpy as np
import pytest
from tests.exchange.units import (
    at,
    changed,
    joint,
    planetary,
    section,
    two_pinions,
    two_stages,
    xml,
)

import loadshare as ls
from loadshare.errors import CaseError
from loadshare.exchange.rexs import import_rexs
from loadshare.exchange.rexs.reading import read_model

MM, NONE, TORQUE = "mm", "none", "torque_around_u_axis"
BACK = {"u_axis_vector": ([-1.0, 0.0, 0.0], MM)}


def forces(path) -> dict[str, np.ndarray]:
    """Return the force of every gear on its support, x, y, z in the unit [N]."""
    result = ls.solve(import_rexs(path).case())
    loads = result.positions[0].loads.bearings
    return {name: np.array(loads[name]) @ np.array(result.frames[name]) for name in loads}


# Senses -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("turned", "mirrored"),
    [
        ({"_20": BACK}, False),
        ({"_21": BACK, "_22": BACK}, False),
        ({"_10": BACK}, True),
        ({"_10": BACK, "_20": BACK}, True),
    ],
)
def test_a_torque_is_about_the_axis_of_its_shaft(written, turned, mirrored) -> None:
    """This holds for either direction of gears. A reversed torque mirrors forces in the plane of
    the axes.
    """
    plain = forces(written(xml(*two_stages())))
    found = forces(written(xml(*changed(two_stages(), **turned))))
    mirror = np.array([1.0, 1.0, -1.0]) if mirrored else np.ones(3)
    for name, force in plain.items():
        assert found[name] == pytest.approx(mirror * force, abs=1e-3)
    assert abs(plain["gear_20"][2]) > 1e3


def test_an_axis_that_is_not_its_shafts_is_reported(written) -> None:
    tilted = changed(two_stages(), _20={"u_axis_vector": ([1.0, 0.1, 0.0], MM)})
    found = import_rexs(written(xml(*tilted)))
    assert found.data["gears"]["gear_20"]["axis"] == "x"
    assert any("gear_20: its axis is that of its shaft" in line for line in found.assumed)


def driven_carrier(shaft: int = 4, torque: float = -7000.0, swapped: tuple[int, ...] = ()):
    """Return a planetary set driven at a shaft of the carrier: 4, or 6, which points backwards."""
    components, relations = planetary()
    components.append((6, "shaft", "", at(175.0, 0.0, 0.0) | BACK))
    parts = changed(
        (components, relations),
        _38={TORQUE: None, "defines_torque": None},
        _61={TORQUE: (torque, "N m"), "defines_torque": (True, NONE)},
        _34={"rotational_speed": None},
    )
    relations = [
        (kind, {**roles, "assembly": shaft} if roles.get("part") == 61 else roles)
        for kind, roles in relations
    ]
    relations = [
        (kind, {**roles, "gear_1": roles["gear_2"], "gear_2": roles["gear_1"]})
        if roles.get("stage") in swapped
        else (kind, roles)
        for kind, roles in relations
    ]
    return parts[0], [*relations, ("assembly", {"assembly": 3, "part": 6})]


def test_a_load_on_a_carriers_second_shaft_is_about_that_shafts_axis(written) -> None:
    first = import_rexs(written(xml(*driven_carrier()))).data
    second = import_rexs(written(xml(*driven_carrier(6, 7000.0)))).data
    assert second["operating"] == first["operating"]
    assert first["operating"]["running"] == "clockwise"


# Drivers and stages -------------------------------------------------------------------------------


@pytest.mark.parametrize("swapped", [(), (212,), (211, 222)])
def test_behind_a_driven_carrier_torque_goes_from_the_held_ring_to_the_sun(
    written, swapped
) -> None:
    """As seen from the carrier, with sun 17 and ring 61: of 7000 N·m, the sun takes 17/78 and the
    ring 61/78.
    """
    unit = written(xml(*driven_carrier(swapped=swapped)))
    result = ls.solve(import_rexs(unit).case())
    stages = {name: set(branches) for name, branches in result.stages.items()}
    assert stages == {
        "from_gear_58": {f"gear_58-gear_{k}" for k in (247, 248, 249)},
        "to_gear_53": {f"gear_{k}-gear_53" for k in (247, 248, 249)},
    }
    loads = result.positions[0].loads
    assert loads.gears["gear_58"] == pytest.approx(7000.0 * 61 / 78, rel=1e-9)
    assert loads.gears["gear_53"] == pytest.approx(7000.0 * 17 / 78, rel=1e-9)
    # The forces are the same as with the sun driven: the flanks that carry are drive flanks.
    for name, force in result.positions[0].equilibrium.flank_force.items():
        assert force > 0.0 or "coast" in name


def test_a_carrier_without_a_held_gear_has_one_stage_at_each_central_gear(written) -> None:
    components, relations = driven_carrier(swapped=(211, 222))
    relations = [r for r in relations if r[1].get("assembly") != 65]
    data = import_rexs(written(xml(components, relations))).data
    assert {name: len(stage["meshes"]) for name, stage in data["stages"].items()} == {
        "to_gear_53": 3,
        "to_gear_58": 3,
    }


def two_sets():
    """Return two planetary sets with rings on one held shaft; the first carrier drives sun 2053."""
    components, relations = planetary()
    kept = {1, 2, 62, 65}

    def moved(id_: int) -> int:
        return id_ if id_ in kept else id_ + 2000

    for id_, kind, name, attributes in planetary()[0]:
        if id_ not in {*kept, 38, 61, 90}:
            place = dict(attributes)
            place.pop("rotational_speed", None)
            if "support_vector" in place:
                (x, y, z), unit = place["support_vector"]
                place["support_vector"] = ([x + 300.0, y, z], unit)
            components.append((moved(id_), kind, name, place))
    for kind, roles in planetary()[1]:
        if not {38, 61, 65} & set(roles.values()):
            relations.append((kind, {role: moved(id_) for role, id_ in roles.items()}))
    relations = [
        (kind, {**roles, "assembly": 2004} if roles.get("part") == 61 else roles)
        for kind, roles in relations
    ]
    components.append((900, "coupling", "", {}))
    return components, [*relations, joint(900, 4, 2034)]


def test_torque_passes_from_a_carrier_to_the_next_set_not_through_held_rings(written) -> None:
    data = import_rexs(written(xml(*two_sets()))).data
    assert data["operating"]["output"] == "carrier_2003"
    assert {name: len(stage["meshes"]) for name, stage in data["stages"].items()} == {
        "from_gear_53": 3,
        "to_gear_58": 3,
        "from_gear_2053": 3,
        "to_gear_2058": 3,
    }


# Loads --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "output", [{}, {TORQUE: (-600.0, "N m")}, {"force_w_direction": (9.0, "N")}]
)
@pytest.mark.parametrize("says", [{}, {"transmits_torque": (False, NONE)}])
def test_a_mere_force_is_no_output(written, output, says) -> None:
    components, relations = changed(two_stages(), _31={**output, "transmits_torque": (True, NONE)})
    components.append((32, "external_load", "belt", {"force_v_direction": (456.0, "N"), **says}))
    relations = [("assembly", {"assembly": 11, "part": 32}), *relations]
    parts = changed((components, relations), _30={"defines_torque": (True, NONE)})
    assert import_rexs(written(xml(*parts))).data["operating"]["output"] == "gear_23"


def on_a_motor(sense: float = 1.0):
    """Return two stages driven through a coupling from a shaft without gears."""
    components, relations = two_stages()
    motor = at(-100.0, 0.0, 0.0) | {"u_axis_vector": ([sense, 0.0, 0.0], MM)}
    components += [(16, "shaft", "motor", motor), (72, "coupling", "", {})]
    relations = [r for r in relations if r[1].get("part") != 30]
    relations += [("assembly", {"assembly": 16, "part": 30}), joint(72, 16, 10)]
    return components, relations


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_load_reaches_gears_through_couplings(written, sense) -> None:
    plain = import_rexs(written(xml(*two_stages()))).data["operating"]
    parts = changed(on_a_motor(sense), _30={TORQUE: (-100.0 * sense, "N m")})
    found = import_rexs(written(xml(*parts)))
    assert found.data["operating"] == plain
    assert not any("coupling 72" in line for line in found.left_out)
    turning = changed(parts, _10={"rotational_speed": (50.0, "1 / min")})
    assert import_rexs(written(xml(*turning))).data["operating"]["torque"] == "-100 N*m"


def test_a_load_behind_an_open_coupling_drives_nothing(written) -> None:
    parts = changed(on_a_motor(), _72={"is_engaged": (False, NONE)})
    with pytest.raises(CaseError, match="has no external_load with a torque"):
        import_rexs(written(xml(*parts)))


def test_couplings_and_the_shaft_between_them_twist_one_after_the_other(written) -> None:
    """Wheel 23 on shaft 12 drives gear 24 on shaft 13 through shaft 15, which has no gears."""
    components, relations = two_stages()
    components += [
        (13, "shaft", "", at(400.0, 140.0, 0.0)),
        (15, "shaft", "between", at(200.0, 140.0, 0.0)),
        (24, "cylindrical_gear", "", gear(25, 400.0, 140.0)),
        (25, "cylindrical_gear", "", gear(25, 400.0, 190.0)),
        (17, "shaft", "", at(400.0, 190.0, 0.0)),
        (42, "cylindrical_stage", "", {}),
        (51, "shaft_section", "", section(200.0, 30.0)),
        (
            70,
            "coupling",
            "",
            {"rotational_stiffness": (2e8, "N mm / rad"), **at(210.0, 140.0, 0.0)},
        ),
        (
            71,
            "coupling",
            "",
            {"rotational_stiffness": (1e8, "N mm / rad"), **at(360.0, 140.0, 0.0)},
        ),
    ]
    relations = [r for r in relations if r[1].get("part") != 31]
    relations += [
        ("assembly", {"assembly": 17, "part": 31}),
        ("assembly", {"assembly": 15, "part": 51}),
        ("assembly", {"assembly": 13, "part": 24}),
        ("assembly", {"assembly": 17, "part": 25}),
        ("stage", {"stage": 42, "gear_1": 24, "gear_2": 25}),
        joint(70, 12, 15),
        joint(71, 15, 13),
    ]
    case = import_rexs(written(xml(components, relations))).case()
    polar = np.pi / 32.0 * 0.03**4
    yields = 1.0 / 2e5 + 1.0 / 1e5 + 0.15 / (79.3e9 * polar)
    assert case.shafts["gear_23-gear_24"].stiffness.si == pytest.approx(1.0 / yields)


def test_a_brake_holds_through_a_shaft_without_gears(written) -> None:
    components, relations = planetary()
    components += [(63, "shaft", "brake disc", at(200.0, 0.0, 0.0)), (66, "coupling", "", {})]
    relations = [r for r in relations if r[1].get("assembly") != 65]
    found = import_rexs(written(xml(components, [*relations, joint(66, 62, 63), joint(65, 63, 2)])))
    assert found.data["gears"]["gear_58"]["held"] is True
    assert not any("coupling" in line for line in found.left_out)


def gear(teeth: int, x: float, y: float):
    """Return a gear of module 2 mm."""
    return {
        "number_of_teeth": (teeth, NONE),
        "normal_module": (2.0, MM),
        "face_width": (50.0, MM),
        **at(x, y, 0.0),
    }


@pytest.mark.parametrize(("name", "more"), [("fixed_coupling", {}), ("coupling", {})])
def test_couplings_of_version_1_0_join_as_later_ones(written, name, more) -> None:
    """They have a relation of their own, and sides 1 and 2."""
    plain = import_rexs(written(xml(*two_pinions()))).data["shafts"]
    components, relations = two_pinions()
    components = [
        (i, name if i == 70 else kind, text, {OLD.get(k, k): v for k, v in a.items()})
        for i, kind, text, a in components
    ]
    relations = [
        ("coupling", {"assembly": 70, "side_1": 11, "side_2": 14}) if r == joint(70, 11, 14) else r
        for r in relations
    ]
    unit = written(xml(components, relations))
    assert read_model(unit).components["70"].type == name
    assert import_rexs(unit).data["shafts"] == plain


OLD = {
    "u_coordinate_on_shaft_inner_side": "u_coordinate_on_shaft_side_1",
    "u_coordinate_on_shaft_outer_side": "u_coordinate_on_shaft_side_2",
}


# Further loads ------------------------------------------------------------------------------------


def with_a_power_take_off(taken: float, output: float, first: bool = False, speeds: bool = True):
    """Return a drive of 100 N·m on the 20:40 stage: 200 on the middle shaft, some of which leaves
    before 60:20.
    """
    components, relations = two_stages()
    components.append((34, "external_load", "pto", {TORQUE: (-taken, "N m")}))
    there = ("assembly", {"assembly": 11, "part": 34})
    turning = {"_10": -1500.0, "_11": 750.0, "_12": -250.0} if speeds else {}
    return changed(
        (components, [there, *relations] if first else [*relations, there]),
        _31={TORQUE: (output, "N m")},
        **{k: {"rotational_speed": (n, "1 / min")} for k, n in turning.items()},
    )


@pytest.mark.parametrize("taken", [60.0, 120.0])
@pytest.mark.parametrize(("first", "speeds"), [(False, False), (False, True), (True, True)])
def test_a_power_take_off_takes_its_torque(written, taken, first, speeds) -> None:
    """Either of the two loads that take power may be called the output."""
    output = 3.0 * (200.0 - taken)
    found = import_rexs(written(xml(*with_a_power_take_off(taken, output, first, speeds))))
    assert found.data["operating"]["input"] == "gear_20"
    assert not any("the others leave" in line for line in found.assumed)
    assert any("an additional torque of -" in line for line in found.assumed)
    (p,) = ls.solve(found.case()).positions
    torques = {"gear_20-gear_21": 100.0, "gear_22-gear_23": 200.0 - taken}
    assert p.torque == pytest.approx(torques)
    assert abs(p.loads.gears["gear_23"]) == pytest.approx(output)


def test_an_output_torque_that_the_others_contradict_is_reported(written) -> None:
    found = import_rexs(written(xml(*with_a_power_take_off(60.0, 500.0))))
    (line,) = [line for line in found.assumed if "the others leave" in line]
    assert line.startswith("gear_23: the load on the output gives -500 N·m")
    assert "leave -420 N·m" in line
    two = changed(two_stages(), _31={TORQUE: (240.0, "N m")})
    (line,) = [line for line in import_rexs(written(xml(*two))).assumed if "leave" in line]
    assert "gives -240 N·m in its sense of rotation; the others leave -600 N·m" in line


# Speeds -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("middle", "running"), [(300.0, "clockwise"), (-300.0, "counter-clockwise")]
)
@pytest.mark.parametrize("output", [False, True])
def test_the_running_sense_follows_from_the_speed_of_another_shaft(
    written, middle, running, output
) -> None:
    """The teeth turn 300 rpm of the middle shaft into 600 of the input, in the opposite sense."""
    speeds = {"_11": {"rotational_speed": (middle, "1 / min")}}
    if output:
        speeds["_31"] = {TORQUE: (600.0, "N m")}
    found = import_rexs(written(xml(*changed(two_stages(), **speeds))))
    torque = {"clockwise": "100 N*m", "counter-clockwise": "-100 N*m"}[running]
    assert found.data["operating"]["running"] == running
    assert found.data["operating"]["torque"] == torque
    said = [line for line in found.assumed if "gear_20: no speed is given" in line]
    by = "from that of shaft 11 (middle), it runs"
    assert said == [f"gear_20: no speed is given; {by} {running} at 600 rpm"]
    if not output:
        as_given = {"_10": {"rotational_speed": (-2.0 * middle, "1 / min")}}
        plain = import_rexs(written(xml(*changed(two_stages(), **speeds, **as_given))))
        assert found.data == plain.data
    assert not any("teeth give" in line for line in found.assumed)


def test_a_speed_that_contradicts_the_one_that_counts_is_reported(written) -> None:
    speed = {"rotational_speed": (300.0, "1 / min")}
    found = import_rexs(written(xml(*changed(two_stages(), _11=speed, _12=speed))))
    assert any("shaft 12 (out) is given a speed of 300 rpm" in line for line in found.assumed)


def test_what_takes_power_is_no_input_while_another_torque_can_be(written) -> None:
    """The output comes first in the file and has a speed; that of the input is missing."""
    components, relations = changed(
        two_stages(), _12={"rotational_speed": (100.0, "1 / min")}, _31={TORQUE: (600.0, "N m")}
    )
    swapped = {"_12": {"rotational_speed": (-100.0, "1 / min")}}
    relations = [r for r in relations if r[1].get("part") != 30] + [
        r for r in relations if r[1].get("part") == 30
    ]
    found = import_rexs(written(xml(*changed((components, relations), **swapped))))
    assert found.data["operating"]["input"] == "gear_20"
    assert found.data["operating"]["torque"] == "100 N*m"
