"""Move answers of the fast method to least norm where forces leave displacements open."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from loadshare.job.machine import Answers, Machine
from loadshare.later import Later
from loadshare.scene.assemble import scene_of
from loadshare.scene.scene import Scene
from loadshare.solver.hot.answer import equilibria
from loadshare.solver.hot.least_norm import least_norm
from loadshare.solver.position import of_least_norm, ranges_of
from loadshare.train.equilibrium import Range
from loadshare.train.situations import Situations


def least_places(
    machine: Machine,
    situations: Situations,
    found: Answers,
    rows: Sequence[int],
    tolerance: float,
) -> None:
    """Move some answers to least norm, in place.

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
    """
    if not rows:
        return
    every = np.array(rows, dtype=np.intp)
    here, iterate = situations.take(every), found.iterate.take(every)
    places = least_norm(machine.structure, here, found.loading.take(every), iterate)
    iterate.x[:] = places.x
    placed, moved = equilibria(machine.structure, here, iterate), places.moved
    for k in np.flatnonzero(~places.known).tolist():
        row = int(every[k])
        scene = _scene(machine, situations, found, row)
        claimed = found.equilibria.one(row, scene.position)
        least = of_least_norm(scene, claimed)
        moved[k] = least.displacement is not claimed.displacement
        placed.put(k, least)
    if not moved.any():
        return
    some = np.flatnonzero(moved)
    ours, here, every = placed.take(some), here.take(some), every[some]
    verdicts = machine.judge.judge(here, ours, tolerance)
    near = machine.measuring.worst(here, ours, verdicts.deflection, refusal=True) < 1.0
    passed = verdicts.passed & near
    for name in ("rotation", "displacement"):
        getattr(found.equilibria, name)[every[passed]] = getattr(ours, name)[passed]


def open_ranges(
    machine: Machine, situations: Situations, found: Answers, row: int
) -> Mapping[str, Range]:
    """Return least and largest values of what the forces of an answer leave undetermined.

    They follow from its own place, however that was found, as in the check of a loaded result, and
    are computed when they are first read.
    """

    def ranges() -> Mapping[str, Range]:
        scene = _scene(machine, situations, found, row)
        return ranges_of(found.equilibria.one(row, scene.position), scene)

    return Later(ranges)


def _scene(machine: Machine, situations: Situations, found: Answers, row: int) -> Scene:
    here = situations.take(slice(row, row + 1))
    return scene_of(machine.structure, here, found.loading.one(row))
