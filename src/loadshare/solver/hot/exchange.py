"""From set to set until every sample is consistent.

Samples on the same set are solved together. Of all sets the one with most samples goes
first, so that few visits serve many.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from heapq import heappop, heappush
from itertools import pairwise, permutations

import numpy as np
from numpy.typing import NDArray

from loadshare.scene.loading import Loading
from loadshare.scene.scene import Array
from loadshare.scene.statics import Basis
from loadshare.scene.structure import Structure
from loadshare.settings import EXCHANGE
from loadshare.solver.hot import contact_states as at
from loadshare.solver.hot.elements import pick
from loadshare.solver.hot.iterate import Iterate

States = NDArray[np.int8]
Engine = Callable[
    [Structure, Loading, Basis, States, NDArray[np.intp], Iterate, NDArray[np.bool_]],
    tuple[States, States],
]

WORD = 8
"""Bytes of a word."""
_KEYS = np.random.default_rng(11).integers(1 << 62, size=1 << 12) | 1


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """What the hot path found.

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

    solved: NDArray[np.bool_]
    states: States
    turns: NDArray[np.intp]
    held: NDArray[np.bool_]

    def completed(self, other: Found) -> Found:
        """Return what was found here, and elsewhere what the other found."""
        mine = self.solved
        return Found(
            mine | other.solved,
            np.where(mine[:, None], self.states, other.states),
            self.turns + other.turns,
            np.where(mine, self.held, other.held),
        )

    def without(self, rows: NDArray[np.bool_]) -> Found:
        """Return the same with some samples as not solved."""
        return replace(self, solved=self.solved & ~rows)

    def replaced(self, row: int, other: Found) -> Found:
        """Return the same with a sample as the only one of another finding."""
        here = np.arange(len(self.solved)) == row
        return Found(
            self.solved | here,
            np.where(here[:, None], other.states, self.states),
            self.turns + np.where(here, other.turns, 0),
            np.where(here, other.held, self.held),
        )


def first_sets(structure: Structure, loading: Loading) -> States:
    """Drive flanks closed under load, other rows open, radial elements on their first piece."""
    count = loading.count
    states = np.zeros((count, structure.switches), dtype=np.int8)
    everyone = np.arange(count)
    push = pick(loading.push, everyone)
    for k, kind in enumerate(structure.kinds[structure.columns.flanks]):
        if kind == "drive flank":
            states[:, k] = np.where(push > 0.0, at.CLOSED, at.OPEN)
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


