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

LANES = 64
"""Samples side by side."""
FEW = 16
"""The same where there are no more samples than that."""
PASSES = 30
"""Passes after which a sample is left to `compiled`."""
UNDECIDED = -1
"""Verdict on a sample that is left to `compiled`."""

OPEN, CLOSED, DONE, OTHER = at.OPEN, at.CLOSED, at.DONE, at.OTHER
SETTLED, STALLED, LAW, SIGN = at.SETTLED, at.STALLED, at.LAW, at.SIGN
HURRY, NEARLY, PATIENCE = at.HURRY, at.NEARLY, at.PATIENCE
SHRINK, BURST, DRIFT, SMALL = at.SHRINK, at.BURST, at.DRIFT, at.SMALL
HASTE = 2
"""Patience with sets that are exchanged all at once (see `places.PATIENCE`)."""
YOUNG = 3
"""Passes in which a set is given up when a contact pulls."""
CLOSE = 1e-9
"""Newton's last step on a root, relative, from which on the root counts as found."""

compiled = njit(
    cache=True, nogil=True, error_model="numpy", fastmath={"reassoc", "contract", "nsz", "arcp"}
)


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
    springs_moved: Array  # (n, r + n): displacements that the springs add per redundant, per load
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


class _Found(NamedTuple):
    """Samples that have settled, side by side, until their signs are judged."""

    x: Array  # (n, lanes)
    force: Array  # (contacts, lanes), as are the gaps and compressions together:
    stretch: Array
    spring: Array  # (springs, lanes): the same without redundants and turned loads
    held: Array  # (springs, lanes): forces, at first without them
    root: Array  # (p, lanes)
    z: Array  # (r, lanes)
    load: Array  # (turning, lanes)
    push: Array
    largest: Array
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
        LANES if len(rows) > FEW else FEW,
    )
    return verdict, proposal


def _plain(elements: Elements, data: Data, basis: Basis, code: Codes) -> _Plain:
    """Arrays of a set; what does not vary from sample to sample is kept for the next block."""
    key = ("plain", code.tobytes(), data.laws)
    known = elements.kept.get(key)
    if known is None:
        known = elements.kept[key] = _structure(elements, data, basis, code)
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
        np.hstack([held @ n[:springs], held @ basis.particular[:springs]]),
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


@compiled
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


@compiled
def _solve(matrix, right, lanes, singular):  # type: ignore[no-untyped-def]
    """Solve symmetric definite systems (r, r, lanes) in place, lower triangles given."""
    r = right.shape[0]
    largest, pivot = np.zeros(lanes), np.empty(lanes)
    for c in range(r):
        for m in range(lanes):
            p = matrix[c, c, m]
            largest[m] = p if p > largest[m] else largest[m]
            if not p > SMALL * largest[m]:
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


@compiled
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


@compiled
def _propose(s, wrong, m, one_only, proposal):  # type: ignore[no-untyped-def]
    """Write the set that mends what is wrong in a lane."""
    for row in range(s.code.shape[0]):
        proposal[row] = s.code[row]
    for row in range(s.code.shape[0]):
        if wrong[row, m]:
            proposal[row] = OPEN if s.code[row] != OPEN else CLOSED
            if one_only:
                break


@compiled
def _coordinates(s, contact, spring, z, load, x, lanes):  # type: ignore[no-untyped-def]
    """Write all coordinates x = Pᵀ(g + δ).

    `contact` is g + δ of the contacts; `spring` is that of the springs without redundants and
    turned loads.
    """
    springs, r = s.springs, z.shape[0]
    for d in range(x.shape[0]):
        for m in range(lanes):
            x[d, m] = 0.0
        for e in range(springs):
            weight = s.particular[d, e]
            if weight != 0.0:
                for m in range(lanes):
                    x[d, m] += weight * spring[e, m]
        for e in range(contact.shape[0]):
            weight = s.particular[d, springs + e]
            if weight != 0.0:
                for m in range(lanes):
                    x[d, m] += weight * contact[e, m]
        for c in range(r):
            weight = s.springs_moved[d, c]
            for m in range(lanes):
                x[d, m] += weight * z[c, m]
        for w in range(s.turning.shape[0]):
            weight = s.springs_moved[d, r + s.turning[w]]
            for m in range(lanes):
                x[d, m] += weight * load[w, m]


