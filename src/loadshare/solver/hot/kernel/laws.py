"""Power laws and tables: the next tangents, and the misfit of the last ones."""

from __future__ import annotations

import numpy as np

from loadshare.settings import HOT, SIDE_BY_SIDE
from loadshare.solver.hot.kernel.options import bare


@bare
def piece(axis, values, where):  # type: ignore[no-untyped-def]
    """Return start on the axis, start value and slope of the table piece that holds `where`."""
    k = 0
    while k + 2 < axis.shape[0] and axis[k + 1] <= where and not np.isnan(axis[k + 2]):
        k += 1
    return axis[k], values[k], (values[k + 1] - values[k]) / (axis[k + 1] - axis[k])


@bare
def renew_laws(s, work, misfit, width):  # type: ignore[no-untyped-def]
    """Take the next tangents at the forces; write the laws' relative misfit (width,)."""
    for m in range(width):
        misfit[m] = 0.0
        work.waits[m] = 0.0
        work.longest[m] = 0.0
    for p in range(s.powers):
        e = s.first_row + p
        for m in range(width):
            f = work.force[e, m]
            moved = work.shift[e, m] + work.tangent[e, m] * f
            b, c_hertz, now = work.bending[p, m], work.hertz[p, m], work.root[p, m]
            touching = (f > 0.0) & (moved > 0.0)
            target = f if touching else 1.0
            # Halley's method, twice, for the cube root of the force.
            cube = now * now * now
            y = now * (cube + 2.0 * target) / (2.0 * cube + target)
            cube = y * y * y
            more = y
            y *= (cube + 2.0 * target) / (2.0 * cube + target)
            more = abs(more - y)
            # Misfit between the tangent and the law.
            gone = abs((b * y + c_hertz) * y * y - moved)
            gone += 0.0 if more <= SIDE_BY_SIDE.close * y else 2.0 * c_hertz * y * more
            gone = gone if touching else 0.0
            misfit[m] = gone if gone > misfit[m] else misfit[m]
            waiting = 0.0 if touching | (now <= work.floor[m]) else 1.0
            work.waits[m] = waiting if waiting > work.waits[m] else work.waits[m]
            idle = abs(f) <= HOT.sign * work.push[m]
            since = 0.0 if touching | idle else work.loose[p, m] + 1.0
            work.loose[p, m] = since
            work.longest[m] = since if since > work.longest[m] else work.longest[m]
            y = y if touching else HOT.shrink * now
            y = y if y > work.floor[m] else work.floor[m]
            y = y if work.go[m] > 0.0 else now
            work.root[p, m] = y
            work.tangent[e, m] = b + 2.0 / 3.0 * c_hertz / y
            work.shift[e, m] = c_hertz * y * y / 3.0
    for m in range(width):
        misfit[m] /= work.largest[m] if work.largest[m] > 0.0 else 1.0


@bare
def renew_tables(s, work, misfit, width):  # type: ignore[no-untyped-def]
    """Take the next pieces of tables at the compressions; include them in the relative misfit."""
    for p in range(s.tables_of.shape[0]):
        e = s.first_row + s.powers + p
        for m in range(width):
            moved = work.stretch[e, m] - work.gap[e, m]
            table = s.tables[work.samples[m] if s.tables.shape[0] > 1 else 0, s.tables_of[p]]
            at_start, at_force, slope = piece(table[1], table[0], moved)
            compliance = 1.0 / slope
            shift = at_start - compliance * at_force
            gone = abs(shift + compliance * work.force[e, m] - moved)
            gone /= work.largest[m] if work.largest[m] > 0.0 else 1.0
            misfit[m] = gone if gone > misfit[m] else misfit[m]
            if work.go[m] > 0.0:
                work.tangent[e, m], work.shift[e, m] = compliance, shift
                work.reached[p, m] = max(at_force + slope * (moved - at_start), 0.0)
