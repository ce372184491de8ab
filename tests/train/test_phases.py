"""Phases of meshes against Parker and Lin, and against teeth that are rotated explicitly."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from tests.support import shipped

import loadshare as ls
from loadshare.case import Case
from loadshare.errors import CaseError
from loadshare.train import build_train


def planetary(sun: int, planet: int, ring: int, angles: list[str], **changes: object) -> Case:
    """Return a set without profile shift."""
    wheel = {"module": "2 mm", "centre": ["0 mm", "0 mm"]}
    case = Case(
        operating={
            "input": "sun",
            "output": "carrier",
            "torque": "10 N*m",
            "positions": 1000,
            "phases": "layout",
        },
        gears={
            "sun": {"teeth": sun, **wheel},
            "ring": {"type": "internal", "teeth": ring, **wheel, "held": True},
            "carrier": {"type": "carrier", "centre": ["0 mm", "0 mm"]},
            "p": {
                "copies": angles,
                "teeth": planet,
                "module": "2 mm",
                "carrier": "carrier",
                "centre": {"distance": f"{sun + planet} mm", "angle": "0 deg"},
            },
        },
        meshes={"sun-p": {"stiffness": "1e6 N*m/rad"}, "p-ring": {"stiffness": "1e6 N*m/rad"}},
    )
    return case.replace(changes)


def apart(one: float, other: float) -> float:
    """Return the distance of two phases around the cycle."""
    return abs((one - other + 0.5) % 1.0 - 0.5)


@pytest.mark.parametrize(
    ("sun", "planet", "angles"),
    [
        (18, 36, ["0 deg", "120 deg", "240 deg"]),
        (21, 20, ["0 deg", "90 deg"]),
        (20, 33, [f"{k * 360 / 106!r} deg" for k in (0, 27, 53, 80)]),
        (17, 36, [f"{k * 360 / 106!r} deg" for k in (0, 35, 72)]),
    ],
)
@pytest.mark.parametrize("running", ["counter-clockwise", "clockwise"])
def test_planets_follow_one_another_as_parker_and_lin_have_it(sun, planet, angles, running) -> None:
    """Sun z_s ψ/2π, ring −z_r ψ/2π, and half a cycle between them for even planets."""
    ring = sun + 2 * planet
    if (sun + ring) % 4 and len(angles) == 2:
        angles = ["0 deg", f"{90 // (360 / (sun + ring)) * 360 / (sun + ring)!r} deg"]
    case = planetary(sun, planet, ring, angles, **{"operating.running": running})
    meshes = build_train(case).meshes
    way = -1.0 if running == "counter-clockwise" else 1.0
    for k, angle in enumerate(angles, start=1):
        turn = math.radians(float(angle.split()[0])) / (2.0 * math.pi)
        sunny, outer = meshes[f"sun-p{k}"].phase, meshes[f"p{k}-ring"].phase
        assert apart(sunny - meshes["sun-p1"].phase, way * sun * turn) < 1e-9
        assert apart(outer - meshes["p1-ring"].phase, -way * ring * turn) < 1e-9
        # Both flanks of a tooth of half a pitch, on opposite sides of the planet.
        assert apart(outer - sunny, 0.5 * (planet + 1) if k == 1 else outer - sunny) < 1e-9


def test_a_gear_train_of_idlers_keeps_step() -> None:
    """The explicit flanks of the idler pass its two pitch points one after the other."""
    case = Case(
        operating={
            "input": "a",
            "output": "c",
            "torque": "10 N*m",
            "phases": "layout",
        },
        gears={
            "a": {"teeth": 19, "module": "3 mm", "centre": ["0 mm", "0 mm"]},
            "b": {
                "teeth": 30,
                "module": "3 mm",
                "profile_shift": 0.0,
                "centre": {"about": "a", "distance": "73.5 mm", "angle": "17 deg"},
            },
            "c": {
                "teeth": 41,
                "module": "3 mm",
                "centre": {"about": "b", "distance": "106.5 mm", "angle": "-64 deg"},
            },
        },
        meshes={"a-b": {"stiffness": "1e6 N*m/rad"}, "b-c": {"stiffness": "1e6 N*m/rad"}},
    )
    train = build_train(case)
    pitch = 2.0 * math.pi / 30
    # A tooth of b is at the angle t. As b runs clockwise, its trailing flank at t + pitch/4 meets a
    # at 197°, its leading flank at t − pitch/4 meets c at −64°.
    sense = train.gears["b"].sense
    assert sense == -1
    for tooth in np.linspace(0.0, pitch, 7):
        from_a = sense * (tooth - sense * pitch / 4 - math.radians(197.0)) / pitch
        to_c = sense * (tooth + sense * pitch / 4 - math.radians(-64.0)) / pitch
        expected = train.meshes["b-c"].phase - train.meshes["a-b"].phase
        assert apart(to_c - from_a, expected) < 1e-9


def face_train(teeth: int | None, *angles: float, **changes: object) -> Case:
    """Return a pinion a that drives a face gear f, which drives pinion b at another angle [rad].

    Both pinions have 25 teeth, and the face gear has the sense of a.
    """
    stiffness = [f"{1.0 + 0.01 * k!r}e6 N*m/rad" for k in range(5)]
    law = {"pressure_angle": "20 deg", "stiffness": stiffness}
    pinions = {
        name: {
            "teeth": 25,
            "module": "4 mm",
            "axis": [math.cos(angle), math.sin(angle), 0.0],
            "centre": [f"{200 * math.cos(angle)!r} mm", f"{200 * math.sin(angle)!r} mm", "50 mm"],
        }
        for name, angle in zip("ab", angles, strict=True)
    }
    face: dict[str, Any] = {"type": "face", "centre": ["0 mm", "0 mm"]}
    face |= {"inner_radius": "180 mm", "outer_radius": "220 mm"}
    face |= {"teeth": teeth} if teeth else {}
    case = Case(
        operating={
            "input": "a",
            "output": "b",
            "torque": "100 N*m",
            "positions": 5,
            "phases": "layout",
        },
        gears={**pinions, "f": face},
        meshes={"a-f": law, "f-b": law},
    )
    return case.replace(changes)


@pytest.mark.parametrize("angle", [0.9, -2.3, 14.0 * math.pi / 106.0])
@pytest.mark.parametrize(("running", "sense"), [("counter-clockwise", 1), ("clockwise", -1)])
@pytest.mark.parametrize("allowance", [0.0, -0.3])
def test_the_teeth_of_a_face_gear_pass_its_pinions_one_after_the_other(
    angle: float, running: str, sense: int, allowance: float
) -> None:
    """Trailing flanks meet a, leading flanks b, so they are a tooth of the face gear apart."""
    thick = {f"gears.{n}.thickness_allowance": f"{allowance} mm" for n in "ab"}
    case = face_train(106, 0.0, angle, **{"operating.running": running}, **thick)
    train = build_train(case)
    assert apart(train.meshes["a-f"].phase, 0.0) < 1e-12
    # The face gear's teeth are thicker by as much as the pinions' are thinner: the spaces are
    # filled.
    tooth = 0.5 - allowance / (4.0 * math.pi)
    expected = tooth - sense * 106 * angle / (2.0 * math.pi)
    assert apart(train.meshes["f-b"].phase, expected) < 1e-9


def test_a_helical_pinion_meets_a_face_gear_in_the_middle_of_its_face() -> None:
    """This holds anywhere along its axis, and with or without a face width."""
    normal, helix = math.radians(20.0), math.radians(15.0)
    pressed = math.atan(math.tan(normal) / math.cos(helix))
    radius = 0.5 * 25 * 4.0 / math.cos(helix)
    wide = {"gears.a.face_width": "40 mm", "gears.b.face_width": "40 mm"}
    found = []
    for more in ({}, wide):
        changes: dict[str, object] = {f"gears.{n}.helix_angle": "15 deg" for n in "ab"}
        changes |= {f'meshes."{m}".pressure_angle': f"{pressed!r} rad" for m in ("a-f", "f-b")}
        # Its radii are those of 106 teeth.
        acting = 1e-3 * 106 / 25 * radius * math.cos(pressed)
        changes |= {"gears.f.inner_radius": f"{acting - 0.02!r} m"}
        changes |= {"gears.f.outer_radius": f"{acting + 0.02!r} m"}
        for name, angle in (("a", 0.0), ("b", 0.9)):
            place = [170.0 * math.cos(angle), 170.0 * math.sin(angle), radius]
            changes[f"gears.{name}.centre"] = [f"{x!r} mm" for x in place]
        train = build_train(face_train(106, 0.0, 0.9, **changes, **more))
        found.append(train.meshes["f-b"].phase)
    assert found[0] == found[1]
    assert apart(found[0], 0.5 - 106 * 0.9 / (2.0 * math.pi)) < 1e-9


def test_a_pinion_keeps_step_with_a_face_gear_and_a_spur_gear() -> None:
    """The pinion b of a face gear drives a spur gear c at the angle 50° in its own plane."""
    place = [200.0, 70.0 * 2.0 * math.cos(math.radians(50.0)), 0.0]
    place[2] = 50.0 + 140.0 * math.sin(math.radians(50.0))
    case = Case(
        operating={
            "input": "f",
            "output": "c",
            "torque": "100 N*m",
            "phases": "layout",
        },
        gears={
            "b": {
                "teeth": 25,
                "module": "4 mm",
                "axis": "x",
                "centre": ["200 mm", "0 mm", "50 mm"],
            },
            "f": {
                "type": "face",
                "teeth": 106,
                "base_radius": "199.21484 mm",
                "centre": ["0 mm", "0 mm"],
            },
            "c": {
                "teeth": 45,
                "module": "4 mm",
                "axis": "x",
                "centre": [f"{x!r} mm" for x in place],
            },
        },
        meshes={
            "f-b": {"pressure_angle": "20 deg", "stiffness": "1e6 N*m/rad"},
            "b-c": {"stiffness": "1e6 N*m/rad"},
        },
    )
    train = build_train(case)
    # About x, from y to z: the face gear is below b, at −90°, and runs from x to y. The flank of b
    # that it pushes therefore moves to y at −90°, which is counter-clockwise. It is the trailing
    # one.
    assert train.gears["b"].sense == 1
    pitch = 2.0 * math.pi / 25
    tooth = -math.pi / 2.0 + pitch / 4.0 + (0.0 - train.meshes["f-b"].phase) * -pitch
    leading = (tooth + pitch / 4.0 - math.radians(50.0)) / pitch
    assert apart(train.meshes["b-c"].phase, leading) < 1e-9


def test_the_four_branches_of_the_seed_keep_step() -> None:
    """Its teeth follow from three pinions; radii of seven digits miss whole numbers by 3e-4."""
    train = build_train(shipped("fgfbstts/phases"))
    gears, turn = train.gears, 2.0 * math.pi
    count = {name: round(gear.teeth or 0) for name, gear in gears.items()}
    assert [count[n] for n in ("2", "3", "6", "7", "8", "9", "10")] == [113, 113, *[69] * 4, 232]
    phase = {name: mesh.phase for name, mesh in train.meshes.items()}

    def pitches(gear: str, one: str, other: str) -> float:
        """Return the pitches by which a gear's tooth moves from one neighbour to another."""
        ways = [gears[gear].plane @ (gears[n].centre - gears[gear].centre) for n in (one, other)]
        angles = [math.atan2(y, x) for x, y in ways]
        return -gears[gear].sense * count[gear] * (angles[1] - angles[0]) / turn

    # Pinion 1 has its face gears above and below: half a revolution is ten of its pitches.
    assert phase["1-2"] == phase["1-3"] == 0.0
    # An idler's trailing flank meets its pinion, its leading flank gear 10. The two ways round from
    # gear 4 to gear 5 differ by 0.012 of a pitch, because the places are rounded.
    for pinion, idlers in (("4", "67"), ("5", "89")):
        first, second = (phase[f"{pinion}-{i}"] for i in idlers)
        assert apart(second - first, pitches(pinion, *idlers)) < 0.02
        for i in idlers:
            passed = phase[f"{i}-10"] - phase[f"{pinion}-{i}"]
            assert apart(passed, 0.5 + pitches(i, pinion, "10")) < 1e-5
    for i in "789":
        assert apart(phase[f"{i}-10"] - phase["6-10"], pitches("10", "6", i)) < 0.02


