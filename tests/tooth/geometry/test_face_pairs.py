"""Unloaded contact of face-gear pairs."""

import math

import numpy as np
import pytest
from tests.tooth.geometry.samples import face_gear, face_pair

from loadshare.settings import TEETH
from loadshare.tooth.cylindrical.gear import HelicoidGear, Modification
from loadshare.tooth.face.build import face_gear_pair
from loadshare.tooth.face.flank import (
    FaceFlank,
    planar_pointing_limit,
    pointing_limit,
    regularity,
    tip_half_angle,
    undercut_limit,
)
from loadshare.tooth.face.gear import FaceGear, Shaper
from loadshare.tooth.face.pair import FaceGearPair, FaceMisalignment
from loadshare.tooth.unloaded.positions import transmission_error
from loadshare.tooth.unloaded.touch import contact_points


@pytest.mark.parametrize("angle", [90.0, 85.0])
def test_pinion_like_the_shaper_touches_along_lines_without_error(angle):
    for at in face_pair(28, angle=angle).positions(5, 15):
        assert abs(at.transmission_error) < 1e-13
        for line in at.lines:
            np.testing.assert_allclose(line.gap, 0.0, atol=1e-15)
            # There is no curvature along a line of contact; across it, it is 1/(tens of mm).
            np.testing.assert_allclose(line.curvature_along, 0.0, atol=1e-9)
            assert (line.curvature > 10.0).all()


@pytest.mark.parametrize("teeth", [27, 26, 25])
def test_pinion_with_fewer_teeth_runs_without_error_too(teeth):
    # An involute pinion rolls inside the imaginary shaper at one pressure angle, so the aligned
    # pair remains conjugate (Litvin & Fuentes, ch. 18). The secant method for the least gap has an
    # error of some 1e-11 rad.
    for at in face_pair(teeth).positions(5, 5):
        assert abs(at.transmission_error) < 1e-9


@pytest.mark.parametrize("teeth", [27, 25])
def test_ideal_path_of_contact(teeth):
    # All contact is at r_bs (1/m)/cos α along the pinion's axis: m N2/2 with standard teeth.
    mesh = face_pair(teeth)
    assert mesh.contact_length == pytest.approx(0.508, rel=1e-14)
    seen = 0
    for phase in (0.0, 0.3, 0.6):
        for point in contact_points(mesh, phase):
            if not point.edge:
                assert point.lead == pytest.approx(0.0, abs=1e-13)
                assert point.point[2] == pytest.approx(0.508 - 0.52, abs=1e-11)
                assert math.atan2(point.normal[0], point.normal[1]) == pytest.approx(
                    math.radians(25.0), abs=1e-11
                )
                seen += 1
    assert seen >= 4


def test_contact_ratio_counts_the_pairs_in_contact():
    mesh, count = face_pair(), 40
    inside = 0
    for index in range(count):
        inside += sum(not point.edge for point in contact_points(mesh, index / count))
    assert inside / count == pytest.approx(mesh.contact_ratio, abs=2.0 / count)


def test_gap_grows_with_the_relative_curvature():
    # Near the point of contact the gap is κ s²/2, with the least relative curvature κ and the
    # distance s along the major axis; the next term is of relative size s over a radius.
    mesh = face_pair()
    point = next(p for p in contact_points(mesh, 0.1) if p.pair == 0)
    at = mesh.positions([0.1], 201)[0]
    line = next(x for x in at.lines if x.pair == 0)
    way = (line.points - point.point) @ point.major
    near = np.abs(way) < 4e-3
    assert near.sum() > 10
    fit = np.polyfit(way[near], line.gap[near], 3)
    assert fit[1] == pytest.approx(0.5 * point.least_curvature, rel=2e-3)
    # The line is tangent to the major axis.
    aside = (line.points - point.point) @ point.minor
    assert np.polyfit(way[near], aside[near], 2)[1] == pytest.approx(0.0, abs=1e-4)
    at_contact = np.argmin(np.abs(way))
    assert line.curvature[at_contact] == pytest.approx(point.greatest_curvature, rel=5e-3)
    assert line.curvature_along[at_contact] == pytest.approx(point.least_curvature, rel=5e-3)


def test_contact_is_the_more_localised_the_fewer_teeth_the_pinion_has():
    curvature = [
        next(p for p in contact_points(face_pair(n), 0.0) if p.pair == 0).least_curvature
        for n in (28, 27, 26, 25)
    ]
    assert curvature[0] == pytest.approx(0.0, abs=1e-9)
    steps = np.diff(curvature)
    assert (steps > 0.0).all()


