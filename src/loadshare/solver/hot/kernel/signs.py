"""Elements with the wrong sign, and the set that corrects them."""

from __future__ import annotations

import numpy as np

from loadshare.settings import HOT
from loadshare.solver.hot import contact_states as at
from loadshare.solver.hot.kernel.arcs import arc
from loadshare.solver.hot.kernel.options import bare
from loadshare.solver.hot.kernel.radials import graph, torque_of
from loadshare.solver.hot.kernel.sums import approach
from loadshare.solver.hot.kernel.work import BAND, BEYONDS


@bare
def look_at_rows(s, work, width):  # type: ignore[no-untyped-def]
    """Mark rows with the wrong sign, (rows, width), and count them.

    `strongest` and `weakest` are set to the largest force and length of a sample, to which the
    violations of signs are compared.
    """
    samples, x, force, wrong, count = work.samples, work.x, work.force, work.wrong, work.mistakes
    strongest, longest, approach_per_offset = work.strongest, work.weakest, work.waits
    force_band, length_band = work.two, work.three
    for m in range(width):
        strongest[m] = work.push[m]
        longest[m] = 0.0
        count[m] = 0
    for e in range(force.shape[0]):
        for m in range(width):
            f = abs(force[e, m])
            strongest[m] = f if f > strongest[m] else strongest[m]
    for d in range(x.shape[0]):
        for m in range(width):
            y = abs(x[d, m])
            longest[m] = y if y > longest[m] else longest[m]
    for m in range(width):
        y = HOT.of_way * longest[m]
        longest[m] = y if y > work.largest[m] else work.largest[m]
        force_band[m] = work.each[BAND, m] * strongest[m]
        length_band[m] = work.each[BAND, m] * longest[m]
    for e in range(s.first_row, s.end_row):
        row = s.switches[e - s.first_row]
        for m in range(width):
            off = force[e, m] < -force_band[m]
            wrong[row, m] = off
            count[m] += off
    for o in range(s.open_rows.shape[0]):
        row = s.open_rows[o]
        approach(s, samples, s.first_column + row, x, width, approach_per_offset)
        for m in range(width):
            off = approach_per_offset[m] > length_band[m]
            wrong[row, m] = off
            count[m] += off
    for o in range(s.open_arcs.shape[0]):
        a = s.open_arcs[o]
        row = s.flanks + a
        arc(s, samples, a, x, width, work.normal, approach_per_offset, work.one)
        for m in range(width):
            off = -approach_per_offset[m] > length_band[m]
            wrong[row, m] = off
            count[m] += off


@bare
def right_state(status, law, u, v, p, q, force_band, length_band, faint):  # type: ignore[no-untyped-def]
    """Return the right state of a radial element, possibly its own; see `radials.right_state`."""
    first, stick, bound, reach, last, _ = law
    radius, size = np.sqrt(u * u + v * v), np.sqrt(p * p + q * q)
    jump = bound > first * stick * (1.0 + HOT.rounded)
    beyond = at.STOP
    if np.isinf(last):
        beyond = at.WALL if reach > 0.0 else at.PINNED
    rubs = bound > faint
    level = (at.SLIP if rubs else at.OPEN) if reach > stick else beyond
    back = at.PINNED
    if bound == 0.0 and reach > 0.0:
        back = at.OPEN
    elif stick > 0.0:
        back = at.CORNER if jump else at.STICK
    inward = u * p + v * q < 0.0
    if status == at.OPEN:
        if radius > reach + length_band:
            return beyond
        if rubs and radius > length_band:
            return at.STICK if radius < stick else level
        return at.OPEN
    if status == at.STICK:
        if size <= first * stick + force_band:
            return at.STICK
        gone = beyond if radius > reach + length_band else level
        return at.CORNER if jump else gone
    if status == at.CORNER:
        if inward or size < first * stick - force_band:
            return at.STICK
        return level if size > bound + force_band else at.CORNER
    if status == at.PINNED:
        yields = bound > 0.0 or reach > 0.0 or np.isfinite(last)
        return level if size > bound + force_band and yields else at.PINNED
    if status == at.SLIP:
        if not rubs:
            return level
        if radius < stick - length_band or inward:
            return back
        return beyond if radius > reach + length_band else at.SLIP
    if status == at.STOP:
        if (radius < reach - length_band or inward) and reach > 0.0:
            # A stop that carries almost nothing sticks: it does not use up its friction.
            slips = reach > stick and radius >= stick and size > HOT.gross * bound
            return level if slips else back
        return at.STOP
    # A wall may hold a float with almost no force.
    return at.OPEN if inward or size <= faint else at.WALL


