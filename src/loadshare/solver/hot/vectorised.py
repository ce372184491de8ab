"""All samples of one set together, with NumPy."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from loadshare.array_types import Array, Flags, Numbers, States
from loadshare.contact.law import roots
from loadshare.scene.loading import Loading
from loadshare.scene.structure import Structure
from loadshare.settings import HOT
from loadshare.solver.hot import contact_states as at
from loadshare.solver.hot.elements import arc_at, pick, piece
from loadshare.solver.hot.iterate import Iterate
from loadshare.solver.hot.radials import Block, beyond, block, misplaced, until
from loadshare.solver.hot.rest import rest


def settle(
    structure: Structure,
    loading: Loading,
    sets: States,
    parts: Sequence[Numbers],
    iterate: Iterate,
    one_only: Flags,
) -> tuple[States, States]:
    """Solve samples, each on its set, and say what has the wrong sign.

    Parameters
    ----------
    structure : Structure
    loading : Loading
    sets : ndarray of int8, shape (G, switches)
    parts : sequence of ndarray of int
        Samples to solve on each of them, k in all.
    iterate : Iterate
        Where each sample is; renewed in place.
    one_only : ndarray of bool, shape (S,)
        Exchange only one element of these samples.

    Returns
    -------
    verdict : ndarray of int8, shape (k,)
        DONE, OTHER or FAILED.
    proposal : ndarray of int8, shape (k, switches)
        Set to try next.
    """
    with np.errstate(all="ignore"):
        found = [
            _settle_set(_Passes(structure, loading, states, rows, iterate), iterate, one_only[rows])
            for states, rows in zip(sets, parts, strict=True)
        ]
    verdicts, proposals = zip(*found, strict=True)
    return np.concatenate(verdicts), np.concatenate(proposals)


def _settle_set(passes: _Passes, iterate: Iterate, single: Flags) -> tuple[States, States]:
    """Solve samples on one set and say what has the wrong sign."""
    rows, states = passes.rows, passes.states
    drift = passes.drift()
    drifting = (drift != 0.0).any(axis=1)
    passes.run(single | drifting)
    start = iterate.x[rows]
    far = iterate.stays[rows] & (size_of(passes.x - start) > HOT.far * (1.0 + size_of(start)))
    if far.any():
        # What all but nothing resists has run away from where it began.
        drift[far], drifting = (passes.x - start)[far], drifting | far
        passes.x[far] = start[far]
    wrong, moved = passes.wrong(HOT.sign)
    staying = iterate.stays[rows] & wrong.any(axis=1)
    if staying.any():
        wrong, moved = passes.left_in_place(iterate.x[rows], staying, wrong, moved)
    gross = passes.gross.any(axis=1)
    wrong[gross] = passes.gross[gross]
    moved[gross] = passes.gross_to[gross]
    if drifting.any():
        # Only what stops the drift is of interest.
        stopping, other = passes.stopped_by(drift)
        wrong[drifting], moved[drifting] = stopping[drifting], other[drifting]
        passes.settled &= ~drifting
        passes.refused &= ~drifting
    if passes.basis.loose.shape[1]:
        for k in np.flatnonzero(single & passes.settled & wrong.any(axis=1)).tolist():
            wrong[k] &= not passes.rests(k, wrong[k])
    passes.store(iterate)
    first = np.zeros_like(wrong)
    first[np.arange(len(rows)), wrong.argmax(axis=1)] = True
    wrong &= first | ~single[:, None]
    verdict = np.where(passes.settled, at.DONE, at.FAILED)
    verdict[wrong.any(axis=1)] = at.OTHER
    verdict[passes.refused] = at.FAILED
    return verdict.astype(np.int8), np.where(wrong, moved, states).astype(np.int8)


class _Passes:
    """Newton passes of some samples on one set.

    Attributes
    ----------
    settled, refused, burst : ndarray of bool, shape (k,)
        Whether the passes arrived; whether a law has no meaning or a number overflowed; whether
        rigid contacts contradict one another, so that their forces grow without bound.
    gross, gross_to : ndarray, shape (k, switches)
        What was clearly wrong before the passes had settled, and the set that mends it.
    loose : ndarray of int, shape (k, flanks with a power law)
        How many passes in a row a flank was not compressed.
    outside : ndarray of int, shape (k, radial elements)
        How many passes in a row an element was beyond its level piece, or held inward.
    patience : ndarray of int, shape (radial elements,)
        How many of these show that it has left its place.
    fixed : dict of int to Graph
        Laws of radial elements that do not follow the torque.
    linear : dict of int to Block
        Tangents of radial elements that stay the same.
    """

    def __init__(
        self,
        structure: Structure,
        loading: Loading,
        states: States,
        rows: Numbers,
        iterate: Iterate,
    ) -> None:
        self.structure, self.loading, self.basis = structure, loading, structure.basis(states)
        self.states, self.rows, basis = states, rows, self.basis
        columns, count = basis.columns, len(rows)
        shape = (count, len(columns))
        self.load = np.broadcast_to(pick(loading.load, rows), (count, structure.size))
        self.gap = np.array(np.broadcast_to(pick(loading.gap, rows)[:, columns], shape))
        self.bending = np.broadcast_to(pick(loading.bending, rows)[:, columns], shape)
        self.hertz = np.broadcast_to(pick(loading.hertz, rows)[:, columns], shape)
        self.power = np.flatnonzero((loading.hertz[:, columns] > 0.0).any(axis=0))
        self.table = np.flatnonzero(loading.tabulated[columns] >= 0)
        tables = pick(loading.tables, rows)[:, loading.tabulated[columns[self.table]]]
        self.points = tables[:, :, 0], tables[:, :, 1]
        self.x, self.floor = iterate.x[rows], iterate.floor[rows]
        self.force, self.root = iterate.force[rows][:, columns], iterate.root[rows][:, columns]
        self.z = self.force @ basis.redundant
        self.lean = self.x, self.force
        self.compression, self.misfit = np.zeros(shape), np.zeros(count)
        first_arc = structure.columns.arcs.start
        arcs = columns - first_arc
        self.arc_at = np.flatnonzero((arcs >= 0) & (arcs < len(structure.arcs)))
        self.arc = arcs[self.arc_at]
        self.radial = [
            (j, int(status), int(np.searchsorted(columns, structure.radial_column(j))))
            for j, status in enumerate(states[structure.rows :])
            if status != at.OPEN
        ]
        self.scalar = np.flatnonzero(columns < structure.columns.contacts.stop)
        self.contact = self.scalar[columns[self.scalar] >= structure.springs]
        n = basis.redundant
        self.products = (n[:, :, None] * n[:, None, :]).reshape(len(columns), n.shape[1] ** 2)
        self.shared = self._shared()
        self.push = np.abs(self.load).max(axis=1, initial=0.0)
        self.unit = np.where(self.push > 0.0, self.push, 1.0)
        self.settled, self.burst = np.zeros(count, dtype=bool), np.zeros(count, dtype=bool)
        self.refused = np.zeros(count, dtype=bool)
        self.gross = np.zeros((count, structure.switches), dtype=bool)
        self.gross_to = np.repeat(states[None, :], count, axis=0)
        self.loose = np.zeros((count, len(self.power)), dtype=int)
        self.outside = np.zeros((count, structure.switches - structure.rows), dtype=int)
        self.patience = np.where(states[structure.rows :] == at.WALL, HOT.inward, HOT.outside)
        self.fixed: dict[int, at.Graph] = {}
        self.linear: dict[int, Block] = {}

    def run(self, patient: Flags) -> None:
        """Pass until every sample is settled, refused, or asks for another set.

        Parameters
        ----------
        patient : ndarray of bool, shape (k,)
            Samples whose signs are looked at only when they are settled.
        """
        straight = (at.STICK, at.PINNED)
        bent = [status for _, status, _ in self.radial if status not in straight]
        curved = len(self.arc) + len(bent) + len(self.table) > 0
        previous = np.full(len(self.rows), np.inf)
        for number in range(HOT.passes):
            x, force = self.x, self.force
            self._pass(self._blocks())
            roots = self.root
            laws = self._renew_laws()
            self.lean = self.x, self.force
            if number % HOT.swing >= HOT.swing - HOT.damped:
                # Newton's steps that swing to and fro around an answer settle between.
                self.lean = 0.5 * (x + self.x), 0.5 * (force + self.force)
                self.root = 0.5 * (roots + self.root)
            if curved and number < 2:
                self._give_up_gross((laws <= HOT.nearly) & ~patient)
            yielded = np.abs(self.compression[:, self.contact]).max(axis=1, initial=0.0)
            closing = self.misfit / np.where(yielded > 0.0, yielded, np.inf)
            misfit = np.maximum(closing, laws * (HOT.settled / HOT.law))
            if curved:
                misfit = np.maximum(misfit, change(self.force, force))
                balanced = misfit <= HOT.settled
                misfit = np.maximum(misfit, change(self.x, x))
            else:
                balanced = misfit <= HOT.settled
            # A law's tangent leaves a misfit of second order, so a small one need not be repeated.
            stalled = (number > 2) & (misfit <= HOT.stalled) & (misfit >= 0.5 * previous)
            self.settled = (misfit <= HOT.settled) | stalled
            self.refused |= ~np.isfinite(self.x).all(axis=1)
            previous = misfit
            self.burst = np.abs(self.force).max(axis=1, initial=0.0) > HOT.burst * self.unit
            hopeless = (self.loose >= HOT.patience).any(axis=1) | self._slipped_out() | self.burst
            hopeless |= self.gross.any(axis=1)
            if (self.settled | self.refused | hopeless).all():
                break
        # What creeps on without end is left to the certificate.
        # Where the forces no longer change, what still moves is held by none.
        self.settled |= (previous <= HOT.creep) | balanced
        self.settled &= ~self.burst
        self.settled &= ~self.refused

    def _pass(self, blocks: list[Block]) -> None:
        """One Newton pass: redundants, forces, compressions, coordinates."""
        particular, n = self.basis.particular, self.basis.redundant
        tangent, shift = self._tangents()
        load, gap = self._at_arcs()
        statics = load @ particular.T + self.z @ n.T
        stretch = gap + shift + tangent * statics
        size, count = n.shape[1], len(self.rows)
        borders = [b for b in blocks if b.bound is not None]
        matrix = np.zeros((count, size + len(borders), size + len(borders)))
        sides = np.zeros((count, size + len(borders)))
        matrix[:, :size, :size] = (tangent @ self.products).reshape(count, size, size)
        for b in blocks:
            stretch[:, b.columns] += b.offset + times(b.compliance, statics[:, b.columns])
            part = n[b.columns]
            matrix[:, :size, :size] += part.T @ b.compliance @ part
        for e, b in enumerate(borders, start=size):
            matrix[:, e, :size] = matrix[:, :size, e] = b.along @ n[b.columns]
            sides[:, e] = b.bound - (b.along * statics[:, b.columns]).sum(axis=1)
        sides[:, :size] = -stretch @ n
        if self.shared.shape[1]:
            self._set_apart(matrix, sides, np.abs(stretch).max(axis=1))
        solved = solve(matrix, sides, size)
        self.z = self.z + solved[:, :size]
        self.force = statics + solved[:, :size] @ n.T
        self.compression = shift + tangent * self.force
        for b in blocks:
            moved = b.offset + times(b.compliance, self.force[:, b.columns])
            self.compression[:, b.columns] = moved
        for e, b in enumerate(borders, start=size):
            self.compression[:, b.columns] += solved[:, e, None] * b.along
        self.x = (gap + self.compression) @ particular
        self.misfit = np.abs((gap + self.compression) @ n).max(axis=1, initial=0.0)

    def _shared(self) -> Array:
        """Redundants (r, q), orthonormal, in which nothing but rigid elements push one another.

        Round-off would settle how much, and does not stop at what is left of zero.
        """
        yields = np.asarray(((self.bending > 0.0) | (self.hertz > 0.0)).any(axis=0))
        yields[self.table] = True
        for _, status, k in self.radial:
            yields[k : k + 2] = status != at.PINNED
        n = self.basis.redundant
        _, sizes, right = np.linalg.svd(n[yields], full_matrices=True)
        return right[int((sizes > HOT.shared).sum()) :].T

    def _set_apart(self, matrix: Array, sides: Array, lengths: Array) -> None:
        """Hold the shares of rigid elements, unless they contradict one another."""
        q = self.shared
        size, largest = len(q), np.abs(matrix).max(axis=(1, 2))
        against = sides[:, :size] @ q
        against[np.abs(against) <= HOT.noise * lengths[:, None]] = 0.0
        apart = np.where(largest > 0.0, largest, 1.0)
        matrix[:, :size, :size] += apart[:, None, None] * (q @ q.T)
        mild = sides[:, :size] - (sides[:, :size] @ q) @ q.T
        sides[:, :size] = mild + (against / HOT.proximal) @ q.T

    def _tangents(self) -> tuple[Array, Array]:
        """Tangent compliance of every scalar element, and what its tangent leaves at no force."""
        tangent, shift = np.array(self.bending), np.zeros_like(self.gap)
        if len(self.power):
            root, c = self.root[:, self.power], self.hertz[:, self.power]
            tangent[:, self.power] += 2.0 / 3.0 * c / root
            shift[:, self.power] = c * root**2 / 3.0
        if len(self.table):
            force, start, slope = piece(*self.points, self.root[:, self.table] ** 3)
            tangent[:, self.table], shift[:, self.table] = slope, start - slope * force
        return tangent, shift

    def _renew_laws(self) -> Array:
        """Take the next tangents at the compressions; return the laws' misfit, relative."""
        misfit = np.zeros(len(self.rows))
        if len(self.power):
            b, c = self.bending[:, self.power], self.hertz[:, self.power]
            force, compression = self.force[:, self.power], self.compression[:, self.power]
            root, floor = self.root[:, self.power], self.floor[:, None]
            touching = (force > 0.0) & (compression > 0.0)
            self.loose = np.where(touching, 0, self.loose + 1)
            true = b * force + c * np.cbrt(np.maximum(force, 0.0)) ** 2
            off = np.where(touching, np.abs(true - compression), 0.0)
            # At the floor a flank that carries nothing has arrived.
            waiting = ~touching & (root > floor)
            largest = np.abs(self.compression[:, self.scalar]).max(axis=1)
            misfit = off.max(axis=1) / largest
            misfit[waiting.any(axis=1)] = 1.0
            self.loose[touching | (np.abs(force) <= HOT.sign * self.push[:, None])] = 0
            following = roots(b, c, np.where(touching, compression, 1.0))
            self.root[:, self.power] = np.maximum(
                np.where(touching, following, HOT.shrink * root), floor
            )
        if len(self.table):
            compression = self.compression[:, self.table]
            start, force, slope = piece(*self.points[::-1], compression)
            force = force + slope * (compression - start)
            self.root[:, self.table] = np.cbrt(np.maximum(force, 0.0))
        return misfit

    def _at_arcs(self) -> tuple[Array, Array]:
        """Loads and gaps with the arcs' faces turned to where they are now."""
        if not len(self.arc):
            return self.load, self.gap
        load, gap = np.array(self.load), self.gap
        for k, a in zip(self.arc_at, self.arc, strict=True):
            normal, margin = arc_at(self.loading, a, self.rows, self.x)
            base = self.basis.directions[k]
            load -= self.force[:, k, None] * (-normal @ self.loading.relative[a] - base)
            gap[:, k] = margin + self.x @ base
        return load, gap

    def _blocks(self) -> list[Block]:
        """Tangents of the radial elements where they are now."""
        blocks = []
        for j, status, k in self.radial:
            if j in self.linear:
                blocks.append(self.linear[j])
                continue
            columns = slice(k, k + 2)
            x, force = self.lean
            offset = self._offset(j, x)
            law = self._graph(j, offset)
            self.refused |= ~law.valid
            size = np.maximum(self.push, 1e-300)
            found = block(columns, status, law, offset, force[:, columns], size)
            if status in (at.STICK, at.PINNED) and j in self.fixed:
                self.linear[j] = found
            blocks.append(found)
        return blocks

    def _slipped_out(self) -> Flags:
        """Samples with a radial element that has left its level piece or its rigid stop.

        It stays far beyond the end of that piece, or friction that follows the torque is gone; a
        stop goes on holding inward, this way and that.
        """
        for j, status, k in self.radial:
            offset = self._offset(j)
            law = self._graph(j, offset)
            if status == at.SLIP:
                radius = np.sqrt((offset**2).sum(axis=1))
                left = (radius > HOT.beyond * law.reach) | (law.bound <= HOT.sign * self.push)
            elif status == at.WALL:
                left = (offset * self.force[:, k : k + 2]).sum(axis=1) < 0.0
            else:
                continue
            self.outside[:, j] = np.where(left, self.outside[:, j] + 1, 0)
        return np.asarray((self.outside >= self.patience).any(axis=1))

    def _graph(self, j: int, offset: Array) -> at.Graph:
        """Law of a radial element at an offset; found once where it is the same everywhere."""
        known = self.fixed.get(j)
        if known is not None:
            return known
        numbers = pick(self.loading.radial, self.rows)[:, j]
        carried = self.force @ self.loading.carried[j, self.basis.columns]
        radius = np.sqrt((offset * offset).sum(axis=1))
        found = at.graph(numbers, carried, radius)
        if not np.isnan(numbers[:, 3]).any() and (numbers[:, 6] == 1.0).all():
            self.fixed[j] = found
        return found

    def _offset(self, j: int, x: Array | None = None) -> Array:
        column, matrix = self.structure.radial_column(j), self.structure.radials[j].matrix
        centre = pick(self.loading.gap, self.rows)[:, column : column + 2]
        return np.asarray((self.x if x is None else x) @ matrix.T - centre)

    def _give_up_gross(self, these: Flags) -> None:
        """Give up sets that are clearly wrong before they are settled."""
        these = these & ~self.gross.any(axis=1)
        if not these.any():
            return
        before, self.settled = self.settled, these
        wrong, moved = self.wrong(HOT.gross)
        self.settled = before
        wrong &= these[:, None]
        self.gross |= wrong
        self.gross_to[these] = moved[these]

    def wrong(self, sign: float) -> tuple[Flags, States]:
        """Which elements have the wrong sign, and where they should be instead."""
        structure, loading = self.structure, self.loading
        wrong = np.zeros((len(self.rows), structure.switches), dtype=bool)
        moved = np.repeat(self.states[None, :], len(self.rows), axis=0)
        largest_force = np.maximum(np.abs(self.force).max(axis=1, initial=0.0), self.push)
        furthest = np.abs(self.x).max(axis=1, initial=0.0)
        yielded = np.abs(self.compression[:, self.scalar]).max(axis=1, initial=0.0)
        force_band, faint = sign * largest_force, HOT.sign * largest_force
        length_band = sign * np.maximum(yielded, HOT.of_way * furthest)
        rows = structure.columns.contacts
        approach = self.x @ structure.vectors[rows].T - pick(loading.gap, self.rows)[:, rows]
        for a in range(len(structure.arcs)):
            approach[:, structure.flat + a] = -arc_at(loading, a, self.rows, self.x)[1]
        closed = self.states[: structure.rows] == at.CLOSED
        wrong[:, : structure.rows] = approach > length_band[:, None]
        row = np.flatnonzero((self.basis.columns >= rows.start) & (self.basis.columns < rows.stop))
        switch = self.basis.columns[row] - rows.start
        wrong[:, switch] = self.force[:, row] < -force_band[:, None]
        moved[:, : structure.rows] = np.where(closed, at.OPEN, at.CLOSED)
        acting = {j: k for j, _, k in self.radial}
        for j in range(structure.switches - structure.rows):
            s, k = structure.rows + j, acting.get(j)
            force = self.force[:, k : k + 2] if k is not None else np.zeros((len(self.rows), 2))
            offset = self._offset(j)
            wrong[:, s], moved[:, s] = misplaced(
                int(self.states[s]),
                self._graph(j, offset),
                offset,
                force,
                force_band,
                length_band,
                faint,
            )
        slipped = (self.outside >= self.patience) & ~self.settled[:, None]
        pulled = wrong & self.burst[:, None] & np.append(closed, np.zeros_like(slipped[0]))
        wrong &= self.settled[:, None]
        wrong[:, structure.rows :] |= slipped
        wrong |= pulled
        # What the passes could not settle may still say which flank is open.
        power = self.basis.columns[self.power] - structure.springs
        opening = (self.loose >= HOT.patience) & ~self.settled[:, None]
        wrong[:, power] |= opening
        return wrong, moved

    def left_in_place(
        self, before: Array, these: Flags, wrong: Flags, moved: States
    ) -> tuple[Flags, States]:
        """Leave what no acting element holds where it was before, if that rights all signs."""
        least, loose = self.x, self.basis.loose
        self._move(these, (before - least) @ loose)
        other, states = self.wrong(HOT.sign)
        these = these & ~other.any(axis=1)
        self.x = np.where(these[:, None], self.x, least)
        return np.where(these[:, None], other, wrong), np.where(these[:, None], states, moved)

    def _move(self, these: Flags, share: Array) -> None:
        """Go along loose moves by shares (k, l), and roll along arcs in contact meanwhile."""
        loose = self.basis.loose
        self.x = np.where(these[:, None], self.x + share @ loose.T, self.x)
        apart = self.x @ loose @ loose.T
        for _ in range(HOT.rolls if len(self.arc) else 0):
            held = (self._at_arcs()[1] + self.compression) @ self.basis.particular
            self.x = np.where(these[:, None], held + apart, self.x)

    def drift(self) -> Array:
        """Move (k, n) that no acting element resists and the load pushes along; zero without."""
        along = self.load @ self.basis.loose
        drifting = np.abs(along).max(axis=1, initial=0.0) > HOT.drift * self.push
        return np.asarray(np.where(drifting[:, None], along @ self.basis.loose.T, 0.0))

    def stopped_by(self, drift: Array) -> tuple[Flags, States]:
        """Go along a drift (k, n) to what is first in the way, if anything: it, and its place."""
        structure = self.structure
        stopping = np.zeros((len(self.rows), structure.switches), dtype=bool)
        rows = structure.columns.contacts
        speed = drift @ structure.vectors[rows].T
        room = pick(self.loading.gap, self.rows)[:, rows] - self.x @ structure.vectors[rows].T
        for a in range(len(structure.arcs)):
            margin = arc_at(self.loading, a, self.rows, self.x)[1]
            room[:, structure.flat + a] = margin
        fast = HOT.drift * np.abs(drift).max(axis=1, initial=0.0)[:, None]
        way = np.where(speed > fast, np.maximum(room, 0.0) / speed, np.inf)
        way[:, self.states[: structure.rows] == at.CLOSED] = np.inf
        states = np.repeat(self.states[None, :], len(self.rows), axis=0)
        states[:, : structure.rows] = at.CLOSED
        ends = [way]
        for j in range(structure.switches - structure.rows):
            offset = self._offset(j)
            law = self._graph(j, offset)
            velocity = drift @ structure.radials[j].matrix.T
            reached = until(offset, velocity, law.reach, fast[:, 0])
            free = self.states[structure.rows + j] == at.OPEN
            ends.append(np.where(free, reached, np.inf)[:, None])
            states[:, structure.rows + j] = beyond(law)
        ways = np.concatenate(ends, axis=1)
        everyone, nearest = np.arange(len(self.rows)), ways.argmin(axis=1)
        way = ways[everyone, nearest]
        stopping[everyone, nearest] = stopped = np.isfinite(way)
        # From elsewhere the passes may end at the far side of a ring, held inward.
        self.x += np.where(stopped, way, 0.0)[:, None] * drift
        return stopping, states

    def rests(self, k: int, wrong: Flags) -> bool:
        """Find sample `k` a place where nothing that is open overlaps, if only places are wrong."""
        if (wrong & (self.states != at.OPEN)).any():
            return False
        before, this = self.x, np.arange(len(self.rows)) == k
        for _ in range(HOT.rolls):
            size = float(np.abs(self.x[k]).max())
            share = rest(*self._room(k), size)
            if share is None:
                self.x = before
                return False
            self._move(this, share[None, :])
            # What rolls along an arc ends next to the place that was sought.
            if not len(self.arc) or float(np.abs(share).max()) <= HOT.sign * size:
                break
        return True

    def _room(self, k: int) -> tuple[Array, Array, list[tuple[Array, Array, float]]]:
        """What is open around sample `k`, as `rest` takes it."""
        structure, rows, here = self.structure, self.structure.rows, self.rows[k : k + 1]
        opened = np.flatnonzero(self.states[:rows] == at.OPEN)
        x, loose = self.x[k : k + 1], self.basis.loose
        vectors = np.array(structure.vectors[structure.springs + opened])
        room = pick(self.loading.gap, here)[0, structure.springs + opened] - vectors @ x[0]
        first = structure.flat
        for a, row in zip(
            opened[opened >= first] - first, np.flatnonzero(opened >= first), strict=True
        ):
            normal, margin = arc_at(self.loading, a, here, x)
            vectors[row], room[row] = (-normal @ self.loading.relative[a])[0], margin[0]
        discs = []
        for j in np.flatnonzero(self.states[rows:] == at.OPEN).tolist():
            matrix = structure.radials[j].matrix @ loose
            offset = self._offset(j)
            # A wall that is a power begins at the clearance, not where its tangent from here does.
            reach = float(self._graph(j, np.zeros_like(offset)).reach[k])
            # Without friction and without an end a spline is nowhere.
            discs += [(matrix, offset[k], reach)] if np.isfinite(reach) else []
        closes = vectors @ loose
        finite = np.isfinite(room)
        return closes[finite], room[finite], discs

    def store(self, iterate: Iterate) -> None:
        """Write back where the samples are."""
        columns = self.basis.columns
        iterate.x[self.rows] = self.x
        force = np.zeros((len(self.rows), len(self.structure.kinds)))
        force[:, columns] = self.force
        iterate.force[self.rows] = force
        iterate.root[np.ix_(self.rows, columns)] = self.root


