"""Planetary sets against Willis, closed forms, an independent model, and natural frequencies."""

from __future__ import annotations

import math
from itertools import combinations
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh
from tests.physics.planetary_model import Set
from tests.support import mostly_slow

import loadshare as ls
from loadshare.errors import CaseError
from loadshare.scene.loading import loading_of
from loadshare.scene.structure import structure_of
from loadshare.train import build_train
from loadshare.train.situations import situation_of

SUN, PLANET, RING = 18, 36, 90
MODULE = 5.0
ARM = 0.5e-3 * MODULE * (SUN + PLANET)
MEMBERS = ("sun", "ring", "carrier")
CHOICES = [
    (first, second, third)
    for first in MEMBERS
    for second in MEMBERS
    for third in MEMBERS
    if len({first, second, third}) == 3
]


def planetary(
    planets: int = 3,
    load: str = "sun",
    output: str = "carrier",
    held: str = "ring",
    **changes: Any,
) -> ls.Case:
    """Return a set of equal planets; `changes` are keys of the case with dots as `__`."""
    # Defined by radii: real teeth could not be assembled for every number of planets.
    radius = [
        f"{0.5 * MODULE * teeth * math.cos(math.radians(20.0)):.17g} mm"
        for teeth in (SUN, PLANET, RING)
    ]
    centre = ["0 mm", "0 mm"]
    gears: dict[str, Any] = {
        "sun": {"base_radius": radius[0], "centre": centre},
        "ring": {"type": "internal", "base_radius": radius[2], "centre": centre},
        "carrier": {"type": "carrier", "centre": centre},
    }
    gears[held]["held"] = True
    meshes = {}
    for k in range(planets):
        at = {"distance": f"{ARM} m", "angle": f"{2.0 * math.pi * k / planets:.17g} rad"}
        gears[f"p{k}"] = {"base_radius": radius[1], "carrier": "carrier", "centre": at}
        meshes[f"sun-p{k}"] = {"stiffness": "2e7 N*m/rad"}
        meshes[f"p{k}-ring"] = {"stiffness": "9e7 N*m/rad"}
    case = ls.Case(
        operating={"input": load, "output": output, "torque": "1000 N*m"},
        gears=gears,
        meshes=meshes,
    )
    return case.replace({key.replace("__", "."): value for key, value in changes.items()})


def fractions(case: ls.Case, member: str = "sun") -> np.ndarray:
    """Return the share of every planet in the torque of the sun, or of the ring."""
    position = ls.solve(case).positions[0]
    names = [f"sun-p{k}" if member == "sun" else f"p{k}-ring" for k in range(len(position.torque))]
    torque = np.array([abs(position.torque[n]) for n in names if n in position.torque])
    return torque / torque.sum()


@pytest.mark.parametrize(("load", "output", "held"), CHOICES)
def test_speeds_are_those_of_willis_and_no_power_is_lost(load: str, output: str, held: str) -> None:
    case = planetary(load=load, output=output, held=held)
    train = build_train(case)
    speed = {n: g.sense * g.ratio for n, g in train.gears.items()}
    carrier, sun, ring = speed["carrier"], speed["sun"], speed["ring"]
    assert (sun - carrier) * SUN == pytest.approx(-(ring - carrier) * RING, abs=1e-13 * RING)
    assert (sun - carrier) * SUN == pytest.approx(-(speed["p0"] - carrier) * PLANET, abs=1e-11)
    assert speed[held] == 0.0
    assert speed[load] == 1.0
    forces = ls.solve(case).positions[0].equilibrium.flank_force
    torque = dict.fromkeys(MEMBERS, 0.0)
    for name, force in forces.items():
        for gear, arm in train.approaches[name].turning.items():
            if gear in torque:
                torque[gear] += train.gears[gear].sense * arm * force
    assert torque[load] == pytest.approx(1000.0, rel=1e-12)
    assert sum(torque.values()) == pytest.approx(0.0, abs=1e-9)
    taken = torque[load] * speed[load] + torque[output] * speed[output]
    assert taken == pytest.approx(0.0, abs=1e-9)


