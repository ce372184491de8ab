"""Errors far beyond the deflection: most branches lose contact, limits close."""

from __future__ import annotations

import numpy as np

from benchmarks.stress.dressing import any_structure, held
from benchmarks.stress.problem import Family
from benchmarks.stress.workbench import DEFLECTION, Workbench


def build(errors: float, generator: np.random.Generator) -> Workbench:
    """Displace every gear by up to `errors` deflections, in any direction."""
    bench = any_structure(generator)
    if generator.random() < 0.5:
        bench.hertz()
    held(bench, generator)
    if generator.random() < 0.5:
        bench.backlash(DEFLECTION * generator.uniform(0.1, 3.0))
    bench.random_errors(errors * DEFLECTION, generator)
    return bench


FAMILY = Family(
    "large-errors",
    "errors beyond the deflection",
    "errors over deflection [-]",
    (0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0),
    build,
)
