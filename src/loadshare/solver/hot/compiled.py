"""One sample of a set after another, compiled with Numba: the same passes as `vectorised`.

Many samples of a plain set go to `lanes`, which come back with what is out of the ordinary.

The compiled code is kept on disk, so that only the first use of a new version waits for it. It
holds no lock of the interpreter: threads share the samples.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from loadshare.compilation import jit
from loadshare.scene.data import Data
from loadshare.scene.elements import Elements
from loadshare.scene.scene import Array
from loadshare.scene.statics import Basis
from loadshare.settings import HOT, LAWS
from loadshare.solver.hot import lanes
from loadshare.solver.hot import places as at
from loadshare.solver.hot.plain import is_plain
from loadshare.solver.hot.state import State

Rows = NDArray[np.intp]
Codes = NDArray[np.int8]

OPEN, CLOSED = at.OPEN, at.CLOSED
STICK, CORNER, PINNED, SLIP, STOP, WALL = (
    at.STICK,
    at.CORNER,
    at.PINNED,
    at.SLIP,
    at.STOP,
    at.WALL,
)
DONE, OTHER, FAILED = at.DONE, at.OTHER, at.FAILED
FEW = 16
"""Samples up to which lanes gain nothing over one sample after another."""
compiled = jit(nogil=True, error_model="numpy", fastmath={"reassoc", "contract", "nsz"})


class _Set(NamedTuple):
    """Numbers of a set and of the samples, as the compiled passes read them.

    m elements in all, k of them act, n coordinates, a arcs, j radial elements.
    """

    columns: NDArray[np.intp]  # (k,)
    particular: Array  # (n, k), transposed
    redundant: Array  # (k, r)
    directions: Array  # (k, n)
    loose: Array  # (n, l)
    inverse: Array  # (r, r) of the redundants' matrix where it never changes, else (0, 0)
    kind: NDArray[np.int8]  # (k,): 0 linear, 1 power law, 2 table, 3 part of a radial element
    arc_of: NDArray[np.intp]  # (k,): number of the arc, or −1
    radial_at: NDArray[np.intp]  # (j,): first column in the set, or −1
    code: Codes
    vectors: Array  # (m, n)
    springs: int
    rows: int
    first_arc: int
    load: Array
    gap: Array
    bending: Array
    hertz: Array
    tabulated: NDArray[np.intp]
    tables: Array
    nominal: Array
    shift: Array
    clearance: Array
    relative: Array
    radial: Array
    carried: Array


def settle(
    elements: Elements,
    data: Data,
    basis: Basis,
    code: Codes,
    rows: Rows,
    state: State,
    one_only: NDArray[np.bool_],
) -> tuple[Codes, Codes]:
    """Solve samples on one set and say what has the wrong sign.

    Parameters and return values are those of :func:`loadshare.solver.hot.vectorised.settle`.
    """
    if len(rows) > FEW and is_plain(elements, data):
        verdict, proposal = lanes.settle(elements, data, basis, code, rows, state, one_only)
        left = np.flatnonzero(verdict == lanes.UNDECIDED)
        if len(left):
            verdict[left], proposal[left] = _one_by_one(
                elements, data, basis, code, rows[left], state, one_only
            )
        return verdict, proposal
    return _one_by_one(elements, data, basis, code, rows, state, one_only)


def _one_by_one(
    elements: Elements,
    data: Data,
    basis: Basis,
    code: Codes,
    rows: Rows,
    state: State,
    one_only: NDArray[np.bool_],
) -> tuple[Codes, Codes]:
    verdict = np.empty(len(rows), dtype=np.int8)
    proposal = np.empty((len(rows), len(code)), dtype=np.int8)
    _settle_all(
        _set(elements, data, basis, code),
        np.ascontiguousarray(rows),
        state.x,
        state.force,
        state.root,
        state.floor,
        one_only,
        verdict,
        proposal,
    )
    return verdict, proposal


def _set(elements: Elements, data: Data, basis: Basis, code: Codes) -> _Set:
    """Arrays of a set; what does not vary from sample to sample is kept for the next block."""
    bends = data.curved
    key = (code.tobytes(), data.laws, len(data.bending) == 1)
    known = elements.kept.get(key)
    if known is None:
        known = elements.keep(key, _structure(elements, data, basis, code, bends))
    varying = (
        np.ascontiguousarray(data.load),
        np.ascontiguousarray(data.gap),
        np.ascontiguousarray(data.bending),
        np.ascontiguousarray(data.hertz),
        data.tabulated,
        np.ascontiguousarray(data.tables),
        data.nominal,
        np.ascontiguousarray(data.shift),
        np.ascontiguousarray(data.clearance),
        data.relative,
        np.ascontiguousarray(data.radial),
        data.carried,
    )
    return _Set._make((*known, *varying))


def _structure(
    elements: Elements, data: Data, basis: Basis, code: Codes, bends: NDArray[np.bool_]
) -> tuple[Any, ...]:
    """The first fields of `_Set`."""
    columns = basis.columns
    kind = bends[columns].astype(np.int8)
    kind[data.tabulated[columns] >= 0] = 2
    kind[columns >= elements.columns.contacts.stop] = 3
    first_arc = elements.columns.arcs.start
    arcs = columns - first_arc
    arc_of = np.where((arcs >= 0) & (arcs < len(elements.arcs)), arcs, -1)
    radial_at = np.full(elements.switches - elements.rows, -1)
    for j in range(len(radial_at)):
        if code[elements.rows + j] != OPEN:
            radial_at[j] = np.searchsorted(columns, elements.radial_column(j))
    n = basis.redundant
    inverse = np.zeros((0, 0))
    if not kind.any() and len(data.bending) == 1 and n.shape[1]:
        inverse = np.linalg.pinv(n.T * data.bending[0, columns] @ n)
    return (
        columns,
        np.ascontiguousarray(basis.particular.T),
        np.ascontiguousarray(n),
        np.ascontiguousarray(basis.directions),
        np.ascontiguousarray(basis.loose),
        inverse,
        kind,
        arc_of,
        radial_at,
        np.array(code),
        elements.vectors,
        elements.springs,
        elements.rows,
        first_arc,
    )


@compiled
def _row(array, i):  # type: ignore[no-untyped-def]
    """Row of a sample, or the only one."""
    return array[i] if array.shape[0] > 1 else array[0]


@compiled
def _root_of(b, c, compression):  # type: ignore[no-untyped-def]
    """F^(1/3) of the law b F + c F^(2/3); see `vectorised.root_of`."""
    y = np.sqrt(compression / c)
    if b > 0.0 and b * y > c:
        y = min(y, np.cbrt(compression / b))
    for _ in range(60):
        step = ((b * y + c) * y * y - compression) / ((3.0 * b * y + 2.0 * c) * y)
        y -= step
        if abs(step) <= 1e-15 * y:
            break
    return y


@compiled
def _next_root(b, c, compression, start):  # type: ignore[no-untyped-def]
    """F^(1/3) of the law, from a start that is nearly right."""
    y = start
    for _ in range(4):
        step = ((b * y + c) * y * y - compression) / ((3.0 * b * y + 2.0 * c) * y)
        y -= step
        if not y > 0.0:
            break
        if abs(step) <= 1e-9 * y:
            # Newton's next step would be below round-off.
            return y
    return _root_of(b, c, compression)


@compiled
def _piece(axis, values, where):  # type: ignore[no-untyped-def]
    """Start on the axis, start value and slope of the piece of a table that holds `where`."""
    k = 0
    while k + 2 < axis.shape[0] and axis[k + 1] <= where and not np.isnan(axis[k + 2]):
        k += 1
    return axis[k], values[k], (values[k + 1] - values[k]) / (axis[k + 1] - axis[k])


@compiled
def _arc(s, i, a, x, normal):  # type: ignore[no-untyped-def]
    """Margin of an arc at x, as `train.ring.Arc` has it; writes its normal."""
    shift = _row(s.shift, i)[a]
    grown, distance, here, ahead = 0.0, 0.0, 0.0, 0.0
    for c in range(3):
        nominal, moved = s.nominal[a, c], shift[c]
        for d in range(x.shape[0]):
            moved += s.relative[a, c, d] * x[d]
        normal[c] = nominal + moved
        here += normal[c] * normal[c]
        distance += nominal * nominal
        grown += (2.0 * nominal + moved) * moved
        ahead += nominal * normal[c]
    here, distance = np.sqrt(here), np.sqrt(distance)
    if ahead <= 0.0:
        for c in range(3):
            normal[c] = s.nominal[a, c] / distance
        return ahead / distance - distance + _row(s.clearance, i)[a]
    for c in range(3):
        normal[c] /= here
    return grown / (here + distance) + _row(s.clearance, i)[a]


@compiled
def _graph(s, i, j, force):  # type: ignore[no-untyped-def]
    """Five numbers of a radial law, and whether it has a meaning; see `places.graph`."""
    numbers = _row(s.radial, i)[j]
    first, given, reach, fixed = numbers[0], numbers[1], numbers[2], numbers[3]
    bound = fixed
    if np.isnan(fixed):
        torque = 0.0
        for e in range(s.columns.shape[0]):
            torque += s.carried[j, s.columns[e]] * force[e]
        bound = numbers[4] * abs(torque)
    continuous = bound / first if first > 0.0 else 0.0
    valid = True
    if np.isnan(given):
        stick = continuous if reach >= continuous else np.inf
    else:
        stick = min(given, continuous)
        valid = first * given <= bound * (1.0 + LAWS.written) and reach >= stick
    return first, stick, bound, reach, numbers[5], valid


@compiled
def _offset(s, i, j, x):  # type: ignore[no-untyped-def]
    """Offset of a radial element at x."""
    column = s.springs + s.rows + 2 * j
    gap = _row(s.gap, i)
    u, v = -gap[column], -gap[column + 1]
    for d in range(x.shape[0]):
        u += s.vectors[column, d] * x[d]
        v += s.vectors[column + 1, d] * x[d]
    return u, v


@compiled
def _along(u, v, p, q):  # type: ignore[no-untyped-def]
    """Unit vector along (u, v), or (p, q) where that is zero, or x."""
    if u == 0.0 and v == 0.0:
        u, v = p, q
    size = np.sqrt(u * u + v * v)
    if size == 0.0:
        return 1.0, 0.0
    return u / size, v / size


@compiled
def _tangent(place, law, u, v, p, q, push):  # type: ignore[no-untyped-def]
    """Compliance along and across, start, and direction of a radial element; see `block`."""
    first, stick, bound, reach, last, _ = law
    if place in (CORNER, WALL):
        du, dv = _along(p, q, u, v)
        limit = stick if place == CORNER else reach
        size = np.sqrt(p * p + q * q)
        return 0.0, limit / (size if size > 0.0 else push), limit, du, dv
    du, dv = _along(u, v, p, q)
    radius = np.sqrt(u * u + v * v)
    if place == STICK:
        return 1.0 / first, 1.0 / first, 0.0, du, dv
    if place == PINNED:
        return 0.0, 0.0, 0.0, du, dv
    if place == SLIP:
        return 0.0, min(max(radius, stick), reach) / max(bound, HOT.faint * push), 0.0, du, dv
    reached = max(radius, reach)
    pull = bound + last * (reached - reach)
    inner = 1.0 / last
    return inner, (reached / pull if pull > 0.0 else inner), reach - bound / last, du, dv


@compiled
def _misplaced(place, law, u, v, p, q, force_band, length_band, faint):  # type: ignore[no-untyped-def]
    """Where a radial element should stand; its own place if that is right. See `misplaced`."""
    first, stick, bound, reach, last, _ = law
    radius, size = np.sqrt(u * u + v * v), np.sqrt(p * p + q * q)
    jump = bound > first * stick * (1.0 + 1e-9)
    beyond = STOP
    if np.isinf(last):
        beyond = WALL if reach > 0.0 else PINNED
    rubs = bound > faint
    level = (SLIP if rubs else OPEN) if reach > stick else beyond
    back = PINNED
    if bound == 0.0 and reach > 0.0:
        back = OPEN
    elif stick > 0.0:
        back = CORNER if jump else STICK
    inward = u * p + v * q < 0.0
    if place == OPEN:
        if radius > reach + length_band:
            return beyond
        if rubs and radius > length_band:
            return STICK if radius < stick else level
        return OPEN
    if place == STICK:
        if size <= first * stick + force_band:
            return STICK
        gone = beyond if radius > reach + length_band else level
        return CORNER if jump else gone
    if place == CORNER:
        if inward or size < first * stick - force_band:
            return STICK
        return level if size > bound + force_band else CORNER
    if place == PINNED:
        yields = bound > 0.0 or reach > 0.0 or np.isfinite(last)
        return level if size > bound + force_band and yields else PINNED
    if place == SLIP:
        if not rubs:
            return level
        if radius > reach + length_band:
            return beyond
        return back if radius < stick - length_band or inward else SLIP
    if place == STOP:
        if (radius < reach - length_band or inward) and reach > 0.0:
            return level if reach > stick and radius >= stick else back
        return STOP
    return OPEN if inward or size <= force_band else WALL


@compiled
def _solve(matrix, right, size):  # type: ignore[no-untyped-def]
    """Solve in place by elimination with partial pivoting; False if a pivot vanishes."""
    largest = 0.0
    for c in range(size):
        best, pivot = abs(matrix[c, c]), c
        for r in range(c + 1, size):
            if abs(matrix[r, c]) > best:
                best, pivot = abs(matrix[r, c]), r
        if not best > HOT.pivot * largest:
            return False
        largest = max(largest, best)
        if pivot != c:
            for d in range(c, size):
                matrix[c, d], matrix[pivot, d] = matrix[pivot, d], matrix[c, d]
            right[c], right[pivot] = right[pivot], right[c]
        for r in range(c + 1, size):
            factor = matrix[r, c] / matrix[c, c]
            if factor != 0.0:
                for d in range(c + 1, size):
                    matrix[r, d] -= factor * matrix[c, d]
                right[r] -= factor * right[c]
    for c in range(size - 1, -1, -1):
        total = right[c]
        for d in range(c + 1, size):
            total -= matrix[c, d] * right[d]
        right[c] = total / matrix[c, c]
    return True


@compiled
def _solve_singular(matrix, target, found, definite, size):  # type: ignore[no-untyped-def]
    """Solve a singular system through a proximal term; see `vectorised.solve`."""
    scale = 0.0
    for c in range(size):
        found[c] = 0.0
        for d in range(size):
            scale = max(scale, abs(matrix[c, d]))
    if not scale > 0.0:
        scale = 1.0
    work, left = np.empty((size, size)), np.empty(size)
    for _ in range(HOT.refinements):
        for c in range(size):
            left[c] = target[c]
            for d in range(size):
                left[c] -= matrix[c, d] * found[d]
                work[c, d] = matrix[c, d]
            work[c, c] += HOT.proximal * scale if c < definite else -HOT.proximal * scale
        if not _solve(work, left, size):
            return
        for c in range(size):
            found[c] += left[c]


@compiled
def _settle_all(s, rows, xs, forces, roots, floors, one_only, verdict, proposal):  # type: ignore[no-untyped-def]
    """Settle every sample of `rows`."""
    k, r = s.redundant.shape
    n = xs.shape[1]
    radials = s.radial_at.shape[0]
    x, x_before = np.empty(n), np.empty(n)
    force, before = np.empty(k), np.empty(k)
    compression, tangent, shift = np.empty(k), np.empty(k), np.empty(k)
    statics, gap, stretch = np.empty(k), np.empty(k), np.empty(k)
    load = np.empty(n)
    root, z = np.empty(k), np.empty(r)
    loose = np.zeros(k, dtype=np.int64)
    normal = np.empty(3)
    matrix = np.empty((r + radials, r + radials))
    kept, target = np.empty((r + radials, r + radials)), np.empty(r + radials)
    right = np.empty(r + radials)
    inner, outer, begin = np.empty(radials), np.empty(radials), np.empty(radials)
    du, dv = np.empty(radials), np.empty(radials)
    border = np.empty(radials, dtype=np.int64)
    outside = np.zeros(radials, dtype=np.int64)
    constant = s.inverse.shape[0] > 0 or r == 0
    bent = False
    for e in range(k):
        bent = bent or s.arc_of[e] >= 0 or s.kind[e] == 2
    for j in range(radials):
        if s.radial_at[j] >= 0:
            place = s.code[s.rows + j]
            bent = bent or (place != STICK and place != PINNED)
            constant = False
    for e in range(k):
        constant = constant and s.kind[e] == 0
    if s.bending.shape[0] > 1:
        constant = False
    for row in range(rows.shape[0]):
        i = rows[row]
        given_load, given_gap = _row(s.load, i), _row(s.gap, i)
        bending, hertz = _row(s.bending, i), _row(s.hertz, i)
        push = 0.0
        for d in range(n):
            x[d] = xs[i, d]
            push = max(push, abs(given_load[d]))
        for e in range(k):
            column = s.columns[e]
            force[e], root[e] = forces[i, column], roots[i, column]
            gap[e] = given_gap[column]
            tangent[e], shift[e] = bending[column], 0.0
            loose[e] = 0
        outside[:] = 0
        for c in range(r):
            z[c] = 0.0
            for e in range(k):
                z[c] += s.redundant[e, c] * force[e]
        settled, refused, hopeless, burst = False, False, False, False
        hurried = False
        previous = np.inf
        for number in range(HOT.passes):
            # Tangents of the laws, faces of the arcs, tangents of the radial elements.
            for d in range(n):
                load[d] = given_load[d]
                x_before[d] = x[d]
            for e in range(k):
                before[e] = force[e]
                if s.kind[e] == 1:
                    column = s.columns[e]
                    tangent[e] = bending[column] + 2.0 / 3.0 * hertz[column] / root[e]
                    shift[e] = hertz[column] * root[e] * root[e] / 3.0
                elif s.kind[e] == 2:
                    table = _row(s.tables, i)[s.tabulated[s.columns[e]]]
                    at_force, at_start, slope = _piece(table[0], table[1], root[e] ** 3)
                    tangent[e], shift[e] = slope, at_start - slope * at_force
                a = s.arc_of[e]
                if a >= 0:
                    margin = _arc(s, i, a, x, normal)
                    gap[e] = margin
                    for d in range(n):
                        base = s.directions[e, d]
                        gap[e] += x[d] * base
                        face = 0.0
                        for c in range(3):
                            face -= normal[c] * s.relative[a, c, d]
                        load[d] -= force[e] * (face - base)
            borders = 0
            for j in range(radials):
                e = s.radial_at[j]
                if e < 0:
                    continue
                law = _graph(s, i, j, force)
                refused = refused or not law[5]
                u, v = _offset(s, i, j, x)
                place = s.code[s.rows + j]
                inner[j], outer[j], begin[j], du[j], dv[j] = _tangent(
                    place, law, u, v, force[e], force[e + 1], max(push, 1e-300)
                )
                border[j] = -1
                if place == SLIP:
                    border[j] = r + borders
                    right[r + borders] = law[2]
                    borders += 1
            # Redundants from compatibility.
            for e in range(k):
                statics[e] = 0.0
                for c in range(r):
                    statics[e] += s.redundant[e, c] * z[c]
            for d in range(n):
                if load[d] != 0.0:
                    for e in range(k):
                        statics[e] += s.particular[d, e] * load[d]
            for e in range(k):
                stretch[e] = gap[e] + shift[e] + tangent[e] * statics[e]
            for j in range(radials):
                e = s.radial_at[j]
                if e >= 0:
                    along = du[j] * statics[e] + dv[j] * statics[e + 1]
                    size = begin[j] + (inner[j] - outer[j]) * along
                    stretch[e] = gap[e] + size * du[j] + outer[j] * statics[e]
                    stretch[e + 1] = gap[e + 1] + size * dv[j] + outer[j] * statics[e + 1]
                    tangent[e] = tangent[e + 1] = outer[j]
            size = r + borders
            for c in range(r):
                right[c] = 0.0
            for e in range(k):
                for c in range(r):
                    right[c] -= s.redundant[e, c] * stretch[e]
            if constant:
                for e in range(k):
                    force[e] = statics[e]
                for c in range(r):
                    more = 0.0
                    for d in range(r):
                        more += s.inverse[c, d] * right[d]
                    z[c] += more
                    for e in range(k):
                        force[e] += s.redundant[e, c] * more
            else:
                if r > 24:
                    scaled = np.empty((k, r))
                    for e in range(k):
                        for c in range(r):
                            scaled[e, c] = tangent[e] * s.redundant[e, c]
                    matrix[:r, :r] = np.dot(s.redundant.T, scaled)
                else:
                    for c in range(r):
                        for d in range(c + 1):
                            matrix[c, d] = 0.0
                    for e in range(k):
                        for c in range(r):
                            weighted = tangent[e] * s.redundant[e, c]
                            for d in range(c + 1):
                                matrix[c, d] += weighted * s.redundant[e, d]
                    for c in range(r):
                        for d in range(c):
                            matrix[d, c] = matrix[c, d]
                for j in range(radials):
                    e = s.radial_at[j]
                    if e < 0:
                        continue
                    excess = inner[j] - outer[j]
                    for c in range(r):
                        here = du[j] * s.redundant[e, c] + dv[j] * s.redundant[e + 1, c]
                        if border[j] >= 0:
                            matrix[border[j], c] = matrix[c, border[j]] = here
                        for d in range(r):
                            there = du[j] * s.redundant[e, d] + dv[j] * s.redundant[e + 1, d]
                            matrix[c, d] += excess * here * there
                    if border[j] >= 0:
                        for d in range(r, size):
                            matrix[border[j], d] = 0.0
                        right[border[j]] -= du[j] * statics[e] + dv[j] * statics[e + 1]
                if r > 24:
                    right[:size] = np.linalg.solve(matrix[:size, :size], right[:size])
                else:
                    for c in range(size):
                        target[c] = right[c]
                        for d in range(size):
                            kept[c, d] = matrix[c, d]
                    if not _solve(matrix, right, size):
                        _solve_singular(kept, target, right, r, size)
                for e in range(k):
                    force[e] = statics[e]
                    for c in range(r):
                        force[e] += s.redundant[e, c] * right[c]
                for c in range(r):
                    z[c] += right[c]
            # Compressions, and the next tangents from them.
            largest = 0.0
            for e in range(k):
                compression[e] = shift[e] + tangent[e] * force[e]
                if s.kind[e] != 3:
                    largest = max(largest, abs(compression[e]))
            for j in range(radials):
                e = s.radial_at[j]
                if e >= 0:
                    along = du[j] * force[e] + dv[j] * force[e + 1]
                    size_along = begin[j] + (inner[j] - outer[j]) * along
                    if border[j] >= 0:
                        size_along += right[border[j]]
                    compression[e] = size_along * du[j] + outer[j] * force[e]
                    compression[e + 1] = size_along * dv[j] + outer[j] * force[e + 1]
            yielded, misfit = 0.0, 0.0
            for e in range(k):
                if s.kind[e] != 3 and s.columns[e] >= s.springs:
                    yielded = max(yielded, abs(compression[e]))
            if yielded > 0.0:
                for c in range(r):
                    open_by = 0.0
                    for e in range(k):
                        open_by += s.redundant[e, c] * (gap[e] + compression[e])
                    misfit = max(misfit, abs(open_by) / yielded)
            for e in range(k):
                if s.kind[e] == 1:
                    column = s.columns[e]
                    b, c_hertz = bending[column], hertz[column]
                    if force[e] > 0.0 and compression[e] > 0.0:
                        loose[e] = 0
                        following = _next_root(b, c_hertz, compression[e], root[e])
                        # What the tangent leaves: its law's true compression, expanded about the
                        # root of the compression, so that no cube root of the force is needed.
                        off = force[e] / following**3 - 1.0
                        if abs(off) > 1e-4:
                            true = b * force[e] + c_hertz * np.cbrt(force[e]) ** 2
                            gone = abs(true - compression[e])
                        else:
                            f = force[e] - following**3
                            gone = abs(f) * (b + 2.0 / 3.0 * c_hertz / following)
                        misfit = max(misfit, gone / largest * (HOT.settled / HOT.law))
                        root[e] = max(following, floors[i])
                    else:
                        waiting = root[e] > floors[i]
                        if waiting:
                            misfit = max(misfit, 1.0)
                        loose[e] += 1
                        if abs(force[e]) <= HOT.sign * push:
                            loose[e] = 0
                        root[e] = max(HOT.shrink * root[e], floors[i])
                        hopeless = hopeless or loose[e] >= HOT.patience
                elif s.kind[e] == 2:
                    table = _row(s.tables, i)[s.tabulated[s.columns[e]]]
                    at_start, at_force, slope = _piece(table[1], table[0], compression[e])
                    value = at_force + slope * (compression[e] - at_start)
                    root[e] = np.cbrt(max(value, 0.0))
            nearly = misfit * HOT.law / HOT.settled
            if bent:
                for d in range(n):
                    x[d] = 0.0
                    for e in range(k):
                        x[d] += s.particular[d, e] * (gap[e] + compression[e])
                top, most = 0.0, 0.0
                for e in range(k):
                    top = max(top, abs(force[e]))
                    most = max(most, abs(force[e] - before[e]))
                misfit = max(misfit, most / max(top, 1e-300))
                top, most = 0.0, 0.0
                for d in range(n):
                    top = max(top, abs(x[d]))
                    most = max(most, abs(x[d] - x_before[d]))
                misfit = max(misfit, most / max(top, 1e-300))
            for j in range(radials):
                if s.radial_at[j] >= 0 and s.code[s.rows + j] == SLIP:
                    u, v = _offset(s, i, j, x)
                    law = _graph(s, i, j, force)
                    left = u * u + v * v > HOT.beyond * HOT.beyond * law[3] * law[3]
                    left = left or law[2] <= HOT.sign * push
                    outside[j] = outside[j] + 1 if left else 0
                    hopeless = hopeless or outside[j] >= HOT.outside
            if not np.isfinite(misfit):
                refused = True
                break
            if bent and number < 2 and nearly <= HOT.nearly and not one_only[i]:
                # A set that is clearly wrong need not be settled.
                verdict[row] = _signs(
                    s,
                    i,
                    x,
                    force,
                    compression,
                    loose,
                    outside,
                    push,
                    HOT.hurry,
                    True,
                    False,
                    False,
                    False,
                    proposal[row],
                    normal,
                )
                hurried = verdict[row] == OTHER
                if hurried:
                    break
            if misfit <= HOT.settled:
                settled = True
                break
            if number > 2 and misfit <= HOT.stalled and misfit >= 0.5 * previous:
                settled = True
                break
            previous = misfit
            burst = False
            for e in range(k):
                burst = burst or abs(force[e]) > HOT.burst * (push if push > 0.0 else 1.0)
            if hopeless or burst:
                break
        if not settled and not refused and not burst and previous <= HOT.creep:
            settled = True
        if not bent and not hurried:
            for d in range(n):
                x[d] = 0.0
                for e in range(k):
                    x[d] += s.particular[d, e] * (gap[e] + compression[e])
        if not hurried:
            verdict[row] = _signs(
                s,
                i,
                x,
                force,
                compression,
                loose,
                outside,
                push,
                HOT.sign,
                settled,
                refused,
                burst,
                one_only[i],
                proposal[row],
                normal,
            )
        for d in range(n):
            xs[i, d] = x[d]
        for c in range(forces.shape[1]):
            forces[i, c] = 0.0
        for e in range(k):
            forces[i, s.columns[e]] = force[e]
            roots[i, s.columns[e]] = root[e]


@compiled
def _signs(  # type: ignore[no-untyped-def]
    s,
    i,
    x,
    force,
    compression,
    loose,
    outside,
    push,
    sign,
    settled,
    refused,
    burst,
    one_only,
    proposal,
    normal,
):
    """Verdict on a sample, and the set it proposes."""
    k, n = s.directions.shape
    switches = s.code.shape[0]
    proposal[:] = s.code
    gap = _row(s.gap, i)
    given = _row(s.load, i)
    drift = 0.0
    for c in range(s.loose.shape[1]):
        along = 0.0
        for d in range(n):
            along += s.loose[d, c] * given[d]
        drift = max(drift, abs(along))
    if drift > HOT.drift * push:
        return _stopped(s, i, x, force, gap, given, proposal, normal)
    if refused:
        return FAILED
    strongest, yielded, furthest = push, 0.0, 0.0
    for e in range(k):
        strongest = max(strongest, abs(force[e]))
        if s.kind[e] != 3:
            yielded = max(yielded, abs(compression[e]))
    for d in range(n):
        furthest = max(furthest, abs(x[d]))
    force_band = sign * strongest
    length_band = sign * max(yielded, 1e-3 * furthest)
    wrong = 0
    acting = 0
    while acting < k and s.columns[acting] < s.springs:
        acting += 1
    for row in range(s.rows):
        column = s.springs + row
        closed = acting < k and s.columns[acting] == column
        off = False
        if closed:
            off = (settled or burst) and force[acting] < -force_band
            if not settled and s.kind[acting] == 1 and loose[acting] >= HOT.patience:
                off = True
            acting += 1
        elif settled:
            if column >= s.first_arc:
                approach = -_arc(s, i, column - s.first_arc, x, normal)
            else:
                approach = -gap[column]
                for d in range(n):
                    approach += s.vectors[column, d] * x[d]
            off = approach > length_band
        if off:
            proposal[row] = OPEN if closed else CLOSED
            wrong += 1
            if one_only:
                return OTHER
    for j in range(switches - s.rows):
        if settled or outside[j] >= HOT.outside:
            e = s.radial_at[j]
            place = s.code[s.rows + j]
            p, q = (force[e], force[e + 1]) if e >= 0 else (0.0, 0.0)
            u, v = _offset(s, i, j, x)
            law = _graph(s, i, j, force)
            better = _misplaced(
                place, law, u, v, p, q, force_band, length_band, HOT.sign * strongest
            )
            if better != place:
                proposal[s.rows + j] = better
                wrong += 1
                if one_only:
                    return OTHER
    if wrong > 0:
        return OTHER
    return DONE if settled else FAILED


@compiled
def _stopped(s, i, x, force, gap, given, proposal, normal):  # type: ignore[no-untyped-def]
    """Propose what is first in the way of a drift."""
    n = x.shape[0]
    drift = np.zeros(n)
    for c in range(s.loose.shape[1]):
        along = 0.0
        for d in range(n):
            along += s.loose[d, c] * given[d]
        for d in range(n):
            drift[d] += along * s.loose[d, c]
    fast = HOT.drift * np.abs(drift).max()
    nearest, first = np.inf, -1
    for row in range(s.rows):
        if s.code[row] == CLOSED:
            continue
        column = s.springs + row
        speed, room = 0.0, gap[column]
        for d in range(n):
            speed += s.vectors[column, d] * drift[d]
            room -= s.vectors[column, d] * x[d]
        if column >= s.first_arc:
            room = _arc(s, i, column - s.first_arc, x, normal)
        if speed > fast:
            way = max(room, 0.0) / speed
            if way < nearest:
                nearest, first = way, row
    place = CLOSED
    for j in range(s.radial_at.shape[0]):
        if s.code[s.rows + j] != OPEN:
            continue
        column = s.springs + s.rows + 2 * j
        u, v = _offset(s, i, j, x)
        du, dv = 0.0, 0.0
        for d in range(n):
            du += s.vectors[column, d] * drift[d]
            dv += s.vectors[column + 1, d] * drift[d]
        square, along = du * du + dv * dv, u * du + v * dv
        if square > fast * fast:
            law = _graph(s, i, j, force)
            inside = max(law[3] * law[3] - u * u - v * v, 0.0)
            way = max((np.sqrt(along * along + square * inside) - along) / square, 0.0)
            if way < nearest:
                nearest, first = way, s.rows + j
                place = STOP
                if np.isinf(law[4]):
                    place = WALL if law[3] > 0.0 else PINNED
    if first < 0:
        return FAILED
    proposal[first] = place
    return OTHER
