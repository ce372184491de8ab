"""Centres that follow from teeth, along chains of meshes."""

import math
import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from loadshare.case import Case, load_case
from loadshare.case.gears import Tooth
from loadshare.errors import CaseError
from loadshare.involute import normal_backlash
from loadshare.train import build_train

CASES = Path(__file__).parents[2] / "cases"


def gear(teeth: int, **keys) -> dict:
    return {"teeth": teeth, "module": "4 mm", "face_width": "40 mm", **keys}


def about(pole: str | None, angle: float, **keys) -> dict:
    return {"angle": f"{angle} deg", **({"about": pole} if pole else {}), **keys}


def chain(**gears: dict) -> Case:
    names = list(gears)
    return Case(
        operating={"input": names[0], "output": names[-1], "torque": "100 N*m"},
        gears=gears,
        meshes={"-".join(pair): {"law": "iso"} for pair in pairwise(names)},
    )


def test_a_chain_of_gears_stands_by_its_teeth():
    case = chain(
        a=gear(20, centre=["10 mm", "-5 mm"]),
        b=gear(30, centre=about("a", 30.0)),
        c=gear(41, centre=about("b", -45.0, height="2 mm")),
    )
    centres = case.centres()
    towards = [(100.0, math.radians(30.0)), (142.0, math.radians(-45.0))]
    x, y = 10.0, -5.0
    for name, (distance, angle) in zip("bc", towards, strict=True):
        x, y = x + distance * math.cos(angle), y + distance * math.sin(angle)
        assert centres[name][:2] == pytest.approx((1e-3 * x, 1e-3 * y), rel=1e-12)
    assert centres["c"][2] == 2e-3


def test_faces_may_touch_side_by_side():
    """Half the sum of their widths exceeds their distance by rounding."""
    chain(
        a=gear(20, centre=["0 mm", "0 mm", "5 mm"]) | {"face_width": "10 mm"},
        b=gear(30, centre=["100 mm", "0 mm"]),
        c=gear(21, centre=["-2 mm", "0 mm", "15 mm"]) | {"face_width": "10 mm"},
    )


@pytest.mark.parametrize("internal", [False, True])
@pytest.mark.parametrize("helix", ["0 deg", "20 deg"])
def test_shifted_teeth_meet_without_backlash(internal: bool, helix: str):
    """`normal_backlash` measures tooth thickness at the working circles independently."""
    other = {"helix_angle": helix if internal else f"-{helix}", "profile_shift": 0.4}
    kind = {"type": "internal"} if internal else {}
    case = chain(
        a=gear(23, centre=["0 mm", "0 mm"], profile_shift=0.25, helix_angle=helix),
        b=gear(60, centre=about("a", 0.0), **other, **kind),
    )
    one, two = case.gears["a"].tooth, case.gears["b"].tooth
    distance = case.centres()["b"][0]
    assert normal_backlash(one, two, distance) == pytest.approx(0.0, abs=1e-15)
    assert distance != pytest.approx(abs(two.radius + two.kind * one.radius), rel=1e-3)


def test_planets_stand_by_their_mesh_with_the_sun():
    """This holds about the carrier or the origin."""
    derived = load_case(CASES / "planetary" / "four_planets.toml")
    given = derived.replace({f"gears.planet{k}.centre.distance": "135 mm" for k in range(1, 5)})
    for name, centre in given.centres().items():
        assert derived.centres()[name] == pytest.approx(centre, abs=1e-16)
    turned = derived.replace({f"gears.planet{k}.centre.about": "carrier" for k in range(1, 5)})
    assert turned.centres() == derived.centres()
    build_train(turned)


