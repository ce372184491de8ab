"""Masses of gears against closed forms of rings and discs."""

import math

import pytest

from loadshare.case import Gear, Quantity
from loadshare.case.mass import inertia_of, mass_of

# A reference diameter of 100 mm, a root diameter of 87.5 mm.
SPUR = {"centre": ["0 mm", "0 mm"], "teeth": 20, "module": "5 mm", "face_width": "40 mm"}
DISC = math.pi * 0.05**2 * 0.04 * 7850.0


def gear(**keys) -> Gear:
    return Gear.model_validate(SPUR | keys)


def test_a_disc_of_steel():
    assert mass_of(gear()) == pytest.approx(DISC, rel=1e-14)
    assert inertia_of(gear()) == pytest.approx(0.5 * DISC * 0.05**2, rel=1e-14)


def test_a_bore_takes_away_a_disc():
    bored = gear(bore="60 mm", density="7.8 g/cm^3")
    disc, hole = (math.pi * r**2 * 0.04 * 7800.0 for r in (0.05, 0.03))
    assert mass_of(bored) == pytest.approx(disc - hole, rel=1e-14)
    inertia = 0.5 * (disc * 0.05**2 - hole * 0.03**2)
    assert inertia_of(bored) == pytest.approx(inertia, rel=1e-14)


def test_a_helix_widens_the_reference_circle():
    helical = gear(helix_angle="30 deg")
    assert mass_of(helical) == pytest.approx(DISC / math.cos(math.radians(30)) ** 2, rel=1e-14)


def test_a_thin_web_below_a_rim():
    webbed = gear(bore="30 mm", rim="8.75 mm", web="10 mm")  # the rim ends at a radius of 35 mm
    rim = math.pi * (0.05**2 - 0.035**2) * 0.04 * 7850.0
    web = math.pi * (0.035**2 - 0.015**2) * 0.01 * 7850.0
    assert mass_of(webbed) == pytest.approx(rim + web, rel=1e-14)
    inertia = 0.5 * (rim * (0.05**2 + 0.035**2) + web * (0.035**2 + 0.015**2))
    assert inertia_of(webbed) == pytest.approx(inertia, rel=1e-14)


@pytest.mark.parametrize("outside", [{"rim": "13.75 mm"}, {"outside_diameter": "440 mm"}])
def test_an_internal_gear_ends_where_its_rim_does(outside):
    ring = gear(type="internal", teeth=80, **outside)  # root at 206.25 mm, outside at 220 mm
    expected = math.pi * (0.22**2 - 0.2**2) * 0.04 * 7850.0
    assert mass_of(ring) == pytest.approx(expected, rel=1e-14)


def test_a_given_mass_is_spread_like_the_body():
    assert mass_of(gear(mass="5 kg")) == 5.0
    assert inertia_of(gear(mass="5 kg")) == pytest.approx(0.5 * 5.0 * 0.05**2, rel=1e-14)


def test_what_nothing_tells():
    bare = Gear(centre=(Quantity("0 mm", 0.0),) * 2, base_radius=Quantity("1 m", 1.0))
    assert mass_of(bare) is None
    assert inertia_of(bare) is None
    assert mass_of(gear(type="internal", teeth=80)) is None
    carrier = Gear.model_validate({"type": "carrier", "centre": ["0 m", "0 m"], "mass": "8 kg"})
    assert mass_of(carrier) == 8.0
    assert inertia_of(carrier) is None