def between_two_face_gears(pitches: float) -> Case:
    """Return pinions a and b between face gears f, g of 106 teeth, `pitches` half pitches apart."""
    angle = 0.9 // (math.pi / 106.0) * math.pi / 106.0 + pitches * math.pi / 106.0
    case = face_train(106, 0.0, angle)
    law = {"pressure_angle": "20 deg", "stiffness": "1e6 N*m/rad"}
    gears = dict(case.gears)
    other: Any = {"type": "face", "teeth": 106, "centre": ["0 mm", "0 mm", "100 mm"]}
    gears["g"] = other | {"inner_radius": "180 mm", "outer_radius": "220 mm"}
    operating: Any = {"input": "a", "output": "b", "torque": "1 N*m", "phases": "layout"}
    meshes = dict.fromkeys(("a-f", "a-g", "f-b", "g-b"), law)
    return Case(operating=operating, gears=gears, meshes=meshes)


def test_face_gears_whose_teeth_do_not_meet_are_reported_with_the_angles_that_fit() -> None:
    """If b is moved by half a pitch of f, g shifts relative to it by a whole one."""
    for fitting in (0.0, 1.0, 2.0):
        build_train(between_two_face_gears(fitting))
    with pytest.raises(CaseError) as caught:
        build_train(between_two_face_gears(0.3))
    message = str(caught.value)
    assert "its teeth miss each other by 0.3 of a pitch" in message
    assert "1.69811 deg apart" in message


