"""Whether forces determine the displacements of samples, by their sets of carrying elements.

`solver.undetermined` answers the same question for one equilibrium: a contact that is closed
without a force holds nothing, nor does a radial element along its level piece. Each set of holding
elements is evaluated once, for all samples that have it. Source: formulation, section 4.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from loadshare.array_types import Array, Flags, Numbers, States
from loadshare.scene.loading import Loading
from loadshare.scene.statics import unresisted
from loadshare.scene.structure import Structure
from loadshare.settings import PLACES, STATICS
from loadshare.solver.hot import contact_states as at
from loadshare.solver.hot.contact_states import FREE, HELD, LEVEL
from loadshare.solver.hot.elements import arcs_at, arcs_of, pick
from loadshare.solver.hot.iterate import Iterate, pushes


def determined(
    structure: Structure,
    loading: Loading,
    iterate: Iterate,
    states: States,
    held: Flags,
    compiled: bool = False,
) -> Flags:
    """Return whether each sample's forces determine all of its displacements, shape (S,).

    Parameters
    ----------
    structure : Structure
    loading : Loading
    iterate : Iterate
    states : ndarray of int8, shape (S, switches)
        Sets of acting elements.
    held : ndarray of bool, shape (S,)
        Whether these leave no coordinate loose.
    compiled : bool
        Whether to use Numba; the answer is the same.
    """
    least, batch = PLACES.carries * pushes(loading), Batch(structure, loading, iterate)
    if compiled:
        return batch.compiled(states, held, least)
    first, last = structure.springs, structure.columns.contacts.stop
    force = iterate.force[:, first:last]
    carries = np.maximum(least, PLACES.carries * np.abs(force).max(axis=1, initial=0.0))
    idle = ((states[:, : structure.rows] != at.OPEN) & (force <= carries[:, None])).any(axis=1)
    kinds = batch.kinds(carries)
    unlike = (kinds != HELD) & (states[:, structure.rows :] != at.OPEN)
    found = held & ~idle & ~unlike.any(axis=1)
    rest = np.flatnonzero(~found)
    if len(rest):
        carry = iterate.force[rest, first:last] > carries[rest, None]
        for alike, some in alike_of(np.hstack([carry.astype(np.int8), kinds[rest]])):
            found[rest[alike]] = batch.fixed(some, rest[alike])
    return np.asarray(found)


def alike_of(sets: NDArray[Any]) -> Iterator[tuple[Numbers, NDArray[Any]]]:
    """Yield the samples that share a set, and the set."""
    order = np.lexsort(sets.T) if sets.shape[1] else np.arange(len(sets))
    changes = np.flatnonzero((sets[order][1:] != sets[order][:-1]).any(axis=1)) + 1
    for part in np.split(order, changes):
        yield part, sets[part[0]]


class _Moves(NamedTuple):
    """Moves (n, d) that a set of carrying elements leaves open, and the elements that they meet."""

    moves: Array
    level: tuple[int, ...]  # radial elements on a level piece
    flat: Numbers  # columns of flanks and stops that carry nothing
    arcs: tuple[int, ...]
    radials: tuple[int, ...]
    # Whether level pieces leave some move open, whatever their directions.
    some_left: bool
    # Whether all elements that are met could hold every move, if a sample touched all of them.
    may_be_held: bool
    # Elements that are met, if they could: numbers of flanks and stops, then arcs, then radial
    # elements; and the largest number of them with which a sample surely stays undetermined.
    met: tuple[int, ...]
    fewest: int


class _Touched(NamedTuple):
    """Elements that carry nothing and must not close further, in the moves of k samples."""

    flags: Flags  # (k, m): whether a sample touches it
    flat: Array  # (f, d): directions of flanks and stops
    others: list[Array]  # of (k, d): directions of the m − f others

    def directions(self, sample: int) -> Array:
        """Return the directions of the elements that a sample touches."""
        every = np.vstack([self.flat, *(other[sample] for other in self.others)])
        return np.asarray(every[self.flags[sample]])


class Batch(NamedTuple):
    """Samples and their iterate."""

    structure: Structure
    loading: Loading
    iterate: Iterate

    def compiled(self, states: States, held: Flags, least: Array) -> Flags:
        """Do the same with Numba; NumPy decides where touched elements might hold a sample."""
        from loadshare.solver.hot.touching import Touching

        touching = Touching(*self, states, held, least)
        number = touching.number
        left_by = [self.moves(some) for some in touching.sets]
        # Per set, and last for samples without one (−1): whether no move is left, and `fewest`.
        fixed = np.array([*(not of.moves.shape[1] for of in left_by), True])
        few = np.array([*(of.fewest for of in left_by), 0])
        found, rest = (
            fixed[number],
            np.flatnonzero(touching.met([of.met for of in left_by]) > few[number]),
        )
        for alike, (at_set,) in alike_of(number[rest, None]) if len(rest) else ():
            found[rest[alike]] = self.fixed(touching.sets[at_set], rest[alike])
        return np.asarray(found)

    def kinds(self, carries: Array) -> States:
        """Return how every radial element holds, shape (S, radials)."""
        structure, loading, iterate = self
        everyone = np.arange(loading.count)
        kinds = np.empty((loading.count, len(structure.radials)), dtype=np.int8)
        for j in range(kinds.shape[1]):
            law = at.graph(pick(loading.radial, everyone)[:, j], iterate.force @ loading.carried[j])
            column = structure.radial_column(j)
            size = np.hypot(iterate.force[:, column], iterate.force[:, column + 1])
            level = (np.abs(size - law.bound) <= carries) & (law.reach > law.stick)
            kinds[:, j] = np.where(level, np.where(size <= carries, FREE, LEVEL), HELD)
        return kinds

    def moves(self, some: States) -> _Moves:
        """Return the moves that a set of carrying elements leaves open; computed once per set."""
        key = "moves", some.tobytes()
        return cast(_Moves, self.structure.cached(key, partial(self._moves_of, some)))

    def _moves_of(self, some: States) -> _Moves:
        structure, loading, _ = self
        carry, kinds = some[: structure.rows], some[structure.rows :]
        flat, columns, vectors = structure.flat, structure.columns, structure.vectors
        holding = [vectors[columns.springs], vectors[columns.flat][carry[:flat] != 0]]
        holding += [loading.relative[a] for a in np.flatnonzero(carry[flat:])]
        holding += [structure.radials[j].matrix for j in np.flatnonzero(kinds == HELD).tolist()]
        moves = unresisted(np.vstack(holding))

        def meets(matrix: Array) -> bool:
            return bool(np.abs(matrix @ moves).max(initial=0.0) > PLACES.loose)

        def radials(which: Flags) -> tuple[int, ...]:
            return tuple(
                j for j in np.flatnonzero(which).tolist() if meets(structure.radials[j].matrix)
            )

        def leave(parts: list[Array]) -> bool:
            met = np.vstack([np.zeros((1, len(moves))), *parts]) @ moves
            return bool(unresisted(met).shape[1] > 0)

        idle = structure.springs + np.flatnonzero(carry[:flat] == 0)
        idle = idle[np.abs(vectors[idle] @ moves).max(axis=1, initial=0.0) > PLACES.loose]
        level, free = radials(kinds == LEVEL), radials(kinds != HELD)
        arcs = tuple(
            a for a in np.flatnonzero(carry[flat:] == 0).tolist() if meets(loading.relative[a])
        )
        pieces = [structure.radials[j].matrix for j in level]
        limits = [vectors[idle], *(loading.relative[a] for a in arcs)]
        limits += [structure.radials[j].matrix for j in free]
        some_left, may_be_held = leave(pieces), not leave(limits)
        met: list[int] = []
        if may_be_held and moves.shape[1]:
            met += (idle - structure.springs).tolist()
            met += [flat + a for a in arcs]
            met += [structure.rows + j for j in free]
        fewest = moves.shape[1] - len(level) if some_left else -1 if may_be_held else 0
        return _Moves(moves, level, idle, arcs, free, some_left, may_be_held, tuple(met), fewest)

    def fixed(self, some: States, rows: Numbers) -> Flags:
        """Return whether samples of one set of carrying elements are determined, (len(rows),)."""
        left_by = self.moves(some)
        moves, level = left_by.moves, left_by.level
        if not moves.shape[1]:
            return np.ones(len(rows), dtype=bool)
        found = np.zeros(len(rows), dtype=bool)
        if not left_by.may_be_held:
            return found
        touched = self.touched(some, left_by, rows)
        # A move that no level piece could hold is stopped by touched contacts, or by nothing.
        some_touch = touched.flags.any(axis=1)
        these = np.flatnonzero(some_touch) if left_by.some_left else np.arange(len(rows))
        if not len(these):
            return found
        across = np.zeros((len(these), len(level), moves.shape[1]))
        for k, j in enumerate(level):
            across[:, k] = self.across(j, rows[these]) @ moves
        left = moves.shape[1] - (np.linalg.svd(across, compute_uv=False) > STATICS.rank).sum(axis=1)
        found[these] = left == 0
        doubtful = (left > 0) & (touched.flags[these].sum(axis=1) > left)
        for k in np.flatnonzero(doubtful).tolist():
            one_sided = touched.directions(int(these[k]))
            found[these[k]] = _pinched(np.vstack([across[k], -across[k], one_sided]))
        return found

    def touched(self, some: States, left_by: _Moves, rows: Numbers) -> _Touched:
        """Find the elements that samples touch at their displacements."""
        structure, loading, iterate = self
        moves, flat, x = left_by.moves, left_by.flat, iterate.x[rows]
        room = pick(loading.gap, rows)[:, flat] - x @ structure.vectors[flat].T
        touches, directions = [room <= PLACES.play], []

        def add(direction: Array, room: Array) -> None:
            directions.append(direction)
            met = (room <= PLACES.play) & (np.abs(direction).max(axis=1) > PLACES.loose)
            touches.append(met[:, None])

        normals, margins = arcs_at(arcs_of(loading, rows), x)
        for a in left_by.arcs:
            add(-normals[:, a] @ loading.relative[a] @ moves, margins[:, a])
        for j in left_by.radials:
            column, matrix = structure.radial_column(j), structure.radials[j].matrix
            law = at.graph(
                pick(loading.radial, rows)[:, j], iterate.force[rows] @ loading.carried[j]
            )
            offset = x @ matrix.T - pick(loading.gap[:, column : column + 2], rows)
            radius = np.linalg.norm(offset, axis=1)
            outward = offset / np.where(radius > 0.0, radius, 1.0)[:, None] @ matrix @ moves
            add(outward, law.reach - radius)
            if some[structure.rows + j] == LEVEL:
                add(-outward, radius - law.stick)
        return _Touched(
            np.concatenate(touches, axis=1), structure.vectors[flat] @ moves, directions
        )

    def across(self, j: int, rows: Numbers) -> Array:
        """Return the direction (k, n) across the force of a radial element."""
        structure, _, iterate = self
        column = structure.radial_column(j)
        pull = iterate.force[rows, column : column + 2]
        pull = pull / np.linalg.norm(pull, axis=1)[:, None]
        turned = np.stack([-pull[:, 1], pull[:, 0]], axis=1)
        return np.asarray(turned @ structure.radials[j].matrix)


def _pinched(limits: Array) -> bool:
    """Return whether L u ≤ 0 holds only for u = 0: the rows (k, d) of L positively span all."""
    from scipy.optimize import nnls

    if len(limits) <= limits.shape[1] or len(unresisted(limits).T):
        return False
    total = limits.sum(axis=0)
    left = float(nnls(limits.T, -total)[1])
    return bool(left <= PLACES.loose * max(float(np.linalg.norm(total)), 1.0))
