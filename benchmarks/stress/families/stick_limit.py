"""Stick limit: the law of a spline that just continues, or jumps up where it starts to slip."""

from __future__ import annotations

import numpy as np

from benchmarks.stress.dressing import any_structure, floats_of
from benchmarks.stress.problem import Family
from benchmarks.stress.workbench import BENDING, DEFLECTION, Workbench


def build(part: float, generator: np.random.Generator) -> Workbench:
    """Let splines stick up to `part` of F_m/K_w; the force jumps from there to F_m."""
    bench = any_structure(generator)
    if generator.random() < 0.5:
        bench.hertz()
    for gear in floats_of(bench):
        clearance = DEFLECTION * float(generator.choice([0.3, 1.0, 3.0]))
        friction = BENDING * clearance * float(generator.uniform(0.05, 0.9))
        bench.spline(gear, BENDING, clearance, friction, part * friction / BENDING)
    bench.random_errors(DEFLECTION * float(generator.choice([0.1, 1.0, 3.0])), generator)
    return bench


FAMILY = Family(
    "stick-limit",
    "stick limit, jumping law",
    "K_w S1 over F_m [-]",
    (1.0, 1.0 - 1e-15, 1.0 - 1e-12, 1.0 - 1e-9, 1.0 - 1e-6, 0.9, 0.5, 0.1, 1e-3, 1e-6, 1e-9, 0.0),
    build,
)