def test_a_pinion_whose_axis_misses_that_of_its_face_gear_is_refused() -> None:
    with pytest.raises(CaseError, match=r"misses the face gear's axis by 30 mm"):
        face_train(106, 0.0, 0.9, **{"gears.a.centre": ["200 mm", "30 mm", "50 mm"]})
    face_train(106, 0.0, 0.9, **{"gears.a.centre": ["200 mm", "0.1 mm", "50 mm"]})


def test_a_phase_that_counts_and_does_not_follow_is_asked_for() -> None:
    """The radii of the face gear give 106.4 teeth, from which no phase follows."""
    with pytest.raises(CaseError, match=r"the teeth of f are not known \(by their radii 106\.4"):
        build_train(face_train(None, 0.0, 0.9))
    given = {'meshes."a-f".phase': 0.0, 'meshes."f-b".phase': 0.3}
    train = build_train(face_train(None, 0.0, 0.9, **given))
    assert train.meshes["f-b"].phase == 0.3
    constant = {f'meshes."{m}".stiffness': "1e6 N*m/rad" for m in ("a-f", "f-b")}
    build_train(face_train(None, 0.0, 0.9, **constant))
    together = {"operating.phases": "together"}
    assert build_train(face_train(None, 0.0, 0.9, **together)).meshes["f-b"].phase == 0.0