def closed_form(planets: int, error: np.ndarray, floats: bool) -> np.ndarray:
    """Return shares if every branch has the compliance of its two meshes; some may lose contact.

    A pin that is e out of place takes e (cos α_s + cos α_r) from its branch; a floating member adds
    a cosine and a sine of the planet's angle. Every set of loaded planets is tried.
    """
    radius = 0.5e-3 * MODULE * np.array([SUN, PLANET, RING]) * math.cos(math.radians(20.0))
    stiffness = 1.0 / (radius[0] ** 2 / 2e7 + radius[1] ** 2 / 9e7)
    late = 2.0 * math.cos(math.radians(20.0)) * error
    force, angle = 1000.0 / radius[0], 2.0 * np.pi * np.arange(planets) / planets
    ways = np.column_stack([np.ones(planets), np.cos(angle), np.sin(angle)])[
        :, : 3 if floats else 1
    ]
    for count in range(planets, 0, -1):
        for some in map(list, combinations(range(planets), count)):
            system = ways[some].T @ ways[some] * stiffness
            due = np.eye(len(system))[0] * force + stiffness * ways[some].T @ late[some]
            move = np.linalg.lstsq(system, due, rcond=1e-12)[0]
            carried = stiffness * (ways @ move - late)
            balanced = np.allclose(ways[some].T @ carried[some], np.eye(len(due))[0] * force)
            away = np.delete(carried, some)
            if balanced and (carried[some] >= 0.0).all() and (away <= 1e-9 * force).all():
                return np.where(np.isin(np.arange(planets), some), carried, 0.0) / force
    raise AssertionError("no set of planets carries the load")


@pytest.mark.parametrize("planets", [3, 4, 5, 6, 7])
@pytest.mark.parametrize("floating", ["", "sun", "ring", "carrier"])
@pytest.mark.parametrize("error", [0.0, 10e-6, 60e-6, -15e-6])
@pytest.mark.quick(30)
def test_shares_are_the_closed_form(planets: int, floating: str, error: float) -> None:
    case = planetary(planets, errors={"p0": {"pin": {"tangential": f"{error:.17g} m"}}})
    if floating:
        case = case.replace({f"gears.{floating}.support": "free"})
    late = np.zeros(planets)
    # A pin that lags makes contact later; the sun runs counter-clockwise.
    late[0] = error
    expected = closed_form(planets, late, bool(floating))
    found = fractions(case)
    assert found == pytest.approx(expected, abs=1e-11)
    if planets == 3 and floating:
        assert found == pytest.approx(np.full(3, 1 / 3), abs=1e-12)