@compiled
def _conclude(s, found, filled, xs, forces, roots, one_only, verdict, proposal, lanes):  # type: ignore[no-untyped-def]
    """Judge the signs of samples that have settled, and store them."""
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
    for e in range(s.springs):
        for c in range(found.z.shape[0]):
            weight = s.redundant[e, c]
            for m in range(lanes):
                found.held[e, m] += weight * found.z[c, m]
        for t in range(s.turning.shape[0]):
            weight = s.particular[s.turning[t], e]
            for m in range(lanes):
                found.held[e, m] += weight * found.load[t, m]
    for m in range(filled):
        i, row = found.samples[m], found.row[m]
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
    """Settle every sample of `rows`, `lanes` at a time; a lane that is done takes the next one."""
    r, springs, contacts = s.redundant.shape[1], s.springs, s.contacts.shape[0]
    n, powers, switches = xs.shape[1], s.power.shape[0], s.code.shape[0]
    turning = s.turning.shape[0]
    constant = s.inverse.shape[0] > 0 or r == 0
    # Per contact.
    force, stretch, tangent, shift, fixed, gap = (
        np.zeros((contacts, lanes)),
        np.zeros((contacts, lanes)),
        np.zeros((contacts, lanes)),
        np.zeros((contacts, lanes)),
        np.zeros((contacts, lanes)),
        np.zeros((contacts, lanes)),
    )
    before = np.zeros((s.arcs.shape[0], lanes))
    # Per power law.
    bending, hertz, root, inverse_hertz = (
        np.ones((powers, lanes)),
        np.ones((powers, lanes)),
        np.ones((powers, lanes)),
        np.ones((powers, lanes)),
    )
    loose = np.zeros((powers, lanes), dtype=np.int64)
    # Per spring, coordinate, redundant.
    spring, statics = np.zeros((springs, lanes)), np.zeros((springs, lanes))
    x, load = np.zeros((n, lanes)), np.zeros((turning, lanes))
    z, base, right = np.zeros((r, lanes)), np.zeros((r, lanes)), np.zeros((r, lanes))
    linear, matrix = np.zeros((r, r, lanes)), np.zeros((r, r, lanes))
    # Per sample.
    push, floor, previous = np.ones(lanes), np.ones(lanes), np.zeros(lanes)
    misfit, law_misfit, step = np.zeros(lanes), np.zeros(lanes), np.zeros(lanes)
    largest, strongest, top = np.zeros(lanes), np.zeros(lanes), np.zeros(lanes)
    weakest = np.zeros(lanes)
    normal, margin = np.zeros((3, lanes)), np.zeros(lanes)
    work = (
        np.zeros(lanes),
        np.zeros(lanes),
        np.zeros(lanes),
        np.zeros(lanes),
        np.zeros((3, lanes)),
    )

    singular, lost = np.zeros(lanes, dtype=np.bool_), np.zeros(lanes, dtype=np.bool_)
    live, waits = np.zeros(lanes, dtype=np.bool_), np.zeros(lanes, dtype=np.bool_)
    patience = np.zeros(lanes, dtype=np.int64)
    number, at_row = np.zeros(lanes, dtype=np.int64), np.zeros(lanes, dtype=np.int64)
    samples = np.full(lanes, rows[0])
    found = _Found(
        np.zeros((n, lanes)),
        np.zeros((contacts, lanes)),
        np.zeros((contacts, lanes)),
        np.zeros((springs, lanes)),
        np.zeros((springs, lanes)),
        np.ones((powers, lanes)),
        np.zeros((r, lanes)),
        np.zeros((turning, lanes)),
        np.ones(lanes),
        np.zeros(lanes),
        np.zeros(lanes),
        samples.copy(),
        np.zeros(lanes, dtype=np.int64),
        np.zeros((switches, lanes), dtype=np.bool_),
        np.zeros(lanes, np.int64),
        work,
    )
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
                        loose[p, m] = 0
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
                tangent[e, m] = bending[p, m] + 2.0 / 3.0 * c_hertz / y
                shift[e, m] = c_hertz * y * y / 3.0
        # Forces without the next step of the redundants.
        for w in range(s.arcs.shape[0]):
            for m in range(lanes):
                before[w, m] = force[s.arcs[w, 0], m]
        for e in range(contacts):
            for m in range(lanes):
                force[e, m] = fixed[e, m]
            for c in range(r):
                weight = s.redundant[springs + e, c]
                for m in range(lanes):
                    force[e, m] += weight * z[c, m]
        for c in range(r):
            for m in range(lanes):
                right[c, m] = base[c, m]
            for d in range(r):
                weight = s.springs_matrix[c, d]
                for m in range(lanes):
                    right[c, m] -= weight * z[d, m]
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
            for t in range(turning):
                d = s.turning[t]
                for e in range(contacts):
                    weight = s.particular[d, springs + e]
                    for m in range(lanes):
                        force[e, m] += weight * load[t, m]
                for c in range(r):
                    weight = s.springs_moved[d, c]
                    for m in range(lanes):
                        right[c, m] -= weight * load[t, m]
        # Redundants from compatibility.
        for e in range(contacts):
            for m in range(lanes):
                top[m] = gap[e, m] + shift[e, m] + tangent[e, m] * force[e, m]
            for c in range(r):
                weight = s.redundant[springs + e, c]
                for m in range(lanes):
                    right[c, m] -= weight * top[m]
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
                    for p in range(powers):
                        e = s.power[p]
                        weight = s.redundant[springs + e, c] * s.redundant[springs + e, d]
                        for m in range(lanes):
                            matrix[c, d, m] += weight * tangent[e, m]
            _solve(matrix, right, lanes, singular)
        for m in range(lanes):
            largest[m] = 0.0
            strongest[m] = 0.0
            weakest[m] = 0.0
            waits[m] = False
            step[m] = 0.0
            law_misfit[m] = 0.0
            lost[m] = False
        for c in range(r):
            for m in range(lanes):
                z[c, m] += right[c, m]
                y = abs(right[c, m])
                step[m] = y if y > step[m] else step[m]
        for e in range(contacts):
            for c in range(r):
                weight = s.redundant[springs + e, c]
                for m in range(lanes):
                    force[e, m] += weight * right[c, m]
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
                touching = f > 0.0 and moved > 0.0
                target = moved if touching else 1.0
                bound = np.sqrt(target * inverse_hertz[p, m])
                y = root[p, m]
                y = y if y < bound else bound
                more = ((b * y + c_hertz) * y * y - target) / ((3.0 * b * y + 2.0 * c_hertz) * y)
                y -= more
                y = y if y < bound else bound
                more = ((b * y + c_hertz) * y * y - target) / ((3.0 * b * y + 2.0 * c_hertz) * y)
                y -= more
                # What the tangent leaves: the law's true compression, expanded about the root.
                gone = abs(f - y * y * y) * (b + 2.0 / 3.0 * c_hertz / y)
                more = abs(more)
                gone = gone if more <= CLOSE * y else target
                gone = gone if touching else 0.0
                waits[m] = waits[m] or (not touching and root[p, m] > floor[m])
                law_misfit[m] = gone if gone > law_misfit[m] else law_misfit[m]
                carries = abs(f) > SIGN * push[m]
                loose[p, m] = 0 if touching or not carries else loose[p, m] + 1
                lost[m] = lost[m] or loose[p, m] >= patience[m]
                y = y if touching else SHRINK * root[p, m]
                root[p, m] = y if y > floor[m] else floor[m]
        for m in range(lanes):
            law_misfit[m] /= largest[m] if largest[m] > 0.0 else 1.0
            misfit[m] = 1.0 if waits[m] else law_misfit[m] * (SETTLED / LAW)
        if turning > 0:
            # Arcs turn as their centres move: both have to stand still.
            for m in range(lanes):
                y = step[m] / (strongest[m] if strongest[m] > 0.0 else 1.0)
                misfit[m] = y if y > misfit[m] else misfit[m]
                step[m] = 0.0
                top[m] = 0.0
            for t in range(turning):
                d = s.turning[t]
                for m in range(lanes):
                    margin[m] = 0.0
                for e in range(springs):
                    weight = s.particular[d, e]
                    if weight != 0.0:
                        for m in range(lanes):
                            margin[m] += weight * spring[e, m]
                for e in range(contacts):
                    weight = s.particular[d, springs + e]
                    if weight != 0.0:
                        for m in range(lanes):
                            margin[m] += weight * stretch[e, m]
                for c in range(r):
                    weight = s.springs_moved[d, c]
                    for m in range(lanes):
                        margin[m] += weight * z[c, m]
                for w in range(turning):
                    weight = s.springs_moved[d, r + s.turning[w]]
                    for m in range(lanes):
                        margin[m] += weight * load[w, m]
                for m in range(lanes):
                    y, moved = abs(margin[m]), abs(margin[m] - x[d, m])
                    step[m] = moved if moved > step[m] else step[m]
                    top[m] = y if y > top[m] else top[m]
                    x[d, m] = margin[m]
            for m in range(lanes):
                y = step[m] / (top[m] if top[m] > 0.0 else 1.0)
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
            if not (settled or pulled or lost[m]):
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