def test_sets_that_cannot_be_assembled_are_reported_with_the_angles_that_fit() -> None:
    case = planetary(18, 36, 90, ["0 deg", "120 deg", "241 deg"])
    with pytest.raises(CaseError) as caught:
        ls.solve(case, positions=[1])
    message = str(caught.value)
    assert "p3-ring" in message
    assert "miss each other by 0.3 of a pitch" in message
    assert "3.33333 deg apart" in message
    assert "divides 108" in message


def test_planets_that_fit_between_some_of_their_gears_only_name_all_conditions() -> None:
    """Ravigneaux: three planets fit between large sun and ring, not from ring to small sun.

    The hint used to name 108 alone, which three divides.
    """
    teeth = {"small": 27, "p": 19, "q": 22, "large": 32, "ring": 76}
    gears: dict[str, Any] = {n: {"teeth": z, "module": "2 mm"} for n, z in teeth.items()}
    for name in ("small", "large", "ring"):
        gears[name]["centre"] = ["0 mm", "0 mm", "0 mm" if name == "small" else "40 mm"]
    for name, angle in (("p", 0.0), ("q", 47.6)):
        gears[name] |= {"carrier": "c", "copies": 3, "centre": {"angle": f"{angle} deg"}}
    gears["p"]["centre"]["height"] = "10 mm"
    gears["q"]["centre"]["height"] = "25 mm"
    for gear, width in zip(gears.values(), (20, 30, 50, 20, 20), strict=True):
        gear["face_width"] = f"{width} mm"
    gears["ring"]["type"] = "internal"
    gears["large"]["held"] = True
    gears["c"] = {"type": "carrier", "centre": ["0 mm", "0 mm"]}
    meshes = {m: {"law": "iso"} for m in ("small-p", "p-q", "q-ring", "large-q")}
    operating: Any = {"input": "small", "output": "ring", "torque": "100 N*m"}
    with pytest.raises(CaseError, match="fit evenly spaced if their number divides 49 and 108"):
        build_train(Case(operating=operating, gears=gears, meshes=meshes))


