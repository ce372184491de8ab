"""Changes that must not affect the answer do not, and others affect it in a known way.

Source: mechanics alone (formulation, sections 1 to 6). Each relation is checked on cases that use
every element.

Tolerances: a relation that rewrites the numbers (other names, frames, units) leaves the equilibrium
the same up to round-off times the condition number of the case; 1e-9 of the largest force and of
the deflection is required.
"""

import math
import re
from collections.abc import Callable, Mapping
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from tests.support import (
    answer,
    certified,
    coasting,
    coordinates,
    disagreement,
    driver_torques,
    forces,
    furthest,
    loaded,
    lost_contact,
    round_ring,
    shipped,
    with_backlash,
)

import loadshare as ls
from benchmarks import families
from loadshare.certify import certify
from loadshare.train import build_train
from loadshare.train.gear import transverse_frame
from loadshare.train.ring import RoundRing

SAME = 1e-9
CASES: dict[str, Callable[[], ls.Case]] = {
    "both errors": lambda: shipped("fgfbstts/both_errors"),
    "drum ring": lambda: shipped("fgfbstts/limit_ring"),
    "spline stop": lambda: shipped("fgfbstts/spline_clearance"),
    "every element": lambda: shipped("fgfbstts/all_elements"),
    "lost contact": lost_contact,
    "round ring": round_ring,
    "coast flanks": coasting,
    "two paths": lambda: families.two_path("1.2 mrad"),
    "six branches": lambda: shipped("branches/split_torque_6"),
}
every_case = pytest.mark.parametrize("name", CASES)


def bare(case: ls.Case) -> dict[str, Any]:
    """Return the plain data of a case without remarks, which may be rewritten."""
    return {k: v for k, v in case.to_dict().items() if k != "assumed"}


# --- Names and order ---


def renamed(data: Any, names: Mapping[str, str]) -> Any:
    if isinstance(data, dict):
        return {names.get(k, k): renamed(v, names) for k, v in data.items()}
    if isinstance(data, list):
        return [renamed(v, names) for v in data]
    return names.get(data, data) if isinstance(data, str) else data


@every_case
def test_names_and_their_order_do_not_matter(name):
    """All gears, meshes and shafts are renamed, and every section is in reverse order."""
    case = CASES[name]()
    names = {gear: f"wheel {k}" for k, gear in enumerate(case.gears)}
    joints = {n: f"{names[m.driver]}-{names[m.driven]}" for n, m in case.meshes.items()}
    joints |= {n: f"{names[s.ends[0]]}-{names[s.ends[1]]}" for n, s in case.shafts.items()}
    data = renamed(bare(case), names | joints)
    for section in ("gears", "meshes", "shafts", "splines", "rings", "errors", "stages"):
        if section in data:
            data[section] = dict(reversed(data[section].items()))
    one, other = driver_torques(case), driver_torques(ls.Case(data))
    assert furthest({joints[m]: t for m, t in one.items()}, other) < SAME


# --- Frames ---


def placed(case: ls.Case, q: np.ndarray) -> ls.Case:
    """Return the same machine in a frame rotated by `q`, or in a mirror if det q = −1.

    A mirror reverses rotations: with the axes mirrored as arrows, every sense changes, and so does
    "a quarter turn counter-clockwise" of a drum ring, which exchanging its neighbours compensates.
    """
    train, data = build_train(case), bare(case)
    mirrored = np.linalg.det(q) < 0.0

    def metres(vector: np.ndarray) -> list[str]:
        return [f"{float(v)!r} m" for v in vector]

    for name, gear in train.gears.items():
        axis = q @ gear.axis
        frame = transverse_frame(axis)
        data["gears"][name] |= {"centre": metres(q @ gear.centre), "axis": axis.tolist()}
        if name in train.offsets:
            error = train.offsets[name]
            way = frame @ q @ (error.eccentricity @ gear.frame)
            data["errors"][name] = {
                "installation": metres(q @ error.installation),
                "eccentricity": {
                    "amount": f"{math.hypot(*way)!r} m",
                    "direction": f"{math.atan2(way[1], way[0])!r} rad",
                },
            }
        ring = train.rings.get(name)
        if isinstance(ring, RoundRing):
            data["rings"][name]["offset"] = metres(frame @ q @ ring.offset)
        elif ring is not None and mirrored:
            data["rings"][name]["neighbours"].reverse()
    if mirrored:
        data["operating"]["running"] = "clockwise"
    return ls.Case(data)


def turn(about: tuple[float, float, float], angle: float) -> np.ndarray:
    """Return the rotation (3, 3) about an axis, by Rodrigues' formula."""
    a = np.array(about) / np.linalg.norm(about)
    k = np.cross(np.eye(3), -a)
    return np.eye(3) + math.sin(angle) * k + (1.0 - math.cos(angle)) * k @ k


