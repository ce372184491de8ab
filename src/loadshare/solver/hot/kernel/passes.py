"""Newton passes of samples side by side until they have settled or need another set."""

from __future__ import annotations

import numpy as np

from loadshare.settings import HOT, SIDE_BY_SIDE
from loadshare.solver.hot.kernel import work as at
from loadshare.solver.hot.kernel.arcs import follow_arcs, turn_arcs
from loadshare.solver.hot.kernel.laws import renew_laws, renew_tables
from loadshare.solver.hot.kernel.options import bare
from loadshare.solver.hot.kernel.radials import follow_radials, lengthen, turn_radials
from loadshare.solver.hot.kernel.sums import add_product, solve


@bare
def _matrix(s, work, width):  # type: ignore[no-untyped-def]
    """Write the lower triangle of the redundants' matrix where it or its factor is not zero.

    Every slip adds a border.
    """
    r, matrix, tangent = s.redundant.shape[1], work.matrix, work.tangent
    entry = 0
    for c in range(r):
        for k in range(s.below_starts[c] - 1, s.below_starts[c + 1]):
            d = s.below[k] if k >= s.below_starts[c] else c
            if d >= r:
                break
            for m in range(width):
                matrix[d, c, m] = work.linear[entry, m]
            for i in range(s.product_starts[entry], s.product_starts[entry + 1]):
                weight, e = s.products[i], s.product_contacts[i]
                for m in range(width):
                    matrix[d, c, m] += weight * tangent[e, m]
            entry += 1
    for t in range(s.turning_radials.shape[0]):
        law = work.radial[t]
        excess = work.one
        for m in range(width):
            excess[m] = law[at.INNER, m] - law[at.OUTER, m]
        for c in range(r):
            for k in range(s.below_starts[c] - 1, s.below_starts[c + 1]):
                d = s.below[k] if k >= s.below_starts[c] else c
                if d >= r:
                    break
                for m in range(width):
                    matrix[d, c, m] += excess[m] * work.along[t, c, m] * work.along[t, d, m]
        border = s.borders[t]
        if border >= 0:
            p, q = work.force[2 * t], work.force[2 * t + 1]
            for m in range(width):
                held = law[at.DU, m] * p[m] + law[at.DV, m] * q[m]
                work.right[r + border, m] = work.go[m] * (law[at.BOUND, m] - held)
            for c in range(r):
                for m in range(width):
                    matrix[r + border, c, m] = work.along[t, c, m]
            for d in range(border + 1):
                for m in range(width):
                    matrix[r + border, r + d, m] = 0.0


@bare
def _pass(s, work, width):  # type: ignore[no-untyped-def]
    """Make one Newton pass: redundants from compatibility, then forces and compressions."""
    r = s.redundant.shape[1]
    force, stretch, tangent, shift = work.force, work.stretch, work.tangent, work.shift
    z, right = work.z, work.right[:r]
    turning, pairs = s.turning.shape[0], s.turning_radials.shape[0]
    if turning > 0:
        turn_arcs(s, work, width)
    if pairs > 0:
        turn_radials(s, work, width)
    for c in range(r):
        for m in range(width):
            right[c, m] = work.base[c, m]
    add_product(right, s.springs_matrix, z, width)
    for e in range(s.contacts.shape[0]):
        for m in range(width):
            force[e, m] = work.fixed[e, m]
    add_product(force, s.redundant, z, width)
    if turning > 0:
        add_product(right, s.turned_gap, work.load, width)
        add_product(force, s.turned, work.load, width)
    for e in range(s.contacts.shape[0]):
        for m in range(width):
            stretch[e, m] = work.gap[e, m] + shift[e, m] + tangent[e, m] * force[e, m]
    lengthen(work.radial, force, stretch, width)
    add_product(right, s.across, stretch, width)
    for c in range(r):
        for m in range(width):
            right[c, m] *= -work.go[m]
    if s.inverse.shape[0] > 0:
        for c in range(r):
            for m in range(width):
                work.matrix[0, c, m] = right[c, m]
        for c in range(r):
            for m in range(width):
                right[c, m] = 0.0
        add_product(right, s.inverse, work.matrix[0], width)
    else:
        _matrix(s, work, width)
        factor = s.below_starts, s.below
        solve(work.matrix, work.right, factor, r, width, work.singular, work.one, work.two)
        for t in range(pairs):
            if s.borders[t] >= 0:
                for m in range(width):
                    work.radial[t, at.EXTRA, m] += work.right[r + s.borders[t], m]
    for m in range(width):
        work.largest[m] = 0.0
        work.strongest[m] = 0.0
        work.weakest[m] = 0.0
    for c in range(r):
        for m in range(width):
            z[c, m] += right[c, m]
    add_product(force, s.redundant, right, width)
    for e in range(s.contacts.shape[0]):
        # Signs and compressions of radial elements are not looked at here.
        row = 1.0 if s.first_row <= e < s.end_row else 0.0
        for m in range(width):
            f = force[e, m]
            y = shift[e, m] + tangent[e, m] * f
            stretch[e, m] = work.gap[e, m] + y
            y = row * abs(y)
            work.largest[m] = y if y > work.largest[m] else work.largest[m]
            y = row * f
            work.weakest[m] = y if y < work.weakest[m] else work.weakest[m]
            f = abs(f)
            work.strongest[m] = f if f > work.strongest[m] else work.strongest[m]
    lengthen(work.radial, force, stretch, width)