def test_natural_frequencies_are_those_of_lin_and_parker() -> None:
    """Tangent stiffness of the programme with masses, doi 10.1115/1.2893982 (validation.md)."""
    mass = {"sun": 0.4, "ring": 2.35, "carrier": 5.43, "p": 0.66}
    inertia = {"sun": 0.39, "ring": 3.00, "carrier": 6.29, "p": 0.61}
    alpha = math.radians(24.6)
    sun, planet = 40.0, 50.0
    arm = (sun + planet) / math.cos(alpha)
    ring = sun + 2.0 * planet
    bearing = "1e8 N/m"
    centre = ["0 mm", "0 mm"]
    gears: dict[str, Any] = {
        "sun": {"base_radius": f"{sun} mm", "centre": centre, "support": bearing},
        "ring": {"type": "internal", "base_radius": f"{ring} mm", "centre": centre}
        | {"support": bearing},
        "carrier": {"type": "carrier", "centre": centre, "support": bearing},
        "housing": {"type": "carrier", "centre": centre, "held": True},
        # The sun is free to turn, because its drive yields.
        "drive": {"type": "carrier", "centre": centre},
        "load": {"type": "carrier", "centre": centre},
    }
    meshes = {}
    for k in range(3):
        at = {"distance": f"{arm:.17g} mm", "angle": f"{120 * k} deg"}
        gears[f"p{k}"] = {"base_radius": f"{planet} mm", "carrier": "carrier", "centre": at}
        gears[f"p{k}"]["support"] = bearing
        meshes[f"sun-p{k}"] = {"stiffness": f"{5e8 * (1e-3 * sun) ** 2:.17g} N*m/rad"}
        meshes[f"p{k}-ring"] = {"stiffness": f"{5e8 * (1e-3 * planet) ** 2:.17g} N*m/rad"}
    case = ls.Case(
        operating={"input": "sun", "output": "load", "torque": "1000 N*m"},
        gears=gears,
        meshes=meshes,
        shafts={
            "ring-housing": {"stiffness": f"{1e9 * (1e-3 * ring) ** 2:.17g} N*m/rad"},
            "carrier-load": {"stiffness": "1 N*m/rad"},
            "drive-sun": {"stiffness": "rigid"},
        },
    )
    train = build_train(case)
    structure = structure_of(train)
    loading = loading_of(structure, situation_of(train, 1))
    every = slice(0, structure.columns.flanks.stop)
    yields = loading.bending[0, every] * structure.length / structure.force
    push = structure.vectors[every]
    stiffness = push.T @ (push / yields[:, None])
    masses = np.zeros(structure.size)
    for gear, turn in structure.coordinates.rotation.items():
        if turn.index is not None and gear != "drive":
            unit = turn.rate * train.gears[gear].base_radius
            masses[turn.index] += inertia[gear[0] if gear[0] == "p" else gear] * unit**2
    for gear, where in structure.coordinates.displacement.items():
        masses[where] = mass[gear[0] if gear[0] == "p" else gear]
    # A planet's coordinates are relative to its pin: its mass moves with the pin as well.
    inert = np.diag(masses)
    for gear in ("p0", "p1", "p2"):
        moved = structure.coordinates.moved(gear)
        pin = structure.coordinates.moved("carrier")
        pin = pin + np.outer(
            train.gears[gear].pin_motion, structure.coordinates.turned(("carrier", 1.0))
        )
        whole = moved + pin
        inert += mass["p"] * (whole.T @ whole - moved.T @ moved)
    found = np.sqrt(np.maximum(eigh(stiffness, inert, eigvals_only=True), 0.0)) / (2.0 * math.pi)
    single = [0.0, 1475.7, 1930.3, 2658.3, 7462.8, 11775.3]
    double = [743.2, 1102.4, 1896.0, 2276.4, 6986.3, 9647.9]
    assert found == pytest.approx(sorted(single + 2 * double), rel=5e-4, abs=1.0)


