import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from loadshare.case.gears import Tooth
from loadshare.involute import inv, inverse_inv


@given(st.floats(1e-4, 1.5))
def test_inverse_undoes_the_involute_function(angle):
    # inv α loses digits as α³/3 below α ≈ 1e-4: the error of α is that of inv α over tan² α.
    assert inverse_inv(inv(angle)) == pytest.approx(angle, abs=1e-15 / math.tan(angle) ** 2 + 1e-14)


def test_tabled_value():
    # inv 20° = 0.014904 in every gear handbook.
    assert inv(math.radians(20.0)) == pytest.approx(0.014904, abs=5e-7)


def test_ends():
    assert inverse_inv(0.0) == 0.0
    with pytest.raises(ValueError, match="negative"):
        inverse_inv(-1e-6)


def tooth(**shape: float) -> Tooth:
    usual = {"module": 5e-3, "pressure_angle": math.radians(40.0), "helix_angle": 0.0}
    return Tooth(**usual, addendum=1.0, dedendum=1.25, **shape)


@pytest.mark.parametrize(
    "pointed",
    [
        tooth(teeth=20, profile_shift=0.5, internal=False),
        tooth(teeth=75, profile_shift=0.0, internal=True),
    ],
)
def test_flanks_meet_where_teeth_have_no_thickness(pointed):
    angle = math.acos(pointed.base_radius / pointed.pointed)
    assert pointed.half_angle_at(angle) == pytest.approx(0.0, abs=1e-12)
    assert pointed.kind * (pointed.tip - pointed.pointed) > 0.0