@pytest.mark.parametrize(
    ("name", "pole", "printed"),
    [
        ("planet_11", "sun_1", 0.863),
        ("planet_21", "sun_2", 0.584),
        ("pinion", "wheel", 0.861),
    ],
)
def test_centre_distances_of_a_real_gearbox(name: str, pole: str, printed: float):
    """Profile shifts are printed to four digits: 1e-4 modules of some 21 to 45 mm."""
    case = load_case(CASES / "nrel_5mw" / "gearbox.toml")
    free = case.replace({f"gears.{name}.centre": about(pole, 90.0)})
    x, y, z = free.centres()[name]
    assert math.hypot(x, y) == pytest.approx(printed, abs=5e-6)
    assert (x, z) == (pytest.approx(0.0, abs=1e-15), free.centres()[pole][2])


@pytest.mark.parametrize(
    ("module", "helix", "teeth", "shifts", "printed"),
    [
        (30, 8, (26, 31), (0.2702, 0.2093), 0.877033),
        (20, 8, (26, 41), (0.2787, 0.1213), 0.684273),
        (18, 12, (28, 61), (0.2976, 0.1024), 0.825885),
    ],
)
def test_centre_distances_of_another(module, helix, teeth, shifts, printed):
    """DTU 10 MW, Wang, Nejad and Moan 2020; shifts have four digits, so 1e-4 modules per gear."""
    rack = {"module": f"{module} mm"}
    case = chain(
        a=gear(teeth[0], centre=["0 mm", "0 mm"], profile_shift=shifts[0])
        | rack
        | {"helix_angle": f"{helix} deg"},
        b=gear(teeth[1], centre=about("a", 0.0), profile_shift=shifts[1])
        | rack
        | {"helix_angle": f"{-helix} deg"},
    )
    assert case.centres()["b"][0] == pytest.approx(printed, abs=1e-4 * module * 1e-3)


def test_external_meshes_decide_before_internal_ones():
    """A sun with a positive shift moves the planet outwards, and the ring has less play."""
    given = load_case(CASES / "planetary" / "four_planets.toml")
    shifted = {"gears.sun.profile_shift": 0.02, "gears.ring.profile_shift": -0.1}
    case = given.replace(shifted)
    sun, planet, ring = (case.gears[n].tooth for n in ("sun", "planet1", "ring"))
    distance = case.centres()["planet1"][0]
    assert distance > 0.135
    assert normal_backlash(sun, planet, distance) == pytest.approx(0.0, abs=1e-15)
    assert normal_backlash(planet, ring, distance) > 1e-4


LOW = {"profile_shift": -2.0, "addendum": 2.05}
ALONG_Y = {"axis": "y"}


@pytest.mark.parametrize(
    ("a", "b", "message"),
    [
        ({}, {"centre": about("c", 0.0)}, "the gear meshes with c or with a gear on the axis"),
        ({}, {"centre": about(None, 90.0), "module": "3 mm"}, "different modules"),
        ({"centre": ["1 mm", "0 mm"]}, {"centre": about(None, 0.0)}, "meshes with a gear on the"),
        (ALONG_Y, {"centre": about("a", 0.0), **ALONG_Y}, "only if the axes are along z"),
        (LOW, {"centre": about("a", 0.0), **LOW}, "at any distance"),
        (gear(50), {"centre": about("a", 0.0), **gear(45, type="internal")}, "at any distance"),
    ],
)
def test_what_keeps_a_distance_from_following_is_reported(a: dict, b: dict, message: str):
    gears = {
        "a": gear(20) | {"centre": ["0 mm", "0 mm"]} | a,
        "b": gear(30) | b,
        "c": gear(20, centre=["0 mm", "1 m"]),
    }
    with pytest.raises(CaseError) as caught:
        Case(
            operating={"input": "a", "output": "b", "torque": "100 N*m"},
            gears=gears,
            meshes={"a-b": {"law": "iso"}},
            shafts={"a-c": {"stiffness": "rigid"}},
        )
    assert message in str(caught.value)


def pair(a: dict, b: dict, distance: str) -> Case:
    at = {"about": "a", "angle": "0 deg", "distance": distance}
    return chain(a={"centre": ["0 mm", "0 mm"]} | a, b={"centre": at} | b)


