"""What forces leave undetermined: closed forms, a second method for every range, all engines.

Source: formulation, sections 4 to 6; the norm and the set are those of the theory page.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog
from tests.physics.test_metamorphic import FRAMES, placed
from tests.physics.test_random_trains import scaled, split_torques, stars
from tests.reproducible import TRAINS, examples
from tests.support import answer, coordinates, shipped

import loadshare as ls
from benchmarks import families
from loadshare.certify import certify
from loadshare.job.block import RUNGS
from loadshare.job.hot import hot_answers
from loadshare.job.machine import Machine
from loadshare.scene import assemble
from loadshare.settings import CERTIFY
from loadshare.solver.position import coordinates_of, of_least_norm
from loadshare.solver.undetermined.norm import norm_of
from loadshare.solver.undetermined.region import Disc, Region
from loadshare.train import build_train
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.train import Train

AGREE = 1e-9
EXACT = 1e-11
"""Residual below which places are compared: with a larger imbalance, forces differ."""


def two_path(**changes: object) -> ls.Case:
    """Return two paths under 10 N·m; B has so large a gap that it carries nothing."""
    late = {'meshes."in-wheelB".gap': "30 mrad", "operating.torque": "10 N*m"}
    return families.two_path("0 mrad").replace({**late, **changes})


# --- Closed forms ---


@pytest.mark.parametrize("shaft", ["rigid", "8e4 N*m/rad"])
@pytest.mark.parametrize("backlash", [0.0, 1e-3, 0.2])
@pytest.mark.parametrize("gap", [0.0, 30.0])
@pytest.mark.quick(6)
def test_an_unloaded_wheel_turns_by_its_backlash_over_its_base_radius(shaft, backlash, gap):
    """Only the two flanks of its mesh with the input gear limit it: its range is their play along
    the line of action, over its base radius. Without play, it is determined.
    """
    changes = {
        'shafts."wheelB-pinionB".stiffness': shaft,
        'meshes."in-wheelB".gap': f"{gap} mrad",
        'meshes."in-wheelB".backlash': f"{backlash} mm",
        # The gap puts A in contact first, so that its path carries; B's second mesh is far from
        # contact.
        'meshes."pinionB-out".gap': "100 mrad",
    }
    case = two_path(**changes)
    mesh, found = build_train(case).meshes["in-wheelB"], ls.solve(case).positions[0]
    play = mesh.backlash + mesh.radii[0] * gap * 1e-3
    many = ls.solve_many(case, {"operating.torque [N*m]": [9.0, 10.0, 11.0]}, positions=[1])
    assert many.determined.values.ravel().tolist() == [play == 0.0] * 3
    if play == 0.0:
        assert not found.undetermined
        return
    low, high = found.undetermined["gear wheelB rotation"]
    assert low == pytest.approx(
        mesh.radii[0] * (found.rotation["in"] - gap * 1e-3) / mesh.radii[1], rel=1e-12
    )
    assert high - low == pytest.approx(play / mesh.radii[1], rel=1e-9)
    assert found.undetermined["gear pinionB rotation"] == pytest.approx((low, high), rel=1e-9)
    assert set(found.undetermined) == {"gear wheelB rotation", "gear pinionB rotation"}


@pytest.mark.parametrize("offset", [(0.0, 0.0), (12.0, -16.0), (60.0, 80.0)])
def test_an_unloaded_pinion_in_a_round_ring(offset):
    """It may move from m − R to m + R in each direction; its least place is the ring's point
    nearest to the centre, which is inside as long as the ring contains it.
    """
    radius = 50.0
    ring = {"radius": f"{radius} um", "offset": [f"{v} um" for v in offset]}
    case = two_path(**{"gears.pinionB.support": "free", "rings": {"pinionB": ring}})
    case = case.replace({'meshes."pinionB-out".gap': "30 mrad"})
    found = ls.solve(case).positions[0]
    centre = np.array(offset) * 1e-6
    for k, axis in enumerate("xy"):
        ends = (centre[k] - radius * 1e-6, centre[k] + radius * 1e-6)
        assert found.undetermined[f"gear pinionB {axis}"] == pytest.approx(ends, rel=1e-9)
    away = max(np.linalg.norm(centre) - radius * 1e-6, 0.0)
    nearest = centre * away / (np.linalg.norm(centre) or 1.0)
    assert found.displacement["pinionB"] == pytest.approx(nearest, abs=1e-9 * radius * 1e-6)
    assert found.floats["pinionB"].state == "undetermined"


def test_an_unloaded_pinion_in_a_slit():
    """Arcs that touch at rest leave all of the float free across the line to the neighbours.

    The range does not depend on the last digits of the place from which it is computed.
    """
    case = shipped("fgfbstts/limit_ring").replace({"operating.power": "0 kW"})
    train = build_train(case)
    scene, found = assemble(train, 1), ls.solve(case, positions=[1]).positions[0].equilibrium
    digits = np.random.default_rng(1)
    for _ in range(20):
        near = replace(
            found,
            displacement={
                g: u * (1.0 + 1e-16 * digits.standard_normal(3))
                for g, u in found.displacement.items()
            },
        )
        ranges = of_least_norm(scene, near).undetermined
        for pinion, one, other, furthest in (("4", "7", "6", 8.24e-6), ("5", "9", "8", 2.74e-6)):
            line = train.gears[one].centre - train.gears[other].centre
            across = np.array([-line[1], line[0]]) / np.linalg.norm(line[:2])
            for axis, share in zip("xy", np.abs(across), strict=True):
                end = share * furthest
                assert ranges[f"gear {pinion} {axis}"] == pytest.approx((-end, end), rel=1e-4)


def test_a_spline_on_its_friction_bound_slips_anywhere_along_its_force():
    """One mesh pushes with F = T/r_b, friction holds up to τ T/radius: at radius = τ r_b they are
    equal under any load. The pinion may be anywhere from S1 to S2 along that force.
    """
    radius = build_train(two_path()).gears["pinionA"].base_radius
    spline = {
        "bending_stiffness": "2e7 N/m",
        "clearance": "0.2 mm",
        "friction": 0.1,
        "radius": f"{0.1 * radius!r} m",
    }
    case = two_path(**{"gears.pinionA.support": "free", "splines": {"pinionA": spline}})
    found = ls.solve(case).positions[0]
    first = build_train(case).meshes["in-wheelA"]
    force = 10.0 * first.radii[1] / first.radii[0] / radius
    assert found.floats["pinionA"].spline_force == pytest.approx(force, rel=1e-9)
    assert found.floats["pinionA"].spline == "slip"
    ends = np.array([found.undetermined[f"gear pinionA {axis}"] for axis in "xy"])
    far = [max(abs(low), abs(high)) for low, high in ends]
    near = [min(abs(low), abs(high)) for low, high in ends]
    assert math.hypot(*near) == pytest.approx(force / 2e7, rel=1e-6)
    assert math.hypot(*far) == pytest.approx(0.2e-3, rel=1e-9)
    assert math.hypot(*found.displacement["pinionA"]) >= force / 2e7 * (1 - 1e-6)


# --- Regions, by a second way ---


@st.composite
def regions(draw: st.DrawFn) -> tuple[Region, np.ndarray]:
    """Draw a region around a point, and that point; bounded or not."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    size, rows, rounds = draw(st.integers(2, 4)), draw(st.integers(0, 6)), draw(st.integers(0, 2))
    point = rng.normal(size=size) * draw(st.sampled_from([0.0, 0.3, 1.0]))
    limits = rng.normal(size=(rows, size))
    limits /= np.linalg.norm(limits, axis=1)[:, None]
    room = rng.choice([0.0, 0.01, 0.3, 1.0], size=rows)
    discs = []
    for _ in range(rounds):
        matrix, centre = rng.normal(size=(2, size)), rng.normal(size=2)
        distance = float(np.linalg.norm(matrix @ point - centre))
        discs.append(Disc(matrix, centre, distance + float(rng.choice([0.0, 0.1, 1.0]))))
    return Region(limits, limits @ point + room, tuple(discs)), point


