"""Zero clearance everywhere: rings, splines and backlash without any play."""

from __future__ import annotations

import numpy as np

from benchmarks.stress.dressing import any_structure, floats_of
from benchmarks.stress.problem import Family
from benchmarks.stress.workbench import BENDING, DEFLECTION, Workbench, pair_of


def build(errors: float, generator: np.random.Generator) -> Workbench:
    """Take all play away; `errors` (in deflections) then preload flanks and limits."""
    bench = any_structure(generator)
    if generator.random() < 0.5:
        bench.hertz()
    for gear in floats_of(bench):
        wall = str(generator.choice(["rigid", "1e9 N/m"]))
        if generator.random() < 0.5:
            bench.spline(gear, BENDING, 0.0, float(generator.choice([0.0, 100.0, 1e5])))
        if generator.random() < 0.7:
            if gear == "sun":
                bench.circle(gear, 0.0, stiffness=wall)
            else:
                bench.drum(gear, pair_of(gear), 0.0, 0.0, 0.0, wall)
    bench.backlash(0.0)
    if errors:
        bench.random_errors(errors * DEFLECTION, generator)
    bench.torque(bench.rated * float(generator.choice([1e-3, 0.1, 1.0])))
    return bench


FAMILY = Family(
    "zero-clearance",
    "zero clearance everywhere",
    "errors over deflection [-]",
    (0.0, 1e-6, 1e-3, 0.03, 0.3, 1.0, 3.0, 10.0),
    build,
)
