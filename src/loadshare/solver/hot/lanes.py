"""Samples of a plain set side by side, compiled with Numba: the passes of `vectorised` in lanes.

Every loop that costs runs along the samples, so that the processor works on several of them at a
time. Lanes are filled together and emptied together; the few samples that take longer than the
others begin again beside one another, where they stand. Tangents are taken at the forces, which
here takes fewer passes than at the compressions. What is out of the ordinary (a drift, a singular
matrix, forces without bound, passes that do not settle) is left undecided, and `compiled` takes it
up one by one. No lane knows of its neighbours but for when a pass ends, so that an answer depends
on the company it was found in by no more than round-off.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from loadshare.compilation import jit, within
from loadshare.scene.data import Data
from loadshare.scene.elements import Elements
from loadshare.scene.scene import Array
from loadshare.scene.statics import Basis
from loadshare.settings import HOT, LANES
from loadshare.solver.hot import places as at
from loadshare.solver.hot.plain import Codes, Rows, plain_set
from loadshare.solver.hot.state import State

WIDTHS = (16, 32, 64)
"""Samples side by side: the first number that is enough, or the last."""
UNDECIDED = -1
"""Verdict on a sample that is left to `compiled`."""

OPEN, CLOSED, DONE, OTHER = at.OPEN, at.CLOSED, at.DONE, at.OTHER

_how: dict[str, Any] = {
    "nogil": True,
    "error_model": "numpy",
    "fastmath": {"reassoc", "contract", "nsz", "arcp"},
}
compiled = jit(**_how)
# Without counted references, which would cost more than the sums: nothing is allocated in these.
_uncounted: dict[str, Any] = {**_how, "_nrt": False}
bare = within(**_uncounted)


class _Room(NamedTuple):
    """Samples side by side; the last axis runs along the lanes."""

    samples: Rows
    at_row: Rows
    patience: Rows
    live: NDArray[np.bool_]
    go: Array  # 1 for a lane that is live, 0 for one that stands
    sign: Array  # band of the signs by which a lane is judged; 0 for one that is not
    push: Array  # largest load
    floor: Array
    weight: Array  # (loads, lanes)
    statics: Array  # (springs, lanes): forces without redundants and turned loads
    spring: Array  # (springs, lanes): gaps and compressions without them
    moved: Array  # (springs, lanes): gaps and compressions
    fixed: Array  # (contacts, lanes): as statics; so are the following
    gap: Array
    force: Array
    tangent: Array
    shift: Array
    stretch: Array  # gap and compression together
    bending: Array  # (p, lanes), as are the following
    hertz: Array
    root: Array
    loose: Array  # passes in a row without contact
    before: Array  # (arcs, lanes): forces of the pass before
    load: Array  # (turning, lanes): what the turned arcs add
    x: Array  # (n, lanes)
    z: Array  # (r, lanes)
    base: Array
    right: Array
    linear: Array  # (r, r, lanes)
    matrix: Array
    normal: Array  # (3, lanes)
    wrong: NDArray[np.bool_]  # (switches, lanes)
    mistakes: Rows
    singular: NDArray[np.bool_]
    previous: Array
    turn: Array
    misfit: Array
    largest: Array  # compression
    strongest: Array
    weakest: Array
    longest: Array
    waits: Array
    one: Array  # (lanes,) for passing use, as are the following
    two: Array
    three: Array


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
        plain_set(elements, data, basis, code),
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
    """Margins (lanes,) of an arc at x, and its normals (3, lanes); see `train.ring.Arc`."""
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
        ahead = s.nominal[a, 0] * normal[0, m]
        ahead += s.nominal[a, 1] * normal[1, m] + s.nominal[a, 2] * normal[2, m]
        if ahead <= 0.0:
            margin[m] = ahead / (work[m] * distance) - distance
            for c in range(3):
                normal[c, m] = s.nominal[a, c] / distance
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
            if not p > LANES.doubtful * largest[m]:
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
def _signs(s, room, lanes):  # type: ignore[no-untyped-def]
    """Mark what has the wrong sign, (rows, lanes), and count it."""
    samples, x, force, wrong, count = room.samples, room.x, room.force, room.wrong, room.mistakes
    force_band, length_band, approach = room.strongest, room.weakest, room.waits
    for m in range(lanes):
        force_band[m] = room.push[m]
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
        force_band[m] *= room.sign[m]
        y = 1e-3 * length_band[m]
        y = y if y > room.largest[m] else room.largest[m]
        length_band[m] = room.sign[m] * y
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
        _arc(s, samples, a, x, lanes, room.normal, approach, room.one)
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
def _fill(s, room, rows, waiting, first, count, lanes, xs, forces, roots, floors, one_only):  # type: ignore[no-untyped-def]
    """Put samples into the lanes; lanes that are left over repeat the last of them."""
    r, springs, powers = s.redundant.shape[1], s.springs, s.powers
    samples, tangent, weight = room.samples, room.tangent, room.weight
    one_load, one_gap = s.load.shape[0] == 1, s.gap.shape[0] == 1
    one_bending, one_hertz = s.bending.shape[0] == 1, s.hertz.shape[0] == 1
    for m in range(lanes):
        row = waiting[first + min(m, count - 1)]
        room.at_row[m], samples[m] = row, rows[row]
    for m in range(lanes):
        i = samples[m]
        room.floor[m] = floors[i]
        room.patience[m] = HOT.patience if one_only[i] else LANES.haste
        room.live[m], room.go[m], room.sign[m], room.singular[m] = m < count, 1.0, 0.0, False
        room.push[m], room.previous[m], room.turn[m] = 0.0, np.inf, np.inf
    for k in range(s.loaded.shape[0]):
        d = s.loaded[k]
        for m in range(lanes):
            f = s.load[0 if one_load else samples[m], d]
            weight[k, m] = f
            room.push[m] = max(room.push[m], abs(f))
    for c in range(s.loose.shape[1]):
        for m in range(lanes):
            drift = 0.0
            for k in range(s.loaded.shape[0]):
                drift += s.loose[s.loaded[k], c] * weight[k, m]
            if abs(drift) > HOT.drift * room.push[m]:
                room.live[m] = False
    for e in range(springs):
        for m in range(lanes):
            room.statics[e, m] = 0.0
        for k in range(s.loaded.shape[0]):
            per_load = s.particular[s.loaded[k], e]
            for m in range(lanes):
                room.statics[e, m] += per_load * weight[k, m]
        compliance = s.yields[e]
        for m in range(lanes):
            gap = s.gap[0 if one_gap else samples[m], e]
            room.spring[e, m] = gap + compliance * room.statics[e, m]
    for e in range(s.contacts.shape[0]):
        column = s.contacts[e]
        for m in range(lanes):
            room.fixed[e, m] = 0.0
            room.shift[e, m] = 0.0
            room.gap[e, m] = s.gap[0 if one_gap else samples[m], column]
            tangent[e, m] = s.bending[0 if one_bending else samples[m], column]
        for k in range(s.loaded.shape[0]):
            per_load = s.particular[s.loaded[k], springs + e]
            for m in range(lanes):
                room.fixed[e, m] += per_load * weight[k, m]
    for c in range(r):
        for m in range(lanes):
            room.z[c, m] = 0.0
            room.base[c, m] = 0.0
        _add(room.base[c], s.across[c, :springs], room.spring, lanes)
        for d in range(c + 1):
            for m in range(lanes):
                room.linear[c, d, m] = s.springs_matrix[c, d]
            _add(room.linear[c, d], s.products[c, d, powers:], tangent[powers:], lanes)
    for p in range(powers):
        column = s.contacts[p]
        for m in range(lanes):
            b, c_hertz = tangent[p, m], s.hertz[0 if one_hertz else samples[m], column]
            y = roots[samples[m], column]
            room.bending[p, m], room.hertz[p, m] = b, c_hertz
            room.root[p, m], room.loose[p, m] = y, 0.0
            tangent[p, m] = b + 2.0 / 3.0 * c_hertz / y
            room.shift[p, m] = c_hertz * y * y / 3.0
    for w in range(s.arcs.shape[0]):
        contact = s.arcs[w, 0]
        for m in range(lanes):
            room.force[contact, m] = forces[samples[m], s.contacts[contact]]
    for d in s.turning:
        for m in range(lanes):
            room.x[d, m] = xs[samples[m], d]


@bare
def _turn_arcs(s, room, lanes):  # type: ignore[no-untyped-def]
    """Gaps of the arcs where the coordinates are, and the load of what their faces have turned."""
    load, x, gap, before = room.load, room.x, room.gap, room.before
    for t in range(s.turning.shape[0]):
        for m in range(lanes):
            load[t, m] = 0.0
    for w in range(s.arcs.shape[0]):
        contact, a = s.arcs[w, 0], s.arcs[w, 1]
        _arc(s, room.samples, a, x, lanes, room.normal, room.one, room.two)
        for m in range(lanes):
            before[w, m] = room.force[contact, m]
            gap[contact, m] = room.one[m]
        for t in range(s.turning.shape[0]):
            d = s.turning[t]
            along = s.base[w, d]
            for m in range(lanes):
                gap[contact, m] += along * x[d, m]
                face = along
                for c in range(3):
                    face += room.normal[c, m] * s.relative[a, c, d]
                load[t, m] += before[w, m] * face


@bare
def _pass(s, room, lanes):  # type: ignore[no-untyped-def]
    """One Newton pass: redundants from compatibility, then forces and compressions."""
    r, springs, powers = s.redundant.shape[1], s.springs, s.powers
    force, stretch, tangent, shift = room.force, room.stretch, room.tangent, room.shift
    z, right, matrix = room.z, room.right, room.matrix
    turning = s.turning.shape[0]
    if turning > 0:
        _turn_arcs(s, room, lanes)
    for c in range(r):
        for m in range(lanes):
            right[c, m] = room.base[c, m]
        _add(right[c], s.springs_matrix[c], z, lanes)
        for t in range(turning):
            weight = s.springs_moved[s.turning[t], c]
            for m in range(lanes):
                right[c, m] += weight * room.load[t, m]
    for e in range(s.contacts.shape[0]):
        for m in range(lanes):
            force[e, m] = room.fixed[e, m]
        _add(force[e], s.redundant[springs + e], z, lanes)
        _add(force[e], s.turned[springs + e], room.load, lanes)
        for m in range(lanes):
            stretch[e, m] = room.gap[e, m] + shift[e, m] + tangent[e, m] * force[e, m]
    for c in range(r):
        _add(right[c], s.across[c, springs:], stretch, lanes)
        for m in range(lanes):
            right[c, m] *= -room.go[m]
    if s.inverse.shape[0] > 0:
        for c in range(r):
            for m in range(lanes):
                matrix[0, c, m] = right[c, m]
        for c in range(r):
            for m in range(lanes):
                right[c, m] = 0.0
            _add(right[c], s.inverse[c], matrix[0], lanes)
    else:
        for c in range(r):
            for d in range(c + 1):
                for m in range(lanes):
                    matrix[c, d, m] = room.linear[c, d, m]
                _add(matrix[c, d], s.products[c, d, :powers], tangent, lanes)
        _solve(matrix, right, lanes, room.singular, room.one, room.two)
    for m in range(lanes):
        room.largest[m] = 0.0
        room.strongest[m] = 0.0
        room.weakest[m] = 0.0
    for c in range(r):
        for m in range(lanes):
            z[c, m] += right[c, m]
    for e in range(s.contacts.shape[0]):
        _add(force[e], s.redundant[springs + e], right, lanes)
        for m in range(lanes):
            f = force[e, m]
            y = shift[e, m] + tangent[e, m] * f
            stretch[e, m] = room.gap[e, m] + y
            y = abs(y)
            room.largest[m] = y if y > room.largest[m] else room.largest[m]
            room.weakest[m] = f if f < room.weakest[m] else room.weakest[m]
            f = abs(f)
            room.strongest[m] = f if f > room.strongest[m] else room.strongest[m]


@bare
def _renew_laws(s, room, misfit, lanes):  # type: ignore[no-untyped-def]
    """Take the next tangents at the forces; write the laws' misfit, relative, (lanes,)."""
    for m in range(lanes):
        misfit[m] = 0.0
        room.waits[m] = 0.0
        room.longest[m] = 0.0
    for p in range(s.powers):
        for m in range(lanes):
            f, moved = room.force[p, m], room.stretch[p, m] - room.gap[p, m]
            b, c_hertz, now = room.bending[p, m], room.hertz[p, m], room.root[p, m]
            touching = (f > 0.0) & (moved > 0.0)
            target = f if touching else 1.0
            # Halley's method, twice, for the cube root of the force.
            cube = now * now * now
            y = now * (cube + 2.0 * target) / (2.0 * cube + target)
            cube = y * y * y
            more = y
            y *= (cube + 2.0 * target) / (2.0 * cube + target)
            more = abs(more - y)
            # What the tangent leaves of the law.
            gone = abs((b * y + c_hertz) * y * y - moved)
            gone += 0.0 if more <= LANES.close * y else 2.0 * c_hertz * y * more
            gone = gone if touching else 0.0
            misfit[m] = gone if gone > misfit[m] else misfit[m]
            waiting = 0.0 if touching | (now <= room.floor[m]) else 1.0
            room.waits[m] = waiting if waiting > room.waits[m] else room.waits[m]
            idle = abs(f) <= HOT.sign * room.push[m]
            since = 0.0 if touching | idle else room.loose[p, m] + 1.0
            room.loose[p, m] = since
            room.longest[m] = since if since > room.longest[m] else room.longest[m]
            y = y if touching else HOT.shrink * now
            y = y if y > room.floor[m] else room.floor[m]
            y = y if room.go[m] > 0.0 else now
            room.root[p, m] = y
            room.tangent[p, m] = b + 2.0 / 3.0 * c_hertz / y
            room.shift[p, m] = c_hertz * y * y / 3.0
    for m in range(lanes):
        misfit[m] /= room.largest[m] if room.largest[m] > 0.0 else 1.0


