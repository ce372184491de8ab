"""Move answers of the fast method to least norm where forces leave displacements open."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from loadshare.job.machine import Answers, Machine
from loadshare.scene.assemble import scene_of
from loadshare.solver.position import of_least_norm, with_ranges
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.situations import Situations


def least_places(
    machine: Machine,
    situations: Situations,
    found: Answers,
    rows: Sequence[int],
    tolerance: float,
) -> dict[int, Equilibrium]:
    """Move some answers to least norm, in place, and return them with the ranges left open.

    An answer stays where it is if it is not certified at least norm, because round-off of a long
    move shows in a stiff element or in the bound, or if it is refused there as too far away for the
    geometry.

    Parameters
    ----------
    machine : Machine
    situations : Situations
    found : Answers
        Answers to these situations; updated.
    rows : sequence of int
        Numbers of the answers to move.
    tolerance : float
        Largest scaled residual of a certified answer.

    Returns
    -------
    dict of int to Equilibrium
        All of these answers, by number.
    """
    scenes = {
        row: scene_of(
            machine.structure, situations.take(slice(row, row + 1)), found.loading.one(row)
        )
        for row in rows
    }
    claimed = {row: found.equilibria.one(row, scene.position) for row, scene in scenes.items()}
    least = {row: of_least_norm(scenes[row], claimed[row]) for row in rows}
    moved = [row for row in rows if least[row].displacement is not claimed[row].displacement]
    if not moved:
        return least
    placed = found.equilibria.take(np.array(moved))
    for k, row in enumerate(moved):
        placed.put(k, least[row])
    here = situations.take(np.array(moved))
    verdicts = machine.judge.judge(here, placed, tolerance)
    near = machine.measuring.worst(here, placed, verdicts.deflection, refusal=True) < 1.0
    for row, passed in zip(moved, (verdicts.passed & near).tolist(), strict=True):
        if passed:
            found.equilibria.put(row, least[row])
        else:
            least[row] = claimed[row]
        least[row] = with_ranges(least[row], scenes[row])
    return least
