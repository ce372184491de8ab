"""Stiffness of rolling bearings against published figures, Stribeck's sum and Hertz contact."""

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

from loadshare.case.rolling import BALL, ROLLER, STRIBECK, bearing_coefficient


def test_line_contact_as_published():
    """Harris: 8.06e4 l^(8/9) N/mm^(10/9) for one of a roller's two contacts, to its digits."""
    two = 8.06e4 * 2.0**-ROLLER * 20.0 ** (8.0 / 9.0) * 1e3**ROLLER
    found = bearing_coefficient("roller", 14, 0.02, 0.02) * STRIBECK["roller"] / 14
    assert found == pytest.approx(two, rel=2e-3)


def test_deflection_of_a_loaded_bearing_as_the_formula_has_it():
    """Nine balls of 12.7 mm under 8900 N: Q = 4.37 F/Z, δ = 4.36e-4 Q^(2/3) D^(-1/3) mm."""
    most = 4.37 * 8900.0 / 9.0
    deflection = 1e-3 * 4.36e-4 * most ** (2.0 / 3.0) * 12.7 ** (-1.0 / 3.0)
    coefficient = bearing_coefficient("ball", 9, 12.7e-3)
    assert (8900.0 / coefficient) ** (1.0 / BALL) == pytest.approx(deflection, rel=1e-12)


@pytest.mark.parametrize(("kind", "exponent"), [("ball", BALL), ("roller", ROLLER)])
def test_the_load_distribution_is_stribecks(kind: str, exponent: float):
    """1/s = ∫ cosⁿ⁺¹ ψ dψ/2π over the loaded half; published to three digits."""
    part, _ = quad(lambda angle: math.cos(angle) ** (exponent + 1.0), -math.pi / 2, math.pi / 2)
    assert 2.0 * math.pi / part == pytest.approx(STRIBECK[kind], rel=2e-3)


@pytest.mark.parametrize(("kind", "exponent"), [("ball", BALL), ("roller", ROLLER)])
def test_elements_one_by_one(kind: str, exponent: float):
    """The forces of inclined elements on a ring that is displaced, summed as vectors."""
    angle, displacement, elements = math.radians(25.0), 2e-5, 12
    one = bearing_coefficient(kind, 1, 0.01, 0.012) * STRIBECK[kind]  # along the line of contact
    sums = []
    for turn in np.linspace(0.0, 2.0 * math.pi / elements, 50, endpoint=False):
        around = turn + 2.0 * math.pi * np.arange(elements) / elements
        approach = np.maximum(displacement * np.cos(around) * math.cos(angle), 0.0)
        sums.append(float(np.sum(one * approach**exponent * math.cos(angle) * np.cos(around))))
    found = bearing_coefficient(kind, elements, 0.01, 0.012, angle) * displacement**exponent
    assert found == pytest.approx(np.mean(sums), rel=2e-3)  # s is published to three digits


def hertz(curvatures: tuple[float, float, float, float], force: float) -> float:
    """Return the approach of two steel bodies in point contact [m], from curvatures [1/m]."""
    total = sum(curvatures)
    difference = (curvatures[0] - curvatures[1] + curvatures[2] - curvatures[3]) / total

    def unlike(ratio: float) -> float:
        m = 1.0 - 1.0 / ratio**2
        whole = (ratio**2 + 1.0) * ellipe(m) - 2.0 * ellipk(m)
        return whole / ((ratio**2 - 1.0) * ellipe(m)) - abs(difference)

    ratio = brentq(unlike, 1.0 + 1e-9, 1e3)
    m = 1.0 - 1.0 / ratio**2
    modulus = 207e9 / (1.0 - 0.3**2)  # of one body; two bodies yield twice as much
    star = 2.0 * ellipk(m) / math.pi * (math.pi / (2.0 * ratio**2 * ellipe(m))) ** (1.0 / 3.0)
    return star * (1.5 * force * 2.0 / (total * modulus)) ** (2.0 / 3.0) * total / 2.0


def test_balls_in_grooves_are_about_as_hertz_has_it():
    """Grooves of 52 % of a ball's diameter, a pitch circle of five diameters: within 10 %."""
    size, force = 12.7e-3, 1000.0
    slope = 1.0 / 5.0
    ball = 2.0 / size
    groove = -1.0 / (0.52 * size)
    inner = hertz((ball, ball, ball * slope / (1.0 - slope), groove), force)
    outer = hertz((ball, ball, -ball * slope / (1.0 + slope), groove), force)
    one = bearing_coefficient("ball", 1, size) * STRIBECK["ball"]
    assert (force / one) ** (1.0 / BALL) == pytest.approx(inner + outer, rel=0.1)


def test_a_roller_without_length():
    with pytest.raises(ValueError, match="length"):
        bearing_coefficient("roller", 10, 0.01)