@bare
def _follow_arcs(s, room, distance, lanes):  # type: ignore[no-untyped-def]
    """Move the coordinates that arcs know of; add what arcs still turn to the misfit."""
    r, springs = s.redundant.shape[1], s.springs
    step, moved = room.one, room.two
    for m in range(lanes):
        step[m] = 0.0
    for d in s.turning:
        for m in range(lanes):
            moved[m] = 0.0
        _add(moved, s.particular[d, :springs], room.spring, lanes)
        _add(moved, s.particular[d, springs:], room.stretch, lanes)
        _add(moved, s.springs_moved[d, :r], room.z, lanes)
        _add(moved, s.springs_moved[d, r:], room.load, lanes)
        for m in range(lanes):
            y = abs(moved[m] - room.x[d, m])
            step[m] = y if y > step[m] else step[m]
            room.x[d, m] = moved[m] if room.go[m] > 0.0 else room.x[d, m]
    for w in range(s.arcs.shape[0]):
        # The push of the pass before was turned.
        for m in range(lanes):
            f = abs(room.force[s.arcs[w, 0], m] - room.before[w, m])
            strongest = room.strongest[m] if room.strongest[m] > 0.0 else 1.0
            y = f / strongest * (LANES.steepest / LANES.turned * distance)
            step[m] = y if y > step[m] else step[m]
    for m in range(lanes):
        # Every pass turns them by about the same share of what the pass before did.
        y = step[m] * (LANES.turned / distance)
        rest = y * min(max(y / room.turn[m], LANES.least), 1.0)
        room.turn[m] = y
        room.misfit[m] = rest if rest > room.misfit[m] else room.misfit[m]


