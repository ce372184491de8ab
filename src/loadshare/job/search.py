"""Search for other answers: many starts, and a path from large clearances.

A proof covers the neighbourhood of an answer (`certify.uniqueness`); this looks further, where ring
arcs make a problem nonconvex. It is a search, not a proof: answers that it does not find may still
exist, and the result says how far it went.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from loadshare.arguments import whole
from loadshare.case import Case
from loadshare.errors import Refused
from loadshare.job.answer import Answer
from loadshare.job.ladder import climb_all
from loadshare.job.machine import Machine
from loadshare.job.positions import prepared, wanted_positions
from loadshare.numbers import counted
from loadshare.scene.loading import loading_of
from loadshare.settings import CERTIFY, JOB
from loadshare.solver import Options
from loadshare.solver.hot import vectorised
from loadshare.solver.hot.answer import equilibria
from loadshare.solver.hot.exchange import exchange, first_sets
from loadshare.solver.hot.iterate import at_rest
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.ring import DrumRing
from loadshare.train.situations import situation_of, stack
from loadshare.train.train import Train
from loadshare.view import View, Viewed


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Search(Viewed):
    """Outcome of a search for other answers at a position.

    Attributes
    ----------
    answer : Answer
        The known answer.
    starts : int
        Starts that led to a certified equilibrium, of `JOB.starts`.
    path : bool or None
        Whether the path from generous clearance ends in the answer; None if it broke off.
    others : tuple of Equilibrium
        Certified equilibria with other forces, each once.
    """

    answer: Answer
    starts: int
    path: bool | None
    others: tuple[Equilibrium, ...]

    @property
    def way(self) -> str:
        """Where the path from generous clearance ends, in words."""
        return {True: "leads to the same", False: "leads elsewhere", None: "broke off"}[self.path]

    @property
    def text(self) -> str:
        """What was done and found, as a sentence."""
        found = counted(len(self.others), "other answer") if self.others else "no other answer"
        return (
            f"Search: {found} from {self.starts} of {JOB.starts} random starts that were "
            f"certified; the path from generous clearance {self.way}."
        )

    def _view(self) -> View:
        from loadshare.job.views import search_view

        return search_view(self)


def search(case: Case | str | Path, position: int = 1, *, seed: int = 0) -> Search:
    """Search for other answers of a position.

    Parameters
    ----------
    case : Case or path
    position : int
        1-based.
    seed : int
        Seed of the random starts.

    Raises
    ------
    CaseError, Refused, ValueError
        As :func:`loadshare.solve`.
    """
    seed = whole("seed", seed, 0)
    _, machine = prepared(case)
    (position,) = wanted_positions(machine.train, [position])
    machine = machine.at(position)
    (known,) = climb_all(machine, [position], Options(), CERTIFY.tolerance)
    if isinstance(known, Refused):
        raise known
    others: list[Equilibrium] = []
    certified = _starts(machine, position, np.random.default_rng(seed))
    for found in certified:
        if not any(_same(found, one, known) for one in (known.equilibrium, *others)):
            others.append(found)
    end = _path(machine.train, position, known.certificate.deflection)
    path = None if end is None else _same(end, known.equilibrium, known)
    if end is not None and not any(_same(end, o, known) for o in (known.equilibrium, *others)):
        others.append(end)
    return Search(known, len(certified), path, tuple(others))


def _same(one: Equilibrium, other: Equilibrium, known: Answer) -> bool:
    forces = (one.flank_force, one.ring_force), (other.flank_force, other.ring_force)
    apart = [abs(a[name] - b[name]) for a, b in zip(*forces, strict=True) for name in a]
    return max(apart, default=0.0) <= JOB.same * known.certificate.load


def _starts(machine: Machine, position: int, rng: np.random.Generator) -> list[Equilibrium]:
    """Return certified equilibria from random active sets and random displacements."""
    structure = machine.structure
    situations = stack([situation_of(machine.train, position)] * JOB.starts)
    loading = loading_of(structure, situations)
    iterate, states = at_rest(structure, loading), first_sets(structure, loading)
    rows = structure.rows
    states[:, :rows] = np.where(
        rng.random((JOB.starts, rows)) < 0.5,
        rng.integers(0, 2, (JOB.starts, rows)),
        states[:, :rows],
    )
    scale = np.abs(loading.nominal).max(initial=0.0)
    # From 1e-9 of the rings' distance up to a tenth of it.
    iterate.x[:] = (
        rng.normal(size=iterate.x.shape) * scale * 10.0 ** -rng.uniform(1, 9, (JOB.starts, 1))
    )
    found = exchange(structure, loading, iterate, vectorised.settle, states)
    answers = equilibria(structure, situations, iterate)
    verdicts = machine.judge.judge(situations, answers, CERTIFY.tolerance)
    good = np.flatnonzero(found.solved & verdicts.passed).tolist()
    return [answers.one(row, position) for row in good]


def _path(train: Train, position: int, deflection: float) -> Equilibrium | None:
    """Return the answer at the end of a path on which clearances shrink to their true values."""
    near: Machine | None = None
    extra = [JOB.generous * deflection * 0.5**k for k in range(JOB.path)] + [0.0]
    found: Answer | Refused | None = None
    for more in extra:
        near = Machine(_widened(train, more), near=near)
        (found,) = climb_all(near, [position], Options(), CERTIFY.tolerance)
        if isinstance(found, Refused):
            return None
    return found.equilibrium if isinstance(found, Answer) else None


def _widened(train: Train, more: float) -> Train:
    rings = {
        name: replace(r, clearances=(r.clearances[0] + more, r.clearances[1] + more))
        if isinstance(r, DrumRing)
        else r
        for name, r in train.rings.items()
    }
    return replace(train, rings=rings)