def _relieve(structure: Structure, loading: Loading, states: States) -> None:
    """Let a rigid ring without play alone hold a gear that a spline would pin in the same place.

    How the two share the force is open; a spline that carries nothing is one answer.
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
    only: NDArray[np.bool_] | None = None,
    singly: bool = False,
    limit: int | None = None,
) -> Found:
    """Lead every sample to a consistent set.

    Parameters
    ----------
    structure : Structure
    loading : Loading
    iterate : Iterate
        At the start; renewed in place.
    engine : Engine
        `vectorised.settle` or `compiled.settle`.
    states : ndarray of int8, shape (S, switches), optional
        Sets to begin with.
    only : ndarray of bool, shape (S,), optional
        Samples to solve; all by default.
    singly : bool
        Exchange one element at a time from the beginning.
    limit : int, optional
        Sets that a sample visits at most.

    Returns
    -------
    Found
        Samples that ran into a cycle, a mechanism or a law without meaning are not solved.
    """
    given = first_sets(structure, loading) if states is None else states
    count, switches = given.shape
    # Rows of whole words, so that sets can be told apart word by word.
    states = np.zeros((count, -(-max(switches, 1) // WORD) * WORD), dtype=np.int8)
    states[:, :switches] = given
    solved = np.zeros(count, dtype=bool)
    turns = np.zeros(count, dtype=np.intp)
    held = np.zeros(count, dtype=bool)
    one_only = np.full(count, singly)
    limit = limit or EXCHANGE.turns
    rounds = _Rounds(structure)
    waiting = _Waiting()
    rows = np.arange(count) if only is None else np.flatnonzero(only)
    waiting.add(states[rows], rows, 1)
    while waiting:
        here, rows, turn = waiting.most()
        turns[rows] += 1
        basis = structure.basis(here[:switches])
        verdict, proposal = engine(
            structure, loading, basis, here[:switches], rows, iterate, one_only
        )
        onward = verdict == at.OTHER
        if singly or turn >= min(limit, EXCHANGE.together + 1):
            visited = turns[rows]
            onward &= visited < limit
            judged = onward if singly else onward & (visited > EXCHANGE.together)
            for k in judged.nonzero()[0].tolist():
                force = iterate.force[rows[k]]
                verdict[k] = rounds.judged(int(rows[k]), here[:switches], proposal[k], force)
                onward[k] = verdict[k] == at.OTHER
        goes = onward.nonzero()[0]
        if len(goes) < len(rows):
            stays = ~onward
            stay = rows[stays]
            done = verdict[stays] == at.DONE
            states[stay], solved[stay] = here, done
            if not basis.loose.shape[1]:
                held[stay] = done
        if len(goes):
            rows = rows[goes]
            if turn >= EXCHANGE.together:
                one_only[rows] |= turns[rows] >= EXCHANGE.together
            other = np.zeros((len(rows), states.shape[1]), dtype=np.int8)
            other[:, :switches] = proposal[goes]
            waiting.add(_without_wedges(structure, loading, here, other), rows, turn + 1)
    return Found(solved, states[:, :switches], turns, held)


class _Rounds:
    """Sets that single samples went through, so that they do not go around for long.

    To and fro between two sets that differ in what carries nothing, a contact on the verge or a
    gear that no load holds against its ring, is no question of forces: the larger set is taken, and
    the certificate says whether it may.
    """

    def __init__(self, structure: Structure) -> None:
        self.structure = structure
        self._visits: dict[int, list[bytes]] = {}

    def judged(self, row: int, here: States, proposal: States, force: Array) -> int:
        """DONE, OTHER or FAILED for a sample that is to go from one set to another."""
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
        """Whether all that differs acts here, not in the proposal, and carries nothing."""
        rows, columns = self.structure.rows, self.structure.columns
        differ = here != proposal
        if proposal[differ].any():
            return False
        size = np.abs(force)
        radial = size[columns.radials].reshape(-1, 2)[differ[rows:]]
        found = np.append(size[columns.contacts][differ[:rows]], radial)
        return bool((found <= EXCHANGE.nothing * size.max()).all())


class _Waiting:
    """Samples that wait to be solved, by the set that they go to."""

    def __init__(self) -> None:
        self.sets: dict[int, States] = {}
        self.parts: dict[int, list[NDArray[np.intp]]] = {}
        self.sizes: dict[int, int] = {}
        # The turn that this will be for a sample of them, at most.
        self.turns: dict[int, int] = {}
        # Sizes once more, the largest first; one that is out of date is passed over.
        self.largest: list[tuple[int, int]] = []

    def __bool__(self) -> bool:
        return bool(self.sizes)

    def most(self) -> tuple[States, NDArray[np.intp], int]:
        """Take the set to which most samples go, them, and the most turns of any of them."""
        size, key = heappop(self.largest)
        while self.sizes.get(key) != -size:
            size, key = heappop(self.largest)
        del self.sizes[key]
        parts, turn = self.parts.pop(key), self.turns.pop(key)
        return self.sets[key], parts[0] if len(parts) == 1 else np.concatenate(parts), turn

    def add(self, states: States, rows: NDArray[np.intp], turn: int) -> None:
        """Let samples wait for the sets in `states`, shape (len(rows), whole words).

        There they have at most so many turns.
        """
        if not len(rows):
            return
        # Should two sets have one key, a sample is solved on the other one: what it finds there
        # is judged there.
        keys = states.view(np.int64) @ _KEYS[: states.shape[1] // WORD]
        if len(rows) == 1 or (keys == keys[0]).all():
            self._put(int(keys[0]), states[0], rows, turn)
            return
        order = keys.argsort()
        keys, rows = keys[order], rows[order]
        ends = (keys[1:] != keys[:-1]).nonzero()[0] + 1
        for first, end in pairwise([0, *ends.tolist(), len(rows)]):
            self._put(int(keys[first]), states[order[first]], rows[first:end], turn)

    def _put(self, key: int, states: States, rows: NDArray[np.intp], turn: int) -> None:
        self.sets.setdefault(key, states)
        self.parts.setdefault(key, []).append(rows)
        self.turns[key] = max(turn, self.turns.get(key, 0))
        size = self.sizes[key] = self.sizes.get(key, 0) + len(rows)
        heappush(self.largest, (-size, key))


def _without_wedges(
    structure: Structure, loading: Loading, here: States, proposal: States
) -> States:
    """Let only one of two opposed rigid arcs act, the one that is new, unless both act here."""
    for one, other in structure.opposed:
        if not (proposal[:, one] & proposal[:, other]).any():
            continue
        if here[one] != at.OPEN and here[other] != at.OPEN:
            continue
        columns = structure.springs + np.array([one, other])
        both = (proposal[:, one] != at.OPEN) & (proposal[:, other] != at.OPEN)
        if both.any() and not loading.bending[:, columns].any():
            leaves = one if here[one] != at.OPEN else other
            proposal[both, leaves] = at.OPEN
    return proposal
