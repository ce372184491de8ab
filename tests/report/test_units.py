"""Units of axes and the forms of figures."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.support import shipped

import loadshare as ls
from loadshare.numbers import NUMBER, Unit, engineering, significant
from loadshare.report.words import undetermined_lines


@pytest.mark.parametrize(
    ("value", "unit", "name", "shown"),
    [
        (8.24e-6, "m", "µm", 8.24),
        (0.4e-3, "m", "µm", 400.0),
        (0.1607, "m", "mm", 160.7),
        (3e-9, "m", "nm", 3.0),
        (81.85, "N", "N", 81.85),
        (71550.0, "N", "kN", 71.55),
        (7571.7, "N·m", "N·m", 7571.7),
        (2.5e5, "N·m", "kN·m", 250.0),
        (2.5e-4, "rad", "µrad", 250.0),
        (1.2e-3, "rad", "mrad", 1.2),
        (1.067, "1", "", 1.067),
        (5.0, "s", "s", 5.0),
    ],
)
def test_the_unit_an_engineer_reads(value, unit, name, shown):
    found = engineering([value, -0.5 * value, math.nan], unit)
    assert found.name == name
    assert found.of(value) == pytest.approx(shown, rel=1e-12)


def test_nothing_is_given_in_micrometres():
    assert engineering([], "m").name == "µm"
    assert engineering([0.0], "m").name == "µm"


def test_titles():
    assert Unit("N·m").title("torque") == "torque [N·m]"
    assert NUMBER.title("Ω") == "Ω"


def test_no_negative_zero():
    assert math.copysign(1.0, Unit("µm", 1e6).of(-0.0)) == 1.0


@given(st.floats(1e-12, 1e12), st.integers(1, 8))
def test_significant_digits_round_trip(value, digits):
    text = significant(value, digits)
    assert "e" not in text
    # Half a unit of the last digit kept, relative to the leading digit.
    assert float(text) == pytest.approx(value, rel=0.5000001 * 10.0 ** (1 - digits))


@pytest.mark.parametrize(
    ("value", "text"),
    [(71553.2, "71550"), (81.8512, "81.85"), (0.0, "0"), (2.0, "2"), (1e-5, "0.00001")],
)
def test_significant_digits(value, text):
    assert significant(value) == text


def test_an_end_of_a_range_that_is_round_off_is_zero():
    """Also where nothing is loaded, so that no other end is larger."""
    case = shipped("star/floating_sun_3").replace({"operating.torque": "0 N*m"})
    lines = undetermined_lines(ls.solve(case).positions)
    assert any(", up to 0 µrad" in line for line in lines)
    assert not any("0.0000" in line for line in lines)
