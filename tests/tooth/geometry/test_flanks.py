"""Flank surfaces: derivatives against differences, curvatures against closed forms, and the face
gear against the shaper that cuts it."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.tooth.geometry.samples import RELIEVED, face_gear, gear

from loadshare.tooth.cylindrical.flank import HelicoidFlank
from loadshare.tooth.cylindrical.gear import Modification
from loadshare.tooth.face.flank import FaceFlank
from loadshare.tooth.geometry.compiled import lead, profile
from loadshare.tooth.geometry.flank import dot, principal_directions, unit

STEP = 1e-6


def helicoid(helix=0.0, internal=False, modification=None, side=1) -> HelicoidFlank:
    chosen = gear(
        90 if internal else 24,
        helix_angle=helix,
        internal=internal,
        addendum=0.8,
        modification=modification or Modification(),
    )
    return HelicoidFlank(chosen, side)


def spread(flank):
    """Return points all over a flank, away from the beginning of a relief."""
    if isinstance(flank, FaceFlank):
        return flank.at_blank(np.linspace(0.485, 0.555, 7)[:, None], np.linspace(0.084, 0.093, 5))
    low, high = sorted((flank.gear.form_roll, flank.gear.tip_roll))
    return np.linspace(low, high, 7)[:, None] + 1e-4, np.linspace(-9e-3, 9e-3, 5)


FLANKS = [
    helicoid(),
    helicoid(0.4, side=-1),
    helicoid(-0.3, modification=RELIEVED),
    helicoid(0.2, modification=RELIEVED._replace(end_relief=5e-6, end_relief_length=3e-3), side=-1),
    helicoid(internal=True),
    helicoid(0.3, internal=True, modification=RELIEVED, side=-1),
    FaceFlank(face_gear(), -1),
    FaceFlank(face_gear(), 1),
    FaceFlank(face_gear(85.0), -1),
]


@pytest.mark.parametrize("flank", FLANKS)
def test_derivatives_are_those_of_the_surface(flank):
    a, b = np.broadcast_arrays(*spread(flank))
    here = flank.patch(a, b, 0.3)
    for parameter, (over_a, over_b) in enumerate(STEP * np.eye(2)):
        after = flank.patch(a + over_a, b + over_b, 0.3)
        before = flank.patch(a - over_a, b - over_b, 0.3)
        for name, slopes in (("point", here.rays), ("normal", here.bends)):
            difference = (getattr(after, name) - getattr(before, name)) / (2.0 * STEP)
            stated = slopes[parameter]
            # Central differences: the step squared times the third derivative (at most 1e3 per
            # unit), and round-off over the step.
            np.testing.assert_allclose(difference, stated, rtol=1e-7, atol=3e-9)


@pytest.mark.parametrize("flank", FLANKS)
def test_normal_is_a_unit_vector_across_both_tangents(flank):
    here = flank.patch(*spread(flank), 0.3)
    np.testing.assert_allclose(dot(here.normal, here.normal), 1.0, atol=1e-14)
    for tangent in here.rays:
        np.testing.assert_allclose(dot(unit(tangent), here.normal), 0.0, atol=1e-13)


@pytest.mark.parametrize("flank", FLANKS)
def test_normal_points_out_of_the_tooth(flank):
    here = flank.patch(*spread(flank), 0.0)
    around = np.stack([-here.point[..., 1], here.point[..., 0], 0.0 * here.point[..., 0]], axis=-1)
    assert (flank.side * dot(here.normal, around) > 0.0).all()


@pytest.mark.parametrize(("helix", "internal"), [(0.0, False), (0.35, False), (0.35, True)])
def test_helicoid_curvatures(helix, internal):
    # A developable surface: r_b ξ / cos β_b is its only finite radius (negative inside a ring).
    flank = helicoid(helix, internal)
    roll, axial = spread(flank)
    here = flank.patch(roll, axial, 0.0)
    across = unit(here.rays[0])
    along = np.cross(here.normal, across)
    chosen = flank.gear
    radius = chosen.base_radius * roll / math.cos(chosen.base_helix_angle)
    bent = dot(across, here.normal_change(across))
    np.testing.assert_allclose(bent, np.broadcast_to(chosen.kind / radius, bent.shape), rtol=1e-12)
    np.testing.assert_allclose(here.normal_change(along), 0.0, atol=1e-10)


@pytest.mark.parametrize("side", [1, -1])
def test_modification_is_taken_off_along_the_normal(side):
    plain, cut = helicoid(0.3, side=side), helicoid(0.3, modification=RELIEVED, side=side)
    roll, axial = np.broadcast_arrays(*spread(plain))
    before, after = plain.patch(roll, axial, 0.0), cut.patch(roll, axial, 0.0)
    depth = dot(before.point - after.point, before.normal)
    taken, radius = cut.numbers, cut.gear.base_radius
    expected = [
        profile(taken, radius * a)[0] + lead(taken, b)[0]
        for a, b in zip(roll.ravel(), axial.ravel(), strict=True)
    ]
    np.testing.assert_allclose(depth.ravel(), expected, atol=1e-16)
    assert profile(taken, radius * cut.gear.tip_roll)[0] == pytest.approx(24e-6, abs=1e-15)
    assert lead(taken, 10e-3)[0] == pytest.approx(10e-6, abs=1e-15)


@pytest.mark.parametrize("angle", [90.0, 85.0, 100.0])
def test_face_gear_is_the_envelope_of_its_shaper(angle):
    # At a point of the gear, the distance from the shaper's flank along its base tangent is r_bs (θ
    # − θ_involute). Its least value over all shaper angles must be zero: the shaper reaches the
    # point, and never cuts deeper.
    length = np.linspace(0.5, 0.54, 3)[:, None] if angle <= 90.0 else np.array([[0.53], [0.55]])
    made = face_gear(angle)
    flank, shaper = FaceFlank(made), made.shaper
    roll, phi = flank.at_blank(length, np.linspace(0.084, 0.093, 4))
    point = flank.patch(roll, phi, math.pi / made.teeth).point  # space at +x
    own = phi - shaper.base_half_angle + roll

    def distance(angle_of_shaper):
        turned = made.roll_ratio * angle_of_shaper
        x = point[..., 0] * np.cos(turned) - point[..., 1] * np.sin(turned)
        y = point[..., 0] * np.sin(turned) + point[..., 1] * np.cos(turned)
        seen = np.stack([x, y, point[..., 2]], axis=-1) @ made.axes
        radius, polar = np.hypot(seen[..., 0], seen[..., 1]), np.arctan2(seen[..., 1], seen[..., 0])
        pressure = np.arccos(shaper.base_radius / radius)
        involute = shaper.base_half_angle - (np.tan(pressure) - pressure)
        return shaper.base_radius * (polar - angle_of_shaper - involute)

    np.testing.assert_allclose(distance(own), 0.0, atol=1e-15)
    swept = np.array([distance(own + turn) for turn in np.linspace(-0.05, 0.05, 41)])
    assert swept.min() > -1e-15
    # At other angles than the one that generates the point, the shaper is clear of it.
    assert (swept[[0, 10, 30, 40]] > 1e-6).all()


def test_both_sides_of_a_face_gear_are_mirror_images():
    one, other = FaceFlank(face_gear(), -1), FaceFlank(face_gear(), 1)
    length, depth = np.linspace(0.485, 0.555, 5)[:, None], np.linspace(0.084, 0.093, 5)
    right = one.patch(*one.at_blank(length, depth), 0.0)
    left = other.patch(*other.at_blank(length, depth), 0.0)
    mirror = np.array([1.0, -1.0, 1.0])
    np.testing.assert_allclose(left.point, right.point * mirror, atol=1e-15)
    np.testing.assert_allclose(left.normal, right.normal * mirror, atol=1e-13)


@settings(max_examples=25)
@given(st.floats(0.5, 0.55), st.floats(0.084, 0.093), st.floats(84.0, 92.0))
def test_blank_coordinates_lead_back_to_the_point(length, depth, angle):
    flank = FaceFlank(face_gear(angle))
    point = flank.patch(*flank.at_blank(np.array(length), np.array(depth)), 0.7).point
    found = flank.gear.blank(point)
    assert found == (pytest.approx(length, abs=1e-14), pytest.approx(depth, abs=1e-14))


def test_principal_directions_of_two_cylinders_crossed():
    # A spur flank and another one turned about the normal by 0.3: the relative curvatures are the
    # eigenvalues of the sum of two rank-one tensors, half-sum ± half the resultant at 2·0.3.
    first = helicoid()
    roll = np.array([0.5])
    one = first.patch(roll, np.zeros(1), 0.0)
    turned = one.turned(np.eye(3), np.zeros(3))
    n = one.normal[0]
    skew = np.cross(np.eye(3), n)
    rotation = np.eye(3) - math.sin(0.3) * skew + (1.0 - math.cos(0.3)) * skew @ skew
    other = turned.turned(rotation, np.zeros(3))
    major, minor = principal_directions(one, other)
    k = 1.0 / (first.gear.base_radius * 0.5)
    half = 0.5 * k * math.sqrt(2.0 + 2.0 * math.cos(0.6))
    for direction, expected in ((major, k - half), (minor, k + half)):
        change = one.normal_change(direction) + other.normal_change(direction)
        assert dot(direction, change)[0] == pytest.approx(expected, rel=1e-12)
    assert dot(np.cross(major, minor), one.normal)[0] == pytest.approx(1.0)
