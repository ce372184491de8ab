r"""The certificate of many claims: residuals, and one small matrix for all that act alike.

It is the bound of `quick`, with all that is the same for claims of which the same elements act put
into a few numbers. With r the largest residual of balance, q the norm of :math:`L^T \epsilon` and w
the rounding of lengths,

.. math:: \lvert \Delta F_e \rvert \le \kappa_e\, r + \lVert L_e \rVert (q + \lambda\, r + \mu\, w).

A radial element is two columns here, and as stiff each way as its graph is anywhere: laws are
monotone, so that it need not be known on which piece the exact equilibrium has it. Residuals are
found by compiled code. Trains whose slip is remembered are not for it. Source: formulation,
section 16.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from loadshare.certify.arrays import arrays_of
from loadshare.certify.bound.claim import EPS
from loadshare.certify.bound.columns import Columns
from loadshare.certify.bound.laws import CLOSED, OPEN
from loadshare.certify.bound.statics import Statics, held_moves
from loadshare.certify.mechanics import mechanics_of
from loadshare.certify.validity import measuring
from loadshare.settings import BOUND, CERTIFY
from loadshare.train.equilibria import Equilibria
from loadshare.train.ring import transverse
from loadshare.train.situations import Situations
from loadshare.train.train import Train

Array = NDArray[np.float64]
Acts = NDArray[np.int8]
Flags = NDArray[np.bool_]
Numbers = NDArray[np.intp]
Places = NDArray[np.uintp]


class Layout(NamedTuple):
    """A train as compiled code reads it.

    e flanks, c contacts (flanks, stops, arcs), d drums, q radial elements, k splines, m columns.
    """

    mesh: Numbers  # (e,)
    is_drive: Flags  # (e,)
    is_tabled: Flags  # (e,)
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
    rest_shift: Places  # (e,): first that is no clocking
    still: Numbers  # gears that cannot be displaced
    axis: Array  # (gears, 3)
    shaft: Numbers  # (shafts, 2): first and second gear
    rigid_shaft: Numbers
    held: Numbers  # gears that do not turn
    carrier: Numbers  # (gears,): carrier on which each rides; −1 without
    squeezed: Numbers  # drums between whose arcs nothing gives way
    neighbour: Numbers  # (2 d,)
    ends: Numbers  # (e, 2): driver and driven gear
    across: Array  # (e, 3): turn of the line of action per displacement of the driver [1/m]
    line: Array  # (e,): its length [m]
    yields: Array  # (e,): one over the compression to warn of [1/m]
    turnable: float  # turn to warn of


class Groups(NamedTuple):
    """What is the same for claims of which the same elements act; G sets of elements.

    Rows of L (rows): contacts, springs, both columns of every radial element; 0 of what is idle.
    """

    known: Flags  # (G,): whether rigid parts do not share by themselves
    is_loose: Flags  # (G,): whether something moves that nothing resists
    carries: Flags  # (G,): whether radial elements take part in carrying a load
    root: Array  # (G, …, rows): L, transposed
    moves: Array  # (G, …, n)
    held: Array  # (G, …, n): moves that only light contacts hold, per force of these
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
    particular: Array  # (G, rows, n): P
    passed: Array  # (G, rows): force of every row by load
    size: Array  # (G, rows): length of every row of L
    softest: Array  # (G, rows): compliance that no claim exceeds; 0 of radial elements [m/N]


class Found(NamedTuple):
    """Figures of S claims."""

    number: Numbers  # (S,): of what acts; −1 if there is too much of it
    acts: Acts  # (S, c + q)
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
    rounding: Array  # of that [N]
    width: Array  # rounding of lengths [m]
    reach: Array  # error of a force up to which laws of contacts are what is said of them [N]
    room: Array  # smallest gap of what does not act [m]
    aside: Array  # largest torque of what is put aside [N·m]
    turned: Array  # largest turn of an arc's line
    bow: Array  # largest force of an arc over its distance [N/m]
    worst: Array  # largest scaled residual; not a number where two opposed contacts carry
    deflection: Array  # of the case [m]
    displaced: Array  # displacements over what is warned of; not a number where that is for NumPy


class Sets(NamedTuple):
    """Sets of elements that act: their first claim, smallest and largest compliances [m/N]."""

    first: Numbers
    key: NDArray[np.uint64]
    least: Array  # (…, c + springs + q)
    most: Array


class Workspace(NamedTuple):
    """What is found of the claims at hand, overwritten by the next; w of them stand abreast."""

    x: Array  # (n, w): coordinates [m]
    varying: Array  # (…, w): clockings and offsets
    shift: Array  # (3 gears, w): where gears are off their nominal centres [m]
    length: Array  # (m, w) [m]
    at_rest: Array  # (e, w): approach that remains when nothing turns or moves [m]
    across: Array  # (e, w): turns of lines of action
    force: Array  # (m, w) [N]
    excess: Array  # (2 q, w): force of radial elements beyond their graph [N]
    left: Array  # (n, w): load that is left over [N]
    sizes: Array  # (n, w): sum of the sizes of its terms
    gap: Array  # (c,) [m]
    line: Array  # (2 d, 2): unit vectors of arcs
    turn: Array  # (2 d,)
    stiffest: Array  # (q,) [m/N]
    law: Array  # (q, 6): of radial elements
    offset: Array  # (q, 2): from their centres [m]
    pull: Array  # (q, 3): claimed, in the gear's frame and along its axis [N]


def is_covered(columns: Columns) -> bool:
    """Whether claims of a train are for this bound."""
    return columns.train.slip is None


class Judged(NamedTuple):
    """What is told of S claims; not a number where it is for NumPy to tell.

    Attributes
    ----------
    relative : ndarray, shape (S,)
        Largest error of a torque over the largest torque; infinite if none is shown.
    worst : ndarray, shape (S,)
        Largest scaled residual.
    load, deflection : ndarray, shape (S,)
        Scales [N], [m].
    displaced : ndarray, shape (S,)
        How far displacements go to a warning (see `Measuring.worst`).
    """

    relative: Array
    worst: Array
    load: Array
    deflection: Array
    displaced: Array


def judged(columns: Columns, situations: Situations, answers: Equilibria) -> Judged:
    """Judge S claims with compiled code."""
    from loadshare.certify.bound import kernel

    held = _springs(columns, situations)
    plan = _plans.get(columns)
    if plan is None or not np.array_equal(plan.layout.spring, held[0]):
        plan = _plans[columns] = Plan(columns, *held)
    here, claim = arrays_of(situations, answers)
    found, sets = plan.found(len(answers.rotation)), plan.sets()
    count = kernel.find_all(plan.layout, here, claim, plan.work(), found, sets)
    acts = found.acts[sets.first[:count]]
    errors = np.empty_like(found.largest)
    groups = plan.groups(acts, sets.least[:count], sets.most[:count])
    kernel.bound_all(plan.layout, here, claim, found, groups, errors)
    with np.errstate(invalid="ignore"):
        relative = np.where(errors < np.inf, errors / found.largest + 2.0 * EPS, np.inf)
    return Judged(relative, found.worst, found.scale, found.deflection, found.displaced)


class Operators(NamedTuple):
    """Statics of a set of elements, without rows of what is idle."""

    particular: Array  # P
    redundant: Array  # N
    moves: Array
    held: Array  # moves that only light contacts hold, per force of these
    is_covered: bool  # whether balance tells these forces


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
        self.over_meshes = columns.over_meshes
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
        self._statics: dict[bytes, Operators] = {}

    @property
    def _rows(self) -> int:
        """Rows of L."""
        return len(self.contacts) + len(self.springs) + 2 * len(self.pulls)

    def work(self) -> Workspace:
        """Return an empty workspace."""
        of, m, n = self.layout, len(self.layout.start) - 1, self.contacts.shape[1]
        arcs, pulls, flanks, gears = len(of.apart), len(self.pulls), len(of.arm), len(of.radius)
        abreast = n, self.varying, 3 * gears, m, flanks, flanks, m, 2 * pulls, n, n
        single = len(self.contacts), (arcs, 2), arcs, pulls, (pulls, 6), (pulls, 2), (pulls, 3)
        sizes = *((size, BOUND.abreast) for size in abreast), *single
        return Workspace(*(np.zeros(size) for size in sizes))

    def found(self, count: int) -> Found:
        """Return room for the figures of so many claims."""
        pulls, n = len(self.pulls), self.contacts.shape[1]
        rows, number = (self._rows, n, pulls, pulls), np.empty(count, dtype=np.intp)
        acts = np.empty((count, len(self.contacts) + pulls), dtype=np.int8)
        sizes = [
            *((count, k) for k in rows),
            (count, pulls, 2),
            *[(count, pulls)] * 2,
            *[(count,)] * 14,
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

    def _known(self, acts: Acts) -> Operators:
        """Statics of what acts.

        A load is carried by radial elements only where nothing else does, and by what yields
        without end not at all.
        """
        found = self._statics.get(acts.tobytes())
        if found is not None:
            return found
        contacts = acts[: len(self.contacts)]
        some = self.pulls[acts[len(contacts) :] != OPEN].reshape(-1, self.springs.shape[1])
        closed = self.contacts[contacts != OPEN]
        whole = Statics.of(np.concatenate([closed, self.springs, some]))
        classes = np.full(len(whole.directions), CLOSED)
        classes[: len(closed)] = contacts[contacts != OPEN]
        lasting = classes == CLOSED
        carrying = whole if lasting.all() else Statics.of(whole.directions[lasting])
        # What is light may open, and then move by any length: it carries no load, but may hold what
        # nothing else does, where balance alone tells its force.
        borne, is_covered = held_moves(carrying.moves, whole.directions[~lasting])
        particular = np.zeros(whole.particular.shape)
        particular[lasting] = carrying.particular
        if len(some):
            first = len(lasting) - len(some)
            firm = np.flatnonzero(lasting[:first])
            known = Statics.of(whole.directions[firm])
            held = some @ known.moves
            held[np.abs(held) < BOUND.rank] = 0.0
            part = np.linalg.pinv(held.T, rcond=BOUND.rank) @ known.moves.T
            particular[firm] = known.particular @ (np.eye(len(part.T)) - some.T @ part)
            particular[first:] = part
        if len(self._statics) >= BOUND.sets:
            self._statics.clear()
        found = Operators(particular, whole.redundant, whole.moves, borne, is_covered)
        self._statics[acts.tobytes()] = found
        return found

    def groups(self, acts: Acts, least: Array, most: Array) -> Groups:
        """Return what is the same for the claims of some sets.

        Parameters
        ----------
        acts : ndarray of int8, shape (G, c + q)
        least, most : ndarray, shape (G, c + springs + q)
            Smallest and largest compliance of contacts, springs and radial elements [m/N].
        """
        count, n, rows = len(acts), self.contacts.shape[1], self._rows
        pulls, splines = len(self.pulls), len(self.layout.moment)
        known = [self._known(each) for each in acts]
        self_stresses = max((k.redundant.shape[1] for k in known), default=0)
        moves = max((k.moves.shape[1] for k in known), default=0)
        held = max((k.held.shape[1] for k in known), default=0)
        sizes = (
            (self_stresses, rows),
            (moves, n),
            (held, n),
            *[()] * 6,
            (5, 4),
            (pulls, 4),
            (pulls, 2, n),
            (splines, 3),
            (splines, splines),
            (pulls, splines),
            (rows, n),
            *[(rows,)] * 3,
        )
        found = Groups._make(
            [*np.zeros((3, count), bool), *(np.zeros((count, *size)) for size in sizes)]
        )
        for at in range(0, count, BOUND.sets_together):
            some = slice(at, at + BOUND.sets_together)
            part = Groups._make(array[some] for array in found)
            self._put(part, acts[some], known[some], least[some], most[some])
        return found

    def _both(self, figures: Array) -> Array:
        """Figures of the elements, those of radial ones twice."""
        first = figures.shape[1] - len(self.pulls)
        return np.append(figures[:, :first], np.repeat(figures[:, first:], 2, axis=1), axis=1)

    def _put(
        self, found: Groups, acts: Acts, every: list[Operators], least: Array, most: Array
    ) -> None:
        """Write what is known of some sets in its place."""
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
            found.is_loose[g], found.known[g] = operators.moves.size > 0, operators.is_covered
        soft, softest = (np.where(on, self._both(figures), 0.0) for figures in (least, most))
        found.known[:] &= np.isfinite(soft + softest).all(axis=1)
        self._put_roots(found, redundant, soft)
        known = found.known[:, None]
        self._put_figures(found, acts, np.where(known, softest / BOUND.secant, 0.0))

    def _put_roots(self, found: Groups, redundant: Array, soft: Array) -> None:
        """Write L, from the smallest compliances; rigid parts must not share by themselves."""
        soft = np.where(found.known[:, None], BOUND.secant * soft, 1.0)
        stiff = redundant.transpose(0, 2, 1) @ (soft[:, :, None] * redundant)
        # Columns that fill up are as soft as any, so that they do not count among the stiffest.
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
        """Write sizes of forces and ways, from the largest compliances."""
        of, contacts = self.layout, len(self.contacts)
        flanks, pulls, arcs = len(of.arm), self._rows - 2 * len(self.pulls), len(of.apart)
        passes, sizes = np.abs(found.particular), np.sqrt((found.root**2).sum(axis=1))
        # What radial elements yield is told by every claim itself.
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
        """Write what concerns radial elements, and torques over splines."""
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


_plans: WeakKeyDictionary[Columns, Plan] = WeakKeyDictionary()


def _entries(matrix: Array) -> tuple[Places, Places, Array]:
    """Entries of a matrix that are not zero, row by row."""
    rows, at = np.nonzero(matrix)
    start = np.searchsorted(rows, np.arange(len(matrix) + 1))
    return start.astype(np.uintp), at.astype(np.uintp), matrix[rows, at]


def _first_from(column: int, start: Places, at: Places) -> Places:
    """First entry of every row from a column on."""
    found = [np.searchsorted(at[a:b], column) + a for a, b in pairwise(start.tolist())]
    return np.array(found, dtype=np.uintp)


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
    gear_pairs = _pairs([(order[m.driver], order[m.driven]) for m, _ in columns.all_flanks])
    size, rest = measuring(train), _entries(columns.constants[0].T)
    across = size.across.reshape(len(gear_pairs), -1, 3)
    return Layout(
        columns.meshes,
        np.array([d for _, d in columns.all_flanks], dtype=np.bool_),
        np.isin(np.arange(columns.flanks.stop), columns.tabled),
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
        *rest,
        _first_from(len(train.shafts), *rest[:2])[: columns.flanks.stop],
        np.setdiff1d(np.arange(len(order)), columns.moving),
        np.array([g.axis for g in train.gears.values()]).reshape(-1, 3),
        _pairs([(order[s.first], order[s.second]) for s in train.shafts.values()]),
        np.setdiff1d(np.arange(len(train.shafts)), columns.elastic_shafts),
        np.array([order[g] for g in train.held], dtype=np.intp),
        np.array([order.get(g.carrier or "", -1) for g in train.gears.values()], dtype=np.intp),
        mechanics_of(train).squeezed,
        np.array([order[n] for r in train.drums for n in r.neighbours], dtype=np.intp),
        gear_pairs,
        across[np.arange(len(gear_pairs)), gear_pairs[:, 0]] / size.line,
        size.line[:, 0].copy(),
        1.0 / (size.height[:, 0] * CERTIFY.compressed),
        min(CERTIFY.turned, size.vanishing),
    )
