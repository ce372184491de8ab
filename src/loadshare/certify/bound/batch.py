r"""The bound of large batches: residuals of every claim, one small matrix for all that act alike.

It is the bound of `quick`, with all that is the same for claims of which the same elements act put
into a few numbers. With r the largest residual of balance, q the norm of :math:`L^T \epsilon` and w
the rounding of lengths,

.. math:: \lvert \Delta F_e \rvert \le \kappa_e\, r + \lVert L_e \rVert (q + \lambda\, r + \mu\, w).

A radial element is two columns here, and as stiff each way as its graph is anywhere: laws are
monotone, so that it need not be known on which piece the exact equilibrium has it. Residuals are
found by compiled code. Trains with tables, or whose slip is remembered, are not for it. Source:
formulation, section 16.
"""

from __future__ import annotations

from collections import namedtuple
from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from loadshare.certify.bound.claim import EPS
from loadshare.certify.bound.columns import Columns
from loadshare.certify.bound.statics import Statics
from loadshare.settings import BOUND
from loadshare.train.equilibria import CLAIMED, Equilibria
from loadshare.train.ring import transverse
from loadshare.train.situations import VARYING, Situations
from loadshare.train.train import Train

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Numbers = NDArray[np.intp]
Places = NDArray[np.uintp]

Here = namedtuple("Here", VARYING)  # type: ignore[misc]
"""The arrays of `Situations`."""
Claims = namedtuple("Claims", CLAIMED)  # type: ignore[misc]
"""The arrays of `Equilibria`."""


class Layout(NamedTuple):
    """A train as compiled code reads it.

    e flanks, c contacts (flanks, stops, arcs), d drums, q radial elements, k splines, m columns.
    """

    mesh: Numbers  # (e,)
    is_drive: Flags  # (e,)
    arm: Array  # (e,)
    twin: Numbers  # (c,): opposed contact of the same ring, or −1
    drum: Numbers  # (c − e,): drum of a ring's contact
    drum_gear: Numbers  # (d,)
    nominal: Array  # (2 d, 2): way from the neighbour
    apart: Array  # (2 d,): length of it
    spring: Numbers  # (springs, 3): column, shaft or gear, axis (2 for a shaft)
    spring_arm: Array
    pull_gear: Numbers  # (q,)
    centre: Array  # (q, 2)
    moment: Array  # (k, e): torque over a spline per force
    rounds: int
    turn: Numbers  # (turns, 2): coordinate, gear
    turn_radius: Array
    place: Numbers  # (places, 2): first coordinate, gear
    load: Numbers  # (loads, 2): coordinate, gear
    load_radius: Array
    frame: Array  # (gears, 2, 3)
    radius: Array  # (gears,)
    first_stop: int
    first_arc: int
    first_pull: int
    start: Places  # (m + 1,): entries of A, row by row
    at: Places
    value: Array
    rest_start: Places  # (m + 1,): what lengths take from clockings and offsets
    rest_at: Places
    rest_value: Array


class Groups(NamedTuple):
    """What is the same for claims of which the same elements act; G sets of elements.

    Rows of L (rows): contacts, springs, both columns of every radial element; 0 of what is idle.
    """

    known: Flags  # (G,): whether rigid parts do not share by themselves
    is_loose: Flags  # (G,): whether something moves that nothing resists
    carries: Flags  # (G,): whether radial elements take part in carrying a load
    root: Array  # (G, …, rows): L, transposed
    moves: Array  # (G, …, n)
    spread: Array  # (G,): sum of the lengths of the rows of L
    spread_of_arcs: Array  # (G,): of arcs alone
    into: Array  # (G,): energy per load, and per push across the lines of arcs
    into_by_push: Array
    bows: Array  # (G,): one over the shortest distance of arcs that act [1/m]
    widest: Array  # (G,): largest way per coordinate
    by: Array  # (G, 5, 4): largest figures by load, push, energy and gap
    pull_by: Array  # (G, q, 4): their forces by load, push and energy, and ways per length
    part: Array  # (G, q, 2, n): P of the radial elements
    moment_by: Array  # (G, k, 3): torque over splines by load, push and energy
    gain: Array  # (G, k, k): of that torque per push along a spline's offset
    pushed: Array  # (G, q, k): force of a radial element per such push