@bare
def _run(s, room, one_only, enough, lanes):  # type: ignore[no-untyped-def]
    """Pass until no more than `enough` lanes are live."""
    distance = np.inf
    for w in range(s.arcs.shape[0]):
        square = 0.0
        for c in range(3):
            square += s.nominal[s.arcs[w, 1], c] ** 2
        distance = min(distance, np.sqrt(square))
    lives = 0
    for m in range(lanes):
        lives += room.live[m]
    law_misfit, misfit = room.three, room.misfit
    for number in range(LANES.passes):
        if lives <= enough:
            break
        _pass(s, room, lanes)
        _renew_laws(s, room, law_misfit, lanes)
        for m in range(lanes):
            misfit[m] = 1.0 if room.waits[m] > 0.0 else law_misfit[m] * (HOT.settled / HOT.law)
        if s.turning.shape[0] > 0:
            _follow_arcs(s, room, distance, lanes)
        for m in range(lanes):
            if not room.live[m]:
                continue
            settled = misfit[m] <= HOT.settled or (
                number > 2 and misfit[m] <= HOT.stalled and misfit[m] >= 0.5 * room.previous[m]
            )
            room.previous[m] = misfit[m]
            # A set that is clearly wrong need not be settled.
            pulled = law_misfit[m] <= HOT.nearly and not one_only[room.samples[m]]
            pulled = pulled and room.weakest[m] < -HOT.hurry * room.strongest[m]
            # Forces without bound and what is not a number are left undecided.
            burst = not room.strongest[m] <= HOT.burst * (
                room.push[m] if room.push[m] > 0.0 else 1.0
            )
            undecided = room.singular[m] or burst
            if settled or pulled or undecided or room.longest[m] >= room.patience[m]:
                room.live[m], room.go[m], lives = False, 0.0, lives - 1
                sign = HOT.sign if settled else (HOT.hurry if pulled else np.inf)
                room.sign[m] = 0.0 if undecided else sign


