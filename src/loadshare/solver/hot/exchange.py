"""Exchange of elements, from set to set, until every sample is consistent.

All samples take each turn together, those on the same set side by side.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise, permutations

import numpy as np

from loadshare.array_types import Array, Flags, Numbers, States
from loadshare.scene.loading import Loading
from loadshare.scene.structure import Structure
from loadshare.settings import EXCHANGE
from loadshare.solver.hot import contact_states as at
from loadshare.solver.hot.elements import pick
from loadshare.solver.hot.iterate import Iterate

Engine = Callable[
    [Structure, Loading, States, Sequence[Numbers], Iterate, Flags],
    tuple[States, States],
]

WORD = 8
"""Bytes of a word."""
_KEYS = np.random.default_rng(11).integers(1 << 62, size=1 << 12) | 1


@dataclass(frozen=True, slots=True, eq=False)
class ExchangeResult:
    """Result of the fast method.

    Attributes
    ----------
    solved : ndarray of bool, shape (S,)
        Samples with a consistent set.
    states : ndarray of int8, shape (S, switches)
        The sets.
    turns : ndarray of int, shape (S,)
        Sets that each sample visited.
    held : ndarray of bool, shape (S,)
        Whether the set leaves no coordinate loose.
    """

    solved: Flags
    states: States
    turns: Numbers
    held: Flags

    def take(self, rows: Numbers) -> ExchangeResult:
        """Return the result of some samples."""
        return ExchangeResult(
            self.solved[rows], self.states[rows], self.turns[rows], self.held[rows]
        )

    def put(self, rows: Numbers, other: ExchangeResult) -> None:
        """Replace some samples by those of another result, in its order; turns are added up."""
        self.solved[rows] = other.solved
        self.states[rows] = other.states
        self.held[rows] = other.held
        self.turns[rows] += other.turns


def first_sets(structure: Structure, loading: Loading) -> States:
    """Return sets with drive flanks closed under load, radial elements on their first piece."""
    count = loading.count
    if structure.radials and count > 1 and _begin_alike(loading):
        return np.repeat(first_sets(structure, loading.one(0)), count, axis=0)
    states = np.zeros((count, structure.switches), dtype=np.int8)
    everyone = np.arange(count)
    push = pick(loading.push, everyone)
    kinds = structure.kinds[structure.columns.flanks]
    drives = [k for k, kind in enumerate(kinds) if kind == "drive flank"]
    states[:, drives] = np.where(push > 0.0, at.CLOSED, at.OPEN)[:, None]
    for j, radial in enumerate(structure.radials):
        gear = structure.train.gears[radial.gear]
        driving = structure.train.gears[structure.train.input]
        torque = np.broadcast_to(push * driving.base_radius / (abs(gear.ratio) or 1.0), (count,))
        law = at.graph(pick(loading.radial, everyone)[:, j], torque)
        rigid = np.isinf(law.last) & (law.reach == 0.0)
        free = (law.bound == 0.0) & (law.stick == 0.0)
        resting = np.where(law.reach > 0.0, at.OPEN, np.where(rigid, at.PINNED, at.STOP))
        held = np.where(law.stick > 0.0, at.STICK, at.PINNED)
        states[:, structure.rows + j] = np.where(free, resting, held)
    _relieve(structure, loading, states)
    return states


def _begin_alike(loading: Loading) -> bool:
    """Return whether all samples begin with the same set: signs, zeros and infinities agree."""
    numbers = loading.radial.reshape(len(loading.radial), -1), loading.push[:, None]
    tests = np.isnan, np.isinf, lambda n: n > 0.0, lambda n: n < 0.0
    return all(bool((found == found[:1]).all()) for n in numbers for found in (t(n) for t in tests))


def _relieve(structure: Structure, loading: Loading, states: States) -> None:
    """Let only a rigid ring without play hold a gear that a spline would pin in the same place.

    How the two share the force is undetermined; a spline that carries nothing is one answer.
    """
    radials = structure.radials
    for (i, spline), (j, ring) in permutations(enumerate(radials), 2):
        if spline.gear != ring.gear or ring.kind != "ring":
            continue
        centres = [loading.gap[:, c : c + 2] for c in map(structure.radial_column, (i, j))]
        together = (centres[0] == centres[1]).all(axis=1)
        pinned = (states[:, structure.rows + np.array([i, j])] == at.PINNED).all(axis=1)
        states[pinned & together, structure.rows + i] = at.OPEN


def exchange(
    structure: Structure,
    loading: Loading,
    iterate: Iterate,
    engine: Engine,
    states: States | None = None,
    singly: bool = False,
    limit: int | None = None,
) -> ExchangeResult:
    """Find a consistent set for every sample.

    Parameters
    ----------
    structure : Structure
    loading : Loading
    iterate : Iterate
        The start; updated in place.
    engine : Engine
        `vectorised.settle` or `compiled.settle`.
    states : ndarray of int8, shape (S, switches), optional
        Sets to begin with.
    singly : bool
        Exchange one element at a time from the beginning.
    limit : int, optional
        Sets that a sample visits at most.

    Returns
    -------
    ExchangeResult
        Samples that ran into a cycle, a mechanism or a law without meaning are not solved.
    """
    given = first_sets(structure, loading) if states is None else states
    count, switches = given.shape
    # Rows of whole words, so that sets can be compared word by word.
    states = np.zeros((count, -(-max(switches, 1) // WORD) * WORD), dtype=np.int8)
    states[:, :switches] = given
    solved = np.zeros(count, dtype=bool)
    turns = np.zeros(count, dtype=np.intp)
    held = np.zeros(count, dtype=bool)
    one_only = np.full(count, singly)
    limit = limit or EXCHANGE.turns
    rounds = _Rounds(structure)
    rows = np.arange(count)
    turn = 0
    while len(rows):
        turn += 1
        order, starts = _alike(states[rows])
        rows = rows[order]
        sets = np.ascontiguousarray(states[rows[starts[:-1]], :switches])
        parts = [rows[a:b] for a, b in pairwise(starts)]
        verdict, proposal = engine(structure, loading, sets, parts, iterate, one_only)
        turns[rows] += 1
        onward = verdict == at.OTHER
        if turn >= limit:
            onward[:] = False
        if singly or turn > EXCHANGE.together:
            for k in onward.nonzero()[0].tolist():
                here, force = states[rows[k], :switches], iterate.force[rows[k]]
                verdict[k] = rounds.judged(int(rows[k]), here, proposal[k], force)
                onward[k] = verdict[k] == at.OTHER
        done = verdict == at.DONE
        solved[rows[done]] = True
        tight = [not structure.basis(one).loose.shape[1] for one in sets]
        held[rows] = done & np.repeat(tight, [len(part) for part in parts])
        if not onward.any():
            break
        rows, here, other = rows[onward], states[rows[onward], :switches], proposal[onward]
        if turn >= EXCHANGE.together:
            one_only[rows] = True
        _without_wedges(structure, loading, here, other)
        states[rows, :switches] = other
    return ExchangeResult(solved, states[:, :switches], turns, held)


def _alike(states: States) -> tuple[Numbers, list[int]]:
    """Return an order that groups equal sets, given in whole words, and where each group begins.

    If two sets share a key, a sample is solved on the other set, and its result is judged on that
    set.
    """
    keys = states.view(np.int64) @ _KEYS[: states.shape[1] // WORD]
    order = keys.argsort(kind="stable")
    keys = keys[order]
    ends = (keys[1:] != keys[:-1]).nonzero()[0] + 1
    return order, [0, *ends.tolist(), len(keys)]


class _Rounds:
    """Sets that each sample has visited, so that cycles are noticed early.

    If a sample alternates between two sets that differ only in elements that carry nothing (a
    contact on the verge, a gear that no load holds against its ring), forces cannot decide: the
    larger set is taken, and the certificate decides whether it is right.
    """

    def __init__(self, structure: Structure) -> None:
        self.structure = structure
        self._visits: dict[int, list[bytes]] = {}

    def judged(self, row: int, here: States, proposal: States, force: Array) -> int:
        """Return DONE, OTHER or FAILED for a sample that is to go from one set to another."""
        visits = self._visits.setdefault(row, [])
        visits.append(here.tobytes())
        if visits.count(visits[-1]) < EXCHANGE.returns:
            return at.OTHER
        to_and_fro = visits[-4:-3] == visits[-2:-1] == [proposal.tobytes()]
        if not to_and_fro:
            return at.FAILED
        if np.count_nonzero(here) < np.count_nonzero(proposal):
            return at.OTHER
        return at.DONE if self._is_idle(here, proposal, force) else at.FAILED

    def _is_idle(self, here: States, proposal: States, force: Array) -> bool:
        """Return whether all elements that differ act here, not in the proposal, without force."""
        rows, columns = self.structure.rows, self.structure.columns
        differ = here != proposal
        if proposal[differ].any():
            return False
        size = np.abs(force)
        radial = size[columns.radials].reshape(-1, 2)[differ[rows:]]
        found = np.append(size[columns.contacts][differ[:rows]], radial)
        return bool((found <= EXCHANGE.nothing * size.max()).all())


def _without_wedges(structure: Structure, loading: Loading, here: States, proposal: States) -> None:
    """Propose only one of two opposed rigid arcs, the new one, unless both act here."""
    if not structure.opposed:
        return
    pairs = np.array(structure.opposed)
    pairs = pairs[~loading.bending[:, structure.springs + pairs].any(axis=(0, 2))]
    acts = here[:, pairs] != at.OPEN
    both = (proposal[:, pairs] != at.OPEN).all(axis=2) & ~acts.all(axis=2)
    rows, which = both.nonzero()
    proposal[rows, np.where(acts[rows, which, 0], *pairs[which].T)] = at.OPEN
