"""Solve one block of samples: all by the fast method, and those that it leaves on the ladder."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from loadshare.array_types import Array, Flags, Numbers, States
from loadshare.certify.nonconvex import arc_curvature, is_convex
from loadshare.errors import CaseError, Refused
from loadshare.job.answer import Answer
from loadshare.job.hot import HOT, SEARCHED
from loadshare.job.ladder import climb, rungs
from loadshare.job.least import least_places
from loadshare.job.machine import Answers, Machine
from loadshare.settings import JOB
from loadshare.solver import Options
from loadshare.solver.hot.exchange import Engine
from loadshare.train.equilibria import Equilibria
from loadshare.train.samples import Samples
from loadshare.train.situations import Situations

RUNGS = ("none", HOT, SEARCHED, *(name for name, _ in rungs(Options())))
"""Rungs that answer samples, by number: none, the fast method without and with the proximal search,
the rungs of the ladder below."""


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """Answers of up to `JOB.block` samples at all requested positions.

    Attributes
    ----------
    rows : ndarray of int, shape (S,)
        Numbers of the samples.
    positions : tuple of int
    equilibria : tuple of Equilibria
        One per position.
    certified : ndarray of bool, shape (S, positions)
    residual : ndarray, shape (S, positions)
        Largest scaled residual; NaN without an answer.
    torque_bound : ndarray, shape (S, positions)
        Largest distance of a torque from the exact one, over the largest torque; NaN likewise.
    determined : ndarray of bool, shape (S, positions)
        Whether the equilibrium determines every displacement.
    displaced : ndarray, shape (S, positions)
        Displacements over the limit of a warning (see `Measuring.worst`); NaN without an answer.
    convex : ndarray of bool, shape (S, positions)
        Whether no nonconvex element carries a force, so that the answer is the only one.
    arc_curvature : ndarray, shape (S, positions)
        Stiffness that arcs take away across them [N/m]; NaN without an answer.
    rung : ndarray of int8, shape (S, positions)
        Number in `RUNGS` of the rung that answered.
    message : dict of (row, position) to str
        Why there is no answer; the position is not repeated in the text.
    """

    rows: Numbers
    positions: tuple[int, ...]
    equilibria: tuple[Equilibria, ...]
    certified: Flags
    residual: Array
    torque_bound: Array
    determined: Flags
    displaced: Array
    convex: Flags
    arc_curvature: Array
    rung: States
    message: dict[tuple[int, int], str]

    def over(self, positions: tuple[int, ...]) -> Block:
        """Return the block over other positions, without an answer at those that it lacks."""
        lacking = np.array([k not in self.positions for k in positions])
        at = [self.positions.index(k) if k in self.positions else 0 for k in positions]
        arrays = {name: getattr(self, name)[:, at] for name in UNANSWERED}
        for name, nothing in UNANSWERED.items():
            arrays[name][:, lacking] = nothing
        none = self.equilibria[0].mapped(lambda array: np.full_like(array, np.nan))
        lacks = zip(lacking.tolist(), at, strict=True)
        message = dict(self.message)
        for k in positions:
            if k not in self.positions:
                message |= {(row, k): NONE for row in self.rows.tolist()}
        return replace(
            self,
            positions=positions,
            equilibria=tuple(none if lacks_it else self.equilibria[p] for lacks_it, p in lacks),
            message=message,
            **arrays,
        )


NONE = "the sample has no such position"
UNANSWERED = {
    **dict.fromkeys(("certified", "determined", "convex"), False),
    **dict.fromkeys(("residual", "torque_bound", "displaced", "arc_curvature"), np.nan),
    "rung": np.int8(0),
}
"""Values in the arrays of a block where there is no answer."""


class _Chunk(NamedTuple):
    """Positions of a block that are solved together, one after another.

    Attributes
    ----------
    columns : slice
        Its positions in arrays over (sample, position).
    machine : Machine
    situations : Situations
        P·S of them.
    equilibria : Equilibria
        Likewise.
    """

    columns: slice
    machine: Machine
    situations: Situations
    equilibria: Equilibria

    def of(self, values: Array) -> Array:
        """Return its part of values over (sample, position), one position after another."""
        return values[:, self.columns].T.reshape(-1)


class _Open:
    """A block that is being solved.

    Attributes
    ----------
    block : Block
        Its arrays are filled in.
    load, deflection : ndarray, shape (S, positions)
        Scales of the answers [N], [m].
    equilibria : list of Equilibria
    chunks : list of _Chunk
    """

    def __init__(self, rows: Numbers, positions: tuple[int, ...]) -> None:
        shape = len(rows), len(positions)
        arrays: dict[str, Any] = {name: np.full(shape, v) for name, v in UNANSWERED.items()}
        self.block = Block(rows, positions, (), message={}, **arrays)
        self.deflection, self.load = np.full((2, *shape), np.nan)
        self.equilibria: list[Equilibria] = []
        self.chunks: list[_Chunk] = []

    @property
    def count(self) -> int:
        """S."""
        return len(self.block.rows)

    def by_sample(self, values: NDArray[Any]) -> NDArray[Any]:
        """Return values of a chunk, one position after another, as (sample, position)."""
        return values.reshape(-1, self.count).T

    def put(self, chunk: _Chunk, found: Answers) -> None:
        """Write the answers of the fast method."""
        verdicts, count, block = found.verdicts, self.count, self.block
        for there, values in (
            (block.certified, found.passed),
            (block.determined, found.determined),
            (block.rung, np.where(found.searched, RUNGS.index(SEARCHED), RUNGS.index(HOT))),
            (block.residual, verdicts.worst),
            (block.torque_bound, verdicts.bounds.relative),
            (block.displaced, verdicts.displaced),
            (self.deflection, verdicts.deflection),
            (self.load, verdicts.load),
        ):
            there[:, chunk.columns] = self.by_sample(values)
        self.chunks.append(chunk)
        for start in range(0, len(found.passed), count):
            self.equilibria.append(found.equilibria.take(slice(start, start + count)))

    def answer(self, row: int, p: int, found: Answer) -> None:
        """Write the ladder's answer to a sample at a position."""
        certificate, block, at = found.certificate, self.block, (row, p)
        self.equilibria[p].put(row, found.equilibrium)
        block.certified[at], block.rung[at] = True, RUNGS.index(found.rung)
        block.determined[at], block.displaced[at] = not found.equilibrium.undetermined, np.nan
        block.residual[at], block.torque_bound[at] = certificate.worst, certificate.proved
        self.deflection[at], self.load[at] = certificate.deflection, certificate.load

    def refuse(self, row: int, p: int, why: str) -> None:
        """Record that a sample has no answer at a position."""
        block = self.block
        for name in ("certified", "rung", "residual", "torque_bound", "displaced"):
            getattr(block, name)[row, p] = UNANSWERED[name]
        self.equilibria[p].forget(row)
        position = block.positions[p]
        block.message[int(block.rows[row]), position] = why.removeprefix(f"position {position}: ")


