"""Friction of splines: none, tiny, about the load, larger than any load."""

from __future__ import annotations

import numpy as np

from benchmarks.stress.dressing import any_structure, floats_of
from benchmarks.stress.problem import Family
from benchmarks.stress.workbench import BENDING, DEFLECTION, Workbench


def build(friction: float, generator: np.random.Generator) -> Workbench:
    """Put every float on a spline whose friction is `friction` times 1 kN, or follows the torque.

    1 kN is about what errors of a deflection make of a branch's load.
    """
    bench = any_structure(generator)
    if generator.random() < 0.5:
        bench.hertz()
    for gear in floats_of(bench):
        clearance = DEFLECTION * float(generator.choice([0.1, 1.0, 10.0]))
        if generator.random() < 0.3:
            bench.spline_by_torque(gear, BENDING, clearance, 0.1 * friction, 0.1)
        else:
            bench.spline(gear, BENDING, clearance, 1e3 * friction)
    bench.random_errors(DEFLECTION, generator)
    return bench


FAMILY = Family(
    "friction",
    "friction",
    "friction over 1 kN [-]",
    (1.0, 0.1, 1e-3, 1e-6, 1e-9, 1e-12, 0.0, 10.0, 1e3, 1e6, 1e9),
    build,
)
