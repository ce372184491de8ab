"""Rigid beside very soft: gears that hardly anything holds between gears that nothing moves."""

from __future__ import annotations

import numpy as np

from benchmarks.stress.dressing import any_structure
from benchmarks.stress.problem import Family
from benchmarks.stress.workbench import DEFLECTION, SUPPORT, Workbench


def build(softness: float, generator: np.random.Generator) -> Workbench:
    """Hold some gears by springs `softness` times softer than a bearing, the others rigidly.

    What flanks do not hold in every direction gets a rigid round ring, or it would run far away.
    """
    bench = any_structure(generator, "rigid")
    if generator.random() < 0.3:
        bench.hertz()
    soft = SUPPORT / softness
    for gear in (*bench.named("sun"), *bench.named("pinion")):
        bench.support(gear, soft)
    for gear in (*bench.named("planet"), *bench.named("idler")):
        if generator.random() < 0.4:
            bench.support(gear, soft)
            bench.circle(gear, DEFLECTION * generator.uniform(0.0, 1.0))
    bench.shafts(lambda _: "rigid" if generator.random() < 0.5 else 5e5)
    bench.random_errors(DEFLECTION, generator)
    return bench


FAMILY = Family(
    "soft-supports",
    "rigid beside very soft",
    "softness [-]",
    tuple(10.0**k for k in range(13)),
    build,
)
