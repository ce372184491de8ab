"""Centres that follow from teeth, along chains of meshes."""

import math
from itertools import pairwise
from pathlib import Path

import pytest

from loadshare.case import Case, load_case
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


@pytest.mark.parametrize("internal", [False, True])
@pytest.mark.parametrize("helix", ["0 deg", "20 deg"])
def test_shifted_teeth_meet_without_backlash(internal: bool, helix: str):
    """`normal_backlash` measures tooth thickness at the working circles, on its own."""
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
    """About the carrier or the origin."""
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
    free = case.replace({f"gears.{name}.centre": about(pole, 0.0)})
    x, y, z = free.centres()[name]
    assert math.hypot(x, y) == pytest.approx(printed, abs=5e-6)
    assert (y, z) == (0.0, free.centres()[pole][2])


def test_external_meshes_decide_before_internal_ones():
    """A sun with a positive shift pushes the planet out, and the ring has less play."""
    given = load_case(CASES / "planetary" / "four_planets.toml")
    shifted = {"gears.sun.profile_shift": 0.02, "gears.ring.profile_shift": -0.1}
    case = given.replace(shifted)
    sun, planet, ring = (case.gears[n].tooth for n in ("sun", "planet1", "ring"))
    distance = case.centres()["planet1"][0]
    assert distance > 0.135
    assert normal_backlash(sun, planet, distance) == pytest.approx(0.0, abs=1e-15)
    assert normal_backlash(planet, ring, distance) > 1e-4


ALONG_Y = {"axis": "y"}


@pytest.mark.parametrize(
    ("a", "b", "told"),
    [
        ({}, {"centre": about("c", 0.0)}, "the gear meshes with c or with a gear on the axis"),
        ({}, {"centre": about(None, 90.0), "module": "3 mm"}, "different modules"),
        ({"centre": ["1 mm", "0 mm"]}, {"centre": about(None, 0.0)}, "meshes with a gear on the"),
        (ALONG_Y, {"centre": about("a", 0.0), **ALONG_Y}, "where axes are along z"),
        ({"profile_shift": -3.5, "addendum": 4.0}, {"centre": about("a", 0.0)}, "at any distance"),
        (gear(50), {"centre": about("a", 0.0), **gear(45, type="internal")}, "at any distance"),
    ],
)
def test_what_keeps_a_distance_from_following_is_told(a: dict, b: dict, told: str):
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
    assert told in str(caught.value)