@pytest.mark.parametrize("name", ["offset", "shaft_angle", "gear_shift"])
def test_misalignment_shifts_the_bearing_smoothly(name):
    # At first, lead and place of contact change in proportion: doubling a small misalignment
    # doubles the shift, and the deviation from that is of second order.
    size = {"offset": 40e-6, "shaft_angle": 2e-4, "gear_shift": 40e-6}[name]

    def contact(factor):
        mesh = face_pair(off=FaceMisalignment(**{name: factor * size}))
        return next(p for p in contact_points(mesh, 0.1) if p.pair == 0)

    place = {f: contact(f) for f in (-0.5, 0.0, 0.5, 1.0)}
    along = {f: p.point[2] - place[0.0].point[2] for f, p in place.items()}
    lead = {f: p.lead for f, p in place.items()}
    assert abs(along[1.0]) > 1e-4
    assert along[1.0] == pytest.approx(2.0 * along[0.5], rel=0.15)
    assert along[-0.5] == pytest.approx(-along[0.5], rel=0.15)
    assert lead[1.0] == pytest.approx(2.0 * lead[0.5], rel=0.02)
    # Litvin observes that misaligned face gears keep an almost constant transmission error.
    mesh = face_pair(off=FaceMisalignment(**{name: size}))
    errors = [transmission_error(mesh, phase) for phase in (0.0, 0.2, 0.4, 0.6, 0.8)]
    assert np.ptp(errors) < 1e-3 * abs(np.mean(errors))


def test_offset_and_gear_shift_turn_the_gear_as_kinematics_says():
    # Moving the gear by e changes the approach by e·n to first order, with n = (sin α, cos α)
    # across and along the pitch plane; so the driver is late by e cos α/r_b or early by e sin
    # α/r_b.
    angle, radius = math.radians(25.0), face_pair().arm
    for name, share in (("offset", math.cos(angle)), ("gear_shift", -math.sin(angle))):
        mesh = face_pair(off=FaceMisalignment(**{name: 1e-6}))
        expected = share * 1e-6 / radius
        assert transmission_error(mesh, 0.1) == pytest.approx(expected, rel=2e-3, abs=2e-11)


def test_pinion_shift_moves_nothing_but_the_bearing_on_the_pinion():
    plain, moved = face_pair(), face_pair(off=FaceMisalignment(pinion_shift=2e-3))
    for one, two in zip(plain.positions(3, 7), moved.positions(3, 7), strict=True):
        assert abs(two.transmission_error - one.transmission_error) < 1e-9
    points = [contact_points(mesh, 0.1)[1].point[2] for mesh in (plain, moved)]
    assert points[1] - points[0] == pytest.approx(-2e-3, abs=1e-11)


def test_newton_on_the_contact_equations_agrees_with_the_least_gap():
    mesh = face_pair(
        off=FaceMisalignment(shaft_angle=5e-4, offset=30e-6),
        modification=Modification(profile_crowning=8e-6, lead_crowning=10e-6),
    )
    for phase in (0.05, 0.35, 0.75):
        first = min(p.lead for p in contact_points(mesh, phase))
        assert transmission_error(mesh, phase) == pytest.approx(first, abs=1e-9)


@pytest.mark.parametrize("tolerance", [1e-6, 1e-8, 1e-10, 1e-13])
def test_transmission_error_is_within_its_tolerance(monkeypatch, tolerance):
    # A remaining gap is an angle of gap/arm. The exact lead is that of the contact equations; the
    # secant of the slope adds up to 1e-10 rad.
    mesh = face_pair(
        off=FaceMisalignment(shaft_angle=3e-4),
        modification=Modification(profile_crowning=30e-6, lead_crowning=10e-6),
    )
    exact = min(point.lead for point in contact_points(mesh, 0.35))
    monkeypatch.setattr(
        "loadshare.tooth.unloaded.positions.TEETH", TEETH._replace(touching=tolerance)
    )
    assert abs(transmission_error(mesh, 0.35) - exact) < tolerance / mesh.arm + 1e-10


def test_turning_by_one_pitch_gives_the_same_position():
    mesh = face_pair(off=FaceMisalignment(offset=50e-6))
    driver, driven = mesh.ideal(np.array([0.3]))
    turn = 2.0 * math.pi / 25
    found = mesh.extents(driver, driven)
    moved = mesh.extents(driver + turn, driven + turn / mesh.ratio)
    np.testing.assert_array_equal(moved.pairs, found.pairs - 1)
    np.testing.assert_allclose(moved.start, found.start, atol=1e-12)
    np.testing.assert_allclose(moved.end, found.end, atol=1e-12)


def test_many_positions_at_once_are_those_one_by_one():
    mesh = face_pair(off=FaceMisalignment(shaft_angle=3e-4, offset=50e-6))
    for at in mesh.positions(4, 9):
        one = mesh.positions([at.phase], 9)[0]
        assert at.transmission_error == pytest.approx(one.transmission_error, abs=1e-14)
        assert [line.pair for line in at.lines] == [line.pair for line in one.lines]
        for two, line in zip(one.lines, at.lines, strict=True):
            np.testing.assert_allclose(line.gap, two.gap, atol=1e-14)
            np.testing.assert_allclose(line.driven_uw, two.driven_uw, atol=1e-12)