def solve_block(
    machine: Machine,
    rows: Numbers,
    samples: Samples,
    positions: tuple[int, ...],
    tolerance: float,
    engine: Engine,
    least_norm: bool,
) -> Block:
    """Solve one block; samples that the fast method leaves climb the ladder.

    Parameters
    ----------
    machine : Machine
    rows : ndarray of int, shape (S,)
        Numbers of the samples.
    samples : Samples
        S of them.
    positions : tuple of int
    tolerance, engine, least_norm
        As for `solve_blocks`.
    """
    open_ = _Open(rows, positions)
    block = open_.block
    width = 1 if machine.train.is_placed_anew else max(1, machine.together // len(rows))
    for at in range(0, len(positions), width):
        some = positions[at : at + width]
        situations, here = samples.at_positions(some), machine.at(some[0])
        found = here.answer(situations, tolerance, engine, starts=some)
        chunk = _Chunk(slice(at, at + len(some)), here, situations, found.equilibria)
        open_.put(chunk, found)
        if least_norm:
            loose = found.passed & ~found.determined
            least_places(here, situations, found, np.flatnonzero(loose).tolist(), tolerance)
            block.displaced[:, chunk.columns][open_.by_sample(loose)] = np.nan
    for row, p in np.argwhere(~block.certified).tolist():
        try:
            train = samples.train_of_one(row)
            open_.answer(row, p, climb(train, positions[p], Options(), tolerance, JOB.steps))
        except (CaseError, Refused) as refusal:
            open_.refuse(row, p, str(refusal))
    for (row, p), why in _too_far(open_).items():
        open_.refuse(row, p, why)
    for chunk in open_.chunks:
        train, answers = chunk.machine.train, chunk.equilibria
        block.arc_curvature[:, chunk.columns] = open_.by_sample(arc_curvature(train, answers))
        only = is_convex(train, chunk.situations, answers, chunk.of(open_.load))
        block.convex[:, chunk.columns] = open_.by_sample(only)
    block.convex[~block.certified] = False
    return replace(block, equilibria=tuple(open_.equilibria))


def _too_far(open_: _Open) -> dict[tuple[int, int], str]:
    """Complete how far displacements go; return why some of them are refused."""
    refused = dict[tuple[int, int], str]()
    for chunk in open_.chunks:
        measuring, here, found = chunk.machine.measuring, chunk.situations, chunk.equilibria
        displaced, deflection = chunk.of(open_.block.displaced), chunk.of(open_.deflection)
        left = np.flatnonzero(np.isnan(displaced))
        if len(left):
            displaced[left] = measuring.worst(here.take(left), found.take(left), deflection[left])
            open_.block.displaced[:, chunk.columns] = open_.by_sample(displaced)
        large = np.flatnonzero(displaced >= 1.0)
        if len(large):
            some = here.take(large), found.take(large), deflection[large]
            for k, why in measuring.refusals(*some).items():
                p, row = divmod(int(large[k]), open_.count)
                refused[row, chunk.columns.start + p] = why
    return refused