@pytest.mark.parametrize(("ring", "parts"), [(-70, 40), (0, 60)])
def test_planets_in_pairs_are_reported_with_the_angles_that_fit(ring: int, parts: int) -> None:
    """For a ring, both gears turn alike and their difference counts; for a second sun, the sum."""
    last = {"teeth": abs(ring or 30), "type": "internal" if ring else "external"}
    gears: dict[str, Any] = {
        "sun": {"teeth": 30, "centre": ["0 mm", "0 mm", "0 mm"]},
        "last": {**last, "centre": ["0 mm", "0 mm", "60 mm"]},
        "c": {"type": "carrier", "centre": ["0 mm", "0 mm"]},
    }
    # Both planets have 20 teeth: 50 mm from a sun, and from a ring of 70 as well.
    for name, turn, height in (("p", 0.0, 15.0), ("q", 47.156357, 45.0)):
        place = {"distance": "50 mm", "height": f"{height} mm"}
        for k, angle in (("1", 0.0), ("2", 91.0)):
            gears[name + k] = {"teeth": 20, "carrier": "c"}
            gears[name + k]["centre"] = {**place, "angle": f"{turn + angle} deg"}
    for name, gear in gears.items():
        if name != "c":
            gear |= {
                "module": "2 mm",
                "face_width": "20 mm" if name in ("sun", "last") else "40 mm",
            }
    meshes = {f"sun-p{k}": {"law": "iso"} for k in (1, 2)}
    meshes |= {f"p{k}-q{k}": {"law": "iso"} for k in (1, 2)}
    meshes |= {f"q{k}-last": {"law": "iso"} for k in (1, 2)}
    gears["last"]["held"] = True
    case = ls.Case(
        operating={"input": "sun", "output": "c", "torque": "100 N*m"}, gears=gears, meshes=meshes
    )
    with pytest.raises(CaseError) as caught:
        ls.solve(case)
    message = str(caught.value)
    assert "cannot be put together" in message
    assert f"divides {parts}." in message


def test_a_law_is_read_at_each_meshs_own_place() -> None:
    case = planetary(18, 36, 90, ["0 deg", "120 deg", "240 deg"])
    stiffness = [f"{1.0 + 0.01 * k!r}e6 N*m/rad" for k in range(20)]
    changes = {f"meshes.sun-p{k}.stiffness": stiffness for k in (1, 2, 3)}
    given = {"operating.phases": "together", "meshes.sun-p2.phase": 0.35}
    case = case.replace({"operating.positions": 20, **changes, **given})
    train = build_train(case)
    assert train.meshes["sun-p2"].phase == 0.35
    for position in ls.solve(case, positions=[1, 7, 20]).positions:
        step = position.position - 1
        assert position.mesh_position["sun-p1"] == step + 1
        assert position.mesh_position["sun-p2"] == (step + 7) % 20 + 1
    together = build_train(case.replace({"operating.phases": None, "meshes.sun-p2.phase": None}))
    assert {m.phase for m in together.meshes.values()} == {0.0}


