"""Torsional stiffness of shafts from their dimensions, against the mechanics of a round bar."""

import math

import pytest
from scipy.integrate import quad

from loadshare.case import Case, Shaft
from loadshare.train import build_train


def shaft(**keys) -> Shaft:
    return Shaft.model_validate({"ends": ["b", "c"], **keys})


def test_a_solid_shaft_of_steel():
    """A handbook's bar: G I_p/l with I_p = π 60⁴/32 mm⁴ = 1.272345e6 mm⁴ is 504 485 N·m/rad."""
    bar = shaft(diameter="60 mm", length="200 mm")
    assert bar.torsional_stiffness == pytest.approx(79.3e9 * 1.272345e-6 / 0.2, rel=1e-6)


def test_sections_yield_one_after_the_other():
    stepped = shaft(
        diameter=["60 mm", "40 mm"],
        length=["0.1 m", "50 mm"],
        bore=["20 mm", "0 mm"],
        shear_modulus="80 GPa",
    )
    windup = 0.0
    for outer, inner, length in ((0.03, 0.01, 0.1), (0.02, 0.0, 0.05)):
        # ∫ r² dA over the section.
        polar, _ = quad(lambda r: 2.0 * math.pi * r**3, inner, outer)
        windup += length / (80e9 * polar)
    assert stepped.torsional_stiffness == pytest.approx(1.0 / windup, rel=1e-12)


def test_one_bore_holds_for_all_sections():
    one = shaft(diameter=["60 mm", "40 mm"], length=["1 m", "2 m"], bore="10 mm")
    both = shaft(diameter=["60 mm", "40 mm"], length=["1 m", "2 m"], bore=["10 mm", "10 mm"])
    assert one.torsional_stiffness == both.torsional_stiffness


def test_the_train_has_it(drive: Case):
    changes = {'shafts."b-c".stiffness': None, 'shafts."b-c".diameter': "60 mm"}
    case = drive.replace(changes | {'shafts."b-c".length': "200 mm"})
    given = drive.replace({'shafts."b-c".stiffness': "504485 N*m/rad"})
    found, expected = (build_train(c).shafts["b-c"].stiffness for c in (case, given))
    assert found == pytest.approx(expected, rel=1e-6)
    assert math.isinf(shaft(stiffness="rigid").torsional_stiffness)
