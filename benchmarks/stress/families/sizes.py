"""Sizes: from gears of tens of nanometres to those of the largest machines, soft to stiff."""

from __future__ import annotations

import numpy as np

from benchmarks.stress.dressing import any_structure, held, spread
from benchmarks.stress.problem import Family
from benchmarks.stress.workbench import DEFLECTION, Workbench


def build(size: float, generator: np.random.Generator) -> Workbench:
    """Scale a whole train by `size`, and its material by up to a thousand either way."""
    bench = any_structure(generator)
    if generator.random() < 0.5:
        bench.hertz()
    held(bench, generator)
    if generator.random() < 0.5:
        bench.backlash(DEFLECTION * generator.uniform(0.1, 3.0))
    bench.random_errors(DEFLECTION, generator)
    bench.scale(size, spread(generator, 3.0))
    return bench


FAMILY = Family(
    "sizes",
    "micro to macro",
    "scale [-]",
    (1.0, 3.0, 10.0, 100.0, 0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6),
    build,
)
