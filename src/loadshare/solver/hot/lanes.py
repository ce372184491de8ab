"""Samples of a plain set side by side, compiled with Numba: the passes of `vectorised` in lanes.

A set is plain if all that can act is a spring, a flank with a linear or a power law, a stop or an
arc. Every loop that costs runs along the samples, so that the processor works on several of them
at a time. What is out of the ordinary (a drift, a singular matrix, forces without bound, passes
that do not settle) is left undecided, and `compiled` takes it up one by one. No lane knows of its
neighbours: an answer does not depend on the company it was found in.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from loadshare.scene.elements import Basis, Data, Elements
from loadshare.scene.scene import Array
from loadshare.solver.hot import places as at
from loadshare.solver.hot.state import State

Rows = NDArray[np.intp]
Codes = NDArray[np.int8]

WIDTHS = (16, 64, 128)
"""Samples side by side: the first number that is enough, or the last."""
PASSES = 30
"""Passes after which a sample is left to `compiled`."""
UNDECIDED = -1
"""Verdict on a sample that is left to `compiled`."""

OPEN, CLOSED, DONE, OTHER = at.OPEN, at.CLOSED, at.DONE, at.OTHER
SETTLED, STALLED, LAW, SIGN = at.SETTLED, at.STALLED, at.LAW, at.SIGN
HURRY, NEARLY, PATIENCE = at.HURRY, at.NEARLY, at.PATIENCE
SHRINK, BURST, DRIFT = at.SHRINK, at.BURST, at.DRIFT
TURNED = 10.0
"""Weight of the angle by which arcs still turn among what has to settle."""
STEEPEST = 1e-2
"""Angle by which no arc turns: 1 mm over 0.1 m."""
CLOSED_BY = 1e-12
"""Misfit of compatibility, over the largest compression, from which on a sample is left."""
DOUBTFUL = 1e-8
"""Pivot, over the largest, below which a sample is left to `compiled`."""
HASTE = 2
"""Patience with sets that are exchanged all at once (see `places.PATIENCE`)."""
YOUNG = 3
"""Passes in which a set is given up when a contact pulls."""
CLOSE = 1e-9
"""Newton's last step on a root, relative, from which on the root counts as found."""

_how: dict[str, Any] = {
    "nogil": True,
    "error_model": "numpy",
    "fastmath": {"reassoc", "contract", "nsz", "arcp"},
}
compiled = njit(cache=True, **_how)
# Without counted references, which would cost more than the sums: nothing is allocated in these.
_uncounted: dict[str, Any] = {**_how, "_nrt": False}
bare = njit(**_uncounted)


class _Plain(NamedTuple):
    """Numbers of a plain set and of the samples.

    k elements act on n coordinates with r redundants. The s springs among them never change, so
    that what they add is written down once; a of the others are arcs, p have a power law.
    """

    contacts: Rows  # (k − s,): columns of what is not a spring
    particular: Array  # (n, k), transposed
    redundant: Array  # (k, r)
    inverse: Array  # (r, r) of the redundants' matrix where it never changes, else (0, 0)
    yields: Array  # (s,): compliances of the springs
    springs_matrix: Array  # (r, r): what the springs add to the redundants' matrix
    springs_moved: Array  # (n, r + t): displacements that the springs add, per redundant and load
    across: Array  # (r, k): the redundants, transposed
    products: Array  # (r, r, p): of the redundants at the power laws
    turned: Array  # (k, t): forces per turned load
    loose: Array  # (n, l)
    power: Rows  # (p,), among the contacts
    arcs: Rows  # (a, 2): acting contact, number of the arc
    turning: Rows  # coordinates that acting arcs know of
    open_arcs: Rows  # numbers of the arcs that do not act
    starts: Rows  # of the rows that do not act: CSR of A, first the rows' own numbers
    open_rows: Rows
    coordinates: Rows
    entries: Array
    arc_starts: Rows  # coordinates that an arc knows of
    arc_coordinates: Rows
    base: Array  # (a, n): rows of A of the acting arcs
    code: Codes
    springs: int
    flanks: int  # rows before the first arc
    loaded: Rows  # coordinates with a load
    load: Array
    gap: Array
    bending: Array
    hertz: Array
    nominal: Array
    shift: Array
    clearance: Array
    relative: Array