def test_phases_do_not_depend_on_the_order_of_tables() -> None:
    """On a driven carrier, both meshes of a planet are equally near to the input."""
    changes = {"operating.input": "carrier", "operating.output": "sun"}
    case = planetary(18, 36, 90, ["0 deg", "120 deg", "240 deg"], **changes)
    stiffness = [f"{1.0 + 0.01 * k!r}e6 N*m/rad" for k in range(20)]
    steps = {f"meshes.{name}.stiffness": stiffness for name in case.meshes}
    case = case.replace(steps | {"operating.positions": 20})
    tables = {
        name: {"gears": case.gears, "meshes": case.meshes} for name in ("as written", "reversed")
    }
    tables["reversed"] = {k: dict(reversed(v.items())) for k, v in tables["reversed"].items()}
    written = [Case(operating=case.operating, **t) for t in tables.values()]
    # The second of two cases is built on the first; neither may take over its phases.
    for first, second in (written, written[::-1]):
        answers = [ls.solve(c, positions=[1, 8]) for c in (first, second)]
        trains = [build_train(c) for c in (first, second)]
        assert [*trains[0].meshes] != [*trains[1].meshes]
        for name, mesh in trains[0].meshes.items():
            other = trains[1].meshes[name]
            assert (mesh.phase, mesh.coast_phase) == (other.phase, other.coast_phase)
        for one, other in zip(*(a.positions for a in answers), strict=True):
            assert one.mesh_position == other.mesh_position
            assert one.torque == pytest.approx(other.torque, rel=1e-12)
    # It is the planet whose name comes first, and of its meshes that of the gear whose name does.
    # There the planet is nearer to the input than the ring, which the train takes as the driver.
    first_mesh = trains[0].meshes["p1-ring"]
    assert (first_mesh.driver, first_mesh.coast_phase) == ("ring", 0.0)


def test_in_a_march_meshes_of_a_set_pass_by_the_relative_speed() -> None:
    """In a turn of the sun, 15 of its 18 teeth pass a planet; each mesh has its own phase."""
    case = planetary(18, 36, 90, ["0 deg", "120 deg", "240 deg"])
    case = case.replace({"march": {"gear": "sun", "revolutions": 1.0, "steps": 7}})
    train = build_train(case)
    for index in range(1, 8):
        passed = 15.0 * (index - 1) / 7
        for name, mesh in train.meshes.items():
            place = math.floor((mesh.phase + passed) % 1.0 * 1000 + 1e-6) % 1000
            assert train.mesh_positions(index)[name] == place


def test_a_phase_that_follows_is_reported_without_its_round_off():
    """That of planets at equal phases is 0, of which round-off makes 1e-15, or almost 1."""
    case = planetary(18, 36, 90, ["0 deg", "120 deg", "240 deg"])
    wrong = {f"meshes.sun-p{k}.phase": 0.4 for k in (1, 2, 3)}
    with pytest.raises(CaseError) as caught:
        build_train(case.replace(wrong))
    assert {p.allowed for p in caught.value.problems} == {"0, or left out"}


def test_a_phase_that_contradicts_the_teeth_is_reported_with_the_one_that_follows():
    case = shipped("planetary/four_planets").replace({"operating.positions": 4})
    laid = {"operating.phases": "layout"}
    train = build_train(case.replace(laid))
    name, phase = next((n, m.phase) for n, m in train.meshes.items() if 0.1 < m.phase < 0.9)
    build_train(case.replace(laid | {f'meshes."{name}".phase': phase}))
    wrong = {f'meshes."{name}".phase': (phase + 0.05) % 1.0}
    build_train(case.replace(wrong))
    with pytest.raises(ls.CaseError, match=rf"contradicts the teeth .* Allowed: {phase:.4g}, or"):
        build_train(case.replace(laid | wrong))
