"""Gears that float without any support: the flanks alone hold them, or do not."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.stress.problem import Family
from benchmarks.stress.workbench import DEFLECTION, Workbench, split_torque, star


def build(bend: float, generator: np.random.Generator) -> Workbench:
    """Leave floats unsupported; of two planets the second stands off the line by `bend` [rad].

    Such a sun is pushed out sideways: nothing holds it unless a coast flank does.
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
    if generator.random() < 0.5:
        bench.hertz()
    if generator.random() < 0.5:
        bench.backlash(DEFLECTION * float(generator.choice([0.0, 1.0, 30.0])))
    bench.random_errors(DEFLECTION * float(generator.choice([0.1, 1.0, 3.0])), generator)
    bench.torque(bench.rated * float(generator.choice([1e-3, 0.1, 1.0])))
    return bench


FAMILY = Family(
    "free-pinion",
    "float without support",
    "bend off the line [rad]",
    (0.0, 0.001, 0.01, 0.03, 0.1, 0.3, 0.5),
    build,
)
