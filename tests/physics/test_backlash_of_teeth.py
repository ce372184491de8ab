"""Backlash from thickness allowances and centre distance, against flanks moved into contact."""

import math

import numpy as np
import pytest

import loadshare as ls
from loadshare.case import Case
from loadshare.case.gears import Tooth
from loadshare.involute import distance_without_backlash, normal_backlash, working_angle
from loadshare.train import build_train


def gear(teeth: int, **keys) -> dict:
    return {"teeth": teeth, "module": "4 mm", "face_width": "40 mm", **keys}


def pair(one: dict, two: dict, change: float = 0.0, **mesh) -> Case:
    """Return two gears in mesh; `change` [m] is their extra centre distance."""
    data = {
        "operating": {"input": "a", "output": "b", "torque": "100 N*m"},
        "gears": {
            "a": {"centre": ["0 mm", "0 mm"]} | one,
            "b": {"centre": {"about": "a", "angle": "0 deg"}} | two,
        },
        "meshes": {"a-b": {"law": "iso", "backlash": "teeth", **mesh}},
    }
    if change:
        distance = Case(data).centres()["b"][0] + change
        data["gears"]["b"]["centre"]["distance"] = f"{distance!r} m"
    return Case(data)


def play(one: Tooth, two: Tooth, distance: float) -> float:
    """Return the angle by which the second gear turns from flank to flank [rad], from flank points.

    A tooth of the first gear is in a space of the second. Points of both its flanks, up to the tip,
    give the distance of the second gear's adjacent flank.
    """
    inside = two.internal
    radius = np.linspace(one.base_radius, one.tip, 200_001)
    half = one.base_half_angle - np.array(
        [math.tan(a) - a for a in np.arccos(one.base_radius / radius)]
    )
    x, y = radius * np.cos(half), radius * np.sin(half)
    if inside:
        # The pinion's centre is at a distance from that of the ring, on the same side.
        at = np.hypot(x + distance, y), np.arctan2(y, x + distance)
        space = math.pi / two.teeth
    else:
        at = np.hypot(distance - x, y), np.arctan2(y, distance - x)
        space = math.pi / two.teeth
    there = at[0] >= max(two.base_radius, two.tip if inside else 0.0)
    if not inside:
        there &= at[0] <= two.tip
    angle = np.arccos(two.base_radius / at[0][there])
    own = two.base_half_angle - two.kind * (np.tan(angle) - angle)
    # The middle of the space is on the line of centres.
    free = space - own - at[1][there]
    return 2.0 * float(np.min(free))


@pytest.mark.parametrize("internal", [False, True])
@pytest.mark.parametrize("change", [0.0, 2e-4, -3e-5])
def test_backlash_is_the_play_between_flanks(internal: bool, change: float):
    """A flank touches at one point: 2e5 points find it within 1e-8 of its play."""
    kind = {"type": "internal"} if internal else {}
    one = gear(25, profile_shift=0.3, thickness_allowance="-60 um")
    two = gear(70, profile_shift=-0.1, thickness_allowance="-90 um", **kind)
    case = pair(one, two, -change if internal else change)
    a, b = case.gears["a"].tooth, case.gears["b"].tooth
    found = build_train(case).meshes["a-b"].backlash
    expected = play(a, b, case.centres()["b"][0]) * b.base_radius
    assert found == pytest.approx(expected, rel=1e-6)
    assert found > 1e-5


@pytest.mark.parametrize("helix", [0.0, 20.0])
@pytest.mark.parametrize("internal", [False, True])
def test_allowances_count_along_the_normal(helix: float, internal: bool):
    """Closed form of ISO/TR 10064-2: j_bn = −(E_sn1 + E_sn2) cos α_n, at any helix angle.

    Along the line of action, in the transverse plane, it is j_bn / cos β_b.
    """
    hand = helix if internal else -helix
    kind = {"type": "internal"} if internal else {}
    one = gear(
        25, helix_angle=f"{helix} deg", thickness_allowance="-60 um", pressure_angle="18 deg"
    )
    two = gear(70, helix_angle=f"{hand} deg", thickness_allowance="-90 um", pressure_angle="18 deg")
    case = pair(one, two | kind)
    along = math.cos(case.gears["a"].tooth.base_helix_angle)
    found = build_train(case).meshes["a-b"].backlash
    assert found * along == pytest.approx(150e-6 * math.cos(math.radians(18.0)), rel=1e-9)


@pytest.mark.parametrize("helix", [0.0, 15.0, 30.0])
def test_gears_turn_by_the_circumferential_backlash(helix: float):
    """In both directions, less the deflection of the mesh: j_wt / r_w at the driver, at any helix
    angle.
    """
    one = gear(25, helix_angle=f"{helix} deg")
    case = pair(one, gear(70, helix_angle=f"{-helix} deg"), backlash="200 um")
    a, b = case.gears["a"].tooth, case.gears["b"].tooth
    angle = working_angle(a, b, distance_without_backlash(a, b))
    working = a.base_radius / math.cos(angle)
    one, two = (
        ls.solve(case.replace({"operating.torque": f"{sign}1e-6 N*m"})).positions[0].rotation["a"]
        for sign in ("", "-")
    )
    assert abs(one - two) == pytest.approx(200e-6 / working, rel=1e-6)
    normal = 200e-6 * math.cos(angle) * math.cos(a.base_helix_angle)
    measured = {"backlash": None, "normal_backlash": f"{normal!r} m"}
    changed = case.replace({f'meshes."a-b".{key}': value for key, value in measured.items()})
    assert build_train(changed).meshes["a-b"].backlash == pytest.approx(
        build_train(case).meshes["a-b"].backlash, rel=1e-12
    )


def test_a_centre_distance_that_is_off_opens_the_flanks():
    """To first order Δj = 2 Δa sin α_wt cos β_b; the rest is of second order in Δa/a."""
    case = pair(gear(25), gear(70))
    one, two = case.gears["a"].tooth, case.gears["b"].tooth
    distance = distance_without_backlash(one, two)
    opened = normal_backlash(one, two, distance + 1e-5)
    assert opened == pytest.approx(2e-5 * math.sin(working_angle(one, two, distance)), rel=1e-3)


def test_the_coast_flank_touches_where_the_play_is_used_up():
    """A float that follows from backlashes, and torques of both signs, use it like any other."""
    word = pair(gear(25, thickness_allowance="-60 um"), gear(70))
    number = pair(gear(25), gear(70), backlash="60 um")
    assert build_train(word).meshes["a-b"].backlash == pytest.approx(
        build_train(number).meshes["a-b"].backlash, rel=1e-9
    )
    turned = [ls.solve(case.replace({"operating.torque": "-100 N*m"})) for case in (word, number)]
    one, two = (result.positions[0].rotation["a"] for result in turned)
    assert one == pytest.approx(two, rel=1e-9)


def test_teeth_without_allowance_touch_on_both_flanks():
    assert build_train(pair(gear(25), gear(70))).meshes["a-b"].backlash == pytest.approx(
        0, abs=1e-15
    )
