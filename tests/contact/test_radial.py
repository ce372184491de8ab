"""Radial graphs: the three stages of a clearance spline, jumps, stops, conjugates.

Source: formulation, section 5.
"""

import math
from itertools import pairwise

import numpy as np
import pytest
from tests.certify.oracle import complementary, interval

from loadshare.contact.radial import Piece, RadialLaw, round_ring_law, spline_law

KW, FM, S2 = 1.78e7, 178.0, 40e-6
"""K_w [N/m], F_m [N], S2 [m]; S1 = F_m/K_w = 10 µm."""
LAWS = {
    "continuous": spline_law(KW, None, S2, FM),
    "jump": spline_law(KW, 4e-6, S2, FM),
    "no friction": spline_law(KW, None, S2, 0.0),
    "no stick": spline_law(KW, 0.0, S2, FM),
    "no clearance": spline_law(KW, None, 0.0, FM),
    "elastic ring": round_ring_law(5e-6, 1e9),
    "rigid ring": round_ring_law(5e-6, math.inf),
    "bare wall": round_ring_law(0.0, 1e9),
}
every_law = pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)


def middle(law: RadialLaw, radius: float) -> float:
    low, high = interval(law, radius)
    assert low == pytest.approx(high, rel=1e-12)
    return low


def test_the_three_stages_of_a_spline():
    law = LAWS["continuous"]
    assert [p.name for p in law.pieces] == ["stick", "slip", "stop"]
    for radius, force in ((5e-6, KW * 5e-6), (20e-6, FM), (50e-6, FM + KW * 10e-6)):
        assert middle(law, radius) == pytest.approx(force, rel=1e-12)


def test_a_law_may_jump_up_where_slip_begins():
    """K_w S1 < F_m: any force between the two is admissible at R = S1."""
    law = LAWS["jump"]
    assert interval(law, 4e-6) == pytest.approx((KW * 4e-6, FM))
    assert middle(law, 3.999e-6) == pytest.approx(KW * 3.999e-6)
    assert middle(law, 4.001e-6) == pytest.approx(FM)
    assert law.step(1) == pytest.approx((KW * 4e-6, FM))


def test_a_law_that_would_drop_is_refused_with_its_three_numbers():
    with pytest.raises(
        ValueError, match=r"K_w S1 = 356 N .*F_m = 178 N .*K_w = 1\.78e\+07 N/m"
    ) as e:
        spline_law(KW, 20e-6, S2, FM)
    assert "S1 = 2e-05 m" in str(e.value)


def test_a_clearance_below_the_stick_limit_is_refused():
    with pytest.raises(ValueError, match="S2 = 3e-06 m is smaller than the radius S1 = 4e-06 m"):
        spline_law(KW, 4e-6, 3e-6, FM)


def test_friction_that_is_never_overcome_leaves_an_elastic_support():
    assert [p.name for p in LAWS["no clearance"].pieces] == ["stick"]
    assert middle(LAWS["no clearance"], 1e-3) == pytest.approx(KW * 1e-3)


def test_rings():
    assert LAWS["elastic ring"].reach == math.inf
    assert LAWS["rigid ring"].reach == 5e-6
    assert interval(LAWS["rigid ring"], 5e-6) == (0.0, math.inf)
    assert middle(LAWS["elastic ring"], 6e-6) == pytest.approx(1e9 * 1e-6)
    assert middle(LAWS["bare wall"], 1e-6) == pytest.approx(1e9 * 1e-6)


@every_law
def test_graphs_are_monotone(law):
    radii = np.linspace(0.0, min(2 * S2, law.reach), 201)
    intervals = np.array([interval(law, r) for r in radii])
    assert (intervals[:, 0] <= intervals[:, 1]).all()
    assert (intervals[:-1, 1] <= intervals[1:, 0] + 1e-9 * FM).all()


@every_law
def test_the_energy_is_the_integral_of_the_force(law):
    """The trapezoidal rule is exact for straight pieces if the corners are among the points."""
    corners = [law.start(k) for k in range(len(law.pieces) + 1)]
    points = sorted({c for c in corners if math.isfinite(c)} | set(np.linspace(0.0, S2, 101)))
    points = [p for p in points if p <= law.reach]
    total = 0.0
    for a, b in pairwise(points):
        inner = a + 1e-9 * (b - a), b - 1e-9 * (b - a)
        total += sum(np.mean(interval(law, r)) for r in inner) / 2 * (b - a)
        assert law.energy(b) == pytest.approx(total, rel=1e-6, abs=1e-18)


@every_law
def test_energies_are_conjugate(law):
    """W(R) + W*(F) ≥ FR, with equality exactly on the graph."""
    for radius in np.linspace(0.0, min(2 * S2, law.reach), 43):
        low, high = interval(law, radius)
        for force in np.linspace(0.0, 4 * FM, 41):
            slack = law.energy(radius) + complementary(law, force) - force * radius
            assert slack >= -1e-12 * FM * S2
            if low <= force <= high:
                assert slack == pytest.approx(0.0, abs=1e-12 * FM * S2)
            elif force < 0.99 * low or force > 1.01 * high + 1e-3:
                assert slack > 0.0


@every_law
def test_scaling_is_a_change_of_units(law):
    scaled = law.scaled(50.0, 2e-6)
    for radius in np.linspace(0.0, min(2 * S2, 0.999 * law.reach), 17):
        expected = np.array(interval(law, radius)) / 50.0
        assert interval(scaled, radius / 2e-6) == pytest.approx(tuple(expected), rel=1e-9)


def test_an_unbounded_complementary_energy_is_reported():
    """A level last piece carries no more than its own force."""
    law = RadialLaw((Piece(0.0, 1e6, 1e-6, "stick"), Piece(1.0, 0.0, math.inf, "slip")))
    assert math.isfinite(complementary(law, 1.0))
    assert complementary(law, 1.001) == math.inf


def test_level_pieces_of_one_force_are_one():
    law = RadialLaw(
        (
            Piece(0.0, 1.0, 2.0, "stick"),
            Piece(2.0, 0.0, 3.0, "slip"),
            Piece(2.0, 0.0, 4.0, "slip on"),
            Piece(2.0, 1.0, math.inf, "stop"),
        )
    )
    assert law.level(2.0, 0.0) == (2.0, 9.0)
    assert law.level(1.0, 0.0) is None


@pytest.mark.parametrize(("radius", "force"), [(0.0, 0.0), (0.5, 1.5), (1.0, 2.0), (2.0, 4.0)])
def test_the_least_force_of_a_graph(radius, force):
    """From 1 N it rises by 1 N/m, steps to 3 N at 1 m and rises again, up to a stop at 2 m."""
    law = RadialLaw((Piece(1.0, 1.0, 1.0, "first"), Piece(3.0, 1.0, 1.0, "second")))
    assert law.least(radius) == force