FRAMES = {
    "turned about z": turn((0.0, 0.0, 1.0), 0.7123),
    "turned about any axis": turn((0.3, -0.5, 0.9), 2.1),
    "mirrored": np.diag([1.0, -1.0, 1.0]),
    "mirrored and turned": turn((0.0, 0.0, 1.0), -1.9) @ np.diag([1.0, -1.0, 1.0]),
}


@pytest.mark.parametrize("frame", FRAMES)
@every_case
@pytest.mark.quick(3)
def test_the_frame_does_not_matter(name, frame):
    """Torques do not change; displacements and reactions turn with the frame."""
    case, q = CASES[name](), FRAMES[frame]
    index = 2 if build_train(case).count > 1 else 1
    here, verdict = certified(case, index)
    there, _ = certified(placed(case, q), index)
    assert furthest(here.flank_force, there.flank_force) < SAME
    assert furthest(here.ring_force, there.ring_force) < SAME
    free = {n.split()[1] for n in here.undetermined}
    for gear, moved in here.displacement.items():
        if gear not in free:
            apart = np.linalg.norm(q @ moved - there.displacement[gear])
            assert apart < SAME * verdict.deflection, gear
    for element, force in here.radial_reaction.items():
        apart = np.linalg.norm(q @ force - there.radial_reaction[element])
        assert apart < SAME * verdict.load, element


# --- Flanks ---


def reversed_load(case: ls.Case) -> dict[str, Any]:
    """Return plain data of the case with reversed load and reversed sense of running.

    The torque is the same in space, and the same flanks touch; they have other names.
    """
    data, running = bare(case), case.operating.running
    data["operating"] = {k: v for k, v in data["operating"].items() if k not in ("power", "speed")}
    data["operating"]["torque"] = [f"{-t!r} N*m" for t in case.operating.input_torque]
    senses = {"counter-clockwise": "clockwise", "clockwise": "counter-clockwise"}
    data["operating"]["running"] = senses[running]
    return data


@pytest.mark.parametrize("name", ["both errors", "drum ring", "spline stop", "lost contact"])
def test_a_load_turned_round_presses_the_other_flanks(name):
    """Torque and running sense, both reversed, push on the same teeth: every force is the same."""
    case = CASES[name]()
    one, _ = certified(case)
    other, _ = certified(ls.Case(reversed_load(case)))
    assert furthest(one.flank_force, other.flank_force) < SAME
    here, there = driver_torques(case), driver_torques(ls.Case(reversed_load(case)))
    assert furthest(here, {m: -t for m, t in there.items()}) < SAME
    assert sum(abs(t) for t in here.values()) > 0.0


def test_with_backlash_a_load_turned_round_swaps_gap_and_backlash():
    """The gap of the flank that touches under −T in the other sense is the backlash."""
    case = with_backlash(shipped("fgfbstts/both_errors"), "0.2 mm")
    for number, mesh in enumerate(case.meshes):
        case = case.replace({f'meshes."{mesh}".gap': f"{5 * number} urad"})
    radii = {n: g.acting_radius for n, g in case.gears.items()}
    data = reversed_load(case)
    for mesh, given in case.meshes.items():
        radius = radii[given.driver]
        gap, play = given.gap.si * radius, build_train(case).meshes[mesh].backlash
        del data["meshes"][mesh]["backlash"]
        data["meshes"][mesh]["normal_backlash"] = f"{gap!r} m"
        data["meshes"][mesh]["gap"] = f"{play / radius!r} rad"
    here, there = driver_torques(case), driver_torques(ls.Case(data))
    assert furthest(here, {m: -t for m, t in there.items()}) < SAME


