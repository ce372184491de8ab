"""Functions that build a problem of a family from the level of its knob and a random generator."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.stress.dressing import (
    any_structure,
    chosen,
    dressed,
    floats_of,
    held,
    maybe,
    maybe_backlash,
    maybe_hertz,
    ring,
    spread,
)
from benchmarks.stress.workbench import (
    BENDING,
    DEFLECTION,
    SUPPORT,
    Workbench,
    pair_of,
    split_torque,
    star,
)

Random = np.random.Generator


def spread_stiffnesses(ratio: float, generator: Random) -> Workbench:
    """Spread the stiffnesses of meshes and shafts over `ratio`, both ends included."""
    bench = any_structure(generator)
    held(bench, generator)
    exponents = generator.uniform(-0.5, 0.5, len(bench.meshes))
    exponents[generator.permutation(len(exponents))[:2]] = (-0.5, 0.5)
    for mesh, exponent in zip(bench.meshes, exponents, strict=True):
        bench.stiffness(mesh, 2e6 * ratio**exponent)
    bench.shafts(lambda _: 5e5 * ratio ** generator.uniform(-0.5, 0.5))
    # The softest mesh yields so much more that errors of the size of its deflection would not be
    # realistic.
    bench.random_errors(0.3 * DEFLECTION * math.sqrt(ratio) / ratio**0.25, generator)
    return bench


def lightly_loaded(part: float, generator: Random) -> Workbench:
    """Load Hertz contacts with `part` of the rated torque; errors are small or fixed.

    The tangent of T^(2/3) grows without bound as the load tends to zero.
    """
    bench = any_structure(generator)
    bench.hertz(chosen(generator, 0.1, 0.3, 0.9, 1.0))
    errors = DEFLECTION * chosen(generator, 0.0, 0.3 * part, 0.3)
    held(bench, generator)
    if errors:
        bench.random_errors(errors, generator)
    bench.torque(part * bench.rated)
    return bench


def without_load(errors: float, generator: Random) -> Workbench:
    """Leave a train without load; `errors` (in deflections) may jam it if the backlash is small.

    Only preload causes displacements, and most displacements are free.
    """
    bench = dressed(generator)
    held(bench, generator)
    kind = generator.choice(["no coast flank", "play", "no play"])
    if kind != "no coast flank":
        bench.backlash(DEFLECTION if kind == "play" else 0.0)
    if errors:
        bench.random_errors(errors * DEFLECTION, generator)
    bench.torque(0.0)
    return bench


def contacts_lost(part: float, generator: Random) -> Workbench:
    """Open `part` of the branches but one by many deflections."""
    bench = dressed(generator, "rigid")
    branches = [m for m in bench.meshes if m.startswith(("sun-", "idler"))]
    lost = max(1, round(part * (len(branches) - 1)))
    for mesh in generator.permutation(branches)[:lost]:
        bench.gap(str(mesh), generator.uniform(0.004, 0.04))
    floats = generator.choice(["rigid", "elastic", "spring on every other gear"])
    if floats != "rigid":
        for gear in floats_of(bench):
            bench.support(gear, 1e8)
    if floats.startswith("spring"):
        for gear in (*bench.named("planet"), *bench.named("idler")):
            bench.support(gear, SUPPORT)
    return bench


def without_play(errors: float, generator: Random) -> Workbench:
    """Remove all play; `errors` (in deflections) then preload flanks and limits."""
    bench = dressed(generator)
    for gear in floats_of(bench):
        wall = str(generator.choice(["rigid", "1e9 N/m"]))
        if maybe(generator):
            bench.spline(gear, BENDING, 0.0, chosen(generator, 0.0, 100.0, 1e5))
        if maybe(generator, 0.7):
            if gear == "sun":
                bench.circle(gear, 0.0, stiffness=wall)
            else:
                bench.drum(gear, pair_of(gear), 0.0, 0.0, 0.0, wall)
    bench.backlash(0.0)
    if errors:
        bench.random_errors(errors * DEFLECTION, generator)
    bench.torque(bench.rated * chosen(generator, 1e-3, 0.1, 1.0))
    return bench


def wide_play(clearance: float, generator: Random) -> Workbench:
    """Give rings, splines and backlashes a play of `clearance` deflections: nothing touches."""
    bench = dressed(generator)
    play = clearance * DEFLECTION
    for gear in floats_of(bench):
        if maybe(generator):
            bench.spline(gear, BENDING, play, chosen(generator, 0.0, 1.0, 100.0))
        else:
            bench.support(gear, "free")
        if maybe(generator, 0.7):
            ring(bench, gear, generator, play)
    if maybe(generator, 0.7):
        bench.backlash(play)
    bench.random_errors(0.5 * DEFLECTION, generator)
    return bench


def rubbing_splines(friction: float, generator: Random) -> Workbench:
    """Put every float on a spline whose friction is `friction` times 1 kN, or follows the torque.

    1 kN is about the change of a branch's load under errors of one deflection.
    """
    bench = dressed(generator)
    for gear in floats_of(bench):
        clearance = DEFLECTION * chosen(generator, 0.1, 1.0, 10.0)
        if maybe(generator, 0.3):
            # The friction coefficient is limited to the largest that case files allow.
            bench.spline_by_torque(gear, BENDING, clearance, min(0.1 * friction, 1e3), 0.1)
        else:
            bench.spline(gear, BENDING, clearance, 1e3 * friction)
    bench.random_errors(DEFLECTION, generator)
    return bench


def jumping_splines(part: float, generator: Random) -> Workbench:
    """Let splines stick up to `part` of F_m/K_w; the force jumps from there to F_m."""
    bench = dressed(generator)
    for gear in floats_of(bench):
        clearance = DEFLECTION * chosen(generator, 0.3, 1.0, 3.0)
        friction = BENDING * clearance * float(generator.uniform(0.05, 0.9))
        bench.spline(gear, BENDING, clearance, friction, part * friction / BENDING)
    bench.random_errors(DEFLECTION * chosen(generator, 0.1, 1.0, 3.0), generator)
    return bench


def nearly_parallel(apart: float, generator: Random) -> Workbench:
    """Build contacts whose normals differ by the angle `apart`."""
    return (_crowded if maybe(generator, 0.7) else _limited_twice)(apart, generator)


def _crowded(apart: float, generator: Random) -> Workbench:
    """Put planets of a star beside each other: two or three in one place except for `apart`."""
    planets = int(generator.integers(4, 7))
    bench = star(planets)
    for number in range(4, planets + 1):
        beside = int(generator.integers(1, 4))
        angle = 2.0 * math.pi * (beside - 1) / 3.0 + apart * (number - 3)
        bench.place(f"planet{number}", angle)
    for number in range(1, 4):
        bench.place(f"planet{number}", 2.0 * math.pi * (number - 1) / 3.0)
    maybe_hertz(bench, generator)
    if maybe(generator):
        bench.backlash(DEFLECTION * chosen(generator, 0.0, 1.0))
    if maybe(generator):
        bench.circle("sun", DEFLECTION * float(generator.uniform(0.0, 1.0)))
    bench.random_errors(DEFLECTION * chosen(generator, 0.01, 1.0), generator)
    return bench


def _limited_twice(apart: float, generator: Random) -> Workbench:
    """Limit pinion and idler by the same pair of rings, once from either side."""
    bench = split_torque(2 * int(generator.integers(1, 5)))
    play = DEFLECTION * chosen(generator, 0.0, 0.1, 1.0)
    for pinion in bench.named("pinion"):
        first, second = pair_of(pinion)
        bench.support(pinion, "free")
        bench.drum(pinion, (first, second), play, play, play)
        bench.support(first, SUPPORT)
        bench.drum(first, (pinion, "out"), play * (1.0 + apart), 10.0 * play, 10.0 * play)
    bench.random_errors(DEFLECTION, generator, bench.named("idler"))
    return bench


def softly_supported(softness: float, generator: Random) -> Workbench:
    """Hold some gears by springs `softness` times softer than a bearing, the others rigidly.

    A gear that flanks do not hold in every direction gets a rigid round ring, so that it stays
    near.
    """
    bench = dressed(generator, "rigid", hertz=0.3)
    soft = SUPPORT / softness
    for gear in floats_of(bench):
        bench.support(gear, soft)
    for gear in (*bench.named("planet"), *bench.named("idler")):
        if maybe(generator, 0.4):
            bench.support(gear, soft)
            bench.circle(gear, DEFLECTION * generator.uniform(0.0, 1.0))
    bench.shafts(lambda _: "rigid" if maybe(generator) else 5e5)
    bench.random_errors(DEFLECTION, generator)
    return bench


def unsupported(bend: float, generator: Random) -> Workbench:
    """Leave floats unsupported; of two planets, the second is off the line by `bend` [rad].

    Such a sun is pushed out sideways, and only a coast flank can hold it.
    """
    kind = generator.choice(["two planets", "more planets", "pinions", "everything"])
    if kind == "two planets":
        bench = star(2)
        bench.place("planet2", math.pi - bend)
    elif kind == "more planets":
        bench = star(int(generator.integers(3, 7)))
    else:
        bench = split_torque(2 * int(generator.integers(2, 5)))
        for gear in bench.named("pinion"):
            bench.support(gear, "free")
        if kind == "everything":
            bench.support("in", "free")
    maybe_hertz(bench, generator)
    if maybe(generator):
        bench.backlash(DEFLECTION * chosen(generator, 0.0, 1.0, 30.0))
    bench.random_errors(DEFLECTION * chosen(generator, 0.1, 1.0, 3.0), generator)
    bench.torque(bench.rated * chosen(generator, 1e-3, 0.1, 1.0))
    return bench


def wedged(pressed: float, generator: Random) -> Workbench:
    """Move the neighbours of every float towards it by `pressed` deflections.

    Both flanks of both meshes close.
    """
    if maybe(generator, 0.4):
        bench = star(int(generator.integers(2, 7)))
        between = {"sun": tuple(bench.named("planet"))}
    else:
        bench = split_torque(2 * int(generator.integers(1, 5)))
        between = {p: pair_of(p) for p in bench.named("pinion")}
    for gear, neighbours in between.items():
        bench.support(gear, "free")
        for neighbour in neighbours:
            amount = pressed * DEFLECTION * generator.uniform(0.5, 1.0)
            bench.installation(neighbour, amount, bench.direction(neighbour, gear))
    maybe_hertz(bench, generator)
    bench.backlash(DEFLECTION * chosen(generator, 0.0, 0.1, 1.0))
    bench.torque(bench.rated * chosen(generator, 0.0, 1e-3, 0.1, 1.0))
    return bench


def displaced_far(errors: float, generator: Random) -> Workbench:
    """Displace every gear by up to `errors` deflections: branches lose contact, limits close."""
    bench = dressed(generator)
    held(bench, generator)
    maybe_backlash(bench, generator)
    bench.random_errors(errors * DEFLECTION, generator)
    return bench


def scaled(size: float, generator: Random) -> Workbench:
    """Scale a whole train by `size`, and its material by up to a thousand either way."""
    bench = displaced_far(1.0, generator)
    bench.scale(size, spread(generator, 3.0))
    return bench


def of_many_branches(branches: float, generator: Random) -> Workbench:
    """Return a split-torque train of `branches` branches; every float is held by something else."""
    bench = split_torque(int(branches))
    maybe_hertz(bench, generator)
    held(bench, generator)
    maybe_backlash(bench, generator)
    bench.random_errors(DEFLECTION * chosen(generator, 0.1, 1.0), generator)
    return bench