class _Room(NamedTuple):
    """Samples side by side while they are solved; the last axis runs along the lanes."""

    force: Array
    stretch: Array
    tangent: Array
    shift: Array
    fixed: Array
    gap: Array
    before: Array
    bending: Array
    hertz: Array
    root: Array
    inverse_hertz: Array
    yields: Array
    loose: Array
    spring: Array
    statics: Array
    x: Array
    load: Array
    z: Array
    base: Array
    right: Array
    linear: Array
    matrix: Array
    push: Array
    floor: Array
    previous: Array
    misfit: Array
    law_misfit: Array
    step: Array
    largest: Array
    strongest: Array
    weakest: Array
    top: Array
    margin: Array
    waits: Array
    longest: Array
    normal: Array
    patience: Rows
    number: Rows
    at_row: Rows
    samples: Rows
    singular: NDArray[np.bool_]
    live: NDArray[np.bool_]


class _Found(NamedTuple):
    """Samples that have settled, side by side, until their signs are judged."""

    x: Array  # (n, lanes)
    force: Array  # (contacts, lanes), as are the gaps and compressions together:
    stretch: Array
    spring: Array  # (springs, lanes): the same without redundants and turned loads
    held: Array  # (springs, lanes): forces, at first without them
    moved: Array  # (springs, lanes): gaps and compressions
    root: Array  # (p, lanes)
    z: Array  # (r, lanes)
    load: Array  # (turning, lanes)
    push: Array  # largest force but for those of the contacts
    largest: Array  # compression
    yielded: Array  # compression of contacts
    closed: NDArray[np.bool_]  # whether the redundants close the gaps
    sign: Array  # band of the signs; infinite for a sample that has not settled
    samples: Rows
    row: Rows
    wrong: NDArray[np.bool_]
    mistakes: Rows  # how many signs are wrong
    work: tuple[Array, ...]


def is_plain(elements: Elements, data: Data) -> bool:
    """Whether all sets of some samples are plain."""
    constant = data.steady[: elements.springs].all()
    return bool(elements.switches == elements.rows and constant and (data.tabulated < 0).all())


def settle(
    elements: Elements,
    data: Data,
    basis: Basis,
    code: Codes,
    rows: Rows,
    state: State,
    one_only: NDArray[np.bool_],
) -> tuple[Codes, Codes]:
    """Solve samples on one plain set and say what has the wrong sign.

    Parameters and return values are those of :func:`loadshare.solver.hot.vectorised.settle`, but
    that a verdict may be `UNDECIDED`: such a sample stands where it stood.
    """
    verdict = np.empty(len(rows), dtype=np.int8)
    proposal = np.empty((len(rows), len(code)), dtype=np.int8)
    _settle_all(
        _plain(elements, data, basis, code),
        rows,
        state.x,
        state.force,
        state.root,
        state.floor,
        one_only,
        verdict,
        proposal,
        next((width for width in WIDTHS if width >= len(rows)), WIDTHS[-1]),
    )
    return verdict, proposal


def _plain(elements: Elements, data: Data, basis: Basis, code: Codes) -> _Plain:
    """Arrays of a set; what does not vary from sample to sample is kept for the next block."""
    key = ("plain", code.tobytes(), data.laws)
    known = elements.kept.get(key)
    if known is None:
        known = elements.keep(key, _structure(elements, data, basis, code))
    return _Plain._make(
        (
            *known,
            data.loaded,
            data.load,
            data.gap,
            data.bending,
            data.hertz,
            data.nominal,
            data.shift,
            data.clearance,
            data.relative,
        )
    )


