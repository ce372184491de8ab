"""Loading of samples into the work arrays: statics, and laws at the samples' iterates."""

from __future__ import annotations

import numpy as np

from loadshare.settings import HOT, SIDE_BY_SIDE
from loadshare.solver.hot.contact_states import STICK
from loadshare.solver.hot.kernel import work as at
from loadshare.solver.hot.kernel.laws import piece
from loadshare.solver.hot.kernel.options import bare
from loadshare.solver.hot.kernel.radials import renew_bound
from loadshare.solver.hot.kernel.sums import add_product, approach, clear


@bare
def fill(s, work, given, waiting, first, count, width):  # type: ignore[no-untyped-def]
    """Load samples side by side; the rest of the width repeats the last of them."""
    samples = work.samples
    for m in range(width):
        row = waiting[first + min(m, count - 1)]
        work.at_row[m], samples[m] = row, given.rows[row]
    for m in range(width):
        i = samples[m]
        work.floor[m] = given.floors[i]
        work.each[at.PATIENT, m] = HOT.patience if given.one_only[i] else SIDE_BY_SIDE.patience
        work.live[m], work.go[m] = 1.0 if m < count else 0.0, 1.0
        work.each[at.BAND, m], work.each[at.DRIFTS, m], work.singular[m] = 0.0, 0.0, 0.0
        work.each[at.PREVIOUS, m], work.each[at.TURN, m], work.each[at.GIVEN_UP, m] = (
            np.inf,
            0.0,
            0.0,
        )
    _load(s, work, width)
    _statics(s, work, width)
    _laws(s, work, width, given.xs, given.forces, given.roots)
    _radials(s, work, width, given.xs, given.forces)
    _linear(s, work, width)


@bare
def _load(s, work, width):  # type: ignore[no-untyped-def]
    """Write the loads, the largest of them, and whether they drive an unresisted move."""
    samples, weight, push = work.samples, work.weight, work.push
    varying = s.load.shape[0] > 1
    for m in range(width):
        push[m] = 0.0
    for k in range(s.loaded.shape[0]):
        d = s.loaded[k]
        for m in range(width):
            f = s.load[samples[m] if varying else 0, d]
            weight[k, m] = f
            push[m] = max(push[m], abs(f))
    for c in range(s.loose.shape[1]):
        for m in range(width):
            drift = 0.0
            for k in range(s.loaded.shape[0]):
                drift += s.loose[s.loaded[k], c] * weight[k, m]
            if abs(drift) > HOT.drift * push[m]:
                work.each[at.DRIFTS, m] = 1.0


@bare
def _statics(s, work, width):  # type: ignore[no-untyped-def]
    """Write forces without redundants, gaps, and the linear part of the laws."""
    samples, weight, statics = work.samples, work.weight, work.spring[at.STATICS]
    one_gap, one_bending = s.gap.shape[0] == 1, s.bending.shape[0] == 1
    for e in range(s.springs.shape[0]):
        for m in range(width):
            statics[e, m] = 0.0
        for k in range(s.loaded.shape[0]):
            per_load = s.particular_springs[s.loaded[k], e]
            if per_load == 0.0:
                continue
            for m in range(width):
                statics[e, m] += per_load * weight[k, m]
        compliance, column = s.compliances[e], s.springs[e]
        for m in range(width):
            gap = s.gap[0 if one_gap else samples[m], column]
            work.spring[at.STILL, e, m] = gap + compliance * statics[e, m]
    for e in range(s.contacts.shape[0]):
        column = s.contacts[e]
        for m in range(width):
            work.fixed[e, m] = 0.0
            work.shift[e, m] = 0.0
            work.gap[e, m] = s.gap[0 if one_gap else samples[m], column]
            work.tangent[e, m] = s.bending[0 if one_bending else samples[m], column]
        for k in range(s.loaded.shape[0]):
            per_load = s.particular[s.loaded[k], e]
            if per_load == 0.0:
                continue
            for m in range(width):
                work.fixed[e, m] += per_load * weight[k, m]


@bare
def _laws(s, work, width, xs, forces, roots):  # type: ignore[no-untyped-def]
    """Begin with the laws and the arcs at the samples' iterates."""
    samples, first_row = work.samples, s.first_row
    one_hertz = s.hertz.shape[0] == 1
    for p in range(s.powers):
        e = first_row + p
        column = s.contacts[e]
        for m in range(width):
            b, c_hertz = work.tangent[e, m], s.hertz[0 if one_hertz else samples[m], column]
            y = roots[samples[m], column]
            work.bending[p, m], work.hertz[p, m] = b, c_hertz
            work.root[p, m], work.loose[p, m] = y, 0.0
            work.tangent[e, m] = b + 2.0 / 3.0 * c_hertz / y
            work.shift[e, m] = c_hertz * y * y / 3.0
    for p in range(s.tables_of.shape[0]):
        e = first_row + s.powers + p
        for m in range(width):
            i = samples[m]
            force = roots[i, s.contacts[e]] ** 3
            table = s.tables[i if s.tables.shape[0] > 1 else 0, s.tables_of[p]]
            at_force, at_start, slope = piece(table[0], table[1], force)
            work.reached[p, m] = force
            work.tangent[e, m], work.shift[e, m] = slope, at_start - slope * at_force
    for w in range(s.arcs.shape[0]):
        contact = s.arc_contacts[w]
        for m in range(width):
            work.force[contact, m] = forces[samples[m], s.contacts[contact]]
    for d in s.turning:
        for m in range(width):
            work.x[d, m] = xs[samples[m], d]


@bare
def _radials(s, work, width, xs, forces):  # type: ignore[no-untyped-def]
    """Begin with the radial elements at the samples' iterates."""
    samples = work.samples
    for j in range(s.radial_at.shape[0]):
        e = s.radial_at[j]
        if e >= s.end_row and s.states[s.first_radial - s.first_column + j] == STICK:
            for m in range(width):
                first = s.radial[samples[m] if s.radial.shape[0] > 1 else 0, j, 0]
                work.tangent[e, m] = work.tangent[e + 1, m] = 1.0 / first
    pairs = s.turning_radials.shape[0]
    if pairs > 0:
        for e in range(s.contacts.shape[0]):
            for m in range(width):
                work.force[e, m] = forces[samples[m], s.contacts[e]]
        for d in s.coordinates[s.starts[s.first_radial] :]:
            for m in range(width):
                work.x[d, m] = xs[samples[m], d]
    for t in range(pairs):
        j = s.turning_radials[t]
        column = s.first_radial + 2 * j
        approach(s, samples, column, work.x, width, work.radial[t, at.U])
        approach(s, samples, column + 1, work.x, width, work.radial[t, at.V])
        for m in range(width):
            work.radial[t, at.EXTRA, m] = 0.0
            work.radial[t, at.BEYONDS, m] = 0.0
        renew_bound(s, work, t, width)


@bare
def _linear(s, work, width):  # type: ignore[no-untyped-def]
    """Set redundants to zero; write what linear elements add to their matrix and their gaps."""
    renewed = s.first_row + s.powers + s.tables_of.shape[0]
    clear(work.z, width)
    clear(work.base, width)
    add_product(work.base, s.across_springs, work.spring[at.STILL], width)
    clear(work.still, width)
    add_product(work.still, s.moved_springs, work.spring[at.STILL], width)
    if s.inverse.shape[0] > 0:
        return
    for entry in range(work.linear.shape[0]):
        for m in range(width):
            work.linear[entry, m] = s.springs_entries[entry]
    add_product(work.linear, s.products_still, work.tangent[renewed:], width)
