"""Stiffness by formula against ISO/TR 6336-30, example 1."""

import math

import pytest

from loadshare.case import Gear
from loadshare.tooth.law.iso6336 import basis_of, formula_stiffness, mesh_stiffness

UNIT = 1e9  # N/(mm·µm)


def example(**changes):
    data = {
        "teeth": (17, 103),
        "profile_shift": (0.145, 0.0),
        "dedendum": (1.4, 1.4),
        "contact_ratio": 1.5491,
        "helix_angle": math.radians(15.8),
    } | changes
    return formula_stiffness(**data)


def test_example_1():
    found = example()
    # Printed to 4 and 5 decimals; ε_α to 4.
    assert found.virtual_teeth == (
        pytest.approx(18.905, abs=5e-4),
        pytest.approx(114.543, abs=5e-4),
    )
    assert found.theoretical / UNIT == pytest.approx(17.85584, rel=1e-4)
    assert found.single / UNIT == pytest.approx(12.37047, rel=1e-4)
    assert found.mesh / UNIT == pytest.approx(17.46485, rel=1e-4)
    assert found.lead / UNIT == pytest.approx(14.84512, rel=1e-4)


def test_the_last_term_takes_the_second_gears_shift():
    # A public code squares x1 there and gets 17.844 for the example.
    assert example().theoretical / UNIT != pytest.approx(17.844, abs=5e-3)


def test_factors():
    assert example(blank_factor=0.9).single == pytest.approx(0.9 * example().single)
    assert example(dedendum=(1.2, 1.2)).single == pytest.approx(example().single / 0.9)
    assert example(dedendum=(1.2, 1.6)).single == pytest.approx(example().single)


@pytest.mark.parametrize(
    "wrong", [{"profile_shift": (2.0, 0.5)}, {"teeth": (0, 20)}, {"contact_ratio": 0.0}]
)
def test_out_of_range(wrong):
    with pytest.raises(ValueError, match=r"x1|positive"):
        example(**wrong)


@pytest.mark.parametrize(("sign", "limit"), [(-1.0, -0.5), (1.0, 2.0)])
def test_shifts_at_a_limit_may_be_rounded(sign, limit):
    """The sum of decimals is rarely exactly the decimal that a user has in mind."""
    shifts = (limit - sign * 0.1, sign * (0.1 + 6e-16))
    assert sign * (sum(shifts) - limit) > 0.0
    at_limit = example(profile_shift=(limit - sign * 0.1, sign * 0.1))
    assert example(profile_shift=shifts).single == pytest.approx(at_limit.single, rel=1e-12)
    with pytest.raises(ValueError, match=f"x1 . x2 = {limit + sign * 1e-6:.7g}: the formula holds"):
        example(profile_shift=(limit, sign * 1e-6))


def test_equal_gears_with_unequal_shifts_are_one_pair_either_way():
    """The formula is not symmetric in its gears; for equal teeth, the larger shift comes first."""
    teeth = {"teeth": 25, "module": "4 mm", "face_width": "40 mm", "centre": ["0 mm", "0 mm"]}
    one, two = (Gear.model_validate({**teeth, "profile_shift": x}) for x in (0.4, -0.1))
    there, back = (mesh_stiffness(pair, 0.1012) for pair in ((one, two), (two, one)))
    assert there == back


def test_a_contact_ratio_below_that_of_the_formula_is_part_of_its_basis():
    """From the lengths of the paths to both tips: 1.066 for 25/50 teeth with addenda of 0.6."""
    stub = {"module": "4 mm", "face_width": "40 mm", "centre": ["0 mm", "0 mm"]}
    short, long = (
        tuple(Gear.model_validate({**stub, "teeth": z, "addendum": a}) for z in (25, 50))
        for a in (0.6, 1.0)
    )
    distance = 0.5 * 4e-3 * 75
    assert basis_of(short, distance, measured=True).endswith("holds from ε_α = 1.2, here 1.07")
    assert basis_of(long, distance, measured=True).endswith("solid bodies")