def _structure(elements: Elements, data: Data, basis: Basis, code: Codes) -> tuple[Any, ...]:
    """The first fields of `_Plain`."""
    columns, n = basis.columns, np.ascontiguousarray(basis.redundant)
    springs, flanks = elements.springs, len(elements.scene.rows)
    first_arc = springs + flanks
    contacts = columns[springs:]
    power = np.flatnonzero(data.curved[contacts])
    acting = np.flatnonzero(contacts >= first_arc)
    arcs = np.stack([acting, contacts[acting] - first_arc], axis=1).astype(np.intp)
    idle = np.flatnonzero(code == OPEN)
    open_rows, open_arcs = idle[idle < flanks], idle[idle >= flanks] - flanks
    entries = elements.vectors[springs + open_rows]
    row, coordinates = np.nonzero(entries)
    known = (data.relative != 0.0).any(axis=1)
    known |= elements.vectors[first_arc : first_arc + len(known)] != 0.0
    arc, arc_coordinates = np.nonzero(known)
    turning = np.flatnonzero(known[arcs[:, 1]].any(axis=0))
    yields = np.array(data.bending[0, :springs])
    inverse = np.zeros((0, 0))
    if not len(power) and data.steady[columns].all() and n.shape[1]:
        inverse = np.linalg.pinv(n.T * data.bending[0, columns] @ n)
    held = basis.particular[:springs].T * yields
    return (
        contacts,
        np.ascontiguousarray(basis.particular.T),
        n,
        inverse,
        yields,
        n[:springs].T * yields @ n[:springs],
        np.hstack([held @ n[:springs], (held @ basis.particular[:springs])[:, turning]]),
        np.ascontiguousarray(n.T),
        np.ascontiguousarray((n[springs + power, :, None] * n[springs + power, None, :]).T),
        np.ascontiguousarray(basis.particular[:, turning]),
        np.ascontiguousarray(basis.loose),
        power,
        arcs,
        turning,
        open_arcs,
        np.searchsorted(row, np.arange(len(open_rows) + 1)),
        open_rows,
        coordinates,
        entries[row, coordinates],
        np.searchsorted(arc, np.arange(len(known) + 1)),
        arc_coordinates,
        np.ascontiguousarray(basis.directions[springs + acting]),
        np.array(code),
        springs,
        flanks,
    )


@bare
def _add(total, weights, table, lanes):  # type: ignore[no-untyped-def]
    """Add weights (q,) times table (q, lanes) to total (lanes,), four rows at a time."""
    q = weights.shape[0]
    whole = q - q % 4
    for e in range(0, whole, 4):
        w0, w1, w2, w3 = weights[e], weights[e + 1], weights[e + 2], weights[e + 3]
        for m in range(lanes):
            total[m] += (w0 * table[e, m] + w1 * table[e + 1, m]) + (
                w2 * table[e + 2, m] + w3 * table[e + 3, m]
            )
    if q - whole == 3:
        w0, w1, w2 = weights[whole], weights[whole + 1], weights[whole + 2]
        for m in range(lanes):
            total[m] += w0 * table[whole, m] + w1 * table[whole + 1, m] + w2 * table[whole + 2, m]
    elif q - whole == 2:
        w0, w1 = weights[whole], weights[whole + 1]
        for m in range(lanes):
            total[m] += w0 * table[whole, m] + w1 * table[whole + 1, m]
    elif q - whole == 1:
        w0 = weights[whole]
        for m in range(lanes):
            total[m] += w0 * table[whole, m]


@bare
def _arc(s, samples, a, x, lanes, normal, margin, work):  # type: ignore[no-untyped-def]
    """Margins (lanes,) of an arc at x, and its normals (3, lanes)."""
    varying = s.shift.shape[0] > 1
    varying_clearance = s.clearance.shape[0] > 1
    for c in range(3):
        for m in range(lanes):
            normal[c, m] = s.shift[samples[m] if varying else 0, a, c]
        for at_coordinate in range(s.arc_starts[a], s.arc_starts[a + 1]):
            d = s.arc_coordinates[at_coordinate]
            along = s.relative[a, c, d]
            for m in range(lanes):
                normal[c, m] += along * x[d, m]
    distance = 0.0
    for c in range(3):
        distance += s.nominal[a, c] * s.nominal[a, c]
    distance = np.sqrt(distance)
    for m in range(lanes):
        work[m] = 0.0
        margin[m] = 0.0
    for c in range(3):
        nominal = s.nominal[a, c]
        for m in range(lanes):
            moved = normal[c, m]
            margin[m] += (2.0 * nominal + moved) * moved
            normal[c, m] = nominal + moved
            work[m] += normal[c, m] * normal[c, m]
    for m in range(lanes):
        work[m] = np.sqrt(work[m])
        margin[m] /= work[m] + distance
        work[m] = 1.0 / work[m]
    for c in range(3):
        for m in range(lanes):
            normal[c, m] *= work[m]
    for m in range(lanes):
        margin[m] += s.clearance[samples[m] if varying_clearance else 0, a]