@bare
def look_at_radials(s, work, width):  # type: ignore[no-untyped-def]
    """Find the right states of radial elements, and count the elements with another state.

    `strongest` and `weakest` hold the largest force and length, as set by `look_at_rows`.
    """
    u, v, torque = work.two, work.three, work.one
    for j in range(s.radial_at.shape[0]):
        e, status = s.radial_at[j], s.states[s.first_radial - s.first_column + j]
        column = s.first_radial + 2 * j
        approach(s, work.samples, column, work.x, width, u)
        approach(s, work.samples, column + 1, work.x, width, v)
        torque_of(s.follows[j], s.carried[j], work.force, width, torque)
        turns = 0 <= e < s.first_row
        for m in range(width):
            work.better[j, m] = status
            sign = work.each[BAND, m]
            radius = np.sqrt(u[m] * u[m] + v[m] * v[m])
            law = graph(s, work.samples[m], j, torque[m], radius)
            if e >= 0 and not law[5]:
                work.each[BAND, m] = 0.0
            if sign == 0.0:
                continue
            if sign > 1.0:
                # Not settled: only an element that has left its level piece is judged.
                if not turns or work.radial[e // 2, BEYONDS, m] < HOT.outside:
                    continue
                sign = HOT.sign
            force_band, length_band = sign * work.strongest[m], sign * work.weakest[m]
            faint = HOT.sign * work.strongest[m]
            p = work.force[e, m] if e >= 0 else 0.0
            q = work.force[e + 1, m] if e >= 0 else 0.0
            better = right_state(status, law, u[m], v[m], p, q, force_band, length_band, faint)
            work.better[j, m] = better
            work.mistakes[m] += better != status


@bare
def propose(states, wrong, better, m, one_only, proposal):  # type: ignore[no-untyped-def]
    """Write the set that corrects the wrong elements of a sample."""
    rows = wrong.shape[0]
    for row in range(states.shape[0]):
        proposal[row] = states[row]
    for row in range(states.shape[0]):
        if row < rows:
            if not wrong[row, m]:
                continue
            proposal[row] = at.OPEN if states[row] != at.OPEN else at.CLOSED
        else:
            if better[row - rows, m] == states[row]:
                continue
            proposal[row] = better[row - rows, m]
        if one_only:
            break


@bare
def stopped(s, work, m, width, proposal, place_of):  # type: ignore[no-untyped-def]
    """Propose the element that first stops the drift of a sample, and move the sample there.

    From another start the passes may end at the far side of a ring, held inward.
    """
    i, n, drift, x = work.samples[m], work.x.shape[0], work.drift, work.x
    load = s.load[i if s.load.shape[0] > 1 else 0]
    gap = s.gap[i if s.gap.shape[0] > 1 else 0]
    fast = 0.0
    for d in range(n):
        drift[d] = 0.0
    for c in range(s.loose.shape[1]):
        along = 0.0
        for d in range(n):
            along += s.loose[d, c] * load[d]
        for d in range(n):
            drift[d] += along * s.loose[d, c]
    for d in range(n):
        fast = max(fast, HOT.drift * abs(drift[d]))
    nearest, first, status = np.inf, -1, at.CLOSED
    rows, open_rows = work.wrong.shape[0], s.open_rows.shape[0]
    for row in range(s.states.shape[0]):
        proposal[row] = s.states[row]
    for o in range(open_rows + s.open_arcs.shape[0]):
        row = s.open_rows[o] if o < open_rows else s.flanks + s.open_arcs[o - open_rows]
        column = s.first_column + row
        speed, left = 0.0, gap[column]
        for c in range(s.starts[column], s.starts[column + 1]):
            speed += s.entries[c] * drift[s.coordinates[c]]
            left -= s.entries[c] * x[s.coordinates[c], m]
        if o >= open_rows:
            a = s.open_arcs[o - open_rows]
            arc(s, work.samples, a, x, width, work.normal, work.one, work.two)
            left = work.one[m]
        if speed > fast:
            way = max(left, 0.0) / speed
            if way < nearest:
                nearest, first = way, row
    for j in range(s.radial_at.shape[0]):
        if s.states[rows + j] != at.OPEN:
            continue
        column = s.first_radial + 2 * j
        approach(s, work.samples, column, x, width, work.one)
        approach(s, work.samples, column + 1, x, width, work.two)
        u, v, du, dv = work.one[m], work.two[m], 0.0, 0.0
        for c in range(s.starts[column], s.starts[column + 1]):
            du += s.entries[c] * drift[s.coordinates[c]]
        for c in range(s.starts[column + 1], s.starts[column + 2]):
            dv += s.entries[c] * drift[s.coordinates[c]]
        square, along = du * du + dv * dv, u * du + v * dv
        if square > fast * fast:
            torque_of(s.follows[j], s.carried[j], work.force, width, work.one)
            law = graph(s, i, j, work.one[m], np.sqrt(u * u + v * v))
            inside = max(law[3] * law[3] - u * u - v * v, 0.0)
            way = max((np.sqrt(along * along + square * inside) - along) / square, 0.0)
            if way < nearest:
                nearest, first = way, rows + j
                status = at.STOP
                if np.isinf(law[4]):
                    status = at.WALL if law[3] > 0.0 else at.PINNED
    if first < 0:
        return at.FAILED
    proposal[first] = status if first >= rows else at.CLOSED
    for d in range(n):
        place_of[d] += nearest * drift[d]
    return at.OTHER
