r"""Figures shared by claims in which the same elements act.

With r the largest residual of balance, q the norm of :math:`L^T \epsilon` and w the rounding of
lengths, the bound of `quick` is

.. math:: \lvert \Delta F_e \rvert \le \kappa_e\, r + \lVert L_e \rVert (q + \lambda\, r + \mu\, w).

A radial element is two columns here, each as stiff as its graph is anywhere: laws are monotone, so
the piece on which it is in the exact equilibrium need not be known. Source: formulation, section
16.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from loadshare.array_types import Array, Flags, Numbers
from loadshare.certify.bound.acts import CLOSED, OPEN, Acts
from loadshare.certify.bound.claim import EPS
from loadshare.certify.bound.columns import Columns
from loadshare.certify.bound.figures import ClaimFigures, Sets, Workspace
from loadshare.certify.bound.layout import layout_of
from loadshare.certify.bound.statics import Statics, force_at_end, held_moves
from loadshare.settings import BOUND


class Groups(NamedTuple):
    """Figures shared by claims in which the same elements act, for G sets of elements.

    Rows of L (rows): contacts, springs, both columns of every radial element; 0 for idle elements.
    """

    known: Flags  # (G,): whether the bound covers the set: no rigid parts share by themselves
    carries: Flags  # (G,): whether radial elements take part in carrying a load
    root: Array  # (G, …, rows): L, transposed
    ended: Array  # (G,): force of an element that ends a move, per load; 0 without free moves
    moves: Array  # (G, …, n)
    held: Array  # (G, …, n): moves that only light contacts hold, per force of these
    spread: Array  # (G,): sum of the lengths of the rows of L
    spread_of_arcs: Array  # (G,): of arcs alone
    into: Array  # (G,): energy per load, and per push across the lines of arcs
    into_by_push: Array
    bows: Array  # (G,): one over the shortest distance of arcs that act [1/m]
    widest: Array  # (G,): largest movement of an element per coordinate
    by: Array  # (G, 6, 4): largest figures per load, push, energy and gap
    pull_by: Array  # (G, q, 4): radial forces per load, push and energy; movements per length
    part: Array  # (G, q, 2, n): P of the radial elements
    moment_by: Array  # (G, k, 3): torque over splines per load, push and energy
    gain: Array  # (G, k, k): of that torque per push along a spline's offset
    pushed: Array  # (G, q, k): force of a radial element per such push
    particular: Array  # (G, rows, n): P
    passed: Array  # (G, rows): force of every row per load
    size: Array  # (G, rows): length of every row of L
    softest: Array  # (G, rows): compliance that no claim exceeds; 0 of radial elements [m/N]


class Operators(NamedTuple):
    """Statics of a set of elements, without rows of idle elements."""

    particular: Array  # P
    redundant: Array  # N
    moves: Array
    ended: float  # force of an element that ends a move, per load; 0 without free moves
    held: Array  # moves that only light contacts hold, per force of these
    is_covered: bool  # whether balance determines these forces


class SharedData:
    """The data that all batches of a train share.

    Parameters
    ----------
    columns : Columns
    spring, spring_arm : ndarray
        As in `Layout`.
    pushed : bool
        Whether forces act on gears from outside.
    """

    def __init__(self, columns: Columns, spring: Numbers, spring_arm: Array, pushed: bool) -> None:
        self.layout = of = layout_of(columns, spring, spring_arm, pushed)
        self.key = spring.tobytes(), pushed
        self.over_meshes = columns.over_meshes
        self.varying = len(columns.constants)
        matrix, first = columns.matrix.high, columns.arcs.start
        arcs = [
            -(way / size) @ matrix[first + 2 * k : first + 2 * k + 2]
            for k, (way, size) in enumerate(zip(of.nominal, of.apart, strict=True))
        ]
        width = matrix.shape[1]
        self.contacts = np.concatenate([matrix[columns.contacts], np.reshape(arcs, (-1, width))])
        pairs = matrix[columns.arcs].reshape(-1, 2, width)
        self.across = np.abs(pairs).sum(axis=1)
        self.springs = matrix[of.spring[:, 0]]
        self.pulls = matrix[columns.radials].reshape(-1, 2, width)
        self._statics: dict[bytes, Operators] = {}
        # For batches with one set, such as cases that differ in loads and errors only.
        self._single: dict[tuple[bytes, ...], Groups] = {}

    @property
    def _rows(self) -> int:
        """Number of rows of L."""
        return len(self.contacts) + len(self.springs) + 2 * len(self.pulls)

    def _force_at_end(self, moves: Array) -> float:
        """Return the force of an element that ends one of some moves, per load; at least 1."""
        return force_at_end(moves, self.contacts, self.pulls)

    def work(self) -> Workspace:
        """Return an empty workspace."""
        of, m, n = self.layout, len(self.layout.start) - 1, self.contacts.shape[1]
        arcs, pulls, flanks, gears = len(of.apart), len(self.pulls), len(of.arm), len(of.radius)
        contacts, shafts = len(self.contacts), len(of.shaft)
        rows = [gears, 3 * gears, gears, shafts, 2 * gears, n, self.varying, 3 * gears]
        rows += [m, flanks, flanks, m, 2 * pulls, n, n, n, contacts, contacts, contacts, self._rows]
        sizes: list[tuple[int, ...]] = [*((k,) for k in rows), (arcs, 2), (arcs,), (4,), (pulls,)]
        sizes += [(pulls, 6), (pulls, 2), (pulls, 3)]
        sizes += [()] * (len(Workspace._fields) - len(sizes))
        return Workspace(*(np.zeros((*size, BOUND.side_by_side)) for size in sizes))

    def found(self, count: int) -> ClaimFigures:
        """Return space for the figures of `count` claims."""
        pulls, n = len(self.pulls), self.contacts.shape[1]
        rows, number = (self._rows, n, pulls, pulls), np.empty(count, dtype=np.intp)
        acts = np.empty((count, len(self.contacts) + pulls), dtype=np.int8)
        sizes = [
            *((count, k) for k in rows),
            (count, pulls, 2),
            *[(count, pulls)] * 2,
            *[(count,)] * 15,
        ]
        return ClaimFigures._make([number, acts, *map(np.empty, sizes)])

    def sets(self, count: int) -> Sets:
        """Return space for the sets of elements of `count` claims."""
        most = min(count, BOUND.sets_distinguished)
        size = most, len(self.contacts) + len(self.springs) + len(self.pulls)
        first, key = np.empty(most, dtype=np.intp), np.empty(most, dtype=np.uint64)
        return Sets(first, key, np.full(size, np.inf), np.zeros(size))

    def _known(self, acts: Acts) -> Operators:
        """Return the statics of the acting elements.

        Radial elements carry a load only where nothing else does; elements that yield without limit
        carry none.
        """
        found = self._statics.get(acts.tobytes())
        if found is not None:
            return found
        contacts, radials = np.split(acts, [len(self.contacts)])
        found = self._operators(contacts, radials)
        if not found.is_covered:
            # Light radial elements that yield in proportion may carry after all.
            found = self._operators(contacts, np.minimum(radials, CLOSED))
        if len(self._statics) >= BOUND.sets:
            self._statics.clear()
        self._statics[acts.tobytes()] = found
        return found

    def _operators(self, contacts: Acts, radials: Acts) -> Operators:
        """Compute the statics of contacts and radial elements."""
        pulls = self.pulls[radials != OPEN].reshape(-1, self.springs.shape[1])
        closed = self.contacts[contacts != OPEN]
        whole = Statics.of(np.concatenate([closed, self.springs, pulls]))
        classes = np.full(len(whole.directions), CLOSED)
        first = len(classes) - len(pulls)
        classes[: len(closed)] = contacts[contacts != OPEN]
        classes[first:] = np.repeat(radials[radials != OPEN], 2)
        lasting = classes == CLOSED
        carrying = whole if lasting.all() else Statics.of(whole.directions[lasting])
        # A light element may open, and then move by any length: it carries no load, but may hold
        # what nothing else holds, where balance alone determines its force.
        others = whole.directions[~lasting]
        borne, shared = held_moves(carrying.moves, others, self._force_at_end)
        particular = np.zeros(whole.particular.shape)
        particular[lasting] = carrying.particular
        if lasting[first:].any():
            firm, last = (k + np.flatnonzero(lasting[k:n]) for k, n in ((0, first), (first, None)))
            some, known = whole.directions[last], Statics.of(whole.directions[firm])
            held = some @ known.moves
            held[np.abs(held) < BOUND.rank] = 0.0
            part = np.linalg.pinv(held.T, rcond=BOUND.rank) @ known.moves.T
            particular[firm] = known.particular @ (np.eye(len(part.T)) - some.T @ part)
            particular[last] = part
        moves = whole.moves
        ended = self._force_at_end(moves) if moves.size else 0.0
        return Operators(particular, whole.redundant, moves, ended, borne, not shared.size)

    def groups(self, acts: Acts, least: Array, most: Array) -> Groups:
        """Return the figures shared by the claims of each set.

        Parameters
        ----------
        acts : ndarray of int8, shape (G, c + q)
        least, most : ndarray, shape (G, c + springs + q)
            Smallest and largest compliance of contacts, springs and radial elements [m/N].
        """
        key = tuple(each.tobytes() for each in (acts, least, most)) if len(acts) == 1 else ()
        # Another thread may be clearing the dictionary.
        if (known_one := self._single.get(key)) is not None:
            return known_one
        count, n, rows = len(acts), self.contacts.shape[1], self._rows
        pulls, splines = len(self.pulls), len(self.layout.moment)
        known = [self._known(each) for each in acts]
        self_stresses = max((k.redundant.shape[1] for k in known), default=0)
        moves = max((k.moves.shape[1] for k in known), default=0)
        held = max((k.held.shape[1] for k in known), default=0)
        sizes = (
            (self_stresses, rows),
            (),
            (moves, n),
            (held, n),
            *[()] * 6,
            (6, 4),
            (pulls, 4),
            (pulls, 2, n),
            (splines, 3),
            (splines, splines),
            (pulls, splines),
            (rows, n),
            *[(rows,)] * 3,
        )
        found = Groups._make(
            [*np.zeros((2, count), bool), *(np.zeros((count, *size)) for size in sizes)]
        )
        for at in range(0, count, BOUND.sets_together):
            some = slice(at, at + BOUND.sets_together)
            part = Groups._make(array[some] for array in found)
            self._put(part, acts[some], known[some], least[some], most[some])
        if count == 1:
            if len(self._single) >= BOUND.sets_together:
                self._single.clear()
            self._single[key] = found
        return found

    def _both(self, figures: Array) -> Array:
        """Return the figures of the elements, those of radial ones twice."""
        first = figures.shape[1] - len(self.pulls)
        return np.append(figures[:, :first], np.repeat(figures[:, first:], 2, axis=1), axis=1)

    def _put(
        self, found: Groups, acts: Acts, every: list[Operators], least: Array, most: Array
    ) -> None:
        """Write the figures of some sets."""
        springs = np.ones((len(acts), len(self.springs)))
        contacts = acts[:, : len(self.contacts)]
        on = self._both(np.concatenate([contacts, springs, acts[:, contacts.shape[1] :]], axis=1))
        on = on != OPEN
        redundant = np.zeros((len(acts), self._rows, found.root.shape[1]))
        for g, operators in enumerate(every):
            found.particular[g, on[g]] = operators.particular
            redundant[g, on[g], : operators.redundant.shape[1]] = operators.redundant
            found.moves[g, : operators.moves.shape[1]] = operators.moves.T
            found.held[g, : operators.held.shape[1]] = operators.held.T
            found.ended[g], found.known[g] = operators.ended, operators.is_covered
        soft, softest = (np.where(on, self._both(figures), 0.0) for figures in (least, most))
        found.known[:] &= np.isfinite(soft + softest).all(axis=1)
        self._put_roots(found, redundant, soft)
        known = found.known[:, None]
        self._put_figures(found, acts, np.where(known, softest / BOUND.secant, 0.0))

    def _put_roots(self, found: Groups, redundant: Array, soft: Array) -> None:
        """Write L, from the smallest compliances; exclude sets whose rigid parts share alone."""
        soft = np.where(found.known[:, None], BOUND.secant * soft, 1.0)
        stiff = redundant.transpose(0, 2, 1) @ (soft[:, :, None] * redundant)
        # Columns that only pad are as soft as the softest, so as not to count among the stiffest.
        filling = np.abs(redundant).max(axis=1, initial=0.0) == 0.0
        diagonal = np.einsum("gii->gi", stiff)
        largest = diagonal.max(axis=1, initial=0.0)
        largest[filling.all(axis=1)] = 1.0
        diagonal[filling] = np.broadcast_to(largest[:, None], filling.shape)[filling]
        values, vectors = np.linalg.eigh(stiff)
        smallest = values.min(axis=1, initial=np.inf)
        found.known[:] &= smallest > BOUND.singular * values.max(axis=1, initial=0.0)
        values[~found.known] = 1.0
        root = redundant @ (vectors / np.sqrt(values)[:, None, :])
        found.root[:] = root.transpose(0, 2, 1)

    def _put_figures(self, found: Groups, acts: Acts, soft: Array) -> None:
        """Write sizes of forces and movements, from the largest compliances."""
        of, contacts = self.layout, len(self.contacts)
        flanks, pulls, arcs = len(of.arm), self._rows - 2 * len(self.pulls), len(of.apart)
        passes, sizes = np.abs(found.particular), np.sqrt((found.root**2).sum(axis=1))
        # The compliance of radial elements is given by every claim itself.
        soft[:, pulls:] = 0.0
        some = acts[:, contacts - arcs : contacts] != OPEN
        across = np.tensordot(some, self.across, 1)
        figures = np.stack(
            [passes.sum(axis=2), (passes @ across[:, :, None])[:, :, 0], sizes], axis=1
        )
        idle = acts[:, contacts:, None, None] == OPEN
        away = np.where(idle, np.abs(self.pulls), 0.0).sum(axis=2)
        turning = np.where(some[:, :, None], self.across, 0.0)
        still = np.broadcast_to(np.abs(self.contacts), (len(acts), *self.contacts.shape))
        rows = np.concatenate([still, away, turning], axis=1)
        ways = rows @ passes.transpose(0, 2, 1)
        by_way = np.append(
            ways @ (soft[:, None, :] * figures).transpose(0, 2, 1),
            ways.sum(axis=2)[:, :, None],
            axis=2,
        )
        arms = of.arm * (1.0 + EPS)
        pushing = np.where(some[:, None], figures[:, :, contacts - arcs : contacts], 0.0)
        by = found.by
        by[:, 0, :3], by[:, 2, :3] = (
            figures.max(axis=2),
            self.over_meshes(figures[:, :, :flanks] * arms).max(axis=2, initial=0.0),
        )
        by[:, 3, :3] = pushing.max(axis=2, initial=0.0)
        light = np.insert(1.0 * (acts > CLOSED), [contacts] * len(self.springs), 0.0, axis=1)
        by[:, 5, :3] = (self._both(light)[:, None] * figures).max(axis=2, initial=0.0)
        by[:, 1] = by_way.max(axis=1, initial=0.0)
        by[:, 4] = by_way[:, by_way.shape[1] - arcs :].max(axis=1, initial=0.0)
        found.spread[:], found.spread_of_arcs[:] = sizes.sum(axis=1), pushing[:, 2].sum(axis=1)
        weighed = (figures @ (soft * sizes)[:, :, None])[:, :, 0]
        found.into[:], found.into_by_push[:] = weighed[:, 0], weighed[:, 1]
        found.bows[:] = np.where(some, 1.0 / of.apart, 0.0).max(axis=1, initial=0.0)
        found.widest[:] = rows.max(axis=(1, 2), initial=0.0)
        found.passed[:], found.size[:], found.softest[:] = figures[:, 0], sizes, soft
        self._put_pulls(found, figures, passes, ways, soft * sizes)

    def _put_pulls(
        self, found: Groups, figures: Array, passes: Array, ways: Array, weights: Array
    ) -> None:
        """Write the figures of radial elements and of torques over splines."""
        of, first, count = self.layout, self._rows - 2 * len(self.pulls), len(figures)
        pairs = (count, len(self.pulls), 2)
        found.pull_by[:, :, :3] = (
            figures[:, :, first:].reshape(count, 3, *pairs[1:]).sum(axis=3).transpose(0, 2, 1)
        )
        found.pull_by[:, :, 3] = ways[:, :, first:].max(axis=1, initial=0.0).reshape(pairs).sum(2)
        found.part[:] = found.particular[:, first:].reshape(found.part.shape)
        found.carries[:] = found.pull_by[:, :, 0].any(axis=1)
        moments = np.abs(of.moment)
        pushed = passes @ np.abs(self.pulls[of.rounds :]).sum(axis=1).T
        gain = pushed + found.size[:, :, None] * (weights[:, None, :] @ pushed)
        flanks = moments.shape[1]
        found.moment_by[:] = moments @ figures[:, :, :flanks].transpose(0, 2, 1)
        found.gain[:] = moments @ gain[:, :flanks]
        found.pushed[:] = pushed[:, first:].reshape(*pairs, len(moments)).sum(axis=2)