@pytest.mark.parametrize("backlash", [None, "0.1 mm"])
@pytest.mark.parametrize("name", ["fgfbstts/both_errors", "fgfbstts/full_float"])
def test_a_train_is_driven_from_its_other_end(name, backlash):
    """Gear 10 drives what drove it, as if every mesh were named the other way round."""
    case = shipped(name)
    torque = build_train(case).input_torque[0] / build_train(case).gears["10"].ratio
    case = loaded(case, f"{torque!r} N*m")
    if backlash:
        case = with_backlash(case, backlash)
    case = case.replace({"operating.input": "10", "operating.output": "1"})
    # A mesh b-a has its law at b, and its drive flank is the coast flank of the mesh a-b.
    radii = {n: g.acting_radius for n, g in case.gears.items()}
    data = bare(case)
    names = {m: f"{g.driven}-{g.driver}" for m, g in case.meshes.items()}
    data = renamed(data, names)
    for mesh, given in case.meshes.items():
        turned = data["meshes"][names[mesh]]
        ratio = radii[given.driven] / radii[given.driver]
        turned["stiffness"] = f"{given.stiffness.si * ratio**2!r} N*m/rad"
        if backlash:
            play = build_train(case).meshes[mesh].backlash
            del turned["backlash"]
            turned["normal_backlash"] = "0 m"
            turned["gap"] = f"{play / radii[given.driven]!r} rad"
    here, there = driver_torques(case), driver_torques(ls.Case(data))
    at_driven = {
        m: -there[names[m]] * radii[g.driver] / radii[g.driven] for m, g in case.meshes.items()
    }
    assert all(t < 0.0 for t in here.values())
    assert furthest(here, at_driven) < SAME


def test_loads_of_both_signs_are_solved_side_by_side():
    """The pressed flank of meshes without a backlash changes from sample to sample."""
    case = loaded(shipped("fgfbstts/base"), "100 N*m")
    load = [-300.0, 0.0, 500.0]
    found = ls.solve_many(case, {"operating.torque [N*m]": load}, positions=[1])
    torque = found["torque"].sel(mesh="1-2").values.ravel()
    assert torque == pytest.approx([t / 2 for t in load])


# --- Units ---

OTHER_UNITS = {
    "mm": ("m", 1e-3),
    "um": ("mm", 1e-3),
    "deg": ("rad", math.pi / 180.0),
    "mrad": ("deg", 0.18 / math.pi),
    "urad": ("mrad", 1e-3),
    "rad": ("arcmin", 10800.0 / math.pi),
    "N": ("kN", 1e-3),
    "N*m": ("N*mm", 1e3),
    "N/m": ("N/um", 1e-6),
    "N*m/rad": ("kN*m/deg", 1e-3 * math.pi / 180.0),
    "rad/(N*m)": ("mrad/(kN*m)", 1e6),
    "rad/(N*m)^(2/3)": ("mrad/(kN*m)^(2/3)", 1e5),
    "kW": ("W", 1e3),
    "rpm": ("rad/s", math.pi / 30.0),
}


def converted(data: Any) -> Any:
    """Return plain data with every quantity in another unit."""
    if isinstance(data, dict):
        return {k: converted(v) for k, v in data.items()}
    if isinstance(data, list):
        return [converted(v) for v in data]
    written = re.fullmatch(r"([-+.\deE]+) (\S+)", data) if isinstance(data, str) else None
    if written is None:
        return data
    unit, factor = OTHER_UNITS[written[2]]
    return f"{float(written[1]) * factor!r} {unit}"


@every_case
def test_units_do_not_matter(name):
    case = CASES[name]()
    data = bare(case)
    other = ls.Case({k: v if k in ("title", "notes") else converted(v) for k, v in data.items()})
    assert other.to_dict()["gears"] != data["gears"]
    assert furthest(driver_torques(case), driver_torques(other)) < SAME


# --- Load ---


@pytest.mark.parametrize("torque", ["1 mN*m", "2 N*m", "50 kN*m"])
def test_without_gaps_and_errors_a_linear_train_is_proportional(torque):
    """With c = 0, no errors and no gaps, every torque is proportional to the input torque."""
    unit = {"1 mN*m": 1e-3, "2 N*m": 2.0, "50 kN*m": 5e4}[torque]
    for base in (shipped("fgfbstts/base"), shipped("branches/split_torque_6")):
        one = driver_torques(loaded(base, "1 N*m"))
        other = driver_torques(loaded(base, torque))
        assert furthest({m: t * unit for m, t in one.items()}, other) < SAME


# --- Limits that vanish ---


@pytest.mark.parametrize("reduce", [True, False], ids=["reduced", "whole"])
def test_a_large_backlash_is_no_coast_flank(reduce):
    case = shipped("fgfbstts/both_errors")
    one = driver_torques(case)
    other = driver_torques(with_backlash(case, "10 mm"), reduce=reduce)
    assert furthest(one, other) < SAME


@pytest.mark.parametrize("reduce", [True, False], ids=["reduced", "whole"])
def test_a_large_ring_is_no_ring(reduce):
    """A drum with 10 mm on every side around an elastic pinion, and a circle of 10 mm."""
    soft = shipped("fgfbstts/limit_ring").replace(
        {"rings": None} | {f"gears.{g}.support": "1e6 N/m" for g in "45"}
    )
    drum = {"neighbours": ["7", "6"], "float": "10 mm", "clearance": "10 mm"}
    circle = families.star(5)
    for free, held in (
        (soft, soft.replace({"rings": {"4": drum}})),
        (circle, circle.replace({"rings": {"sun": {"radius": "10 mm"}}})),
    ):
        assert furthest(driver_torques(free), driver_torques(held, reduce=reduce)) < SAME


