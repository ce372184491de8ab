"""Bearings with radial clearance: closed forms, what they are without clearance, 50 digits.

Source: formulation, section 14; linear from where the clearance ends.
"""

import math

import numpy as np
import pytest
from tests.physics.test_metamorphic import FRAMES, placed
from tests.support import shipped

import loadshare as ls
from benchmarks import families
from benchmarks.reference.solve import reference
from loadshare.train import build_train

FORCE = 100.0 / 0.05
"""Torque of the pair over the base radius of its driver [N]."""
ALONG = np.array([-math.sqrt(1.0 - (150 / 160) ** 2), -150 / 160])
"""Line of action, as the driven gear pushes the driver."""


def pair(**bearing: object) -> ls.Case:
    """Two gears, the first in a bearing with clearance."""
    angle = f"{math.degrees(math.acos(150 / 160))!r} deg"
    return ls.Case(
        {
            "operating": {"input": "a", "output": "b", "torque": "100 N*m"},
            "gears": {
                "a": {"centre": ["0 mm", "0 mm"], "base_radius": "50 mm"},
                "b": {"centre": ["160 mm", "0 mm"], "base_radius": "100 mm"},
            },
            "meshes": {"a-b": {"pressure_angle": angle, "stiffness": "1e6 N*m/rad"}},
            "bearings": {"a": {"clearance": "20 um", "stiffness": "1e8 N/m", **bearing}},
        }
    )


def planets_in_bearings(clearance: str, stiffness: str = "5e8 N/m") -> ls.Case:
    """A star of four whose planets stand in bearings, and whose sun floats."""
    case = families.star(4)
    planets = [g for g in case.gears if g.startswith("planet")]
    bearing = {"clearance": clearance, "stiffness": stiffness}
    return case.replace(
        {
            "bearings": dict.fromkeys(planets, bearing),
            "errors": {
                planets[0]: {"installation": {"amount": "15 um", "direction": "40 deg"}},
                planets[2]: {"installation": {"amount": "8 um", "direction": "200 deg"}},
            },
        }
    )


@pytest.mark.parametrize("stiffness", [1e7, 1e8, math.inf])
@pytest.mark.parametrize("offset", [(0.0, 0.0), (3.0, -4.0)])
def test_a_loaded_gear_in_a_round_gap(stiffness, offset):
    """It goes along its force to the end of the gap, and F / K further."""
    told = "rigid" if math.isinf(stiffness) else f"{stiffness!r} N/m"
    found = ls.solve(pair(stiffness=told, offset=[f"{v} um" for v in offset])).positions[0]
    expected = np.array(offset) * 1e-6 + (20e-6 + FORCE / stiffness) * ALONG
    assert found.displacement["a"] == pytest.approx(tuple(expected), rel=1e-12)
    rest = found.floats["a"]
    assert rest.state == "on boundary"
    assert rest.boundary == "outer race"
    assert rest.reaction == pytest.approx(tuple(-FORCE * ALONG), rel=1e-12)


def test_a_bearing_without_clearance_is_an_elastic_or_a_rigid_one():
    without = {k: v for k, v in planets_in_bearings("0 um").to_dict().items() if k != "bearings"}
    gears = without["gears"]
    for told, support in (("5e8 N/m", "5e8 N/m"), ("rigid", "rigid")):
        for name in gears:
            if name.startswith("planet"):
                gears[name]["support"] = support
        plain, held = (ls.solve(c) for c in (ls.Case(without), planets_in_bearings("0 um", told)))
        for one, other in zip(plain.positions, held.positions, strict=True):
            assert other.torque == pytest.approx(one.torque, rel=1e-11)


@pytest.mark.parametrize("clearance", ["0 um", "0.3 um", "5 um", "40 um"])
@pytest.mark.parametrize("stiffness", ["5e8 N/m", "rigid"])
def test_shares_of_planets_in_bearings_agree_with_50_digits(clearance, stiffness):
    case = planets_in_bearings(clearance, stiffness)
    found, exact = ls.solve(case).positions[0], reference(build_train(case))
    assert found.torque == pytest.approx(dict(exact.torque), rel=1e-11)
    assert found.certificate.proved < 1e-11


def test_a_bearing_inside_a_limit_ring_agrees_with_50_digits():
    """Both limit the pinion; the bearing holds it before its ring does, or after."""
    for clearance in ("1 um", "200 um"):
        bearing = {"clearance": clearance, "stiffness": "2e8 N/m"}
        case = shipped("fgfbstts/limit_ring").replace({"bearings": {"4": bearing}})
        found, exact = ls.solve(case, positions=[1]).positions[0], reference(build_train(case))
        assert found.torque == pytest.approx(dict(exact.torque), rel=1e-11)
        names = [touch.name for touch in found.floats["4"].boundaries if touch.touching]
        assert ("bearing 4: outer race" in names) == (clearance == "1 um")


def test_clearances_of_bearings_are_samples_of_one_machine():
    case = planets_in_bearings("5 um")
    planet = next(iter(case.bearings))
    clearances, stiffnesses = np.array([0.0, 2.0, 7.0, 30.0]), np.array([5e8, 2e8, 1e9, 5e8])
    batch = ls.solve_many(
        case,
        {
            f"bearings.{planet}.clearance [um]": clearances,
            f"bearings.{planet}.stiffness [N/m]": stiffnesses,
        },
    )
    assert batch.certified.all()
    for sample, (clearance, stiffness) in enumerate(zip(clearances, stiffnesses, strict=True)):
        alone = case.replace(
            {
                f"bearings.{planet}.clearance": f"{clearance} um",
                f"bearings.{planet}.stiffness": f"{stiffness} N/m",
            }
        )
        torque = ls.solve(alone).positions[0].torque
        for mesh, expected in torque.items():
            here = float(batch.torque.sel(sample=sample, mesh=mesh).values[0])
            assert here == pytest.approx(expected, rel=1e-10, abs=1e-9)


def test_a_gear_moves_with_its_clearance():
    """The sensitivity of the closed form: a micrometre of clearance is one of displacement."""
    found = ls.sensitivity(pair(), "bearings.a.clearance")
    for side in ("rising", "falling"):
        rates = found.rates[1, "bearings.a.clearance", side]
        assert rates.displacement["a"] == pytest.approx(tuple(ALONG), rel=1e-9)


@pytest.mark.parametrize("frame", FRAMES)
def test_a_turned_train_shares_alike(frame):
    case = planets_in_bearings("5 um")
    turned = placed(case, FRAMES[frame])
    one, other = (ls.solve(c).positions[0].torque for c in (case, turned))
    assert other == pytest.approx(one, rel=1e-9)


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"bearings.a.clearance": "-1 um"}, "bearings.a.clearance"),
        ({"bearings.a.stiffness": None}, "bearings.a.stiffness"),
        ({"bearings.c": {"clearance": "1 um", "stiffness": "rigid"}}, "bearings.c"),
        ({"gears.a.support": "rigid"}, "gears.a.support"),
    ],
)
def test_what_does_not_hold_is_told(changes, told):
    with pytest.raises(ls.CaseError, match=told):
        pair().replace(changes)