def refusal(make, *arguments) -> str:
    with pytest.raises(CaseError) as caught:
        make(*arguments)
    return str(caught.value)


def test_a_tip_must_not_reach_below_the_pinions_base_circle():
    """Closed form: r_a2² ≤ r_b2² + (a sin α)²; 12 and 60 teeth of module 4 mm at 144 mm."""
    angle = math.radians(20.0)
    most = 1e3 * math.hypot(0.12 * math.cos(angle), 0.144 * math.sin(angle))
    pinion = gear(12, dedendum=2.0)  # a root that leaves enough room
    message = refusal(pair, pinion, gear(60), "144 mm")
    assert "the tip of gear b, at a radius of 124 mm, has no room in gear a" in message
    assert f"at most {most:.6g} mm" in message
    for height, fits in ((most + 0.05, False), (most - 0.001, True)):
        wheel = gear(60, tip_alteration=f"{height - 124.0} mm")
        if fits:
            pair(pinion, wheel, "144 mm")
        else:
            assert "has no room" in refusal(pair, pinion, wheel, "144 mm")
    # The value proposed in the message is sufficient.
    proposed = message.partition('tip_alteration = "')[2].partition('"')[0]
    pair(pinion, gear(60, tip_alteration=proposed), "144 mm")


@pytest.mark.parametrize("internal", [False, True])
def test_a_tip_must_not_reach_the_root(internal: bool):
    """An addendum of 1.2 on both meets a dedendum of 1.15: 0.05 modules too high."""
    kind = {"type": "internal"} if internal else {}
    one, two = gear(40, addendum=1.2), gear(100, dedendum=1.15, **kind)
    distance = "120 mm" if internal else "280 mm"
    message = refusal(pair, one, two, distance)
    assert "the tip of gear a, at a radius of 84.8 mm, has no room in gear b" in message
    assert "at most 84.6 mm" in message
    pair(one | {"tip_alteration": "-0.2 mm"}, two, distance)


def meets(pinion: Tooth, ring: Tooth, distance: float) -> float:
    """Return how deep a tip corner of the pinion enters a ring's tooth as both turn [rad].

    The ring is fixed, and the pinion's centre moves around in it; the centres are apart along x.
    Both have a tooth space and a tooth on the line of centres, with the backlash divided equally.
    """
    deepest = -math.inf
    corner = pinion.half_angle_at(math.acos(pinion.base_radius / pinion.tip))
    for turn in np.linspace(-2.0, 2.0, 4001):  # of the pinion, in the frame of the centres
        angle = turn + corner
        x, y = distance + pinion.tip * math.cos(angle), pinion.tip * math.sin(angle)
        radius = math.hypot(x, y)
        if radius <= ring.tip:
            continue
        pitch = 2.0 * math.pi / ring.teeth
        seen = math.atan2(y, x) - turn * pinion.teeth / ring.teeth
        off = abs((seen % pitch) - pitch / 2.0)  # teeth of the ring are between its spaces
        deepest = max(deepest, ring.half_angle_at(math.acos(ring.base_radius / radius)) - off)
    return deepest


@pytest.mark.parametrize("more", range(5, 14))
def test_tips_in_an_internal_gear_pass_as_their_paths_show(more: int):
    """The path of the pinion's tip corner is followed into the ring's teeth."""
    ring = {"type": "internal", "addendum": 0.8, "dedendum": 1.6}
    wide = pair(gear(30), gear(90, **ring), "120 mm").gears
    one, two = wide["a"].tooth, replace(wide["b"].tooth, teeth=30 + more)
    arguments = gear(30, dedendum=1.6), gear(30 + more, **ring), f"{2 * more} mm"
    if meets(one, two, 2e-3 * more) > 1e-6:
        assert more < 9
        assert "interfere beside the line of action" in refusal(pair, *arguments)
    else:
        assert more > 6
        pair(*arguments)