@bare
def _solve(matrix, right, lanes, singular, largest, pivot):  # type: ignore[no-untyped-def]
    """Solve symmetric definite systems (r, r, lanes) in place, lower triangles given."""
    r = right.shape[0]
    for m in range(lanes):
        largest[m] = 0.0
    for c in range(r):
        for m in range(lanes):
            p = matrix[c, c, m]
            largest[m] = p if p > largest[m] else largest[m]
            if not p > DOUBTFUL * largest[m]:
                singular[m] = True
            pivot[m] = 1.0 / p
        for d in range(c + 1, r):
            for m in range(lanes):
                matrix[c, d, m] = matrix[d, c, m] * pivot[m]
        for d in range(c + 1, r):
            for e in range(c + 1, d + 1):
                for m in range(lanes):
                    matrix[d, e, m] -= matrix[d, c, m] * matrix[c, e, m]
            for m in range(lanes):
                right[d, m] -= matrix[c, d, m] * right[c, m]
        for m in range(lanes):
            right[c, m] *= pivot[m]
    for c in range(r - 1, -1, -1):
        for d in range(c + 1, r):
            for m in range(lanes):
                right[c, m] -= matrix[c, d, m] * right[d, m]


@bare
def _signs(s, samples, x, force, reference, push, sign, lanes, wrong, count, work):  # type: ignore[no-untyped-def]
    """Mark what has the wrong sign, (rows, lanes), and count it."""
    force_band, length_band, approach, spare, normal = work
    for m in range(lanes):
        force_band[m] = push[m]
        length_band[m] = 0.0
        count[m] = 0
    for e in range(force.shape[0]):
        for m in range(lanes):
            f = abs(force[e, m])
            force_band[m] = f if f > force_band[m] else force_band[m]
    for d in range(x.shape[0]):
        for m in range(lanes):
            y = abs(x[d, m])
            length_band[m] = y if y > length_band[m] else length_band[m]
    for m in range(lanes):
        force_band[m] *= sign[m]
        y = 1e-3 * length_band[m]
        length_band[m] = sign[m] * (y if y > reference[m] else reference[m])
    for e in range(s.contacts.shape[0]):
        row = s.contacts[e] - s.springs
        for m in range(lanes):
            off = force[e, m] < -force_band[m]
            wrong[row, m] = off
            count[m] += off
    varying = s.gap.shape[0] > 1
    for o in range(s.open_rows.shape[0]):
        row = s.open_rows[o]
        for m in range(lanes):
            approach[m] = -s.gap[samples[m] if varying else 0, s.springs + row]
        for c in range(s.starts[o], s.starts[o + 1]):
            d, entry = s.coordinates[c], s.entries[c]
            for m in range(lanes):
                approach[m] += entry * x[d, m]
        for m in range(lanes):
            off = approach[m] > length_band[m]
            wrong[row, m] = off
            count[m] += off
    for o in range(s.open_arcs.shape[0]):
        a = s.open_arcs[o]
        row = s.flanks + a
        _arc(s, samples, a, x, lanes, normal, approach, spare)
        for m in range(lanes):
            off = -approach[m] > length_band[m]
            wrong[row, m] = off
            count[m] += off


@bare
def _propose(s, wrong, m, one_only, proposal):  # type: ignore[no-untyped-def]
    """Write the set that mends what is wrong in a lane."""
    for row in range(s.code.shape[0]):
        proposal[row] = s.code[row]
    for row in range(s.code.shape[0]):
        if wrong[row, m]:
            proposal[row] = OPEN if s.code[row] != OPEN else CLOSED
            if one_only:
                break


@bare
def _coordinates(s, contact, spring, z, load, x, lanes):  # type: ignore[no-untyped-def]
    """Write all coordinates x = Pᵀ(g + δ).

    `contact` is g + δ of the contacts; `spring` is that of the springs without redundants and
    turned loads.
    """
    springs, r = s.springs, z.shape[0]
    for d in range(x.shape[0]):
        for m in range(lanes):
            x[d, m] = 0.0
        _add(x[d], s.particular[d, :springs], spring, lanes)
        _add(x[d], s.particular[d, springs:], contact, lanes)
        _add(x[d], s.springs_moved[d, :r], z, lanes)
        _add(x[d], s.springs_moved[d, r:], load, lanes)


