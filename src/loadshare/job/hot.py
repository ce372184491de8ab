"""The first rung of the ladder: positions of a case by the fast method, all of them at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np

from loadshare.array_types import Flags
from loadshare.certify import Certificate, Claims, certified
from loadshare.certify.certificate import in_groups
from loadshare.contact.plan import Plan, Role
from loadshare.job.answer import Answer
from loadshare.job.engines import available_engine
from loadshare.job.least import least_places, open_ranges
from loadshare.job.machine import Answers, Machine
from loadshare.numbers import counted
from loadshare.settings import JOB
from loadshare.solver import Record
from loadshare.solver.position import coordinates_of
from loadshare.train.equilibrium import Equilibrium, Range
from loadshare.train.situations import Situations
from loadshare.train.train import Train

HOT, SEARCHED = "fast method", "proximal search"


@dataclass(eq=False, repr=False)
class HotAnswers:
    """Answers of the fast method to situations of one machine, handed out one by one.

    Parameters
    ----------
    machine : Machine
    situations : Situations
        S of them.
    found : Answers
        Answers to these situations.
    tolerance : float
        Tolerance of their certificates.
    """

    machine: Machine
    situations: Situations
    found: Answers
    tolerance: float
    _placed: set[int] = field(default_factory=set, init=False)

    @cached_property
    def small(self) -> Flags:
        """Whether displacements are known to be below the limits of a refusal, (S,)."""
        found = self.found
        if (found.verdicts.displaced < JOB.small).all():
            # The limit of a warning is below that of a refusal.
            return np.ones(self.situations.count, dtype=bool)
        deflection = found.verdicts.deflection
        moved = self.machine.measuring.worst(
            self.situations, found.equilibria, deflection, refusal=True
        )
        return np.asarray(moved < JOB.small)

    def answers(self, rows: Sequence[int], indices: Sequence[int], train: Train) -> list[Answer]:
        """Return answers that passed, each at a position of a train."""
        found: list[Answer] = []
        names, every = self.found.equilibria.names.flanks, self.found.equilibria.flank_force
        for some in in_groups(range(len(rows))):
            placed = _Placed(self, [rows[k] for k in some], [indices[k] for k in some], train)
            for n, row in enumerate(placed.rows):
                found.append(
                    Answer(
                        train,
                        placed.indices[n],
                        SEARCHED if self.found.searched[row] else HOT,
                        dict(zip(names, every[row].tolist(), strict=True)),
                        partial(placed.answer, n),
                        partial(_record, self.machine, self.found, row),
                        bool(self.small[row]),
                    )
                )
        return found

    def to_least_norm(self, rows: Sequence[int]) -> None:
        """Move answers with open displacements to least norm."""
        loose = [r for r in rows if r not in self._placed and not self.found.determined[r]]
        if loose:
            least_places(self.machine, self.situations, self.found, loose, self.tolerance)
            self._placed.update(loose)

    def ranges(self, row: int) -> Mapping[str, Range]:
        """Return least and largest values of what the forces of an answer leave undetermined."""
        if self.found.determined[row]:
            return {}
        return open_ranges(self.machine, self.situations, self.found, row)


@dataclass(eq=False)
class _Placed:
    """Answers of one train, put at their places of least norm and certified together.

    Attributes
    ----------
    solved : HotAnswers
    rows, indices : list of int
        Numbers among the solved answers, and positions.
    train : Train
    """

    solved: HotAnswers
    rows: list[int]
    indices: list[int]
    train: Train

    def answer(self, n: int) -> tuple[Equilibrium, Certificate]:
        """Return an answer at its place of least norm, and its certificate."""
        return self._every[n]

    @cached_property
    def _every(self) -> list[tuple[Equilibrium, Certificate]]:
        solved, train = self.solved, self.train
        solved.to_least_norm(self.rows)
        found = solved.found
        placed = [
            replace(found.equilibria.one(row, index), undetermined=solved.ranges(row))
            for row, index in zip(self.rows, self.indices, strict=True)
        ]
        rows = np.array(self.rows)
        open_ = [answer.undetermined for answer in placed]
        claims = Claims(
            train, solved.machine.judge, self.indices, found.equilibria.take(rows), open_
        )
        proved = found.verdicts.bounds.relative[rows].tolist()
        return list(zip(placed, certified(claims, solved.tolerance, proved), strict=True))


def hot_answers(
    machine: Machine,
    indices: Sequence[int],
    tolerance: float,
    engine: str = "auto",
) -> dict[int, Answer]:
    """Return the answers that the fast method finds, by position."""
    situations = machine.situations(indices)
    found = machine.answer(situations, tolerance, available_engine(engine, len(indices)))
    solved = HotAnswers(machine, situations, found, tolerance)
    passed = np.flatnonzero(found.passed).tolist()
    wanted = [indices[r] for r in passed]
    return dict(zip(wanted, solved.answers(passed, wanted, machine.train), strict=True))


def _record(machine: Machine, found: Answers, row: int) -> Record:
    """Return the record of an answer of the fast method."""
    structure, states = machine.structure, found.states[row]
    basis = structure.basis(states)
    acting = states[: structure.rows] != 0
    rows = {
        name: Role.IN_PLAY if acts else Role.OPEN
        for name, acts in zip(structure.row_names, acting, strict=True)
    }
    radials = {
        r.name: Role.IN_PLAY if place else Role.OPEN
        for r, place in zip(structure.radials, states[structure.rows :], strict=True)
    }
    redundants = basis.redundant.shape[1]
    return Record(
        solver=HOT,
        method="force",
        kind=f"force method, {counted(redundants, 'redundant')}",
        iterations=(),
        plan=Plan(rows, radials),
        rounds=int(found.turns[row]),
        removed=structure.removed,
        coordinates=structure.coordinates.names,
    )


def left_out(answer: Answer) -> tuple[tuple[str, str], ...]:
    """Return what did not act in an answer of the fast method, and figures to show it."""
    scene, found = answer.scene, answer.equilibrium
    plan = answer.record.plan
    x = coordinates_of(scene, found)
    idle = [
        (row.name, f"open by {(row.gap - float(row.vector @ x)) * 1e6:.4g} µm")
        for row in scene.rows_at(x)
        if plan.rows[row.name] is Role.OPEN
    ]
    idle += [
        (r.name, f"moves freely, {r.radius(x) * 1e6:.4g} µm out")
        for r in scene.radials
        if plan.radials[r.name] is Role.OPEN
    ]
    return scene.removed + tuple(idle)
