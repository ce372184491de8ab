"""Unloaded contact of cylindrical pairs against the closed forms of the plane of action."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.tooth.geometry.samples import RELIEVED, gear, pair

from loadshare.involute import inv
from loadshare.tooth.cylindrical.gear import Modification
from loadshare.tooth.cylindrical.pair import HelicoidPair, Misalignment
from loadshare.tooth.geometry.gap import least_gap
from loadshare.tooth.unloaded.positions import transmission_error
from loadshare.tooth.unloaded.touch import contact_points

PAIRS = {
    "spur": {},
    "helical": {"helix": 0.3},
    "left-hand": {"helix": -0.25},
    "shifted": {"helix": 0.2, "profile_shift": 0.4},
    "internal": {"z2": 80, "ring": "driven"},
    "internal helical": {"z2": 80, "ring": "driven", "helix": -0.3},
    "driving ring": {"z1": 80, "z2": 24, "ring": "driver", "helix": 0.2},
    "centre distance": {"off": Misalignment(centre_distance=0.2e-3)},
    "helical, far apart and shifted": {
        "helix": 0.25,
        "off": Misalignment(centre_distance=0.2e-3, axial_shift=1e-3),
    },
    "ring, closer": {"z2": 80, "ring": "driven", "off": Misalignment(centre_distance=0.05e-3)},
}
ALL = pytest.mark.parametrize("data", PAIRS.values(), ids=PAIRS.keys())


def round_the_cycle(mesh, points=11, count=7):
    return mesh.positions(count, points)


@ALL
def test_unmodified_pairs_run_without_transmission_error(data):
    # The gap is computed from both surfaces, not from the plane of action; only round-off remains.
    for at in round_the_cycle(pair(**data)):
        assert abs(at.transmission_error) < 1e-13
        for line in at.lines:
            np.testing.assert_allclose(line.gap, 0.0, atol=1e-15)


@ALL
def test_lines_lie_in_the_plane_of_action(data):
    mesh = pair(**data)
    sign = mesh.driver_gear.kind
    angle, base = (
        mesh.working_angle,
        math.asin(
            math.sin(mesh.driver_gear.helix_angle) * math.cos(mesh.driver_gear.pressure_angle)
        ),
    )
    action = [sign * math.sin(angle), math.cos(angle)]
    for at in round_the_cycle(mesh):
        for line in at.lines:
            # Normals: cos β_b along the line of action, −sin β_b along the axis.
            expected = [*(math.cos(base) * np.array(action)), -math.sin(base)]
            np.testing.assert_allclose(line.normals, np.tile(expected, (11, 1)), atol=1e-13)
            # Moment of the line of action about the driver's axis: the base radius.
            x, y, _ = line.points.T
            np.testing.assert_allclose(
                x * action[1] - y * action[0], mesh.driver_gear.base_radius, rtol=1e-13
            )


@ALL
def test_relative_curvature_is_that_of_two_cylinders(data):
    # 1/ρ1 + 1/ρ2 with ρ = (length of the base tangent)/cos β_b, negative for the ring.
    mesh = pair(**data)
    one, two = mesh.driver_gear, mesh.driven_gear
    cosine = math.cos(one.base_helix_angle)
    at = mesh.positions([0.4], 9)[0]
    centre = mesh.driven.placement.origin
    for line in at.lines:
        total = 0.0
        for made, middle in ((one, np.zeros(3)), (two, centre)):
            radius = np.hypot(*(line.points - middle)[:, :2].T)
            total = total + made.kind * cosine / np.sqrt(radius**2 - made.base_radius**2)
        np.testing.assert_allclose(line.curvature, total, rtol=1e-12)
        np.testing.assert_allclose(line.curvature_along, 0.0, atol=1e-9)


@pytest.mark.parametrize("distance", [0.077, 0.0773, 0.0776])
def test_contact_ratio(distance):
    # ISO 21771: ε_α = [√(r_a1² − r_b1²) + √(r_a2² − r_b2²) − a sin α_wt] / p_bt.
    mesh = pair(distance=distance)
    one, two = mesh.driver_gear, mesh.driven_gear
    angle = math.acos((one.base_radius + two.base_radius) / distance)
    path = sum(math.sqrt(g.tip**2 - g.base_radius**2) for g in (one, two))
    pitch = 2.0 * math.pi * one.base_radius / one.teeth
    expected = (path - distance * math.sin(angle)) / pitch
    assert mesh.contact_ratio == pytest.approx(expected, rel=1e-13)
    # The share of positions with two pairs is the fractional part.
    count = 400
    found = mesh.extents(*mesh.ideal(np.arange(count) / count))
    two_pairs = np.bincount(found.position, minlength=count).mean()
    assert two_pairs == pytest.approx(expected, abs=2.0 / count)


def test_total_length_of_lines_over_the_cycle():
    # On average ε_α b / cos β_b, whatever the helix.
    mesh = pair(helix=0.3)
    total = [sum(line.length.sum() for line in at.lines) for at in round_the_cycle(mesh, 5, 200)]
    expected = mesh.contact_ratio * 20e-3 / math.cos(mesh.driver_gear.base_helix_angle)
    # 200 samples of a piecewise linear function.
    assert np.mean(total) == pytest.approx(expected, rel=1e-4)
    assert mesh.overlap_ratio == pytest.approx(20e-3 * math.sin(0.3) / (math.pi * 2e-3))


def test_centre_distance_without_backlash():
    # Both flanks touch: the teeth of both gears fill a pitch at the pitch circles.
    mesh = pair(profile_shift=0.5)
    thickness = 0.0
    for made in (mesh.driver_gear, mesh.driven_gear):
        radius = made.base_radius / math.cos(mesh.working_angle)
        thickness += 2.0 * radius * made.half_angle(radius)
    pitch = 2.0 * math.pi * mesh.driver_gear.base_radius / math.cos(mesh.working_angle) / 24
    assert thickness == pytest.approx(pitch, rel=1e-13)
    assert inv(mesh.working_angle) == pytest.approx(
        inv(math.radians(20.0)) + 2.0 * math.tan(math.radians(20.0)) * 0.5 / 77, rel=1e-13
    )


@settings(max_examples=15)
@given(st.floats(2e-6, 40e-6), st.floats(0.0, 0.999), st.sampled_from([0.0, 0.3]))
def test_gap_of_a_lead_crowned_pair(crowning, phase, helix):
    # Closed form: C_β (2ζ/b)², less its least value on the lines. The ray starts along the crowned
    # normal, whose slope of up to 4 C_β/b makes it longer by half the slope squared.
    mesh = pair(helix=helix, modification=Modification(lead_crowning=crowning))
    at = mesh.positions([phase], 31)[0]
    found = mesh.extents(np.array([at.driver_rotation]), np.array([at.driven_rotation]))
    nearest = min(
        0.0 if low <= 0.0 <= high else min(abs(low), abs(high))
        for low, high in zip(found.start, found.end, strict=True)
    )
    least = crowning * (nearest / 10e-3) ** 2
    second_order = crowning * (4.0 * crowning / 20e-3) ** 2 + 1e-13
    assert at.transmission_error * mesh.arm == pytest.approx(least, abs=second_order)
    lean = math.sin(mesh.driver_gear.base_helix_angle)
    for line in at.lines:
        # The normal of a helical flank, along which material is removed, has an axial component.
        axial = line.points[:, 2] - lean * (line.gap + least)
        expected = crowning * (axial / 10e-3) ** 2 - least
        np.testing.assert_allclose(line.gap, expected, atol=second_order)
        if helix == 0.0:
            np.testing.assert_allclose(
                line.curvature_along, 8.0 * crowning / (20e-3) ** 2, rtol=1e-3
            )


@pytest.mark.parametrize("exponent", [1, 2])
def test_gap_under_tip_relief(exponent):
    amount, length = 20e-6, 2e-3
    mesh = pair(
        modification=Modification(
            tip_relief=amount, tip_relief_length=length, tip_relief_exponent=exponent
        )
    )
    one = mesh.driver_gear
    seen = 0
    for at in round_the_cycle(mesh, 3, 40):
        for line in at.lines:
            radius = np.hypot(*line.points[:, :2].T)
            roll = np.sqrt(radius**2 - one.base_radius**2)
            tip = one.base_radius * one.tip_roll
            # Removed material shortens the base tangent to the point by the same length.
            lead = at.transmission_error * mesh.arm
            into = np.clip((roll + line.gap + lead - tip + length) / length, 0.0, 1.0)
            # The relief has slopes along the profile of up to 2 %/ξ = 3.6 %; the ray starts at that
            # angle and is longer by half its square, 13 nm in 20 µm.
            np.testing.assert_allclose(line.gap, amount * into**exponent - lead, atol=1.5e-8)
            seen += bool((line.gap > 5e-6).any())
    assert seen > 5


@pytest.mark.parametrize(
    ("off", "slope"),
    [
        (Misalignment(deviation=1e-4), 1e-4 * math.cos(math.radians(20.0))),
        (Misalignment(inclination=1e-4), 1e-4 * math.sin(math.radians(20.0))),
    ],
)
def test_gap_of_misaligned_spur_gears(off, slope):
    # A tilt out of the plane of axes opens the mesh by cos α, one in it by sin α of its angle.
    mesh = pair(off=off)
    at = mesh.positions([0.4], 40)[0]
    # One end is nearer by slope × b/2 and touches before the ideal pair would. The error is of
    # second order in the tilt, times the distances involved, 1e-8 × 50 mm.
    assert at.transmission_error * mesh.arm == pytest.approx(-slope * 10e-3, abs=2e-9)
    for line in at.lines:
        rise = np.polyfit(line.points[:, 2], line.gap, 1)[0]
        assert abs(rise) == pytest.approx(slope, rel=2e-3)
        assert line.gap.min() == pytest.approx(slope * 0.25e-3, rel=5e-3)


@ALL
def test_turning_by_one_pitch_gives_the_same_position(data):
    mesh = pair(**data | {"modification": RELIEVED})
    driver, driven = mesh.ideal(np.array([0.3]))
    turn = 2.0 * math.pi / mesh.driver_gear.teeth
    back = mesh.driven_step * turn / mesh.ratio
    found = mesh.extents(driver, driven)
    moved = mesh.extents(driver + turn, driven + back)
    np.testing.assert_array_equal(moved.pairs, found.pairs - 1)
    np.testing.assert_allclose(moved.start, found.start, atol=1e-15)
    np.testing.assert_allclose(moved.end, found.end, atol=1e-15)
    stations = np.linspace(found.start, found.end, 9, axis=1)
    one, two = found.trace(stations), moved.trace(stations)
    np.testing.assert_allclose(two.gap, one.gap, atol=1e-15)
    np.testing.assert_allclose(two.driver.point, one.driver.point, atol=1e-15)


def test_mirror_image_has_the_same_gaps():
    # Mirrored at z = 0: the hand of the helix, the deviation and the inclination change sign.
    off = Misalignment(inclination=2e-4, deviation=3e-4, centre_distance=1e-4, axial_shift=5e-4)
    image = replace(
        off, inclination=-off.inclination, deviation=-off.deviation, axial_shift=-off.axial_shift
    )
    one = pair(helix=0.3, off=off, modification=RELIEVED).positions([0.2], 20)[0]
    two = pair(helix=-0.3, off=image, modification=RELIEVED).positions([0.2], 20)[0]
    assert two.transmission_error == pytest.approx(one.transmission_error, abs=1e-12)
    for first, second in zip(one.lines, two.lines, strict=True):
        np.testing.assert_allclose(second.gap[::-1], first.gap, atol=1e-13)
        np.testing.assert_allclose(second.points[::-1] * [1.0, 1.0, -1.0], first.points, atol=1e-12)


def test_a_herringbone_half_is_a_helical_pair():
    half = pair(helix=0.3)
    both = HelicoidPair(
        replace(half.driver_gear, helices=2, helix_gap=5e-3),
        replace(half.driven_gear, helices=2, helix_gap=5e-3),
        half.centre_distance,
    )
    assert both.helices == 2
    one, two = half.positions([0.3], 5)[0], both.positions([0.3], 5)[0]
    for first, second in zip(one.lines, two.lines, strict=True):
        np.testing.assert_array_equal(first.points, second.points)


@pytest.mark.parametrize("phase", [0.1, 0.45, 0.8])
def test_contact_equations_agree_with_the_least_gap(phase):
    # Two methods for one angle: Newton on equal points and normals, and the least gap over the
    # lines.
    mesh = pair(
        helix=0.15,
        modification=Modification(lead_crowning=20e-6, profile_crowning=20e-6),
        off=Misalignment(deviation=2e-4),
    )
    points = contact_points(mesh, phase)
    first = min(points, key=lambda point: point.lead)
    # The line neglects the slope of the profile across it: slope²/(2κ), 3 nm at a slope of 1e-3.
    # Measured: 40, 507 and 24 nm; the crowned profile has slopes of up to 1e-2.
    assert 1e-9 < (transmission_error(mesh, phase) - first.lead) * mesh.arm < 6e-7
    if not first.edge:
        assert first.major @ first.normal == pytest.approx(0.0, abs=1e-12)
        assert 0.0 < first.least_curvature < first.greatest_curvature


@pytest.mark.parametrize("phase", [-0.1, 1.0])
def test_phase_out_of_range(phase):
    with pytest.raises(ValueError, match="0 ≤ phase < 1"):
        pair().positions([phase], 5)[0]
    with pytest.raises(ValueError, match="at least 1"):
        pair().positions([0.0], 0)[0]


def test_tooth_thickness_by_the_tabled_formula():
    # s_y = d_y [s/d + inv α − inv α_y] at the tip of z = 24, x = 0.3, m = 2 mm.
    made = gear(profile_shift=0.3)
    tip = math.acos(made.base_radius / made.tip)
    reference = math.pi / 2 * 2e-3 + 2.0 * 0.3 * 2e-3 * math.tan(math.radians(20.0))
    expected = 2.0 * made.tip * (reference / 48e-3 + inv(math.radians(20.0)) - inv(tip))
    assert 2.0 * made.tip * made.half_angle(made.tip) == pytest.approx(expected, rel=1e-13)


@ALL
def test_the_cycle_begins_at_the_pitch_point_in_the_middle_of_the_common_face(data):
    mesh = pair(**data)
    driver, _ = mesh.ideal(np.zeros(1))
    middle = np.array([0.5 * sum(mesh.ends)])
    roll = mesh.roll(np.zeros(1), middle, driver)
    np.testing.assert_allclose(roll, math.tan(mesh.working_angle), rtol=1e-12)


@pytest.mark.parametrize("helix", [0.0, 0.2])
def test_the_least_gap_is_found_in_a_kink(helix):
    """End relief on a tilted pair gives the gap a V shape with its minimum between stations."""
    relieved = Modification(end_relief=20e-6, end_relief_length=4.3e-3)
    mesh = pair(helix=helix, off=Misalignment(deviation=4e-4), modification=relieved)
    found = mesh.extents(*mesh.ideal(np.arange(5) / 5))
    stations = found.start[:, None] + np.outer(found.end - found.start, np.linspace(0, 1, 40001))
    dense = found.trace(stations).gap.min(axis=1)
    np.testing.assert_allclose(least_gap(found)[0], dense, rtol=0.0, atol=1e-9)