class Found(NamedTuple):
    """Figures of S claims."""

    number: Numbers  # (S,): of what acts; −1 if there is too much of it
    acts: Flags  # (S, c + q)
    misfit: Array  # (S, rows) [m]
    left: Array  # (S, n): of the balance [N]
    soft: Array  # (S, q): compliance where a radial element stands [m/N]
    spare: Array  # (S, q): by how much its force may change there [N]
    slip: Array  # (S, q, 2): unit vector along a slip, 0 of anything else
    rate: Array  # (S, q): change of its force with the torque [1/m]
    held: Array  # (S, q): change of the torque at which that begins to matter [N·m]
    scale: Array  # (S,): load [N], as the following
    largest: Array  # torque [N·m]
    push: Array  # largest force [N]
    residual: Array  # largest one of balance [N]
    width: Array  # rounding of lengths [m]
    light: Array  # smallest force of a flank with a Hertz contact [N]
    room: Array  # smallest gap of what does not act [m]
    aside: Array  # largest torque of what is put aside [N·m]
    turned: Array  # largest turn of an arc's line
    bow: Array  # largest force of an arc over its distance [N/m]


class Sets(NamedTuple):
    """Sets of elements that act: their first claim, smallest and largest compliances [m/N]."""

    first: Numbers
    key: NDArray[np.uint64]
    least: Array  # (…, c + springs + q)
    most: Array


class Sheet(NamedTuple):
    """What is found of the claim at hand, overwritten by the next."""

    x: Array
    length: Array
    varying: Array
    force: Array
    left: Array
    sizes: Array
    gap: Array
    line: Array
    turn: Array
    stiffest: Array


def is_covered(columns: Columns) -> bool:
    """Whether claims of a train are for this bound."""
    train = columns.train
    return train.slip is None and not any(
        hasattr(law, "forces") for m in train.meshes.values() for law in m.laws
    )


def relative_bounds(columns: Columns, situations: Situations, answers: Equilibria) -> Array:
    """Largest error of a torque over the largest torque, shape (S,); infinite if not shown."""
    from loadshare.certify.bound import compiled

    held = _springs(columns, situations)
    plan = _plans.get(columns)
    if plan is None or not np.array_equal(plan.layout.spring, held[0]):
        plan = _plans[columns] = Plan(columns, *held)
    here = Here(*(_plain(getattr(situations, name)) for name in VARYING))
    claim = Claims(*(_plain(array) for array in answers.arrays))
    found, sets = plan.found(len(answers.rotation)), plan.sets()
    count = compiled.find_all(plan.layout, here, claim, plan.sheet(), found, sets)
    acts = found.acts[sets.first[:count]]
    errors = np.empty_like(found.largest)
    compiled.bound_all(plan.layout, found, plan.groups(acts, sets.least, sets.most), errors)
    return np.asarray(errors / found.largest + EPS)


def _plain(array: Array) -> Array:
    """Return an array of the one kind that code is compiled for."""
    return np.require(array, np.float64, ["C", "W"])


class Operators(NamedTuple):
    """Statics of what acts, P and L, without rows of what is idle."""

    statics: Statics
    particular: Array
    root: Array