@bare
def _conclude(s, room, count, lanes, xs, forces, roots, one_only, verdict, proposal):  # type: ignore[no-untyped-def]
    """Judge the signs of samples that have settled, and store where every sample stands."""
    springs, r = s.springs, s.redundant.shape[1]
    yielded, misfit, total = room.one, room.two, room.three
    for m in range(lanes):
        yielded[m] = room.largest[m]
        misfit[m] = 0.0
    for e in range(springs):
        held, moved, compliance = room.statics[e], room.moved[e], s.yields[e]
        for m in range(lanes):
            total[m] = 0.0
        _add(total, s.redundant[e], room.z, lanes)
        _add(total, s.turned[e], room.load, lanes)
        for m in range(lanes):
            moved[m] = room.spring[e, m] + compliance * total[m]
            held[m] += total[m]
            f = abs(held[m])
            y = compliance * f
            room.largest[m] = y if y > room.largest[m] else room.largest[m]
            room.push[m] = f if f > room.push[m] else room.push[m]
    for c in range(r):
        for m in range(lanes):
            total[m] = 0.0
        _add(total, s.across[c, :springs], room.moved, lanes)
        _add(total, s.across[c, springs:], room.stretch, lanes)
        for m in range(lanes):
            y = abs(total[m])
            misfit[m] = y if y > misfit[m] else misfit[m]
    for m in range(lanes):
        if misfit[m] > LANES.closed_by * yielded[m] and room.sign[m] == HOT.sign:
            # What the matrix of the redundants was too stiff or too flat for.
            room.sign[m] = 0.0
    for d in range(room.x.shape[0]):
        for m in range(lanes):
            room.x[d, m] = 0.0
        _add(room.x[d], s.particular[d, :springs], room.moved, lanes)
        _add(room.x[d], s.particular[d, springs:], room.stretch, lanes)
    _signs(s, room, lanes)
    for m in range(count):
        i, row, sign = room.samples[m], room.at_row[m], room.sign[m]
        if sign == 0.0 and not room.live[m]:
            continue
        for d in range(room.x.shape[0]):
            xs[i, d] = room.x[d, m]
        for column in range(springs, forces.shape[1]):
            forces[i, column] = 0.0
        for e in range(springs):
            forces[i, e] = room.statics[e, m]
        for e in range(s.contacts.shape[0]):
            forces[i, s.contacts[e]] = room.force[e, m]
        for p in range(s.powers):
            roots[i, s.contacts[p]] = room.root[p, m]
        if room.live[m]:
            continue
        verdict[row] = DONE if sign == HOT.sign and room.mistakes[m] == 0 else OTHER
        if sign > HOT.sign and room.mistakes[m] == 0:
            # What does not settle may still say which flank is open.
            for p in range(s.powers):
                if room.force[p, m] <= 0.0:
                    room.wrong[s.contacts[p] - springs, m] = True
        _propose(s, room.wrong, m, one_only[i], proposal[row])


