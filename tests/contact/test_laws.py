"""Compliance laws: inverse, energies and tangents.

Source: formulation, section 3: δ = bF + cF^(2/3), U* = ½bF² + ⅗cF^(5/3); the strain energy is its
conjugate.
"""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.certify.oracle import released

from loadshare.contact.law import RIGID, PowerLaw, TableLaw

TABLE = TableLaw((0.0, 100.0, 500.0, 2000.0), (0.0, 2e-6, 5e-6, 20e-6))
LAWS = {
    "linear": PowerLaw(2e-9),
    "b and c": PowerLaw(2e-9, 3e-8),
    "mostly Hertz": PowerLaw(1e-12, 3e-8),
    "c alone": PowerLaw(0.0, 3e-8),
    "table": TABLE,
}
FORCES = np.geomspace(1e-6, 1e6, 49)
every_law = pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)


@every_law
def test_force_is_the_inverse_of_compression(law):
    """It holds to a few units in the last place, over twelve decades."""
    for force in FORCES:
        assert law.force(law.compression(force)) == pytest.approx(force, rel=1e-14)


@settings(max_examples=300)
@given(
    b=st.floats(-15, -6), c=st.floats(-15, -5), force=st.floats(-12, 8),
)  # fmt: skip
def test_force_is_the_inverse_of_compression_for_any_coefficients(b, c, force):
    """Exponents are drawn: b, c and F over many decades and in any ratio."""
    law = PowerLaw(10.0**b, 10.0**c)
    assert law.force(law.compression(10.0**force)) == pytest.approx(10.0**force, rel=1e-14)


@every_law
def test_an_open_contact_carries_nothing(law):
    for gap in (0.0, -1e-9, -1.0):
        assert law.force(gap) == 0.0
        assert law.energy(gap) == 0.0
    assert law.compression(0.0) == 0.0


@every_law
def test_energies_are_conjugate(law):
    """Fenchel and Young: U(δ) + U*(F) ≥ Fδ, with equality on the law and nowhere else."""
    for force in FORCES[::6]:
        on = law.compression(force)
        assert law.energy(on) + released(law, force) == pytest.approx(force * on, rel=1e-13)
        for other in FORCES[::6]:
            if other != force:
                here = law.compression(other)
                assert law.energy(here) + released(law, force) > force * here * (1 + 1e-12)


@every_law
def test_derivatives_of_the_energies(law):
    """dU/dδ = F and dU*/dF = δ by central differences of relative width 1e-5, whose error is of
    order 1e-10.
    """
    for force in FORCES[1::7]:
        step = 1e-5 * force
        slope = (released(law, force + step) - released(law, force - step)) / (2 * step)
        assert slope == pytest.approx(law.compression(force), rel=1e-8)
        here = law.compression(force)
        step = 1e-5 * here
        slope = (law.energy(here + step) - law.energy(here - step)) / (2 * step)
        assert slope == pytest.approx(force, rel=1e-8)


@every_law
def test_secant_and_tangent(law):
    for force in FORCES[1::7]:
        assert law.secant(force) * force == pytest.approx(law.compression(force), rel=1e-14)
        compliance, offset = law.tangent(force)
        assert compliance * force + offset == pytest.approx(law.compression(force), rel=1e-13)
        step = 1e-5 * force
        slope = (law.compression(force + step) - law.compression(force - step)) / (2 * step)
        assert compliance == pytest.approx(slope, rel=1e-8)


@every_law
def test_scaling_is_a_change_of_units(law):
    scaled = law.scaled(250.0, 3e-6)
    for force in FORCES[::8]:
        assert scaled.compression(force / 250.0) * 3e-6 == pytest.approx(law.compression(force))


def test_light_load_has_an_infinite_compliance_only_with_hertz_contact():
    law = LAWS["b and c"]
    assert law.secant(0.0) == law.tangent(0.0)[0] == math.inf
    assert law.tangent(1e-18)[0] > 1e-3
    assert LAWS["linear"].tangent(0.0) == (2e-9, 0.0)
    assert TABLE.secant(0.0) == TABLE.tangent(0.0)[0] == 2e-8


def test_a_rigid_contact_does_not_yield():
    assert RIGID.is_rigid
    assert RIGID.compression(1e9) == RIGID.energy(1e-6) == 0.0
    with pytest.raises(ZeroDivisionError):
        RIGID.force(1e-6)


def test_a_table_passes_through_its_points_and_goes_on_straight():
    for force, compression in zip(TABLE.forces, TABLE.compressions, strict=True):
        assert TABLE.compression(force) == pytest.approx(compression, rel=1e-15)
    assert TABLE.compression(300.0) == pytest.approx(3.5e-6, rel=1e-14)
    assert TABLE.compression(4000.0) == pytest.approx(40e-6, rel=1e-14)
    assert not TABLE.is_linear
    assert TableLaw((0.0, 1.0, 3.0), (0.0, 2e-6, 6e-6)).is_linear


def test_a_table_of_the_power_law_converges_to_it():
    """For straight pieces over n equal steps, the interpolation error decreases as 1/n²."""
    law = LAWS["b and c"]
    errors = []
    for n in (50, 100, 200):
        points = np.linspace(0.0, 1000.0, n + 1)
        table = TableLaw(tuple(points), tuple(law.compression(f) for f in points))
        at = np.linspace(500.0, 1000.0, 777)
        errors.append(max(abs(table.compression(f) - law.compression(f)) for f in at))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx([2.0, 2.0], abs=0.05)