class Plan:
    """What all batches of a train share.

    Parameters
    ----------
    columns : Columns
    spring, spring_arm : ndarray
        As in `Layout`.
    """

    def __init__(self, columns: Columns, spring: Numbers, spring_arm: Array) -> None:
        self.layout = of = _layout(columns, spring, spring_arm)
        self.varying = len(columns.constants[0])
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
        self._statics: dict[bytes, tuple[Statics, Array]] = {}

    @property
    def _rows(self) -> int:
        """Rows of L."""
        return len(self.contacts) + len(self.springs) + 2 * len(self.pulls)

    def sheet(self) -> Sheet:
        """Return an empty sheet."""
        m, n, contacts = len(self.layout.start) - 1, self.contacts.shape[1], len(self.contacts)
        arcs = len(self.layout.apart)
        sizes = (n, m, self.varying, m, n, n, contacts, (arcs, 2), arcs, len(self.pulls))
        return Sheet(*(np.zeros(size) for size in sizes))

    def found(self, count: int) -> Found:
        """Return room for the figures of so many claims."""
        pulls, n = len(self.pulls), self.contacts.shape[1]
        rows, number = (self._rows, n, pulls, pulls), np.empty(count, dtype=np.intp)
        acts = np.empty((count, len(self.contacts) + pulls), dtype=np.bool_)
        sizes = [
            *((count, k) for k in rows),
            (count, pulls, 2),
            *[(count, pulls)] * 2,
            *[(count,)] * 10,
        ]
        return Found._make([number, acts, *map(np.empty, sizes)])

    def sets(self) -> Sets:
        """Return room for sets of elements."""
        size = (BOUND.sets_told_apart, len(self.contacts) + len(self.springs) + len(self.pulls))
        first, key = (
            np.empty(BOUND.sets_told_apart, dtype=np.intp),
            np.empty(BOUND.sets_told_apart, dtype=np.uint64),
        )
        return Sets(first, key, np.full(size, np.inf), np.zeros(size))

    def _known(self, acts: Flags) -> tuple[Statics, Array]:
        """Statics of what acts, and P, by radial elements only if nothing else carries a load."""
        found = self._statics.get(acts.tobytes())
        if found is None:
            contacts = len(self.contacts)
            some = self.pulls[acts[contacts:]].reshape(-1, self.springs.shape[1])
            firm = np.concatenate([self.contacts[acts[:contacts]], self.springs])
            statics, known = Statics.of(np.concatenate([firm, some])), Statics.of(firm)
            held = some @ known.moves
            held[np.abs(held) < BOUND.rank] = 0.0
            part = np.linalg.pinv(held.T, rcond=BOUND.rank) @ known.moves.T
            by_firm = known.particular @ (np.eye(len(part.T)) - some.T @ part)
            particular = np.concatenate([by_firm, part])
            if len(self._statics) >= BOUND.sets:
                self._statics.clear()
            found = self._statics[acts.tobytes()] = statics, particular
        return found

    def groups(self, acts: Flags, least: Array, most: Array) -> Groups:
        """Return what is the same for the claims of some sets.

        Parameters
        ----------
        acts : ndarray of bool, shape (G, c + q)
        least, most : ndarray, shape (G or more, c + springs + q)
            Smallest and largest compliance of contacts, springs and radial elements [m/N].
        """
        count, n, of = len(acts), self.contacts.shape[1], self.layout
        pulls, splines = len(self.pulls), len(of.moment)
        known = [self._operators(acts[g], least[g]) for g in range(count)]
        self_stresses = max((k.root.shape[1] for k in known if k), default=0)
        moves = max((k.statics.moves.shape[1] for k in known if k), default=0)
        flags = [
            np.array([k is not None for k in known], dtype=np.bool_),
            *np.zeros((2, count), bool),
        ]
        sizes = (
            (self_stresses, self._rows),
            (moves, n),
            *[()] * 6,
            (5, 4),
            (pulls, 4),
            (pulls, 2, n),
            (splines, 3),
            (splines, splines),
            (pulls, splines),
        )
        found = Groups._make([*flags, *(np.zeros((count, *size)) for size in sizes)])
        for g, operators in enumerate(known):
            if operators is not None:
                self._put(found, g, acts[g], operators, most[g])
        return found

    def _on(self, acts: Flags) -> Flags:
        """Rows of L of what acts."""
        contacts = len(self.contacts)
        springs = np.ones(len(self.springs), dtype=bool)
        return np.concatenate([acts[:contacts], springs, np.repeat(acts[contacts:], 2)])

    def _operators(self, acts: Flags, least: Array) -> Operators | None:
        """Return statics and L; None if rigid parts share by themselves."""
        statics, particular = self._known(acts)
        soft, n = self._both(least)[self._on(acts)], statics.redundant
        if not np.isfinite(soft).all():
            return None
        stiff = n.T @ (BOUND.secant * soft[:, None] * n)
        values, vectors = np.linalg.eigh(stiff)
        if values.size and values.min() <= BOUND.singular * values.max():
            return None
        return Operators(statics, particular, n @ (vectors / np.sqrt(values)))

    def _both(self, figures: Array) -> Array:
        """Figures of the elements, those of radial ones twice."""
        first = len(figures) - len(self.pulls)
        return np.append(figures[:first], np.repeat(figures[first:], 2))

    def _put(self, found: Groups, g: int, acts: Flags, known: Operators, most: Array) -> None:
        """Write what is known of a set in its place."""
        of, on, contacts = self.layout, self._on(acts), len(self.contacts)
        flanks, pulls, arcs = len(of.arm), self._rows - 2 * len(self.pulls), len(of.apart)
        root = np.zeros((self._rows, known.root.shape[1]))
        particular = np.zeros((self._rows, self.contacts.shape[1]))
        root[on], particular[on] = known.root, known.particular
        passes, sizes = np.abs(particular), np.sqrt((root**2).sum(axis=1))
        # What radial elements yield is told by every claim itself.
        soft = np.where(on, self._both(most) / BOUND.secant, 0.0)
        soft[pulls:] = 0.0
        some = acts[contacts - arcs : contacts]
        across = self.across[some].sum(axis=0)
        figures = np.array([passes.sum(axis=1), passes @ across, sizes])
        open_ = np.abs(self.pulls[~acts[contacts:]]).sum(axis=1)
        rows = np.concatenate([np.abs(self.contacts), open_, self.across[some]])
        ways = rows @ passes.T
        by_way = np.append(ways @ (soft * figures).T, ways.sum(axis=1)[:, None], axis=1)
        arcs_on = contacts - arcs + np.flatnonzero(some)
        arms = of.arm * (1.0 + EPS)
        by = found.by[g]
        by[0, :3], by[2, :3] = figures.max(axis=1), (figures[:, :flanks] * arms).max(axis=1)
        by[3, :3] = figures[:, arcs_on].max(axis=1, initial=0.0)
        by[1], by[4] = (
            v.max(axis=0, initial=0.0) for v in (by_way, by_way[len(by_way) - len(arcs_on) :])
        )
        found.spread[g], found.spread_of_arcs[g] = sizes.sum(), sizes[arcs_on].sum()
        found.into[g], found.into_by_push[g], _ = figures @ (soft * sizes)
        found.bows[g] = (1.0 / of.apart[some]).max(initial=0.0)
        found.widest[g] = rows.max(initial=0.0)
        found.pull_by[g, :, :3] = figures[:, pulls:].reshape(3, -1, 2).sum(axis=2).T
        found.pull_by[g, :, 3] = ways[:, pulls:].max(axis=0, initial=0.0).reshape(-1, 2).sum(axis=1)
        found.part[g] = particular[pulls:].reshape(-1, 2, len(rows.T))
        found.carries[g] = found.pull_by[g, :, 0].any()
        moments, pushed = np.abs(of.moment), passes @ np.abs(self.pulls[of.rounds :]).sum(axis=1).T
        gain = pushed + sizes[:, None] * ((soft * sizes) @ pushed)
        found.moment_by[g] = moments @ figures[:, :flanks].T
        found.gain[g] = moments @ gain[:flanks]
        found.pushed[g] = pushed[pulls:].reshape(len(self.pulls), 2, len(moments)).sum(axis=1)
        moves = known.statics.moves.T
        found.root[g, : root.shape[1]], found.moves[g, : len(moves)] = root.T, moves
        found.is_loose[g] = len(moves) > 0