@bare
def _conclude(s, found, filled, xs, forces, roots, one_only, verdict, proposal, lanes):  # type: ignore[no-untyped-def]
    """Judge the signs of samples that have settled, and store them."""
    misfit, total, more, _, _ = found.work
    yielded = found.yielded
    for m in range(lanes):
        yielded[m] = found.largest[m]
        misfit[m] = 0.0
    for e in range(s.springs):
        for m in range(lanes):
            more[m] = 0.0
        _add(more, s.redundant[e], found.z, lanes)
        _add(more, s.turned[e], found.load, lanes)
        compliance = s.yields[e]
        for m in range(lanes):
            found.moved[e, m] = found.spring[e, m] + compliance * more[m]
            found.held[e, m] += more[m]
            f = abs(found.held[e, m])
            y = compliance * f
            found.largest[m] = y if y > found.largest[m] else found.largest[m]
            found.push[m] = f if f > found.push[m] else found.push[m]
    for c in range(found.z.shape[0]):
        for m in range(lanes):
            total[m] = 0.0
        _add(total, s.across[c, : s.springs], found.moved, lanes)
        _add(total, s.across[c, s.springs :], found.stretch, lanes)
        for m in range(lanes):
            y = abs(total[m])
            misfit[m] = y if y > misfit[m] else misfit[m]
    for m in range(filled):
        # What the matrix of the redundants was too stiff or too flat for.
        found.closed[m] = misfit[m] <= CLOSED_BY * yielded[m] or found.sign[m] != SIGN
    _coordinates(s, found.stretch, found.spring, found.z, found.load, found.x, lanes)
    _signs(
        s,
        found.samples,
        found.x,
        found.force,
        found.largest,
        found.push,
        found.sign,
        lanes,
        found.wrong,
        found.mistakes,
        found.work,
    )
    for m in range(filled):
        i, row = found.samples[m], found.row[m]
        if not found.closed[m]:
            continue
        if found.sign[m] == SIGN:
            verdict[row] = OTHER if found.mistakes[m] > 0 else DONE
        else:
            verdict[row] = OTHER
            if found.mistakes[m] == 0:
                # What does not settle may still say which flank is open.
                for p in range(s.power.shape[0]):
                    contact = s.power[p]
                    if found.force[contact, m] <= 0.0:
                        found.wrong[s.contacts[contact] - s.springs, m] = True
        _propose(s, found.wrong, m, one_only[i], proposal[row])
        for d in range(found.x.shape[0]):
            xs[i, d] = found.x[d, m]
        for column in range(s.springs, forces.shape[1]):
            forces[i, column] = 0.0
        for e in range(s.springs):
            forces[i, e] = found.held[e, m]
        for e in range(s.contacts.shape[0]):
            forces[i, s.contacts[e]] = found.force[e, m]
        for p in range(s.power.shape[0]):
            roots[i, s.contacts[s.power[p]]] = found.root[p, m]


@compiled
def _settle_all(s, rows, xs, forces, roots, floors, one_only, verdict, proposal, lanes):  # type: ignore[no-untyped-def]
    """Settle every sample of `rows`, `lanes` at a time."""
    r, springs, contacts = s.redundant.shape[1], s.springs, s.contacts.shape[0]
    n, powers, switches = xs.shape[1], s.power.shape[0], s.code.shape[0]
    turning, arcs = s.turning.shape[0], s.arcs.shape[0]
    room = _Room(
        np.zeros((contacts, lanes)),
        np.zeros((contacts, lanes)),
        np.zeros((contacts, lanes)),
        np.zeros((contacts, lanes)),
        np.zeros((contacts, lanes)),
        np.zeros((contacts, lanes)),
        np.zeros((arcs, lanes)),
        np.ones((powers, lanes)),
        np.ones((powers, lanes)),
        np.ones((powers, lanes)),
        np.ones((powers, lanes)),
        np.ones((powers, lanes)),
        np.ones((powers, lanes)),
        np.zeros((springs, lanes)),
        np.zeros((springs, lanes)),
        np.zeros((n, lanes)),
        np.zeros((turning, lanes)),
        np.zeros((r, lanes)),
        np.zeros((r, lanes)),
        np.zeros((r, lanes)),
        np.zeros((r, r, lanes)),
        np.zeros((r, r, lanes)),
        np.ones(lanes),
        np.ones(lanes),
        np.zeros(lanes),
        np.zeros(lanes),
        np.zeros(lanes),
        np.zeros(lanes),
        np.zeros(lanes),
        np.zeros(lanes),
        np.zeros(lanes),
        np.zeros(lanes),
        np.zeros(lanes),
        np.zeros(lanes),
        np.zeros(lanes),
        np.zeros((3, lanes)),
        np.zeros(lanes, dtype=np.int64),
        np.zeros(lanes, dtype=np.int64),
        np.zeros(lanes, dtype=np.int64),
        np.full(lanes, rows[0]),
        np.zeros(lanes, dtype=np.bool_),
        np.zeros(lanes, dtype=np.bool_),
    )
    work = (
        np.zeros(lanes),
        np.zeros(lanes),
        np.zeros(lanes),
        np.zeros(lanes),
        np.zeros((3, lanes)),
    )
    found = _Found(
        np.zeros((n, lanes)),
        np.zeros((contacts, lanes)),
        np.zeros((contacts, lanes)),
        np.zeros((springs, lanes)),
        np.zeros((springs, lanes)),
        np.zeros((springs, lanes)),
        np.ones((powers, lanes)),
        np.zeros((r, lanes)),
        np.zeros((turning, lanes)),
        np.ones(lanes),
        np.zeros(lanes),
        np.zeros(lanes),
        np.zeros(lanes, dtype=np.bool_),
        np.zeros(lanes),
        np.full(lanes, rows[0]),
        np.zeros(lanes, dtype=np.int64),
        np.zeros((switches, lanes), dtype=np.bool_),
        np.zeros(lanes, np.int64),
        work,
    )
    _run(s, rows, xs, forces, roots, floors, one_only, verdict, proposal, lanes, room, found)


