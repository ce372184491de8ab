"""Tolerances by class against numbers from the standard's formulas."""

import math

import pytest

from loadshare.case import Gear
from loadshare.case.iso1328 import tolerances_of


def gear(**keys) -> Gear:
    spur = {"centre": ["0 mm", "0 mm"], "teeth": 25, "module": "4 mm", "face_width": "36 mm"}
    return Gear.model_validate(spur | keys)


def test_class_5_by_hand():
    """d = 100 mm, m = 4 mm, b = 36 mm have exact roots; the terms are worked out one by one."""
    found = tolerances_of(gear(tolerance_class=5))
    expected = {
        "single_pitch": 0.1 + 1.6 + 5.0,
        "cumulative_pitch": 0.2 + 5.5 + 2.8 + 12.0,
        "profile_slope": 1.6 + 0.1 + 4.0,
        "profile_form": 2.2 + 5.0,
        "profile": math.sqrt(5.7**2 + 7.2**2),
        "helix_slope": 0.5 + 2.1 + 4.0,
        "helix_form": 0.7 + 2.7 + 4.0,
        "helix": math.sqrt(6.6**2 + 7.4**2),
        "runout": 18.45,
    }
    for name, micrometres in expected.items():
        assert getattr(found, name) == pytest.approx(1e-6 * micrometres, rel=1e-12), name


def test_two_classes_are_a_factor_of_two():
    five, nine = (tolerances_of(gear(tolerance_class=k)) for k in (5, 9))
    for name in five.__slots__:
        assert getattr(nine, name) == pytest.approx(4.0 * getattr(five, name), rel=1e-14)


def test_a_helix_counts_by_its_reference_circle():
    found = tolerances_of(gear(tolerance_class=5, helix_angle="60 deg"))
    assert found.single_pitch == pytest.approx(1e-6 * (0.2 + 1.6 + 5.0), rel=1e-12)


def test_without_class_or_width():
    assert tolerances_of(gear()) is None
    bare = tolerances_of(gear(tolerance_class=6, face_width=None))
    assert bare.helix is bare.helix_slope is bare.helix_form is None
    assert bare.runout > 0.0
