"""Problems without an answer: no path for the torque, or limits that contradict each other."""

from __future__ import annotations

import math

import numpy as np

from benchmarks.stress.dressing import maybe_hertz
from benchmarks.stress.workbench import (
    DEFLECTION,
    Workbench,
    pair_of,
    split_torque,
    star,
)


def without_answer(excess: float, generator: np.random.Generator) -> Workbench:
    """Return a train that must be refused; it misses an equilibrium by `excess`."""
    kinds = (_squeezed, _one_sided, _unheld)
    kind = kinds[int(generator.integers(len(kinds)))]
    bench = kind(excess, generator)
    maybe_hertz(bench, generator)
    return bench


def _squeezed(excess: float, generator: np.random.Generator) -> Workbench:
    """Return a train whose drum has neighbours closer than rings made to the drawing allow."""
    bench = split_torque(2 * int(generator.integers(1, 5)))
    pinion = str(generator.choice(bench.named("pinion")))
    clearance = DEFLECTION * generator.uniform(0.1, 1.0)
    bench.support(pinion, "free")
    bench.drum(pinion, pair_of(pinion), clearance, DEFLECTION, DEFLECTION)
    bench.data["rings"][pinion]["measured"] = "nominal"
    for neighbour in pair_of(pinion):
        amount = clearance * (1.0 + excess)
        bench.installation(neighbour, amount, bench.direction(neighbour, pinion))
    return bench


def _one_sided(excess: float, generator: np.random.Generator) -> Workbench:
    """Return a star with a free sun that has all planets on one side."""
    planets = int(generator.integers(2, 5))
    bench = star(planets)
    for number in range(1, planets + 1):
        bench.place(f"planet{number}", math.pi / (1.2 + excess) * (number - 1) / planets)
    return bench


def _unheld(excess: float, generator: np.random.Generator) -> Workbench:
    """Return a train with free idlers between a pinion and a gear that both push them out."""
    bench = split_torque(2 * int(generator.integers(1, 5)))
    for idler in bench.named("idler"):
        bench.support(idler, "free")
    bench.torque(bench.rated * min(1.0, excess))
    return bench