@bare
def _judge(s, work, law_misfit, number, one_only, width):  # type: ignore[no-untyped-def]
    """Judge samples that have settled or need another set; return how many."""
    misfit, judged = work.misfit, 0
    for m in range(width):
        if work.live[m] == 0.0:
            continue
        stalled = number > 2 and misfit[m] <= HOT.stalled
        stalled = stalled and misfit[m] >= 0.5 * work.each[at.PREVIOUS, m]
        settled = misfit[m] <= HOT.settled or stalled
        work.each[at.PREVIOUS, m] = misfit[m]
        # A set that is clearly wrong need not be settled.
        pulled = law_misfit[m] <= HOT.nearly and not one_only[work.samples[m]]
        if work.each[at.DRIFTS, m] > 0.0:
            # Which element stops a drift first depends on how deep walls are pressed in.
            pulled = pulled and misfit[m] <= HOT.nearly * (HOT.settled / HOT.law)
        else:
            pulled = pulled and work.weakest[m] < -HOT.gross * work.strongest[m]
        # Samples with forces without bound or NaN are left undecided.
        burst = not work.strongest[m] <= HOT.burst * (work.push[m] if work.push[m] > 0.0 else 1.0)
        outside = False
        for t in range(s.turning_radials.shape[0]):
            outside = outside or work.radial[t, at.BEYONDS, m] >= HOT.outside
        hopeless = outside or work.longest[m] >= work.each[at.PATIENT, m]
        # Far outside its level piece a slipping element may leave a move that nothing resists.
        undecided = (work.singular[m] > 0.0 and not outside) or (burst and not settled)
        if settled or pulled or undecided or hopeless:
            sign = HOT.sign if settled else (HOT.gross if pulled else np.inf)
            work.each[at.BAND, m] = 0.0 if undecided else sign
            work.live[m], work.go[m] = 0.0, 1.0 if settled and not undecided else 0.0
            judged += 1
    return judged


@bare
def run(s, work, one_only, enough, width):  # type: ignore[no-untyped-def]
    """Make passes until no more than `enough` samples are live."""
    distance = np.inf
    for w in range(s.arcs.shape[0]):
        square = 0.0
        for c in range(3):
            square += s.nominal[s.arcs[w], c] ** 2
        distance = min(distance, np.sqrt(square))
    lives = 0
    for m in range(width):
        lives += work.live[m] > 0.0
    law_misfit, misfit = work.waits, work.misfit
    for number in range(SIDE_BY_SIDE.passes):
        if lives <= enough:
            break
        _pass(s, work, width)
        renew_laws(s, work, misfit, width)
        renew_tables(s, work, misfit, width)
        for m in range(width):
            # While a flank waits for its law, the laws of the sample count as unmet.
            law_misfit[m], waits = misfit[m], work.waits[m] > 0.0
            misfit[m] = 1.0 if waits else misfit[m] * (HOT.settled / HOT.law)
        follow_radials(s, work, misfit, width)
        if s.turning.shape[0] > 0:
            follow_arcs(s, work, distance, width)
        lives -= _judge(s, work, law_misfit, number, one_only, width)


@bare
def give_up(work, count):  # type: ignore[no-untyped-def]
    """End the passes of samples that have not settled.

    Those whose laws are nearly met are still judged by signs that are clearly wrong.
    """
    for m in range(count):
        if work.live[m] > 0.0:
            nearly = work.misfit[m] <= HOT.nearly * HOT.settled / HOT.law
            work.live[m], work.each[at.BAND, m] = 0.0, HOT.gross if nearly else 0.0
            work.go[m], work.each[at.GIVEN_UP, m] = 0.0, 1.0