@compiled
def _settle_all(s, rows, xs, forces, roots, floors, one_only, verdict, proposal, lanes):  # type: ignore[no-untyped-def]
    """Settle every sample of `rows`, `lanes` at a time."""
    r, springs, contacts, powers = s.redundant.shape[1], s.springs, s.contacts.shape[0], s.powers
    room = _Room(
        np.zeros(lanes, dtype=np.int64),
        np.zeros(lanes, dtype=np.int64),
        np.zeros(lanes, dtype=np.int64),
        np.zeros(lanes, dtype=np.bool_),
        np.zeros(lanes),
        np.zeros(lanes),
        np.zeros(lanes),
        np.zeros(lanes),
        np.zeros((s.loaded.shape[0], lanes)),
        np.zeros((springs, lanes)),
        np.zeros((springs, lanes)),
        np.zeros((springs, lanes)),
        np.zeros((contacts, lanes)),
        np.zeros((contacts, lanes)),
        np.zeros((contacts, lanes)),
        np.zeros((contacts, lanes)),
        np.zeros((contacts, lanes)),
        np.zeros((contacts, lanes)),
        np.zeros((powers, lanes)),
        np.zeros((powers, lanes)),
        np.zeros((powers, lanes)),
        np.zeros((powers, lanes)),
        np.zeros((s.arcs.shape[0], lanes)),
        np.zeros((s.turning.shape[0], lanes)),
        np.zeros((xs.shape[1], lanes)),
        np.zeros((r, lanes)),
        np.zeros((r, lanes)),
        np.zeros((r, lanes)),
        np.zeros((r, r, lanes)),
        np.zeros((r, r, lanes)),
        np.zeros((3, lanes)),
        np.zeros((s.code.shape[0], lanes), dtype=np.bool_),
        np.zeros(lanes, dtype=np.int64),
        np.zeros(lanes, dtype=np.bool_),
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
    )
    verdict[:] = UNDECIDED
    waiting = np.arange(rows.shape[0])
    total = rows.shape[0]
    for number in range(LANES.rounds):
        kept = 0
        last = number == LANES.rounds - 1 or total <= lanes
        for first in range(0, total, lanes):
            count = min(lanes, total - first)
            width = min(lanes, (count + 7) // 8 * 8)
            _fill(s, room, rows, waiting, first, count, width, xs, forces, roots, floors, one_only)
            _run(s, room, one_only, 0 if last else int(LANES.few * count), width)
            if last:
                for m in range(count):
                    room.live[m] = False
            _conclude(s, room, count, width, xs, forces, roots, one_only, verdict, proposal)
            for m in range(count):
                if room.live[m]:
                    waiting[kept] = room.at_row[m]
                    kept += 1
        total = kept
        if total == 0:
            break
