"""Clearances so large that nothing touches."""

from __future__ import annotations

import numpy as np

from benchmarks.stress.dressing import any_structure, floats_of, ring
from benchmarks.stress.problem import Family
from benchmarks.stress.workbench import BENDING, DEFLECTION, Workbench


def build(clearance: float, generator: np.random.Generator) -> Workbench:
    """Give rings, splines and backlashes a play of `clearance` deflections."""
    bench = any_structure(generator)
    if generator.random() < 0.5:
        bench.hertz()
    play = clearance * DEFLECTION
    for gear in floats_of(bench):
        if generator.random() < 0.5:
            bench.spline(gear, BENDING, play, float(generator.choice([0.0, 1.0, 100.0])))
        else:
            bench.support(gear, "free")
        if generator.random() < 0.7:
            ring(bench, gear, generator, play)
    if generator.random() < 0.7:
        bench.backlash(play)
    bench.random_errors(0.5 * DEFLECTION, generator)
    return bench


FAMILY = Family(
    "large-clearance",
    "clearance without end",
    "clearance over deflection [-]",
    (1.0, 3.0, 10.0, 30.0, 100.0, 1e3, 1e4, 1e5),
    build,
)