def test_what_is_known_of_a_line_does_not_change_it():
    mesh = face_pair(off=FaceMisalignment(offset=50e-6))
    found = mesh.extents(*mesh.ideal(np.array([0.1, 0.6])))
    stations = np.linspace(found.start, found.end, 11, axis=1)
    cold = mesh.valleys(found.pairs, found.driver, found.driven).trace(stations)
    warm = found.trace(stations)
    np.testing.assert_allclose(warm.gap, cold.gap, atol=1e-15)
    np.testing.assert_allclose(warm.driver.point, cold.driver.point, atol=1e-15)
    np.testing.assert_allclose(warm.tangent, cold.tangent, atol=1e-12)


def test_ends_of_the_lines_lie_on_edges():
    mesh = face_pair(off=FaceMisalignment(offset=50e-6))
    found = mesh.extents(*mesh.ideal(np.array([0.3])))
    trace = found.trace(np.stack([found.start, found.end], axis=1))
    margins = np.min(list(mesh.margins(trace.driver_at, trace.driven_at).values()), axis=0)
    # Interpolated between stations 0.1 mm apart.
    np.testing.assert_allclose(margins, 0.0, atol=2e-8)


def narrow_pair() -> FaceGearPair:
    """Return a face gear only two modules wide, whose edges curve away beside the pinion's axis."""
    shaper = Shaper(2e-3, 24, math.radians(20.0), addendum=1.15)
    pinion = HelicoidGear(2e-3, 23, 6e-3, addendum=0.88, tip_radius=0.25)
    gear = FaceGear(91, shaper, 88.5e-3, 93e-3, addendum=0.98)
    return face_gear_pair(pinion, gear, FaceMisalignment(shaft_angle=1e-4))


def test_lines_of_a_narrow_face_end_at_its_edges_at_every_position():
    """This includes lines that begin at a corner, of which only the end of the scanned range is on
    both flanks.
    """
    mesh = narrow_pair()
    found = mesh.extents(*mesh.ideal(np.arange(400) / 400))
    assert (found.start < found.end).all()
    trace = found.trace(np.stack([found.start, found.end], axis=1))
    margins = np.min(list(mesh.margins(trace.driver_at, trace.driven_at).values()), axis=0)
    np.testing.assert_allclose(margins, 0.0, atol=1e-6)


def test_undercut_limit_by_the_closed_condition():
    # At 90°, u² sin α tan α = r_bs² ξ (ξ cos α − sin α) with u = r_bs/(m cos α) on the line of the
    # shaper's tip ξ; then L1² = u² + y².
    gear = face_gear()
    base, ratio, roll = gear.shaper.base_radius, gear.roll_ratio, gear.shaper.tip_roll
    low, high = 0.01, 1.0
    for _ in range(80):
        angle = 0.5 * (low + high)
        u = base / ratio / math.cos(angle)
        left = u**2 * math.sin(angle) * math.tan(angle)
        right = base**2 * roll * (roll * math.cos(angle) - math.sin(angle))
        low, high = (angle, high) if left < right else (low, angle)
    y = base * (roll * math.cos(angle) - math.sin(angle))
    assert undercut_limit(gear) == pytest.approx(math.hypot(u, y), rel=1e-13)


@pytest.mark.parametrize("angle", [90.0, 85.0, 100.0])
def test_flank_is_regular_outside_the_undercut_limit_only(angle):
    gear = face_gear(angle)
    flank, limit = FaceFlank(gear), undercut_limit(gear)
    tip = np.array(gear.shaper.tip_roll)
    for factor, sign in ((1.001, 1.0), (0.999, -1.0)):
        phi = flank.at_length(np.array(factor * limit), tip)
        assert sign * regularity(flank, tip, phi) > 0.0


@pytest.mark.parametrize(("teeth", "pressure"), [(28, 25.0), (22, 25.0), (40, 20.0)])
def test_pointing_limit(teeth, pressure):
    gear = face_gear(teeth=teeth, pressure_angle=math.radians(pressure))
    limit = pointing_limit(gear)
    assert tip_half_angle(FaceFlank(gear), limit) == pytest.approx(0.0, abs=1e-13)
    # Litvin's plane section is an approximation of second order in half a pitch over the radius.
    planar = planar_pointing_limit(gear)
    assert planar == pytest.approx(limit, rel=2e-3)
    assert planar != pytest.approx(limit, rel=1e-6)


def test_planar_pointing_limit_by_litvins_equation():
    # α − (N_s − 2)/(N_s cos α0) sin α = π/(2 N_s) − inv α0 and L2 = r_ps N2 cos α0/(N_s cos α).
    gear, alpha = face_gear(), math.radians(25.0)
    limit = planar_pointing_limit(gear)
    angle = math.acos(gear.shaper.radius * 160 * math.cos(alpha) / (28 * limit))
    left = angle - 26.0 / (28.0 * math.cos(alpha)) * math.sin(angle)
    right = math.pi / 56.0 - (math.tan(alpha) - alpha)
    assert left == pytest.approx(right, abs=1e-14)
