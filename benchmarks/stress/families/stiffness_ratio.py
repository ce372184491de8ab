"""Stiffness ratio: meshes, shafts and bearings that differ by many powers of ten."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.stress.dressing import any_structure, held
from benchmarks.stress.problem import Family
from benchmarks.stress.workbench import DEFLECTION, Workbench


def build(ratio: float, generator: np.random.Generator) -> Workbench:
    """Spread the stiffnesses over `ratio`, its two ends included."""
    bench = any_structure(generator)
    held(bench, generator)
    exponents = generator.uniform(-0.5, 0.5, len(bench.meshes))
    exponents[generator.permutation(len(exponents))[:2]] = (-0.5, 0.5)
    for mesh, exponent in zip(bench.meshes, exponents, strict=True):
        bench.stiffness(mesh, 2e6 * ratio**exponent)
    bench.shafts(lambda _: 5e5 * ratio ** generator.uniform(-0.5, 0.5))
    # The softest mesh yields so much more that errors of its size would be no gear's any more.
    bench.random_errors(0.3 * DEFLECTION * math.sqrt(ratio) / ratio**0.25, generator)
    return bench


FAMILY = Family(
    "stiffness-ratio",
    "stiffness ratio",
    "stiffest over softest [-]",
    tuple(10.0**k for k in range(13)),
    build,
)