def polygon(region: Region, sides: int = 720) -> tuple[np.ndarray, np.ndarray]:
    """Return half-planes that enclose the region: each disc is replaced by a polygon around it."""
    ways = 2.0 * np.pi * np.arange(sides) / sides
    rows, bounds = [region.limits], [region.bounds]
    for disc in region.discs:
        normals = np.stack([np.cos(ways), np.sin(ways)], axis=1)
        rows.append(normals @ disc.matrix)
        bounds.append(disc.radius + normals @ disc.centre)
    return np.vstack(rows), np.concatenate(bounds)


@settings(TRAINS, max_examples=examples(25, 60))
@given(regions())
def test_extremes_are_those_of_a_linear_programme_over_polygons(given_region):
    region, _ = given_region
    rows, bounds = polygon(region)
    for direction in np.eye(region.size):
        found = region.furthest(direction)
        outer = linprog(-direction, rows, bounds, bounds=(None, None))
        if found is None:
            assert outer.status in (3, 4), outer.message
            continue
        assert outer.status == 0, outer.message
        assert region.beyond(found) < 1e-9
        reached = float(direction @ found)
        # A polygon of 720 sides is off its circle by 1e-5 of the radius.
        assert reached <= -outer.fun + 1e-9 * max(1.0, abs(outer.fun))
        assert reached >= -outer.fun - 1e-2 * max(1.0, abs(outer.fun))


@settings(TRAINS, max_examples=examples(60, 150))
@given(regions())
def test_the_least_point_is_nearer_than_all_others(given_region):
    """The least point u of a convex region satisfies (v − u)·u ≥ 0 for all its points v."""
    region, point = given_region
    least = region.least()
    assert region.beyond(least) < 1e-9
    assert float((point - least) @ least) >= -1e-9 * (1.0 + float(np.linalg.norm(point)) ** 2)
    for direction in (*np.eye(region.size), *-np.eye(region.size), -least):
        found = region.furthest(direction) if np.any(direction) else None
        if found is not None:
            size = 1.0 + float(np.linalg.norm(found)) ** 2
            assert float((found - least) @ least) >= -1e-9 * size


