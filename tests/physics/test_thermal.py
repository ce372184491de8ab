"""Thermal growth: closed forms of backlash, planets and bearings.

Source: formulation, section 14; ISO 21771 for the geometry of the teeth.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.physics.test_bearings import FORCE, pair
from tests.support import shipped

import loadshare as ls
from loadshare.involute import normal_backlash
from loadshare.train import build_train

STEEL = 11.5e-6
HOUSING = {"operating.temperature": "70 K"}


def teeth(case: ls.Case, name: str, scale: float) -> object:
    """Return the teeth of a gear that is larger by a scale."""
    tooth = case.gears[name].tooth
    return replace(tooth, module=tooth.module * scale)


@pytest.mark.parametrize("internal", [False, True])
@pytest.mark.parametrize("warm", [("sun",), ("planet",), ("sun", "planet")])
def test_backlash_is_that_of_larger_teeth_at_larger_distances(internal, warm):
    """To first order in the growth, as far as half a pitch is tooth and half of it space."""
    partner = "ring" if internal else "sun"
    warm = tuple(partner if name == "sun" else name for name in warm)
    away = "134.9 mm" if internal else "135.1 mm"
    case = ls.Case(
        {
            "operating": {"input": partner, "output": "planet", "torque": "100 N*m"},
            "gears": {
                partner: {
                    "teeth": 90 if internal else 18,
                    "module": "5 mm",
                    "centre": ["0 mm", "0 mm"],
                    "type": "internal" if internal else "external",
                },
                "planet": {"teeth": 36, "module": "5 mm", "centre": [away, "0 mm"]},
            },
            "meshes": {f"{partner}-planet": {"backlash": "200 um", "stiffness": "1e6 N*m/rad"}},
        }
    )
    distance = case.gears["planet"].centre[0].si
    for housing in (0.0, 60.0):
        rise = {f"gears.{g}.temperature": "80 K" for g in warm}
        warmed = case.replace({**rise, "operating.temperature": f"{housing} K"})
        before, after = (next(iter(build_train(c).meshes.values())) for c in (case, warmed))
        scales = [1.0 + 80.0 * STEEL * (g in warm) for g in (partner, "planet")]
        grown = [teeth(case, g, s) for g, s in zip((partner, "planet"), scales, strict=True)]
        plain = [teeth(case, g, 1.0) for g in (partner, "planet")]
        # A grown pitch is larger in one gear's spaces, and smaller in the other's.
        change = 0.0
        for order in (1, -1):
            change += 0.5 * normal_backlash(*grown[::order], distance * (1.0 + housing * STEEL))
            change -= 0.5 * normal_backlash(*plain[::order], distance)
        computed = after.backlash + after.gaps[0] - before.backlash - before.gaps[0]
        assert computed == pytest.approx(change, rel=1e-2)


def test_what_is_warm_all_over_shares_as_if_it_were_cold():
    case = shipped("planetary/four_planets")
    rise = {f"gears.{g}.temperature": "70 K" for g in case.gears}
    warm = case.replace(rise | HOUSING)
    cold, found = (ls.solve(c).positions[0].torque for c in (case, warm))
    assert found == pytest.approx(cold, rel=1e-9)


def test_a_ring_between_gears_that_are_warm_all_over_keeps_its_room():
    """This includes a ring dimensioned on the drawing: growth with the housing is no error."""
    centres = {"a": ["-80 mm", "0 mm"], "p": ["0 mm", "0 mm"], "b": ["0 mm", "90 mm"]}
    case = ls.Case(
        {
            "operating": {"input": "a", "output": "b", "torque": "100 N*m"},
            "gears": {n: {"base_radius": "37 mm", "centre": at} for n, at in centres.items()},
            "meshes": {m: {"stiffness": "1e6 N*m/rad"} for m in ("a-p", "p-b")},
            "rings": {"p": {"neighbours": ["a", "b"], "float": "1 mm", "measured": "nominal"}},
        }
    )
    rise = {f"gears.{g}.temperature": "70 K" for g in case.gears}
    cold, warm = (ls.solve(c).positions[0] for c in (case, case.replace(rise | HOUSING)))
    np.testing.assert_allclose(warm.displacement["p"], cold.displacement["p"], rtol=1e-9)


def test_a_warm_planet_takes_more():
    """Its teeth are thicker on both sides, so it meets sun and ring sooner, by twice r tan α ε."""
    case = shipped("planetary/four_planets").replace({"errors": {}, "gears.sun.support": "rigid"})
    planet = next(n for n, g in case.gears.items() if g.carrier)
    rise = {f"gears.{planet}.temperature": "50 K"}
    torque = ls.solve(case.replace(rise)).positions[0].torque
    others = [t for m, t in torque.items() if m.startswith("sun-") and planet not in m]
    assert torque[f"sun-{planet}"] > max(others) + 1.0
    mesh = f"sun-{planet}"
    cold, warm = (build_train(c).meshes[mesh] for c in (case, case.replace(rise)))
    gear = case.gears[planet].tooth
    line = 50.0 * STEEL * gear.radius * math.sin(math.radians(20.0))
    assert cold.gaps[0] - warm.gaps[0] == pytest.approx(line, rel=1e-9)


@pytest.mark.parametrize(("gear", "housing"), [("60 K", "20 K"), ("10 K", "50 K")])
def test_a_warm_shaft_uses_up_clearance(gear, housing):
    case = pair(clearance="20 um", stiffness="1e8 N/m", diameter="60 mm").replace(
        {"gears.a.temperature": gear, "operating.temperature": housing}
    )
    case = case.replace({"operating.expansion": "23e-6 /K"})
    rises = [float(text.split()[0]) for text in (gear, housing)]
    clearance = 20e-6 + 0.03 * (rises[1] * 23e-6 - rises[0] * STEEL)
    found = ls.solve(case).positions[0]
    assert np.hypot(*found.displacement["a"]) == pytest.approx(clearance + FORCE / 1e8, rel=1e-9)


def test_a_clearance_that_is_used_up_is_reported():
    with pytest.raises(ls.CaseError, match=r"bearings\.a\.clearance.*used up"):
        ls.solve(pair(diameter="60 mm").replace({"gears.a.temperature": "90 K"}))


def test_degrees_are_not_a_rise():
    with pytest.raises(ls.CaseError, match="degC is not known"):
        pair().replace({"gears.a.temperature": "90 degC"})


def test_a_warm_housing_grows_once_however_a_case_is_changed():
    """A case made from another, samples of it, and rates must not apply the growth again."""
    case = shipped("two_path/from_teeth").replace(
        {
            "operating.temperature": "30 K",
            "errors.wheel1.installation": ["5 um", "0 um"],
            "operating.torque": "300 N*m",
        }
    )
    key, values = "operating.torque", [300.0, 310.0, 320.0]
    fresh = [ls.Case(case.replace({key: f"{t!r} N*m"}).to_dict()) for t in values]
    expected = [ls.solve(one).torque.values for one in fresh]
    changed = case
    for torque, right in zip(values, expected, strict=True):
        changed = changed.replace({key: f"{torque!r} N*m"})
        np.testing.assert_allclose(ls.solve(changed).torque.values, right, rtol=1e-12)
    many = ls.solve_many(case, {f"{key} [N*m]": values}).torque.values
    swept = ls.sweep(case, {key: [f"{t!r} N*m" for t in values]}).dataset.torque.values
    np.testing.assert_allclose(many, expected, rtol=1e-12)
    np.testing.assert_allclose(swept, expected, rtol=1e-12)
    mesh = ls.solve(case).torque.mesh.values[0]
    rate = ls.sensitivity(case, key, positions=[1]).rates[1, key, "rising"].torque[mesh]
    assert 10.0 * rate == pytest.approx(expected[1][0, 0] - expected[0][0, 0], rel=1e-9)
