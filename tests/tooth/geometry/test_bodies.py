"""Tooth outlines: the root against the rack that cuts it, and flanks against contact lines."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.reproducible import examples
from tests.tooth.geometry.samples import face_gear, face_pair, gear, pair

from loadshare.tooth.cylindrical.body import HelicoidBody, root_curve
from loadshare.tooth.face.body import FaceBody
from loadshare.tooth.geometry.body import turned

BODIES = [
    HelicoidBody(gear()),
    HelicoidBody(gear(helix_angle=0.3, profile_shift=0.4)),
    HelicoidBody(gear(tip_radius=0.0)),
    HelicoidBody(gear(80, internal=True, addendum=0.8, helix_angle=-0.2)),
    FaceBody(face_gear()),
    FaceBody(face_gear(85.0)),
]


@pytest.mark.parametrize("body", BODIES)
def test_outline_runs_from_the_middle_of_the_space_to_the_tip(body):
    w = np.linspace(0.0, 1.0, 5)
    half_pitch = math.pi / body.gear.teeth
    twist = getattr(body.gear, "twist", 0.0) * (w - 0.5) * getattr(body.gear, "face_width", 0.0)
    start, tip = body.outline(0.0, w, 1), body.outline(1.0, w, 1)
    polar = np.arctan2(start[:, 1], start[:, 0]) - twist
    np.testing.assert_allclose(polar, half_pitch, atol=1e-13)
    land = np.arctan2(tip[:, 1], tip[:, 0]) - twist
    assert ((land > 0.0) & (land < half_pitch)).all()
    if body.gear.shape == "face":
        np.testing.assert_allclose(body.gear.blank(tip)[1], body.gear.tip_depth, atol=1e-15)
        if body.gear.shaft_angle == math.pi / 2:
            # The shaper's tip cylinder leaves a plane.
            np.testing.assert_allclose(start[:, 2], -body.gear.shaper.tip, atol=1e-15)
    else:
        np.testing.assert_allclose(np.hypot(tip[:, 0], tip[:, 1]), body.gear.tip, rtol=1e-14)
        np.testing.assert_allclose(np.hypot(start[:, 0], start[:, 1]), body.gear.root, rtol=1e-14)


@pytest.mark.parametrize("body", BODIES)
def test_outline_is_in_one_piece_and_climbs_steadily(body):
    u = np.linspace(0.0, 1.0, 401)
    line = body.outline(u, 0.3, 1)
    steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    length = steps.sum()
    # No jump anywhere, including at the foot; steps have equal lengths to within a factor.
    assert steps.max() < 12.0 * length / 400
    around = np.unwrap(np.arctan2(line[:, 1], line[:, 0]))
    assert (np.diff(around) < 1e-12).all()


@pytest.mark.parametrize("body", [b for b in BODIES if b.gear.shape != "face"])
def test_fillet_is_tangent_to_the_flank(body):
    step = 1e-7
    u = body.foot + np.array([-2 * step, -step, step, 2 * step])
    line = body.outline(u, 0.5, 1)
    before, after = line[1] - line[0], line[3] - line[2]
    if body.gear.tip_radius > 0.0:
        cosine = before @ after / np.linalg.norm(before) / np.linalg.norm(after)
        # The fillet's end is found by differences over 1e-7 of its length.
        assert cosine == pytest.approx(1.0, abs=1e-8)


def test_a_root_without_radius_is_a_sharp_corner():
    bodies = [
        HelicoidBody(gear(80, internal=True, addendum=0.8, tip_radius=r)) for r in (0.0, 1e-6)
    ]
    u = np.linspace(0.0, 1.0, 41)
    sharp, round_ = (body.outline(u, 0.5, 1) for body in bodies)
    np.testing.assert_allclose(sharp, round_, atol=1e-8)


def test_the_rack_touches_all_of_the_root_and_cuts_none_of_it():
    # Independent check: the rack's tip circle, rolled in small steps, against points of the root.
    made = gear(20, profile_shift=0.2)
    root = root_curve(made)(np.linspace(0.0, 1.0, 40)) * np.exp(-1j * math.pi / made.teeth)
    corner = made.tip_radius * made.module
    flat = made.module * (
        math.pi / 4
        - (made.dedendum - made.tip_radius) * math.tan(made.pressure_angle)
        - made.tip_radius / math.cos(made.pressure_angle)
    )
    depth = (made.profile_shift - made.dedendum + made.tip_radius) * made.module
    least = np.full(root.shape, np.inf)
    for travel in np.linspace(-3.0, 3.0, 20001) * made.module:
        # The space at +x is turned up to +y; the gear turns by −travel/r about its centre.
        seen = root * np.exp(1j * (0.5 * math.pi - travel / made.radius)) - 1j * made.radius
        x, y = seen.real - travel, seen.imag
        outside = np.hypot(x - np.clip(x, -flat, flat), y - depth) - corner
        least = np.minimum(least, np.where(y > depth, np.inf, outside))
    # The error of the steps of 0.3 µm is their square over the radii.
    np.testing.assert_allclose(least[1:], 0.0, atol=2e-10)


@settings(max_examples=examples(20, 40))
@given(st.sampled_from(BODIES), st.floats(0.41, 1.0), st.floats(0.0, 1.0), st.sampled_from([1, -1]))
def test_locate_finds_where_outline_stands(body, u, w, side):
    found = body.locate(body.outline(u, w, side))
    assert found == (pytest.approx(u, abs=1e-10), pytest.approx(w, abs=1e-11))


@pytest.mark.parametrize("body", BODIES)
def test_sides_mirror_each_other(body):
    u = np.linspace(0.0, 1.0, 21)
    one, other = body.outline(u, 0.5, 1), body.outline(u, 0.5, -1)
    np.testing.assert_allclose(one * [1.0, -1.0, 1.0], other, atol=1e-15)


def to_space(body, points, rotation):
    """Return points of the gear turned by `rotation` [rad], in the fixed frame."""
    return turned(points, rotation) @ body.placement.axes.T + body.placement.origin


@pytest.mark.parametrize(
    "made",
    [
        lambda: pair(helix=0.3),
        lambda: pair(z2=80, ring="driven", helix=-0.2),
        lambda: pair(z1=80, z2=24, ring="driver"),
        face_pair,
        lambda: face_pair(angle=85.0),
    ],
)
def test_contact_lines_lie_on_the_outlines(made):
    mesh = made()
    # This relates frames, rotations, tooth numbers, sides and flank coordinates.
    at = mesh.positions([0.3], 7)[0]
    for line in at.lines:
        for body, rotation, uw, side, step, gap in (
            (mesh.driver, at.driver_rotation, line.driver_uw, 1, 1, 0.0),
            (
                mesh.driven,
                at.driven_rotation,
                line.driven_uw,
                mesh.driven_side,
                mesh.driven_step,
                line.gap,
            ),
        ):
            turn = rotation + 2.0 * math.pi * step * line.pair / body.gear.teeth
            outline = to_space(body, body.outline(*uw.T, side), turn)
            reached = line.points + np.asarray(gap)[..., None] * line.normals
            np.testing.assert_allclose(outline, reached, atol=1e-12)
            assert ((uw > -1e-9) & (uw < 1.0 + 1e-9)).all()
            back = body.to_body(to_space(body, outline, 0.7), 0.7)
            np.testing.assert_allclose(back, outline, atol=1e-15)