# --- All engines alike ---


@st.composite
def with_lost_branches(draw: st.DrawFn) -> ls.Case:
    """Draw a random train with some meshes so far apart that branches carry nothing."""
    data = draw(st.one_of(stars(), split_torques())).to_dict()
    for name in draw(st.lists(st.sampled_from(list(data["meshes"])), unique=True, max_size=3)):
        data["meshes"][name]["gap"] = scaled(draw(st.sampled_from([0.05, 0.3, 1.0])), "mrad")
    return ls.Case(data)


def radius_of(train: Train, name: str) -> float:
    """Return the length [m] of one unit of a coordinate."""
    return train.gears[name.split()[1]].base_radius if name.endswith("rotation") else 1.0


def same_places(train: Train, one: Equilibrium, other: Equilibrium) -> None:
    """Check that the undetermined coordinates, their ranges and the places agree."""
    assert one.undetermined.keys() == other.undetermined.keys()
    here, there = coordinates(train, one), coordinates(train, other)
    for name, (low, high) in one.undetermined.items():
        play = high - low if math.isfinite(high - low) else 1e-5
        assert abs(here[name] - there[name]) <= AGREE * play * radius_of(train, name), name
        for mine, others in zip((low, high), other.undetermined[name], strict=True):
            assert mine == others or abs(mine - others) <= AGREE * play, name


@pytest.mark.slow
def test_engines_agree_on_random_trains_with_lost_branches():
    seen = {"open": 0, "compared": 0}

    @settings(TRAINS, max_examples=20)
    @given(with_lost_branches())
    def run(case: ls.Case) -> None:
        train = build_train(case)
        found = hot_answers(Machine(train), [1], CERTIFY.tolerance).get(1)
        if found is None:
            return
        mine = found.equilibrium
        seen["open"] += bool(mine.undetermined)
        for options in ({}, {"reduce": False, "method": "picard"}):
            try:
                other, _ = answer(train, **options)
            except ls.Refused:
                continue  # the ladder does not depend on every rung
            if certify(train, other).worst < EXACT:
                same_places(train, mine, other)
                seen["compared"] += 1
        torque = {"operating.torque": [case.to_dict()["operating"]["torque"]]}
        many = ls.solve_many(case, torque, positions=[1])
        if RUNGS[many.rung.item()] == "fast method":
            assert bool(many.determined.item()) == (not mine.undetermined)

    run()
    assert seen["open"] > 10
    assert seen["compared"] > 20


# --- What must not change it ---


@pytest.mark.parametrize("frame", FRAMES)
def test_the_frame_does_not_matter(frame):
    """The same gears are undetermined, rotations have the same ranges, and the least place rotates
    with the frame.
    """
    ring = {"radius": "50 um", "offset": ["60 um", "80 um"]}
    case = two_path(**{"gears.pinionB.support": "free", "rings": {"pinionB": ring}})
    case = case.replace({'meshes."pinionB-out".gap': "30 mrad"})
    q = FRAMES[frame]
    here, _ = answer(build_train(case))
    there, _ = answer(build_train(placed(case, q)))
    assert {n.split()[1] for n in here.undetermined} == {n.split()[1] for n in there.undetermined}
    for name, ends in here.undetermined.items():
        if name.endswith("rotation"):
            assert there.undetermined[name] == pytest.approx(ends, abs=1e-12)
    for gear, moved in here.displacement.items():
        assert there.displacement[gear] == pytest.approx(q @ moved, abs=1e-14)


def test_the_norm_counts_every_gear_and_no_name():
    """Two gears on a clocked rigid shaft: their least place weighs both, in any order."""
    case = two_path(
        **{
            'shafts."wheelB-pinionB"': {"stiffness": "rigid", "clocking": "0.4 mrad"},
            'meshes."pinionB-out".gap': "30 mrad",
        }
    )
    train = build_train(case)
    found, _ = answer(train)
    scene = assemble(train, 1)
    x = coordinates_of(scene, found)
    squares = sum((g.base_radius * found.rotation[n]) ** 2 for n, g in train.gears.items())
    squares += sum(float(p @ p) for p in found.displacement.values())
    fixed = sum(
        (g.base_radius * scene.turned[n]) ** 2
        for n, g in train.gears.items()
        if scene.rotation[n].index is None
    )
    lengths = norm_of(scene).lengths(x)
    # To the squares is added the least cost of the clocking.
    wheel, pinion = (train.gears[g].base_radius for g in ("wheelB", "pinionB"))
    apart = (wheel * pinion * 0.4e-3) ** 2 / (wheel**2 + pinion**2)
    assert float(lengths @ lengths) + fixed + apart == pytest.approx(squares, rel=1e-9)
    turned = found.rotation["wheelB"]
    assert turned == pytest.approx(pinion**2 * 0.4e-3 / (wheel**2 + pinion**2), rel=1e-9)
    data = case.to_dict()
    data["gears"] = dict(reversed(data["gears"].items()))
    other, _ = answer(build_train(ls.Case(data)))
    assert other.rotation["wheelB"] == pytest.approx(turned, rel=1e-12)
