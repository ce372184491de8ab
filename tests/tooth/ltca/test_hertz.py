"""Hertz's laws against closed forms, published figures and direct integration."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad
from tests.tooth.ltca.hertz import (
    PointContact,
    compression,
    compression_tangent,
    strip_shape,
    surfaces,
)

from loadshare.errors import Refused
from loadshare.tooth.contact.strips import (
    StripLine,
    axis_ratio,
    contact_modulus,
    half_width,
    width_factor,
)

STEEL = ((206e9, 206e9), (0.3, 0.3))
E_STAR = contact_modulus(*STEEL)
RADIUS = 1.0 / (2.0 / 25e-3 + 2.0 / 50e-3)


def test_balls_of_25_and_50_mm():
    """Steel, D 25 on D 50 mm; approach [µm] and pressure [MPa], printed to four figures."""
    contact = PointContact((1.0 / RADIUS, 1.0 / RADIUS), E_STAR)
    load = np.array([100.0, 200.0, 800.0])
    printed = np.array([3.749, 5.951, 14.996])
    np.testing.assert_allclose(contact.approach(load) * 1e6, printed, atol=5e-4)
    np.testing.assert_allclose(contact.pressure(load) / 1e6, [1528, 1926, 3057], atol=0.5)
    closed = np.cbrt(9.0 * load**2 / (16.0 * E_STAR**2 * RADIUS))
    np.testing.assert_allclose(contact.approach(load), closed, rtol=1e-12)


@given(st.floats(1e-6, 1.0))
def test_axis_ratio_solves_its_equation(ratio):
    """A/B = (K − E)/((a/b)²E − K), Johnson eq. (4.25), except where its terms cancel."""
    from scipy.special import ellipe, ellipk

    beta = float(axis_ratio(ratio))
    assert 0.0 < beta <= 1.0
    m = 1.0 - beta**2
    if m > 1e-3:
        k, e = ellipk(m), ellipe(m)
        assert (k - e) / (e / beta**2 - k) == pytest.approx(ratio, rel=1e-9)


def test_a_small_ellipticity_follows_the_expansion():
    """b/a → (A/B)^(2/3) near a circle (Johnson, section 4.2); the next term is of second order."""
    ratio = np.array([1.0 - 1e-3, 1.0 - 1e-5, 1.0 - 1e-9])
    np.testing.assert_allclose(axis_ratio(ratio), ratio ** (2.0 / 3.0), atol=1e-6)


def test_no_curvature_along_is_a_line():
    assert axis_ratio(0.0) == 0.0
    np.testing.assert_array_equal(width_factor([0.0, -3.0], [10.0, 10.0]), [1.0, 1.0])


@given(st.floats(0.02, 50.0))
def test_width_factor_is_the_ellipse_in_strips(ratio):
    """q = (π/2) p0 b in the middle of the ellipse, and b² = κ·4q/(πE*k) there."""
    across = 120.0
    contact = PointContact((ratio * across, across), E_STAR)
    a, b = (float(x) for x in contact.axes(500.0))
    width = b if ratio < 1.0 else a
    q = 0.5 * np.pi * float(contact.pressure(500.0)) * width
    expected = width**2 * np.pi * E_STAR * across / (4.0 * q)
    # Within 1e-6 of a circle the factor is taken as π/4, which is off by less than that.
    assert float(width_factor(ratio * across, across)) == pytest.approx(expected, rel=2e-6)


@given(st.floats(1.0, 1e6), st.floats(1e-3, 1e2))
def test_unit_scaling(force, scale):
    """Lengths times s, forces times s², E unchanged: approach times s, pressure unchanged."""
    one = PointContact((100.0, 20.0), E_STAR)
    other = PointContact((100.0 / scale, 20.0 / scale), E_STAR)
    assert float(other.approach(force * scale**2)) == pytest.approx(
        scale * float(one.approach(force)), rel=1e-12
    )
    assert float(other.pressure(force * scale**2)) == pytest.approx(
        float(one.pressure(force)), rel=1e-12
    )


def test_tangents_are_derivatives():
    contact = PointContact((100.0, 20.0), E_STAR)
    step = 1e-3
    slope = (contact.approach(300.0 + step) - contact.approach(300.0 - step)) / (2.0 * step)
    # Central differences: rounding of 1e-16 over a relative step of 3e-6.
    assert float(contact.tangent(300.0)) == pytest.approx(float(slope), rel=1e-8)

    def yielded(q):
        return float(compression(q, half_width(q, 90.0, E_STAR), 4e-3, 206e9, 0.3))

    q, dq = 3e5, 10.0
    slope = (yielded(q + dq) - yielded(q - dq)) / (2.0 * dq)
    tangent = compression_tangent(half_width(q, 90.0, E_STAR), 4e-3, 206e9, 0.3)
    assert float(tangent) == pytest.approx(slope, rel=1e-8)


@pytest.mark.parametrize("tau", [1e-9, 1e-5, 1e-2, 0.3, 1.0, 3.0, 1e2, 1e5])
def test_strip_shape_is_its_integral(tau):
    expected = quad(
        lambda u: 4.0 / np.pi * np.cos(u) ** 2 * np.arcsinh(tau / np.sin(u)),
        0.0,
        0.5 * np.pi,
        epsabs=0.0,
        epsrel=1e-11,
        limit=400,
        points=[min(tau, 1.0)],
    )[0]
    value, slope = strip_shape(np.array([tau, -tau]))
    # Below the table's first knot, 1e-7, the shape is linear, unlike the logarithm.
    near = 1e-8 if tau > 1e-7 else 0.5
    np.testing.assert_allclose(value, [expected, -expected], rtol=near)
    assert slope[0] == -slope[1]


def test_a_long_row_of_strips_is_the_compression_to_the_depth():
    """Weber and Banaschek's plane formula, for a line that is long compared with the depth: in the
    middle of a line 200 depths long, the 3-D strips differ from it by (h/L)².
    """
    n, depth, length, q = 401, 4e-3, 0.8, 3e5
    line = StripLine(
        np.full(n, length / n),
        np.full(n, 90.0),
        np.zeros(n),
        *STEEL,
        depth=(np.full(n, depth), np.full(n, depth)),
    )
    force = q * line.length
    moved = surfaces([line]).compliance(force[None])[0][0] @ force
    width = float(half_width(q, 90.0, E_STAR))
    closed = 2.0 * float(compression(q, width, depth, 206e9, 0.3))
    # The plane formula evaluates the field at depth at the edge of a contact of width b, the strips
    # at its middle: they differ by (b/h)².
    assert moved[n // 2] == pytest.approx(closed, rel=3e-3)
    np.testing.assert_allclose(line.pressure(force), 2.0 * q / (np.pi * width), rtol=1e-12)


def test_strip_tangent_is_the_derivative_of_the_yielding():
    n = 9
    line = StripLine(np.full(n, 4e-4), np.full(n, 90.0), np.full(n, 20.0), *STEEL)
    force = 50.0 + 10.0 * np.arange(n) % 37
    surface = surfaces([line])
    tangent = surface.compliance(force[None])[1][0]
    numeric = np.empty((n, n))
    for j, step in enumerate(1e-3 * np.eye(n)):
        up, down = (surface.compliance(f[None])[0][0] @ f for f in (force + step, force - step))
        numeric[:, j] = (up - down) / 2e-3
    # The table's slope is accurate to 1e-7 of a strip's own compliance.
    np.testing.assert_allclose(tangent, numeric, atol=1e-6 * tangent.max())


@pytest.mark.parametrize("load", [1e-3, 1.0, 1e2, 1e4])
def test_surfaces_of_lines_are_those_of_their_strips(load):
    """The series far from a strip is compared with the table, to the accuracy of the table: from
    strips a thousand half-widths apart to overlapping ones. Lines do not affect one another.
    """
    rng = np.random.default_rng(2)
    lines = [
        StripLine(rng.uniform(2e-4, 6e-4, n), rng.uniform(40.0, 90.0, n), np.zeros(n), *STEEL)
        for n in (17, 12)
    ]
    force = load * rng.uniform(0.5, 1.5, 29)
    # A second position has the same lines in the other order.
    both = np.stack([force, np.roll(force, 12)])
    secant, tangent = surfaces(lines, lines[::-1]).compliance(both)
    order = np.roll(np.arange(29), -17)
    np.testing.assert_array_equal(secant[1], secant[0][np.ix_(order, order)])
    secant, tangent = secant[0], tangent[0]
    start = 0
    for line in lines:
        part = slice(start, start := start + len(line.length))
        width = line.widths(force[part])
        away = line.place[:, None] - line.place
        ends = [away + 0.5 * line.length, away - 0.5 * line.length]
        (far, far_slope), (near, near_slope) = (strip_shape(end / width) for end in ends)
        scale = 1.0 / (np.pi * line.effective * line.length)
        wanted = scale * (far - near)
        tight = 1e-9 * wanted.max()
        np.testing.assert_allclose(secant[part, part], wanted, atol=tight)
        wanted = wanted - 0.5 * scale * (far_slope - near_slope)
        # The table's slope is accurate to 1e-7.
        np.testing.assert_allclose(tangent[part, part], wanted, atol=1e2 * tight)
    assert not secant[:17, 17:].any()


def test_flanks_that_do_not_part_are_refused():
    with pytest.raises(
        Refused, match=r"relative curvature -1 1/m\); make the modifications .*driven"
    ):
        StripLine(np.ones(2), np.array([1.0, -1.0]), np.zeros(2), *STEEL)
    with pytest.raises(ValueError, match="two positive relative curvatures"):
        PointContact((1.0, 0.0), E_STAR)
