"""The drawn region against the exact arcs and stops, and against closed forms."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.reproducible import examples
from tests.support import round_ring, shipped

import loadshare as ls
from loadshare.report.figures.region import Journey, region
from loadshare.train import build_train
from loadshare.train.situations import situation_of

STILL = dict.fromkeys(map(str, range(1, 11)), (0.0, 0.0))


def ring_of(**values):
    keys = {f"rings.4.{key}": value for key, value in values.items()}
    return build_train(shipped("fgfbstts/limit_ring").replace(keys))


def exact_margin(train, gear, point, displacement, position=1):
    """Return the smallest distance of a displacement from the ring's boundaries [m]."""
    ring, frame = train.rings[gear], train.gears[gear].frame
    moved = np.array(point) @ frame
    situation = situation_of(train, position)
    across = float(ring.across @ moved)
    margins = [ring.up - across, ring.down + across]
    for side, name in enumerate(ring.neighbours):
        neighbour = np.array(displacement[name]) @ train.gears[name].frame
        margins.append(situation.arc(ring, side).margin(moved - neighbour))
    return min(margins)


def inside(polygon, point):
    """Return whether a point is in a closed polygon (even–odd rule)."""
    x, y = point
    crossings = False
    for (x0, y0), (x1, y1) in pairwise(polygon):
        if (y0 > y) != (y1 > y) and x < x0 + (y - y0) * (x1 - x0) / (y1 - y0):
            crossings = not crossings
    return crossings


def test_the_width_of_a_drum_without_clearance_is_the_chords_closed_form():
    train = ring_of(float="400 um")
    found = region(train, "4", 1, STILL, 1e-3)
    ring, gear = train.rings["4"], train.gears["4"]
    across = gear.frame @ ring.across
    y = 400e-6
    top = [p for piece in found.pieces for p in piece if abs(np.array(p) @ across - y) < 1e-12]
    width = max(math.dist(a, b) for a in top for b in top)
    expected = 0.0
    for neighbour in ring.neighbours:
        start = gear.frame @ (gear.centre - train.gears[neighbour].centre)
        v = float(start @ across)
        u = math.sqrt(float(start @ start) - v**2)
        expected += u - math.sqrt(float(start @ start) - (y + v) ** 2)
    # 0.9 µm is a difference of lengths of 0.17 m, whose round-off is a few 1e-17 m.
    assert width == pytest.approx(expected, abs=1e-15)
    # With the gear on the line of its neighbours (v = 0) these are two sagittas, y²/a.
    assert expected == pytest.approx(y**2 / 0.169654, rel=1e-3)


def test_a_narrow_drum_is_a_line_across_the_neighbours():
    train = ring_of()
    found = region(train, "4", 1, STILL, 1e-5)
    points = [p for piece in found.pieces for p in piece]
    ends = max(((a, b) for a in points for b in points), key=lambda ab: math.dist(*ab))
    assert math.dist(*ends) == pytest.approx(2 * 8.24e-6, rel=1e-9)
    angle = math.atan2(ends[0][1] - ends[1][1], ends[0][0] - ends[1][0])
    assert math.degrees(angle) % 180.0 == pytest.approx(60.0, abs=1e-2)
    assert {b.name for b in found.boundaries} == {"upper stop", "lower stop", "arc 6", "arc 7"}


@settings(max_examples=examples(20, 40))
@given(
    st.floats(2.0, 60.0),
    st.tuples(st.floats(2.0, 40.0), st.floats(2.0, 40.0)),
    st.tuples(*[st.floats(-30.0, 30.0)] * 4),
    st.integers(0, 2**32 - 1),
)
def test_the_outline_holds_exactly_what_the_exact_arcs_admit(reach, clearances, moved, seed):
    """Random rings, random displacements of the neighbours, random points."""
    train = ring_of(float=f"{reach} um", clearance=[f"{c} um" for c in clearances])
    displacement = {
        **STILL,
        "6": (moved[0] * 1e-6, moved[1] * 1e-6),
        "7": (moved[2] * 1e-6, moved[3] * 1e-6),
    }
    window = 150e-6
    found = region(train, "4", 1, displacement, window)
    points = np.random.default_rng(seed).uniform(-90e-6, 90e-6, (60, 2))
    for point in points:
        margin = exact_margin(train, "4", point, displacement)
        # The outline joins points on the arcs by straight lines: 120 lines over 120 µm have a
        # sagitta below 1e-15 m; round-off of half a chord is 1e-16 m.
        if abs(margin) > 1e-13:
            assert (margin > 0.0) == any(inside(piece, point) for piece in found.pieces)


