"""Samples whose passes have ended: their signs, verdicts and iterates."""

from __future__ import annotations

import numpy as np

from loadshare.settings import HOT, SIDE_BY_SIDE
from loadshare.solver.hot.contact_states import DONE, OTHER
from loadshare.solver.hot.kernel import work as at
from loadshare.solver.hot.kernel.options import bare
from loadshare.solver.hot.kernel.signs import look_at_radials, look_at_rows, propose, stopped
from loadshare.solver.hot.kernel.sums import add_product, clear


@bare
def conclude(s, work, given, count, width):  # type: ignore[no-untyped-def]
    """Judge the signs of samples that have settled, and store the iterate of every sample."""
    springs, force = s.springs.shape[0], work.force
    xs, forces, roots = given.xs, given.forces, given.roots
    verdict, proposal = given.verdict, given.proposal
    _refine(s, work, width)
    look_at_rows(s, work, width)
    look_at_radials(s, work, width)
    for m in range(count):
        i, row, sign = work.samples[m], work.at_row[m], work.each[at.BAND, m]
        if sign == 0.0 and work.live[m] == 0.0:
            continue
        for d in range(work.x.shape[0]):
            xs[i, d] = work.x[d, m]
        for column in range(forces.shape[1]):
            forces[i, column] = 0.0
        for e in range(springs):
            forces[i, s.springs[e]] = work.spring[at.STATICS, e, m]
        for e in range(s.contacts.shape[0]):
            forces[i, s.contacts[e]] = force[e, m]
        for p in range(s.powers):
            roots[i, s.contacts[s.first_row + p]] = work.root[p, m]
        for p in range(s.tables_of.shape[0]):
            roots[i, s.contacts[s.first_row + s.powers + p]] = np.cbrt(work.reached[p, m])
        if work.live[m] > 0.0:
            continue
        if sign == HOT.sign and work.mistakes[m] == 0 and work.each[at.DRIFTS, m] == 0.0:
            verdict[row] = DONE
            continue
        if sign == HOT.gross and work.mistakes[m] == 0 and work.each[at.GIVEN_UP, m] > 0.0:
            continue
        verdict[row] = OTHER
        if sign > HOT.sign and work.mistakes[m] == 0:
            # Passes that do not settle may still show which flank is open.
            for p in range(s.powers):
                if force[s.first_row + p, m] <= 0.0:
                    work.wrong[s.switches[p], m] = True
        propose(s.states, work.wrong, work.better, m, given.one_only[i], proposal[row])
        if work.each[at.DRIFTS, m] > 0.0:
            # Only the element that stops the drift is of interest.
            verdict[row] = stopped(s, work, m, width, proposal[row], xs[i])


@bare
def _refine(s, work, width):  # type: ignore[no-untyped-def]
    """Find spring forces and coordinates; leave samples undecided that are not compatible."""
    springs, total, moved = s.springs.shape[0], work.spring[at.TOTAL], work.spring[at.MOVED]
    r, yielded, misfit = s.redundant.shape[1], work.one, work.two
    for m in range(width):
        yielded[m] = work.largest[m]
        misfit[m] = 0.0
    clear(total, width)
    add_product(total, s.redundant_springs, work.z, width)
    add_product(total, s.turned_springs, work.load, width)
    for e in range(springs):
        held, compliance = work.spring[at.STATICS, e], s.compliances[e]
        for m in range(width):
            moved[e, m] = work.spring[at.STILL, e, m] + compliance * total[e, m]
            held[m] += total[e, m]
            f = abs(held[m])
            y = compliance * f
            work.largest[m] = y if y > work.largest[m] else work.largest[m]
            work.push[m] = f if f > work.push[m] else work.push[m]
    left = work.right[:r]
    clear(left, width)
    add_product(left, s.across_springs, moved, width)
    add_product(left, s.across, work.stretch, width)
    for c in range(r):
        for m in range(width):
            y = abs(left[c, m])
            misfit[m] = misfit[m] if y <= misfit[m] else y
    for m in range(width):
        closed = misfit[m] <= SIDE_BY_SIDE.closed_by * yielded[m] or yielded[m] == 0.0
        if work.each[at.BAND, m] == HOT.sign and not closed:
            # The matrix of the redundants was too stiff or too flat for this sample.
            work.each[at.BAND, m] = 0.0
    clear(work.x, width)
    add_product(work.x, s.particular_springs, moved, width)
    add_product(work.x, s.particular, work.stretch, width)