@pytest.mark.parametrize("shift", [0.0, 0.011, 0.02, 0.033])
def test_tips_pass_with_the_alteration_that_is_told(shift: float):
    """The message used to give a tip radius of six digits, which was often just too small."""
    ring = {"type": "internal", "addendum": 0.8, "dedendum": 1.6, "profile_shift": shift}
    one, two = gear(30, dedendum=1.6, profile_shift=-shift), gear(37, **ring)
    message = refusal(pair, one, two, "14 mm")
    assert "interfere beside the line of action" in message
    (told,) = re.findall(r'gears\.b\.tip_alteration = "(.+?)" would do', message)
    pair(one, two | {"tip_alteration": told}, "14 mm")


def star(copies: int, **planet) -> Case:
    at = {"centre": {"angle": "0 deg"}, "copies": copies}
    return Case(
        operating={"input": "s", "output": "r", "torque": "100 N*m"},
        gears={
            "s": gear(18, centre=["0 mm", "0 mm"]),
            "p": gear(36) | at | planet,
            "r": gear(90, type="internal", centre=["0 mm", "0 mm"]),
        },
        meshes={"s-p": {"law": "iso"}, "p-r": {"law": "iso"}},
    )


def test_as_many_planets_as_find_room():
    """sin(π/n) > r_a/a: at most four planets of 36 teeth fit around a sun of 18."""
    assert math.sin(math.pi / 4) > 38.0 / 54.0 > math.sin(math.pi / 5)
    star(4)
    message = refusal(star, 5)
    assert "At most 4 such gears fit evenly spaced" in message
    assert message.count("is too close to") == 1
    apart = 2.0 * 108.0 * math.sin(math.pi / 5)
    assert f"overlap by {152.0 - apart:.6g} mm" in message


def test_planets_at_one_place():
    assert "is the same as that of gear p1" in refusal(star, ["0 deg", "0 deg"])


def test_a_ring_that_is_not_called_internal():
    """Its centre is that of the sun, so planets would have to roll between two external gears."""
    set_ = star(3)
    with pytest.raises(CaseError) as found:
        set_.replace({"gears.r.type": "external"})
    message = str(found.value)
    assert "is the same as that of gear r, and both mesh with p1" in message
    assert 'If gear r is a ring around the other, it needs type = "internal".' in message
    assert "is a ring" not in refusal(star, ["0 deg", "0 deg"])


def test_gears_that_stand_side_by_side_along_the_axis():
    def wheels(height: str) -> Case:
        at = {"angle": "0 deg", "about": "a"}
        return Case(
            operating={
                "input": "a",
                "output": "c",
                "torque": "100 N*m",
                "external": {"b": "100 N*m"},
            },
            gears={
                "a": gear(20, centre=["0 mm", "0 mm"], face_width="80 mm"),
                "b": gear(60, centre=at),
                "c": gear(60, centre=at | {"angle": "20 deg", "height": height}),
            },
            meshes={"a-b": {"law": "iso"}, "a-c": {"law": "iso"}},
        )

    wheels("40 mm")  # the face widths of both wheels are 40 mm
    assert "gears.c.centre: is too close to gear b" in refusal(wheels, "39 mm")
    assert "At most 3 such gears fit" in refusal(wheels, "0 mm")


@pytest.mark.parametrize("teeth", [80, 84, 240])
def test_a_planet_no_smaller_than_its_ring_is_named(teeth):
    """No tip would fit, nor any centre distance: nothing is said of these."""
    star = load_case(CASES / "planetary/star.toml")
    with pytest.raises(CaseError, match=r"gear ring, .*, has no room for gear planet1") as e:
        star.replace({"gears.planet1.teeth": teeth})
    told = [problem for problem in e.value.problems if problem.key.startswith("meshes")]
    assert len(told) == 1