def test_boundaries_lie_on_the_exact_arcs_and_stops():
    train = ring_of(float="20 um", clearance=["3 um", "5 um"])
    found = region(train, "4", 1, STILL, 100e-6)
    for boundary in found.boundaries:
        path = boundary.path if boundary.name.startswith("arc") else boundary.path[:0]
        for point in path:
            assert exact_margin(train, "4", point, STILL) == pytest.approx(0.0, abs=1e-15)
    stops = {b.name: b for b in found.boundaries if "stop" in b.name}
    across = train.gears["4"].frame @ train.rings["4"].across
    for name, limit in (("upper stop", 20e-6), ("lower stop", -20e-6)):
        for point in stops[name].path:
            assert np.array(point) @ across == pytest.approx(limit, abs=1e-18)


def test_outward_points_out():
    train = ring_of(float="20 um", clearance="10 um")
    found = region(train, "4", 1, STILL, 100e-6)
    for boundary in found.boundaries:
        middle = np.mean(boundary.path, axis=0)
        beyond = middle + 1e-6 * np.array(boundary.outward)
        assert exact_margin(train, "4", beyond, STILL) < 0.0


def test_a_neighbours_displacement_moves_its_arc():
    train = ring_of(float="20 um", clearance="10 um")
    along = np.array([math.cos(math.radians(-30.0)), math.sin(math.radians(-30.0))])
    moved = {**STILL, "6": tuple(4e-6 * along)}
    before, after = (region(train, "4", 1, d, 100e-6) for d in (STILL, moved))
    arcs = [next(b for b in r.boundaries if b.name == "arc 6") for r in (before, after)]
    shift = np.mean(arcs[1].path, axis=0) - np.mean(arcs[0].path, axis=0)
    assert shift == pytest.approx(4e-6 * along, abs=1e-11)


def test_a_window_cuts_what_is_far_away():
    train = ring_of(float="20 um", clearance="500 um")
    found = region(train, "4", 1, STILL, 50e-6)
    assert {b.name for b in found.boundaries} == {"upper stop", "lower stop"}
    assert max(abs(v) for piece in found.pieces for p in piece for v in p) < 75e-6


def test_a_round_ring_is_its_circle():
    train = build_train(round_ring())
    found = region(train, "sun", 1, {}, 1e-5)
    (outline,) = found.pieces
    distances = [math.dist(p, (0.5e-6, -1e-6)) for p in outline]
    assert distances == pytest.approx([3e-6] * len(distances), rel=1e-12)


def test_a_gear_without_a_ring_has_no_region():
    assert region(ring_of(), "1", 1, STILL, 1e-5) is None


def test_a_bearing_inside_a_ring_is_drawn_beside_it():
    """Both outlines are drawn, but no area: the centre may only be in their intersection."""
    bearing = {"clearance": "3 um", "stiffness": "2e8 N/m"}
    case = shipped("fgfbstts/limit_ring").replace({"bearings": {"4": bearing}})
    found = ls.solve(case, positions=[1])
    journey = Journey(found, build_train(case), "4")
    assert journey.region is not None
    assert journey.region.pieces == []
    names = [edge.name for edge in journey.region.boundaries]
    assert {"outer race", "upper stop", "lower stop", "arc 6", "arc 7"} == {*names}
    (x, y), half = journey.view
    for edge in journey.region.boundaries:
        assert all(max(abs(a - x), abs(b - y)) <= half for a, b in edge.path)
