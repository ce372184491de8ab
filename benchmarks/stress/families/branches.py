"""Branches: from 2 to 64, every float held by something else."""

from __future__ import annotations

import numpy as np

from benchmarks.stress.dressing import held
from benchmarks.stress.problem import Family
from benchmarks.stress.workbench import DEFLECTION, Workbench, split_torque


def build(branches: float, generator: np.random.Generator) -> Workbench:
    """Return a split-torque train of so many branches with errors, play and b + c laws."""
    bench = split_torque(int(branches))
    if generator.random() < 0.5:
        bench.hertz()
    held(bench, generator)
    if generator.random() < 0.5:
        bench.backlash(DEFLECTION * generator.uniform(0.1, 3.0))
    bench.random_errors(DEFLECTION * float(generator.choice([0.1, 1.0])), generator)
    return bench


FAMILY = Family(
    "branches",
    "2 to 64 branches",
    "branches [-]",
    (2, 4, 6, 8, 10, 12, 16, 20, 24, 32, 40, 48, 56, 64),
    build,
)
