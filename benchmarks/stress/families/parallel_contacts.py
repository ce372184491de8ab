"""Redundant and nearly parallel contacts: planets almost in one place, limits given twice."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.stress.problem import Family
from benchmarks.stress.workbench import (
    DEFLECTION,
    SUPPORT,
    Workbench,
    pair_of,
    split_torque,
    star,
)


def build(apart: float, generator: np.random.Generator) -> Workbench:
    """Make contacts whose normals differ by the angle `apart`."""
    if generator.random() < 0.7:
        return _crowded(apart, generator)
    return _twice(apart, generator)


def _crowded(apart: float, generator: np.random.Generator) -> Workbench:
    """Put planets of a star beside each other, two or three in one place up to `apart`."""
    planets = int(generator.integers(4, 7))
    bench = star(planets)
    for number in range(4, planets + 1):
        beside = int(generator.integers(1, 4))
        angle = 2.0 * math.pi * (beside - 1) / 3.0 + apart * (number - 3)
        bench.place(f"planet{number}", angle)
    for number in range(1, 4):
        bench.place(f"planet{number}", 2.0 * math.pi * (number - 1) / 3.0)
    if generator.random() < 0.5:
        bench.hertz()
    if generator.random() < 0.5:
        bench.backlash(DEFLECTION * float(generator.choice([0.0, 1.0])))
    if generator.random() < 0.5:
        bench.circle("sun", DEFLECTION * float(generator.uniform(0.0, 1.0)))
    bench.random_errors(DEFLECTION * float(generator.choice([0.01, 1.0])), generator)
    return bench


def _twice(apart: float, generator: np.random.Generator) -> Workbench:
    """Limit pinion and idler by the same pair of rings, once from either side."""
    bench = split_torque(2 * int(generator.integers(1, 5)))
    play = DEFLECTION * float(generator.choice([0.0, 0.1, 1.0]))
    for pinion in bench.named("pinion"):
        first, second = pair_of(pinion)
        bench.support(pinion, "free")
        bench.drum(pinion, (first, second), play, play, play)
        bench.support(first, SUPPORT)
        bench.drum(first, (pinion, "out"), play * (1.0 + apart), 10.0 * play, 10.0 * play)
    bench.random_errors(DEFLECTION, generator, bench.named("idler"))
    return bench


FAMILY = Family(
    "parallel-contacts",
    "redundant, nearly parallel",
    "angle between normals [rad]",
    (0.3, 0.1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 0.0),
    build,
)
