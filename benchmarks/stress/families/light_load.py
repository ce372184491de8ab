"""Light load: the tangent of T^(2/3) grows without bound as the load goes."""

from __future__ import annotations

import numpy as np

from benchmarks.stress.dressing import any_structure, held
from benchmarks.stress.problem import Family
from benchmarks.stress.workbench import DEFLECTION, Workbench


def build(part: float, generator: np.random.Generator) -> Workbench:
    """Load a train of Hertz contacts by `part` of its rated torque, errors small or fixed."""
    bench = any_structure(generator)
    bench.hertz(float(generator.choice([0.1, 0.3, 0.9, 1.0])))
    errors = DEFLECTION * float(generator.choice([0.0, 0.3 * part, 0.3]))
    held(bench, generator)
    if errors:
        bench.random_errors(errors, generator)
    bench.torque(part * bench.rated)
    return bench


FAMILY = Family(
    "light-load",
    "light load, c > 0",
    "load over rated [-]",
    tuple(10.0**-k for k in range(10)),
    build,
)
