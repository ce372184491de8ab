"""No load at all: what moves is moved by preload alone, and most displacements are free."""

from __future__ import annotations

import numpy as np

from benchmarks.stress.dressing import any_structure, held
from benchmarks.stress.problem import Family
from benchmarks.stress.workbench import DEFLECTION, Workbench


def build(errors: float, generator: np.random.Generator) -> Workbench:
    """Leave a train without load; `errors` (in deflections) may jam it where backlash is small."""
    bench = any_structure(generator)
    if generator.random() < 0.5:
        bench.hertz()
    held(bench, generator)
    kind = generator.choice(["no coast flank", "play", "no play"])
    if kind != "no coast flank":
        bench.backlash(DEFLECTION if kind == "play" else 0.0)
    if errors:
        bench.random_errors(errors * DEFLECTION, generator)
    bench.torque(0.0)
    return bench


FAMILY = Family(
    "no-load",
    "load exactly zero",
    "errors over deflection [-]",
    (0.0, 0.01, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0),
    build,
)
