"""Contact lost: on one, on several, on all branches but one."""

from __future__ import annotations

import numpy as np

from benchmarks.stress.dressing import any_structure
from benchmarks.stress.problem import Family
from benchmarks.stress.workbench import SUPPORT, Workbench


def build(part: float, generator: np.random.Generator) -> Workbench:
    """Open `part` of the branches but one by many deflections."""
    bench = any_structure(generator, "rigid")
    if generator.random() < 0.5:
        bench.hertz()
    branches = [m for m in bench.meshes if m.startswith(("sun-", "idler"))]
    lost = max(1, round(part * (len(branches) - 1)))
    for mesh in generator.permutation(branches)[:lost]:
        bench.gap(str(mesh), generator.uniform(0.004, 0.04))
    floats = generator.choice(["rigid", "elastic", "spring on every other gear"])
    if floats != "rigid":
        for gear in (*bench.named("sun"), *bench.named("pinion")):
            bench.support(gear, 1e8)
    if floats.startswith("spring"):
        for gear in (*bench.named("planet"), *bench.named("idler")):
            bench.support(gear, SUPPORT)
    return bench


FAMILY = Family(
    "lost-contact",
    "contact lost",
    "part of the branches that are lost [-]",
    (0.01, 0.25, 0.5, 0.75, 1.0),
    build,
)
