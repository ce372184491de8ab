"""Random trains for the families: a structure, and supports for its floats."""

from __future__ import annotations

import numpy as np

from benchmarks.stress.workbench import (
    BENDING,
    DEFLECTION,
    SUPPORT,
    Workbench,
    pair_of,
    split_torque,
    star,
)


def any_structure(generator: np.random.Generator, sun: str = "free") -> Workbench:
    """Return a star of three to six planets, or a split-torque train of two to eight branches."""
    if generator.random() < 0.5:
        return star(int(generator.integers(3, 7)), sun)
    return split_torque(2 * int(generator.integers(1, 5)))


def dressed(generator: np.random.Generator, sun: str = "free", hertz: float = 0.5) -> Workbench:
    """Return `any_structure`; a fraction `hertz` of them has b + c laws."""
    bench = any_structure(generator, sun)
    maybe_hertz(bench, generator, hertz)
    return bench


def maybe(generator: np.random.Generator, part: float = 0.5) -> bool:
    """Return True with probability `part`."""
    return bool(generator.random() < part)


def chosen(generator: np.random.Generator, *values: float) -> float:
    """Return one of several values at random."""
    return float(generator.choice(values))


def maybe_hertz(bench: Workbench, generator: np.random.Generator, part: float = 0.5) -> None:
    """Turn stiffnesses into b + c laws, with probability `part`."""
    if maybe(generator, part):
        bench.hertz()


def maybe_backlash(bench: Workbench, generator: np.random.Generator) -> None:
    """Give all meshes a backlash of 0.1 to 3 deflections, or none."""
    if maybe(generator):
        bench.backlash(DEFLECTION * generator.uniform(0.1, 3.0))


def floats_of(bench: Workbench) -> list[str]:
    """Return the gears that may float: the sun, or the pinions."""
    return bench.named("sun") + bench.named("pinion")


def held(bench: Workbench, generator: np.random.Generator, play: float = DEFLECTION) -> None:
    """Hold every float by a bearing, a spline, a ring, or a spline in a ring.

    Parameters
    ----------
    bench : Workbench
    generator : numpy.random.Generator
    play : float
        Largest clearance [m]; each is between a tenth of it and all of it.
    """
    for gear in floats_of(bench):
        kind = generator.choice(["elastic", "spline", "ring", "spline in a ring"])
        if kind == "elastic":
            bench.support(gear, 1e7 * spread(generator, 0.5))
        if kind.startswith("spline"):
            clearance = play * generator.uniform(0.1, 1.0)
            friction = BENDING * clearance * generator.choice([0.0, 0.1, 0.5])
            bench.spline(gear, BENDING, clearance, friction)
        elif kind == "ring":
            bench.support(gear, "free")
        if kind.endswith("ring"):
            ring(bench, gear, generator, play)
    for gear in (*bench.named("idler"), *bench.named("planet")):
        if generator.random() < 0.3:
            bench.support(gear, SUPPORT * spread(generator, 0.3))


def ring(bench: Workbench, gear: str, generator: np.random.Generator, play: float) -> None:
    """Put a float into a ring: a circle around the sun, a drum around a pinion."""
    stiffness = generator.choice(["rigid", "1e9 N/m"])
    if gear == "sun":
        bench.circle(gear, play * generator.uniform(0.1, 1.0), (0.0, 0.0), str(stiffness))
        return
    clearance, up, down = play * generator.uniform(0.1, 1.0, 3)
    bench.drum(gear, pair_of(gear), clearance, up, down, str(stiffness))


def spread(generator: np.random.Generator, decades: float) -> float:
    """Return a random factor, log-uniform over `decades` decades on either side of 1."""
    return float(10.0 ** generator.uniform(-decades, decades))