@pytest.mark.parametrize(
    "friction",
    [{"friction_force": "0 N"}, {"friction": 0.5, "radius": "10 mm"}],
    ids=["no friction", "never overcome"],
)
def test_a_spline_without_clearance_is_an_elastic_support(friction):
    """With zero clearance, the shaft bends from the start, whatever the friction."""
    case = shipped("fgfbstts/both_errors")
    spline = {"bending_stiffness": "1.78e7 N/m", "clearance": "0 um", **friction}
    one, _ = answer(build_train(case.replace({"gears.4.support": "1.78e7 N/m"})))
    other, _ = answer(build_train(case.replace({"splines": {"4": spline}})))
    assert furthest(one.flank_force, other.flank_force) < SAME
    assert other.displacement["4"] == pytest.approx(one.displacement["4"], rel=1e-8)


def test_a_spline_without_friction_is_an_elastic_round_ring():
    case = shipped("fgfbstts/both_errors")
    spline = {"bending_stiffness": "1.78e7 N/m", "clearance": "5 um", "friction_force": "0 N"}
    ring = {"radius": "5 um", "stiffness": "1.78e7 N/m"}
    one = driver_torques(case.replace({"splines": {"4": spline}}))
    other = driver_torques(case.replace({"rings": {"4": ring}}))
    assert furthest(one, other) < SAME


# --- Limits that are approached ---


def order(errors: list[float], factor: float) -> list[float]:
    """Return the order of convergence between neighbours; the parameter decreases by `factor`."""
    return [math.log(a / b) / math.log(factor) for a, b in pairwise(errors)]


def test_friction_vanishes_to_first_order():
    """The friction of a slipping spline acts as a force, so its effect on the torques is
    proportional to it.
    """
    case = shipped("fgfbstts/full_float")

    def torques(friction: float) -> dict[str, float]:
        changes = {f"splines.{g}.normal_force": f"{10 * friction!r} N" for g in "45"}
        return driver_torques(case.replace(changes))

    limit = torques(0.0)
    errors = [furthest(limit, torques(f)) for f in (50.0, 10.0, 2.0)]
    # The direction of slip turns slightly with the friction: 2 % in the order.
    assert order(errors, 5.0) == pytest.approx([1.0, 1.0], abs=0.02)


@pytest.mark.parametrize("kind", ["drum", "circle"])
def test_a_stiff_ring_becomes_rigid_to_first_order(kind):
    """An elastic ring yields by force over stiffness, so the error decreases as 1/k."""

    def torques(stiffness: str) -> dict[str, float]:
        if kind == "circle":
            return driver_torques(round_ring(stiffness))
        changes = {f"rings.{g}.stiffness": stiffness for g in "45"}
        ranges = {"rings.4.float": "4 um", "rings.5.float": "1 um"}
        return driver_torques(shipped("fgfbstts/limit_ring").replace({**changes, **ranges}))

    rigid = torques("rigid")
    errors = [furthest(rigid, torques(f"{k!r} N/m")) for k in (1e11, 1e12, 1e13)]
    # The next term is the ring's compliance over the meshes', below 1e-2 at 1e11 N/m.
    assert order(errors, 10.0) == pytest.approx([1.0, 1.0], abs=0.02)


@every_case
def test_positions_do_not_know_of_each_other(name):
    case = CASES[name]()
    count = build_train(case).count
    order_ = list(range(count, 0, -1))[:4]
    together = ls.solve(case, positions=order_)
    for index, position in zip(order_, together.positions, strict=True):
        (alone,) = ls.solve(case, positions=[index]).positions
        assert position.position == index
        # Positions share matrix products, whose round-off depends on the number of positions.
        for mesh, torque in position.torque.items():
            assert torque == pytest.approx(alone.torque[mesh], rel=1e-12, abs=1e-9)
        for gear, moved in position.displacement.items():
            assert moved == pytest.approx(alone.displacement[gear], rel=1e-11, abs=1e-18)


@every_case
@pytest.mark.quick(3)
def test_solving_twice_gives_the_same_bits(name):
    case = CASES[name]()
    one, other = (answer(build_train(case))[0] for _ in range(2))
    assert forces(one) == forces(other)
    train = build_train(case)
    assert coordinates(train, one) == coordinates(train, other)
    assert disagreement(train, one, other) == (0.0, 0.0)
    assert certify(train, one).residuals == certify(train, other).residuals
