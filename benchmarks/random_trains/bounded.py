"""Check that errors of forces and places against the 50-digit reference are within their bounds."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from benchmarks.reference.machine import Machine
from benchmarks.reference.settle import Settled
from loadshare.results.result import Position
from loadshare.train import Train

NONE = 1e-20
"""Force, over the load, or place, over the deflection, that counts as zero: the last digits of the
reference."""
ROUNDING = 2.0**-52
"""Relative rounding of a place that is written as a double."""


def below_error(
    train: Train, found: Position, machine: Machine, settled: Settled
) -> tuple[int, dict[str, list[float]]]:
    """Return the number of bounds on forces and places, and those below the true error.

    Returns
    -------
    count : int
    below : dict of element or coordinate to [bound, error]
        [N] and [m].
    """
    certified = found.certificate.bound
    bounds = {**certified.force, **certified.place}
    count, below = 0, {}
    for name, error, allowance in _errors(train, found, machine, settled):
        count += 1
        if not error <= bounds[name] + allowance:
            below[name] = [bounds[name], float(error)]
    return count, below


def _errors(
    train: Train, found: Position, machine: Machine, settled: Settled
) -> Iterator[tuple[str, Any, Any]]:
    """Yield name, true error and allowance for round-off: flanks, rings, splines, displacements."""
    of, claim, at = machine.arithmetic.mpf, found.equilibrium, settled.at
    unit, length = of(machine.force), of(machine.length)
    for name, force in {**claim.flank_force, **claim.ring_force}.items():
        yield name, abs(of(force) - at.forces.get(name, 0) * unit), NONE * unit
    for name, pulled in claim.radial_reaction.items():
        parts = train.gears[machine.graphs[name].gear].frame @ pulled
        apart = [of(float(v)) + p * unit for v, p in zip(parts, at.pulls[name], strict=True)]
        turned = 8.0 * ROUNDING * np.hypot(*parts)
        yield name, machine.arithmetic.hypot(*apart), turned + NONE * unit
    for gear, i in machine.moves.items():
        body = train.gears[gear]
        moved = body.plane @ claim.displacement[gear]
        turn = body.plane @ body.frame.T
        for k, axis in enumerate("xy"):
            value = float(moved[k])
            exact = sum(of(float(turn[k, j])) * at.x[i + j] for j in range(2))
            error = abs(of(value) - exact * length)
            yield f"{gear} {axis}", error, 8.0 * ROUNDING * np.hypot(*moved) + NONE * length