def drawn(seed: int) -> tuple[ls.Case, Set, str, float, set[str]]:
    """Draw a random set: as a case, and for the independent model."""
    dice = np.random.default_rng(seed)
    planets = int(dice.integers(2, 8))
    sun, planet = dice.uniform(0.02, 0.2, 2)
    angles = dice.uniform(math.radians(15.0), math.radians(28.0))
    arm = (sun + planet) / math.cos(angles)
    ring = planet + arm * math.cos(dice.uniform(math.radians(15.0), math.radians(28.0)))
    at = 2.0 * np.pi * np.arange(planets) / planets + dice.uniform(-0.1, 0.1, planets)
    stiffness = 10.0 ** dice.uniform(8.0, 9.3, (2, planets))
    gaps = np.where(dice.random((2, planets)) < 0.5, 0.0, dice.uniform(0.0, 2e-5, (2, planets)))
    supports = {
        body: float(10.0 ** dice.uniform(7.5, 9.5))
        for body in ("sun", "ring", "carrier")
        if dice.random() < 0.7
    }
    supports["planet"] = float(10.0 ** dice.uniform(7.5, 9.5))
    clearance = float(dice.choice([0.0, dice.uniform(1e-6, 3e-5)]))
    pins = dice.normal(0.0, 2e-5, (planets, 2))
    load, output, held = CHOICES[int(dice.integers(len(CHOICES)))]
    torsion = (
        float(10.0 ** dice.uniform(7.0, 9.0)) if held == "ring" and dice.random() < 0.5 else 0.0
    )
    centre = ["0 mm", "0 mm"]
    gears: dict[str, Any] = {
        "sun": {"base_radius": f"{sun:.17g} m", "centre": centre},
        "ring": {"type": "internal", "base_radius": f"{ring:.17g} m", "centre": centre},
        "carrier": {"type": "carrier", "centre": centre},
    }
    meshes, bearings, errors, shafts = {}, {}, {}, {}
    for body in ("sun", "ring", "carrier"):
        gears[body]["support"] = f"{supports[body]:.17g} N/m" if body in supports else "rigid"
    if torsion:
        gears["housing"] = {"type": "carrier", "centre": centre, "held": True}
        shafts["ring-housing"] = {"stiffness": f"{torsion:.17g} N*m/rad"}
    else:
        gears[held]["held"] = True
    for k in range(planets):
        gears[f"p{k}"] = {"base_radius": f"{planet:.17g} m", "carrier": "carrier"} | {
            "centre": {"distance": f"{arm:.17g} m", "angle": f"{at[k]:.17g} rad"}
        }
        if clearance:
            bearings[f"p{k}"] = {
                "clearance": f"{clearance:.17g} m",
                "stiffness": f"{supports['planet']:.17g} N/m",
            }
        else:
            gears[f"p{k}"]["support"] = f"{supports['planet']:.17g} N/m"
        for number, (name, radius) in enumerate(((f"sun-p{k}", sun), (f"p{k}-ring", planet))):
            meshes[name] = {
                "stiffness": f"{stiffness[number, k] * radius**2:.17g} N*m/rad",
                "gap": f"{gaps[number, k] / radius:.17g} rad",
            }
        errors[f"p{k}"] = {"installation": [f"{pins[k, 0]:.17g} m", f"{pins[k, 1]:.17g} m"]}
    torque = 10.0 ** dice.uniform(3.0, 5.0)
    case = ls.Case(
        operating={"input": load, "output": output, "torque": f"{torque:.17g} N*m"},
        gears=gears,
        meshes=meshes,
        bearings=bearings,
        errors=errors,
        shafts=shafts,
    )
    train = build_train(case)
    # The sun pushes the planets in the sense of its torque, or against that of the other driven
    # member.
    pressed = train.meshes["sun-p0"]
    driven = train.gears["sun"].sense * (1 if not pressed.named_backwards else -1)
    second = Set(
        sun,
        planet,
        ring,
        arm,
        at,
        stiffness[0],
        stiffness[1],
        gaps,
        supports,
        clearance,
        pins,
        torsion,
        driven,
    )
    signed = torque * train.gears[load].sense
    return case, second, load, signed, {output} if torsion else {output, held}


@pytest.mark.parametrize("seed", mostly_slow(range(200), range(60)))
@pytest.mark.quick(6)
def test_random_sets_are_those_of_a_second_model(seed: int) -> None:
    case, second, load, torque, held = drawn(seed)
    found = ls.solve(case).positions[0].equilibrium
    x, force = second.solve(load, torque, held)
    names = [f"sun-p{k}" for k in range(len(second.angles))]
    names += [f"p{k}-ring" for k in range(len(second.angles))]
    mine = np.array([found.flank_force[name] for name in names])
    assert mine == pytest.approx(force, abs=1e-9 * force.max())
    for body in MEMBERS:
        moved = [x[second.names[body + axis]] for axis in "xy"]
        assert found.displacement[body][:2] == pytest.approx(moved, abs=1e-9 * np.abs(x).max())


