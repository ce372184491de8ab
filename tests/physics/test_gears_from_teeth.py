"""Gears from teeth: geometry and stiffness against a printed report and another method."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.support import CASES

import loadshare as ls
from loadshare.case import Case
from loadshare.case.gears import Tooth
from loadshare.case.line_of_action import line_of_action
from loadshare.errors import CaseError
from loadshare.involute import (
    base_distance,
    contact_ratio,
    normal_backlash,
    working_angle_without_backlash,
)
from loadshare.tooth import resolve
from loadshare.tooth.law.iso6336 import MEASURED, blank_factor, formula_stiffness, mesh_stiffness

# NREL 5 MW reference gearbox, KISSsoft reports of 2020: module, helix, face width, centre distance;
# then for both gears teeth (negative: internal), shift, tip alteration and base diameter [mm, deg];
# working pressure angle [deg], contact ratio, C_R, c' [N/(mm µm)].
NREL = {
    "stage 1, sun": (45, 0, 491, 863, (19, 0.617, -10.861, 803.437), (17, 0.8021, -10.861, 718.865),
                     28.118, 1.115, 0.862, 12.362),
    "stage 1, ring": (45, 0, 491, 863, (17, 0.8021, -10.861, 718.865), (-56, -0.5013, 0, 2368.025),
                      17.161, 1.278, 0.862, 13.289),
    "stage 2, sun": (21, 0, 550, 584, (18, 0.3890, -1.750, 355.204), (36, 0.5039, -1.750, 710.408),
                     24.169, 1.370, 0.862, 12.240),
    "stage 2, ring": (21, 0, 550, 584, (36, 0.5039, -1.750, 710.408), (-93, 0.1171, 0, 1835.220),
                      15.630, 1.618, 0.862, 14.053),
    "stage 3": (14, 10, 360, 861, (24, 0.4800, -0.938, 320.026), (95, 0.6691, -0.938, 1266.770),
                22.856, 1.463, 0.898, 13.832),
}  # fmt: skip


def pair(module, helix, width, distance, *gears):
    """Return a case of two gears in mesh, from their teeth."""
    made = {}
    for k, (name, (teeth, shift, altered, *_)) in enumerate(zip("ab", gears, strict=True)):
        hand = 1 if k == 0 or teeth < 0 else -1
        made[name] = {
            "type": "internal" if teeth < 0 else "external",
            "teeth": abs(teeth),
            "module": f"{module} mm",
            "helix_angle": f"{hand * helix} deg",
            "profile_shift": shift,
            "face_width": f"{width} mm",
            "tip_alteration": f"{altered} mm",
            "centre": [f"{k * distance} mm", "0 mm"],
        }
    return Case(
        operating={"input": "a", "output": "b", "torque": "1000 N*m"},
        gears=made,
        meshes={"a-b": {"law": "iso"}},
    )


@pytest.mark.parametrize("row", NREL.values(), ids=NREL)
def test_derived_geometry_is_that_of_the_report(row):
    distance, angle, ratio = 1e-3 * row[3], row[6], row[7]
    case = pair(*row[:6])
    a, b = case.gears.values()
    # Half a unit of the last printed digit, and that of the centre distance: 0.5 mm of 863.
    assert 2e3 * a.acting_radius == pytest.approx(row[4][3], abs=5.1e-4)
    assert 2e3 * b.acting_radius == pytest.approx(row[5][3], abs=5.1e-4)
    line = line_of_action(case.meshes["a-b"], case.gears, case.centres())
    assert math.degrees(line.pressure_angle) == pytest.approx(angle, abs=1.1e-3)
    assert contact_ratio(a.tooth, b.tooth, distance) == pytest.approx(ratio, abs=6e-4)
    # The shifts have four digits: at the printed distance, they allow no more play than this.
    assert abs(normal_backlash(a.tooth, b.tooth, distance)) < 2e-4 * a.module.si


@pytest.mark.parametrize("row", NREL.values(), ids=NREL)
def test_stiffness_of_a_tooth_is_that_of_the_report(row):
    case = pair(*row[:6])
    a, b = case.gears.values()
    one, two = sorted((a.tooth, b.tooth), key=lambda t: (t.internal, t.teeth))
    found = formula_stiffness(
        (one.teeth, math.inf if two.internal else two.teeth),
        profile_shift=(one.profile_shift, two.profile_shift),
        dedendum=(1.25, 1.25),
        contact_ratio=row[7],
        helix_angle=one.helix_angle,
        blank_factor=row[8],
    )
    assert found.single == pytest.approx(1e9 * row[9], rel=1e-3)


def test_the_law_of_a_mesh_is_the_formulas():
    row = NREL["stage 3"]
    case = pair(*row[:6])
    a, b = case.gears.values()
    single = 1e9 * row[9] / row[8]
    stiffness = single * (0.75 * row[7] + 0.25) * 0.360
    assert mesh_stiffness((a, b), 0.861) == pytest.approx(stiffness, rel=1e-3)
    softer = MEASURED * mesh_stiffness((a, b), 0.861, measured=False)
    assert softer == pytest.approx(mesh_stiffness((a, b), 0.861), rel=1e-14)
    assert mesh_stiffness((b, a), 0.861) == mesh_stiffness((a, b), 0.861)
    position = ls.solve(case).positions[0]
    turned = 1000.0 / (mesh_stiffness((a, b), 0.861) * a.acting_radius**2)
    assert abs(position.rotation["a"]) == pytest.approx(turned, rel=1e-12)


def test_a_thin_web_makes_a_gear_softer():
    row = NREL["stage 3"]
    case = pair(*row[:6])
    thin = case.replace({"gears.b.web": "72 mm", "gears.b.rim": "56 mm"})
    factor = 1.0 + math.log(0.2) / (5.0 * math.exp(0.8))
    assert blank_factor(0.2, 4.0) == pytest.approx(factor, rel=1e-15)
    assert blank_factor(1.0, 4.0) == 1.0
    # The mean of both gears' factors.
    found = mesh_stiffness(tuple(thin.gears.values()), 0.861)
    solid = mesh_stiffness(tuple(case.gears.values()), 0.861)
    assert found == pytest.approx(solid * 0.5 * (1.0 + factor), rel=1e-14)


@given(
    st.integers(12, 60),
    st.integers(62, 150),
    st.floats(-0.2, 0.6),
    st.floats(-0.3, 0.6),
    st.floats(0.0, 0.5),
    st.booleans(),
)
def test_backlash_begins_where_both_flanks_touch(z1, z2, x1, x2, helix, internal):
    """It grows with the centre distance by 2 sin α_wt cos β_b; inside a ring, it decreases."""
    one, two = (
        Tooth(
            module=2e-3,
            teeth=teeth,
            pressure_angle=math.radians(20.0),
            helix_angle=helix,
            profile_shift=shift,
            addendum=1.0,
            dedendum=1.25,
            internal=inside,
        )
        for teeth, shift, inside in ((z1, x1, False), (z2, x2, internal))
    )
    try:
        angle = working_angle_without_backlash(one, two)
    except ValueError:
        return
    if angle < math.radians(5.0):
        return
    distance = base_distance(one, two) / math.cos(angle)
    assert normal_backlash(one, two, distance) == pytest.approx(0.0, abs=1e-14)
    step = 1e-8
    slope = (
        normal_backlash(one, two, distance + step) - normal_backlash(one, two, distance - step)
    ) / (2.0 * step)
    expected = two.kind * 2.0 * math.sin(angle) * math.cos(one.base_helix_angle)
    assert slope == pytest.approx(expected, rel=1e-5)


def test_a_star_from_teeth_is_the_one_from_typed_numbers():
    star = ls.load_case(CASES / "nrel_5mw" / "stage_2.toml")
    centres = star.centres()
    typed = {}
    for name, gear in star.gears.items():
        typed |= {f"gears.{name}.base_radius": f"{gear.acting_radius!r} m"}
        for key in gear.given("module", "profile_shift", "face_width", "tip_alteration"):
            typed[f"gears.{name}.{key}"] = None
    for name, mesh in star.meshes.items():
        line = line_of_action(mesh, star.gears, centres)
        gears = star.gears[mesh.driver], star.gears[mesh.driven]
        compliance = 1.0 / (mesh_stiffness(gears, 0.584) * gears[0].acting_radius ** 2)
        typed[f'meshes."{name}".pressure_angle'] = f"{line.pressure_angle!r} rad"
        typed[f'meshes."{name}".law'] = {"b": f"{compliance!r} rad/(N*m)"}
    own, other = ls.solve(star), ls.solve(star.replace(typed))
    for mesh, torque in own.positions[0].torque.items():
        assert other.positions[0].torque[mesh] == pytest.approx(torque, rel=1e-12)
    for gear, turned in own.positions[0].rotation.items():
        assert other.positions[0].rotation[gear] == pytest.approx(turned, rel=1e-9, abs=1e-15)
    # Three planets around a floating sun share equally, wherever their pins are.
    assert own.omega["I"] == pytest.approx(1.0, abs=1e-9)


def test_teeth_out_of_reach_are_reported_with_the_distance_at_which_they_mesh() -> None:
    """A ring of 75 teeth about planets of 24 and a sun of 24: they would need 51 mm, the sun 48."""
    centre = ["0 mm", "0 mm"]
    gears: dict[str, dict] = {
        "sun": {"teeth": 24, "centre": centre},
        "ring": {"teeth": 75, "type": "internal", "held": True, "centre": centre},
        "p": {"teeth": 24, "carrier": "c", "copies": 3, "centre": {"angle": "0 deg"}},
    }
    for gear in gears.values():
        gear |= {"module": "2 mm", "face_width": "30 mm"}
    gears["c"] = {"type": "carrier", "centre": centre}
    case = ls.Case(
        operating={"input": "sun", "output": "c", "torque": "100 N*m"},
        gears=gears,
        meshes={"sun-p": {"law": "iso"}, "p-ring": {"law": "iso"}},
    )
    with pytest.raises(CaseError, match=r"48 mm apart; without backlash it would be 51 mm"):
        ls.solve(case)


@pytest.mark.parametrize("law", ["iso", "ltca"])
def test_faces_side_by_side_carry_where_they_overlap(law: str):
    """At 40 mm wide and 32 mm apart they are like gears 8 mm wide; the wider one may overhang."""

    def stiffness(widths: tuple[int, int], height: int) -> float:
        centre = {"about": "a", "angle": "0 deg", "height": f"{height} mm"}
        places = {"a": ["0 mm", "0 mm"], "b": centre}
        case = ls.Case(
            operating={"input": "a", "output": "b", "torque": "100 N*m", "positions": 2},
            gears={
                name: {
                    "teeth": teeth,
                    "module": "4 mm",
                    "face_width": f"{width} mm",
                    "centre": places[name],
                }
                for (name, teeth), width in zip({"a": 25, "b": 30}.items(), widths, strict=True)
            },
            meshes={"a-b": {"law": law, "rated_torque": "100 N*m" if law == "ltca" else None}},
        )
        found = resolve(case).meshes["a-b"].power_law
        return 1.0 / np.mean([b.si for b in found.b] if isinstance(found.b, tuple) else found.b.si)

    assert stiffness((40, 40), 32) == pytest.approx(stiffness((8, 8), 0), rel=1e-9)
    assert stiffness((40, 20), 10) == stiffness((40, 20), 0)
