"""Arcs of drums: their margins and normals, and the effect of their turning faces."""

from __future__ import annotations

import numpy as np

from loadshare.settings import SIDE_BY_SIDE
from loadshare.solver.hot.kernel.options import bare
from loadshare.solver.hot.kernel.sums import add_product
from loadshare.solver.hot.kernel.work import TURN


@bare
def arc(s, samples, a, x, width, normal, margin, size):  # type: ignore[no-untyped-def]
    """Write margins (width,) and normals (3, width) of an arc at x; see `contact.arc.Arc`."""
    varying = s.shift.shape[0] > 1
    varying_clearance = s.clearance.shape[0] > 1
    for c in range(3):
        for m in range(width):
            normal[c, m] = s.shift[samples[m] if varying else 0, a, c]
        for at_coordinate in range(s.arc_starts[a], s.arc_starts[a + 1]):
            d = s.arc_coordinates[at_coordinate]
            along = s.relative[a, c, d]
            for m in range(width):
                normal[c, m] += along * x[d, m]
    distance = 0.0
    for c in range(3):
        distance += s.nominal[a, c] * s.nominal[a, c]
    distance = np.sqrt(distance)
    for m in range(width):
        size[m] = 0.0
        margin[m] = 0.0
    for c in range(3):
        nominal = s.nominal[a, c]
        for m in range(width):
            moved = normal[c, m]
            margin[m] += (2.0 * nominal + moved) * moved
            normal[c, m] = nominal + moved
            size[m] += normal[c, m] * normal[c, m]
    for m in range(width):
        size[m] = np.sqrt(size[m])
        margin[m] /= size[m] + distance
        size[m] = 1.0 / size[m]
    for c in range(3):
        for m in range(width):
            normal[c, m] *= size[m]
    for m in range(width):
        ahead = s.nominal[a, 0] * normal[0, m]
        ahead += s.nominal[a, 1] * normal[1, m] + s.nominal[a, 2] * normal[2, m]
        if ahead <= 0.0:
            margin[m] = ahead / (size[m] * distance) - distance
            for c in range(3):
                normal[c, m] = s.nominal[a, c] / distance
    for m in range(width):
        margin[m] += s.clearance[samples[m] if varying_clearance else 0, a]


@bare
def turn_arcs(s, work, width):  # type: ignore[no-untyped-def]
    """Renew the arcs' gaps at the coordinates, and the load due to the turn of their faces."""
    load, x, gap, before, go = work.load, work.x, work.gap, work.before, work.go
    for t in range(s.turning.shape[0]):
        for m in range(width):
            load[t, m] = 0.0 if go[m] > 0.0 else load[t, m]
    for w in range(s.arcs.shape[0]):
        contact, a = s.arc_contacts[w], s.arcs[w]
        arc(s, work.samples, a, x, width, work.normal, work.one, work.two)
        for m in range(width):
            before[w, m] = work.force[contact, m]
            gap[contact, m] += go[m] * (work.one[m] - gap[contact, m])
        for t in range(s.turning.shape[0]):
            d = s.turning[t]
            along = s.base[w, d]
            for m in range(width):
                gap[contact, m] += go[m] * along * x[d, m]
                face = along
                for c in range(3):
                    face += work.normal[c, m] * s.relative[a, c, d]
                load[t, m] += go[m] * before[w, m] * face


@bare
def follow_arcs(s, work, distance, width):  # type: ignore[no-untyped-def]
    """Move the coordinates on which arcs depend; include the arcs' remaining turn in the misfit."""
    step, moved, shrinks = work.one, work.moved, s.turning_radials.shape[0] == 0
    for m in range(width):
        step[m] = 0.0
    for t in range(moved.shape[0]):
        for m in range(width):
            moved[t, m] = work.still[t, m]
    add_product(moved, s.moved, work.stretch, width)
    add_product(moved, s.moved_redundant, work.z, width)
    add_product(moved, s.moved_turned, work.load, width)
    for t in range(moved.shape[0]):
        d = s.turning[t]
        for m in range(width):
            y = abs(moved[t, m] - work.x[d, m])
            step[m] = y if y > step[m] else step[m]
            work.x[d, m] = moved[t, m] if work.go[m] > 0.0 else work.x[d, m]
    for w in range(s.arcs.shape[0]):
        # The face was turned with the force of the previous pass.
        for m in range(width):
            f = abs(work.force[s.arc_contacts[w], m] - work.before[w, m])
            strongest = work.strongest[m] if work.strongest[m] > 0.0 else 1.0
            y = f / strongest * (SIDE_BY_SIDE.steepest / SIDE_BY_SIDE.turned * distance)
            step[m] = y if y > step[m] else step[m]
    for m in range(width):
        # Every pass turns arcs by about the same share of their previous turn. Splines respond to
        # each turn more than springs do.
        y = step[m] * (SIDE_BY_SIDE.turned / distance)
        before = work.each[TURN, m]
        rest = y * min(max(y / before, SIDE_BY_SIDE.least), 1.0) if shrinks and before > 0.0 else y
        work.each[TURN, m] = y
        work.misfit[m] = rest if rest > work.misfit[m] else work.misfit[m]
