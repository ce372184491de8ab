"""Wedging: a float pressed in between its two neighbours, both flanks of both meshes closed."""

from __future__ import annotations

import numpy as np

from benchmarks.stress.problem import Family
from benchmarks.stress.workbench import DEFLECTION, Workbench, pair_of, split_torque, star


def build(pressed: float, generator: np.random.Generator) -> Workbench:
    """Move the neighbours of every float towards it by `pressed` deflections."""
    if generator.random() < 0.4:
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
    if generator.random() < 0.5:
        bench.hertz()
    bench.backlash(DEFLECTION * float(generator.choice([0.0, 0.1, 1.0])))
    bench.torque(bench.rated * float(generator.choice([0.0, 1e-3, 0.1, 1.0])))
    return bench


FAMILY = Family(
    "wedging",
    "wedged between neighbours",
    "pressed in, over deflection [-]",
    (0.0, 0.01, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0),
    build,
)