def solve(matrix: Array, sides: Array, size: int) -> Array:
    """Solve (k, n, n) symmetric systems; singular ones through a proximal term.

    Rigid contacts that push along one line leave their shares open: the matrix is singular, and any
    solution is one. The refined proximal solution tends to the one of least norm; shares that
    contradict one another grow without bound and are recognised by their signs.

    Parameters
    ----------
    matrix : ndarray, shape (k, n, n)
    sides : ndarray, shape (k, n)
    size : int
        Numbers of the positive semidefinite part; the rest are constraints.
    """
    if not matrix.shape[1]:
        return sides
    scale = np.abs(matrix).max(axis=(1, 2))
    scale = np.where(scale > 0.0, scale, 1.0)
    normed, target = matrix / scale[:, None, None], sides / scale[:, None]
    solved: Array = np.zeros(sides.shape)
    regular = np.ones(len(sides), dtype=bool)
    try:
        solved[:] = np.linalg.solve(normed, target[:, :, None])[:, :, 0]
    except np.linalg.LinAlgError:
        regular = np.linalg.slogdet(normed)[0] != 0.0
        solved[regular] = np.linalg.solve(normed[regular], target[regular][:, :, None])[:, :, 0]
    residual = np.abs(times(normed, solved) - target).max(axis=1)
    regular &= residual <= HOT.refined * np.maximum(np.abs(solved).max(axis=1), 1e-300)
    if not regular.all():
        sign = np.where(np.arange(matrix.shape[1]) < size, 1.0, -1.0)
        normed, target = normed[~regular], target[~regular]
        proximal = normed + HOT.proximal * np.diag(sign)
        found: Array = np.zeros(target.shape)
        for _ in range(HOT.refinements):
            left = target - times(normed, found)
            found += np.linalg.solve(proximal, left[:, :, None])[:, :, 0]
        solved[~regular] = found
    return solved


def size_of(vectors: Array) -> Array:
    """Largest entry of every row."""
    return np.asarray(np.abs(vectors).max(axis=1, initial=0.0))


def change(now: Array, before: Array) -> Array:
    """Largest change of a row over its largest entry."""
    size = np.abs(now).max(axis=1, initial=0.0)
    return np.asarray(np.abs(now - before).max(axis=1, initial=0.0) / np.maximum(size, 1e-300))


def times(matrices: Array, vectors: Array) -> Array:
    """Return the products of (k, n, n) with (k, n)."""
    return np.asarray((matrices @ vectors[:, :, None])[:, :, 0])