@bare
def _run(s, rows, xs, forces, roots, floors, one_only, verdict, proposal, lanes, room, found):  # type: ignore[no-untyped-def]
    """Pass until every sample is settled; a lane that is done takes the next one."""
    r, springs, contacts = s.redundant.shape[1], s.springs, s.contacts.shape[0]
    powers, turning = s.power.shape[0], s.turning.shape[0]
    constant = s.inverse.shape[0] > 0 or r == 0
    distance = np.inf
    for w in range(s.arcs.shape[0]):
        square = 0.0
        for c in range(3):
            square += s.nominal[s.arcs[w, 1], c] ** 2
        distance = min(distance, np.sqrt(square))
    (
        force,
        stretch,
        tangent,
        shift,
        fixed,
        gap,
        before,
        bending,
        hertz,
        root,
        inverse_hertz,
        yields,
        loose,
        spring,
        statics,
        x,
        load,
        z,
        base,
        right,
        linear,
        matrix,
        push,
        floor,
        previous,
        misfit,
        law_misfit,
        step,
        largest,
        strongest,
        weakest,
        top,
        margin,
        waits,
        longest,
        normal,
        patience,
        number,
        at_row,
        samples,
        singular,
        live,
    ) = room
    one_load, one_gap = s.load.shape[0] == 1, s.gap.shape[0] == 1
    one_bending, one_hertz = s.bending.shape[0] == 1, s.hertz.shape[0] == 1
    filled, following, lives = 0, 0, 0
    while True:
        # Lanes that are done take the next samples.
        for m in range(lanes):
            while not live[m] and following < rows.shape[0]:
                i = rows[following]
                g, b = 0 if one_gap else i, 0 if one_bending else i
                h, f = 0 if one_hertz else i, 0 if one_load else i
                verdict[following] = UNDECIDED
                pushed = 0.0
                for d in s.loaded:
                    pushed = max(pushed, abs(s.load[f, d]))
                adrift = False
                for c in range(s.loose.shape[1]):
                    drift = 0.0
                    for d in s.loaded:
                        drift += s.loose[d, c] * s.load[f, d]
                    adrift = adrift or abs(drift) > DRIFT * pushed
                if not adrift:
                    live[m], singular[m], lives = True, False, lives + 1
                    samples[m], at_row[m], number[m] = i, following, 0
                    push[m], floor[m], previous[m] = pushed, floors[i], np.inf
                    patience[m] = PATIENCE if one_only[i] else HASTE
                    for c in range(r):
                        z[c, m] = 0.0
                        base[c, m] = 0.0
                    for e in range(springs):
                        fixed_force = 0.0
                        for d in s.loaded:
                            fixed_force += s.particular[d, e] * s.load[f, d]
                        statics[e, m] = fixed_force
                        spring[e, m] = s.gap[g, e] + s.yields[e] * fixed_force
                        for c in range(r):
                            base[c, m] -= s.redundant[e, c] * spring[e, m]
                    for e in range(contacts):
                        column = s.contacts[e]
                        gap[e, m] = s.gap[g, column]
                        tangent[e, m] = s.bending[b, column]
                        shift[e, m] = 0.0
                        force[e, m] = forces[i, column]
                        fixed_force = 0.0
                        for d in s.loaded:
                            fixed_force += s.particular[d, springs + e] * s.load[f, d]
                        fixed[e, m] = fixed_force
                    for p in range(powers):
                        column = s.contacts[s.power[p]]
                        bending[p, m] = s.bending[b, column]
                        hertz[p, m] = s.hertz[h, column]
                        inverse_hertz[p, m] = 1.0 / hertz[p, m]
                        root[p, m] = roots[i, column]
                        loose[p, m] = 0.0
                        tangent[s.power[p], m] = 0.0
                    for w in s.turning:
                        x[w, m] = xs[i, w]
                    for c in range(r):
                        for d in range(c + 1):
                            total = s.springs_matrix[c, d]
                            for e in range(contacts):
                                total += (
                                    s.redundant[springs + e, c]
                                    * s.redundant[springs + e, d]
                                    * tangent[e, m]
                                )
                            linear[c, d, m] = total
                following += 1
        if lives == 0:
            break
        for p in range(powers):
            e = s.power[p]
            for m in range(lanes):
                y, c_hertz = root[p, m], hertz[p, m]
                yields[p, m] = bending[p, m] + 2.0 / 3.0 * c_hertz / y
                tangent[e, m] = yields[p, m]
                shift[e, m] = c_hertz * y * y / 3.0
        # Forces without the next step of the redundants.
        for w in range(s.arcs.shape[0]):
            for m in range(lanes):
                before[w, m] = force[s.arcs[w, 0], m]
        for e in range(contacts):
            for m in range(lanes):
                force[e, m] = fixed[e, m]
            _add(force[e], s.redundant[springs + e], z, lanes)
        for c in range(r):
            for m in range(lanes):
                right[c, m] = -base[c, m]
            _add(right[c], s.springs_matrix[c], z, lanes)
        if turning > 0:
            for w in range(turning):
                for m in range(lanes):
                    load[w, m] = 0.0
            for w in range(s.arcs.shape[0]):
                contact, a = s.arcs[w, 0], s.arcs[w, 1]
                _arc(s, samples, a, x, lanes, normal, margin, top)
                for m in range(lanes):
                    gap[contact, m] = margin[m]
                for t in range(turning):
                    d = s.turning[t]
                    along = s.base[w, d]
                    for m in range(lanes):
                        gap[contact, m] += along * x[d, m]
                        face = along
                        for c in range(3):
                            face += normal[c, m] * s.relative[a, c, d]
                        load[t, m] += before[w, m] * face
            for e in range(contacts):
                _add(force[e], s.turned[springs + e], load, lanes)
            for c in range(r):
                for t in range(turning):
                    weight = s.springs_moved[s.turning[t], c]
                    for m in range(lanes):
                        right[c, m] += weight * load[t, m]
        # Redundants from compatibility.
        for e in range(contacts):
            for m in range(lanes):
                stretch[e, m] = gap[e, m] + shift[e, m] + tangent[e, m] * force[e, m]
        for c in range(r):
            _add(right[c], s.across[c, springs:], stretch, lanes)
            for m in range(lanes):
                right[c, m] = -right[c, m]
        if constant:
            for c in range(r):
                for m in range(lanes):
                    matrix[0, c, m] = right[c, m]
            for c in range(r):
                for m in range(lanes):
                    right[c, m] = 0.0
                for d in range(r):
                    weight = s.inverse[c, d]
                    for m in range(lanes):
                        right[c, m] += weight * matrix[0, d, m]
        else:
            for c in range(r):
                for d in range(c + 1):
                    for m in range(lanes):
                        matrix[c, d, m] = linear[c, d, m]
                    _add(matrix[c, d], s.products[c, d], yields, lanes)
            _solve(matrix, right, lanes, singular, step, law_misfit)
        for m in range(lanes):
            largest[m] = 0.0
            strongest[m] = 0.0
            weakest[m] = 0.0
            waits[m] = 0.0
            step[m] = 0.0
            law_misfit[m] = 0.0
            longest[m] = 0.0
        for c in range(r):
            for m in range(lanes):
                z[c, m] += right[c, m]
        for e in range(contacts):
            _add(force[e], s.redundant[springs + e], right, lanes)
            for m in range(lanes):
                y = shift[e, m] + tangent[e, m] * force[e, m]
                stretch[e, m] = gap[e, m] + y
                y, f = abs(y), abs(force[e, m])
                largest[m] = y if y > largest[m] else largest[m]
                strongest[m] = f if f > strongest[m] else strongest[m]
                f = force[e, m]
                weakest[m] = f if f < weakest[m] else weakest[m]
        # The next tangents.
        for p in range(powers):
            e = s.power[p]
            for m in range(lanes):
                f, moved = force[e, m], stretch[e, m] - gap[e, m]
                b, c_hertz = bending[p, m], hertz[p, m]
                touching = (f > 0.0) & (moved > 0.0)
                target = moved if touching else 1.0
                bound = np.sqrt(target * inverse_hertz[p, m])
                now = root[p, m]
                y = now if now < bound else bound
                more = ((b * y + c_hertz) * y * y - target) / ((3.0 * b * y + 2.0 * c_hertz) * y)
                y -= more
                y = y if y < bound else bound
                more = ((b * y + c_hertz) * y * y - target) / ((3.0 * b * y + 2.0 * c_hertz) * y)
                y -= more
                # What the tangent leaves: the law's true compression, expanded about the root.
                gone = abs(f - y * y * y) * (b + 2.0 / 3.0 * c_hertz / y)
                gone = gone if abs(more) <= CLOSE * y else target
                gone = gone if touching else 0.0
                law_misfit[m] = gone if gone > law_misfit[m] else law_misfit[m]
                waiting = 0.0 if touching | (now <= floor[m]) else 1.0
                waits[m] = waiting if waiting > waits[m] else waits[m]
                idle = abs(f) <= SIGN * push[m]
                since = 0.0 if touching | idle else loose[p, m] + 1.0
                loose[p, m] = since
                longest[m] = since if since > longest[m] else longest[m]
                y = y if touching else SHRINK * now
                root[p, m] = y if y > floor[m] else floor[m]
        for m in range(lanes):
            law_misfit[m] /= largest[m] if largest[m] > 0.0 else 1.0
            misfit[m] = 1.0 if waits[m] > 0.0 else law_misfit[m] * (SETTLED / LAW)
        if turning > 0:
            # Arcs turn as their centres move: these have to stand still, as seen along the arc.
            for m in range(lanes):
                step[m] = 0.0
            for t in range(turning):
                d = s.turning[t]
                for m in range(lanes):
                    margin[m] = 0.0
                _add(margin, s.particular[d, :springs], spring, lanes)
                _add(margin, s.particular[d, springs:], stretch, lanes)
                _add(margin, s.springs_moved[d, :r], z, lanes)
                _add(margin, s.springs_moved[d, r:], load, lanes)
                for m in range(lanes):
                    moved = abs(margin[m] - x[d, m])
                    step[m] = moved if moved > step[m] else step[m]
                    x[d, m] = margin[m]
            for m in range(lanes):
                y = step[m] * (TURNED / distance)
                misfit[m] = y if y > misfit[m] else misfit[m]
            for w in range(s.arcs.shape[0]):
                # The push of the pass before was turned.
                for m in range(lanes):
                    f = abs(force[s.arcs[w, 0], m] - before[w, m]) * STEEPEST
                    y = f / (strongest[m] if strongest[m] > 0.0 else 1.0)
                    misfit[m] = y if y > misfit[m] else misfit[m]
        for m in range(lanes):
            if not live[m]:
                continue
            settled = misfit[m] <= SETTLED or (
                number[m] > 2 and misfit[m] <= STALLED and misfit[m] >= 0.5 * previous[m]
            )
            previous[m] = misfit[m]
            number[m] += 1
            # Forces without bound and what is not a number are left undecided.
            burst = not strongest[m] <= BURST * (push[m] if push[m] > 0.0 else 1.0)
            if singular[m] or burst or (number[m] >= PASSES and not settled):
                live[m], lives = False, lives - 1
                continue
            i, row = samples[m], at_row[m]
            # A set that is clearly wrong need not be settled.
            pulled = number[m] <= YOUNG and law_misfit[m] <= NEARLY and not one_only[i]
            pulled = pulled and weakest[m] < -HURRY * strongest[m]
            if not (settled or pulled or longest[m] >= patience[m]):
                continue
            live[m], lives = False, lives - 1
            for e in range(contacts):
                found.force[e, filled] = force[e, m]
                found.stretch[e, filled] = stretch[e, m]
            for e in range(springs):
                found.spring[e, filled] = spring[e, m]
                found.held[e, filled] = statics[e, m]
            for p in range(powers):
                found.root[p, filled] = root[p, m]
            for c in range(r):
                found.z[c, filled] = z[c, m]
            for t in range(turning):
                found.load[t, filled] = load[t, m]
            found.push[filled], found.largest[filled] = push[m], largest[m]
            found.samples[filled], found.row[filled] = i, row
            found.sign[filled] = SIGN if settled else (HURRY if pulled else np.inf)
            filled += 1
            if filled == lanes:
                _conclude(s, found, filled, xs, forces, roots, one_only, verdict, proposal, lanes)
                filled = 0
    if filled > 0:
        _conclude(s, found, filled, xs, forces, roots, one_only, verdict, proposal, lanes)