@pytest.mark.parametrize(("load", "output", "held"), CHOICES)
@pytest.mark.quick(3)
def test_a_set_that_turns_is_the_same_set_placed_anew(load: str, output: str, held: str) -> None:
    """As seen from the carrier, like the march, and in the housing, as every step is."""
    errors = {
        "sun": {"eccentricity": {"amount": "12 um", "direction": "20 deg"}},
        "ring": {
            "installation": ["9 um", "-4 um"],
            "eccentricity": {"amount": "7 um", "direction": "-50 deg"},
        },
        "carrier": {
            "installation": ["-5 um", "3 um"],
            "eccentricity": {"amount": "8 um", "direction": "75 deg"},
        },
        "p0": {"pin": {"tangential": "20 um", "radial": "-6 um"}},
        "p2": {"eccentricity": {"amount": "10 um", "direction": "10 deg"}},
    }
    case = planetary(4, load, output, held, errors=errors).replace({"gears.sun.support": "2e8 N/m"})
    marched = ls.solve(case.replace({"march": {"gear": load, "revolutions": 0.7, "steps": 5}}))
    train = build_train(case)
    for k, position in enumerate(marched.positions):
        turned = {
            name: g.sense * g.ratio * 2.0 * math.pi * 0.7 * k / 5 for name, g in train.gears.items()
        }
        changes: dict[str, Any] = {}
        for name, error in errors.items():
            if "eccentricity" in error:
                changes[f"errors.{name}.eccentricity.phase"] = f"{turned[name]:.17g} rad"
        for k in range(4):
            angle = 0.5 * math.pi * k + turned["carrier"]
            changes[f"gears.p{k}.centre.angle"] = f"{angle:.17g} rad"
        again = ls.solve(case.replace(changes)).positions[0]
        assert position.torque == pytest.approx(again.torque, rel=1e-9)


def test_a_march_counts_the_turns_of_what_turns() -> None:
    """A ring on an elastic mount stands still; the carrier of a double set runs against its sun."""
    case = planetary().replace(
        {
            "gears.ring.held": None,
            "gears.housing": {"type": "carrier", "centre": ["0 mm", "0 mm"], "held": True},
            'shafts."ring-housing"': {"stiffness": "1e8 N*m/rad"},
        }
    )
    march = {"gear": "ring", "revolutions": 1.0, "steps": 3}
    with pytest.raises(CaseError, match=r"march\.gear"):
        ls.solve(case.replace({"march": march}))
    train = build_train(case.replace({"march": {**march, "gear": "carrier"}}))
    assert train.rotations(2)["carrier"] == pytest.approx(2.0 * math.pi / 3.0)


def test_two_planets_that_mesh_turn_the_carrier_the_other_way() -> None:
    """Sun 30, planets 20 and 20, ring 92 by radii: i = 1 − z_r/z_s."""
    alpha = math.cos(math.radians(20.0))
    sun, planet = 30.0 * alpha, 20.0 * alpha
    gears: dict[str, Any] = {
        "sun": {"base_radius": f"{sun:.17g} mm", "teeth": 30, "centre": ["0 mm", "0 mm"]},
        "carrier": {"type": "carrier", "centre": ["0 mm", "0 mm"]},
    }
    meshes: dict[str, Any] = {}
    reach = 0.0
    for k in range(3):
        turn = 2.0 * math.pi * k / 3.0
        inner = 50.0 * np.array([math.cos(turn), math.sin(turn)])
        outer = inner + 40.0 * np.array([math.cos(turn + 0.9), math.sin(turn + 0.9)])
        reach = float(np.hypot(*outer))
        for name, place in ((f"p{k}", inner), (f"q{k}", outer)):
            gears[name] = {
                "base_radius": f"{planet:.17g} mm",
                "carrier": "carrier",
                "centre": [f"{v:.17g} mm" for v in place],
            }
        for pair in (f"sun-p{k}", f"p{k}-q{k}", f"q{k}-ring"):
            meshes[pair] = {"stiffness": "1e7 N*m/rad"}
    ring = reach * alpha + planet
    gears["ring"] = {
        "type": "internal",
        "base_radius": f"{ring:.17g} mm",
        "centre": ["0 mm", "0 mm"],
        "held": True,
    }
    case = ls.Case(
        operating={"input": "sun", "output": "carrier", "torque": "100 N*m", "positions": 4},
        gears=gears,
        meshes=meshes,
    )
    train = build_train(case)
    speed = {name: g.sense * g.ratio for name, g in train.gears.items()}
    assert 1.0 / speed["carrier"] == pytest.approx(1.0 - ring / sun, rel=1e-12)
    assert speed["carrier"] < 0.0
    assert train.rotations(2)["sun"] > 0.0
    loads = ls.solve(case).positions[1].loads.gears
    assert loads["carrier"] == pytest.approx(-100.0 * (1.0 - ring / sun), rel=1e-9)