_plans: WeakKeyDictionary[Columns, Plan] = WeakKeyDictionary()


def _entries(matrix: Array) -> tuple[Places, Places, Array]:
    """Entries of a matrix that are not zero, row by row."""
    rows, at = np.nonzero(matrix)
    start = np.searchsorted(rows, np.arange(len(matrix) + 1))
    return start.astype(np.uintp), at.astype(np.uintp), matrix[rows, at]


def _springs(columns: Columns, situations: Situations) -> tuple[Numbers, Array]:
    """Elastic shafts and bearings, and the arms of shafts."""
    train = columns.train
    found, arms = [], []
    shafts = list(train.shafts.values())
    for at, k in enumerate(columns.elastic_shafts, columns.shafts.start):
        found.append((at, k, 2))
        arms.append(train.gears[shafts[k].first].base_radius)
    for number, gear in enumerate(columns.places):
        for axis in (0, 1):
            if situations.support[:, columns.order[gear], axis].any():
                found.append(
                    (columns.bearings.start + 2 * number + axis, columns.order[gear], axis)
                )
                arms.append(1.0)
    return np.array(found, dtype=np.intp).reshape(-1, 3), np.array(arms)


def _twins(columns: Columns, nominal: Array, apart: Array) -> Numbers:
    """Opposed contacts of rings."""
    flanks, contacts = columns.flanks.stop, len(columns.contacts)
    twin = np.full(contacts + len(apart), -1, dtype=np.intp)
    for start in range(flanks, len(twin), 2):
        k = start - contacts
        if k >= 0 and nominal[k] @ nominal[k + 1] > -BOUND.opposed * apart[k] * apart[k + 1]:
            continue
        twin[start], twin[start + 1] = start + 1, start
    return twin


def _pairs(pairs: list[tuple[int, int]]) -> Numbers:
    return np.array(pairs, dtype=np.intp).reshape(-1, 2)


def _pull_centres(train: Train) -> Array:
    centres = [train.gears[r.gear].frame @ r.offset for r in train.rounds]
    return np.array([*centres, *np.zeros((len(train.splines), 2))]).reshape(-1, 2)


def _layout(columns: Columns, spring: Numbers, spring_arm: Array) -> Layout:
    train, order = columns.train, columns.order
    ends = [(train.gears[r.gear], train.gears[n]) for r in train.drums for n in r.neighbours]
    ways = [transverse(g.centre - n.centre, g.axis) @ g.frame.T for g, n in ends]
    nominal = np.array(ways).reshape(-1, 2)
    apart = np.sqrt((nominal**2).sum(axis=1))
    drums = np.arange(len(train.drums))
    held = {g: t for g, t in columns.turns.items() if t.coordinate is not None}
    turns = [(t.coordinate or 0, order[g], t.radius) for g, t in held.items() if not t.shafts]
    loads = [(t.coordinate or 0, order[g], t.radius) for g, t in held.items()]
    pulled = [order[r.gear] for r in train.rounds] + [order[g] for g in train.splines]
    return Layout(
        columns.meshes,
        np.array([d for _, d in columns.all_flanks], dtype=np.bool_),
        columns.arms,
        _twins(columns, nominal, apart),
        np.concatenate([np.repeat(drums, 2)] * 2),
        np.array([order[r.gear] for r in train.drums], dtype=np.intp),
        nominal,
        apart,
        spring,
        spring_arm,
        np.array(pulled, dtype=np.intp),
        _pull_centres(train),
        columns.moments,
        len(train.rounds),
        _pairs([t[:2] for t in turns]),
        np.array([t[2] for t in turns]),
        _pairs([(at, order[g]) for g, at in columns.places.items()]),
        _pairs([t[:2] for t in loads]),
        np.array([t[2] for t in loads]),
        np.array([g.frame for g in train.gears.values()]).reshape(-1, 2, 3),
        np.array([g.base_radius for g in train.gears.values()]),
        columns.stops.start,
        columns.arcs.start,
        columns.radials.start,
        *_entries(columns.matrix.high),
        *_entries(columns.constants[0].T),
    )
