"""Newton passes of samples on one set (see `kernel.passes` for the compiled ones)."""

from __future__ import annotations

import math

from loadshare.array_library import columns, cube_root, in_places, largest, lengths, library_of
from loadshare.array_types import Array, Flags
from loadshare.contact.law import roots
from loadshare.settings import HOT
from loadshare.solver.hot import contact_states as at
from loadshare.solver.hot.elements import piece, times
from loadshare.solver.hot.on_set import OnSet
from loadshare.solver.hot.radials import RadialTangent, tangent
from loadshare.solver.hot.signs import wrong_elements
from loadshare.solver.hot.symmetric import solve


def run(on: OnSet, patient: Flags) -> None:
    """Make passes until every sample is settled, refused, or needs another set.

    Parameters
    ----------
    patient : ndarray of bool, shape (k,)
        Samples whose signs are checked only when they are settled.
    """
    xp = on.library
    straight = (at.STICK, at.PINNED)
    bent = [status for _, status, _ in on.radial if status not in straight]
    curved = len(on.arc) + len(bent) + on.table.shape[0] > 0
    previous = xp.full_like(on.push, math.inf)
    for number in range(HOT.passes):
        x, force = on.x, on.force
        _pass(on, _tangents_of_radials(on))
        laws = _renew_laws(on)
        on.lean = on.x, on.force
        if number % HOT.swing >= HOT.swing - HOT.damped:
            # Newton steps that swing to and fro around an answer settle at the mean.
            on.lean = 0.5 * (x + on.x), 0.5 * (force + on.force)
        if curved and number < 2:
            _give_up_gross(on, (laws <= HOT.nearly) & ~patient)
        yielded = largest(on.compression[:, on.contact])
        closing = on.misfit / xp.where(yielded > 0.0, yielded, math.inf)
        misfit = xp.maximum(closing, laws * (HOT.settled / HOT.law))
        if curved:
            misfit = xp.maximum(misfit, change(on.force, force))
            balanced = misfit <= HOT.settled
            misfit = xp.maximum(misfit, change(on.x, x))
        else:
            balanced = misfit <= HOT.settled
        # A law's tangent leaves a misfit of second order, so a small one need not be repeated.
        stalled = (misfit <= HOT.stalled) & (misfit >= 0.5 * previous)
        on.settled = misfit <= HOT.settled
        if number > 2:
            on.settled = on.settled | stalled
        on.refused = on.refused | ~xp.all(xp.isfinite(on.x), axis=1)
        previous = misfit
        on.burst = largest(on.force) > HOT.burst * on.unit
        hopeless = xp.any(on.loose >= HOT.patience, axis=1) | _slipped_out(on) | on.burst
        hopeless = hopeless | xp.any(on.gross, axis=1)
        if xp.all(on.settled | on.refused | hopeless):
            break
    # Samples that creep on without end are left to the certificate.
    # Where the forces no longer change, no force holds the coordinates that still move.
    on.settled = (on.settled | (previous <= HOT.creep) | balanced) & ~on.burst & ~on.refused


def _pass(on: OnSet, turning: list[RadialTangent]) -> None:
    """Make one Newton pass: redundants, forces, compressions, coordinates."""
    xp, particular, n = on.library, on.basis.particular, on.basis.redundant
    rate, shift = _tangents(on)
    load, gap = on.at_arcs()
    statics = load @ particular.T + on.z @ n.T
    stretch = gap + shift + rate * statics
    if turning:
        moved = [b.offset + times(b.compliance, statics[:, b.columns]) for b in turning]
        stretch = stretch + xp.concat([xp.zeros_like(stretch[:, on.scalar]), *moved], axis=1)
    size, count = n.shape[1], len(on.rows)
    matrix = xp.reshape(rate @ on.products, (count, size, size))
    for b in turning:
        part = n[b.columns, :]
        matrix = matrix + part.T @ b.compliance @ part
    borders = [b for b in turning if b.bound is not None]
    sides = -stretch @ n
    if borders:
        matrix, sides = _bordered(on, matrix, sides, borders, statics)
    if on.shared.shape[1]:
        matrix, sides = _set_apart(on, matrix, sides, largest(stretch))
    solved = solve(matrix, sides, size)
    on.z = on.z + solved[:, :size]
    on.force = statics + solved[:, :size] @ n.T
    on.compression = shift + rate * on.force
    if turning:
        moved = [b.offset + times(b.compliance, on.force[:, b.columns]) for b in turning]
        free = iter(range(size, size + len(borders)))
        moved = [
            m if b.bound is None else m + solved[:, next(free), None] * b.along
            for m, b in zip(moved, turning, strict=True)
        ]
        on.compression = xp.concat([on.compression[:, on.scalar], *moved], axis=1)
    on.x = (gap + on.compression) @ particular
    on.misfit = largest((gap + on.compression) @ n)


def _bordered(
    on: OnSet, matrix: Array, sides: Array, borders: list[RadialTangent], statics: Array
) -> tuple[Array, Array]:
    """Add a row and a column for the compression along every level piece, which is free."""
    xp, n = on.library, on.basis.redundant
    rows = xp.stack([b.along @ n[b.columns, :] for b in borders], axis=1)
    none = xp.zeros_like(rows @ xp.permute_dims(rows, (0, 2, 1)))
    upper = xp.concat([matrix, xp.permute_dims(rows, (0, 2, 1))], axis=2)
    bounds = [b.bound - xp.sum(b.along * statics[:, b.columns], axis=1) for b in borders]
    return (
        xp.concat([upper, xp.concat([rows, none], axis=2)], axis=1),
        xp.concat([sides, xp.stack(bounds, axis=1)], axis=1),
    )


def _set_apart(on: OnSet, matrix: Array, sides: Array, longest: Array) -> tuple[Array, Array]:
    """Fix the shares of rigid elements, unless they contradict one another."""
    xp, borders = on.library, sides.shape[1] - on.shared.shape[0]
    none = xp.zeros_like(xp.broadcast_to(on.shared[:1, :], (borders, on.shared.shape[1])))
    q = xp.concat([on.shared, none], axis=0)
    largest_entry = xp.max(xp.abs(matrix), axis=(1, 2))
    against = sides @ q
    against = xp.where(xp.abs(against) <= HOT.noise * longest[:, None], 0.0, against)
    apart = xp.where(largest_entry > 0.0, largest_entry, 1.0)
    mild = sides - (sides @ q) @ q.T
    return matrix + apart[:, None, None] * (q @ q.T), mild + (against / HOT.proximal) @ q.T


def _tangents(on: OnSet) -> tuple[Array, Array]:
    """Return the tangent compliance of every scalar element, and its compression at no force."""
    xp, powers = on.library, on.power.shape[0]
    if not on.root.shape[1]:
        return on.bending, xp.zeros_like(on.gap)
    root, c = on.root[:, :powers], on.hertz
    rates, shifts = [2.0 / 3.0 * c / root], [c * root**2 / 3.0]
    if on.table.shape[0]:
        force, start, slope = piece(*on.points, on.root[:, powers:] ** 3)
        rates.append(slope)
        shifts.append(start - slope * force)
    rate, shift = (in_places(xp.concat(v, axis=1), on.law_of) for v in (rates, shifts))
    return on.bending + rate, shift


def _renew_laws(on: OnSet) -> Array:
    """Take the next tangents at the compressions; return the laws' relative misfit."""
    xp, following = on.library, []
    misfit: Array = xp.zeros_like(on.push)
    if on.power.shape[0]:
        b, c = on.bending_of_power, on.hertz
        force = columns(on.force, on.power)
        compression = columns(on.compression, on.power)
        root, floor = on.root[:, : on.power.shape[0]], on.floor[:, None]
        touching = (force > 0.0) & (compression > 0.0)
        off = b * force + c * cube_root(xp.maximum(force, 0.0)) ** 2 - compression
        misfit = largest(xp.where(touching, off, 0.0)) / largest(on.compression[:, on.scalar])
        # A flank that carries nothing has settled once its root is at the floor.
        misfit = xp.where(xp.any(~touching & (root > floor), axis=1), 1.0, misfit)
        idle = xp.abs(force) <= HOT.sign * on.push[:, None]
        on.loose = xp.where(touching | idle, 0, on.loose + 1)
        next_root = xp.where(
            touching, roots(b, c, xp.where(touching, compression, 1.0)), HOT.shrink * root
        )
        following.append(xp.maximum(next_root, floor))
    if on.table.shape[0]:
        compression = columns(on.compression, on.table)
        start, force, slope = piece(*on.points[::-1], compression)
        force = force + slope * (compression - start)
        following.append(cube_root(xp.maximum(force, 0.0)))
    on.root = xp.concat(following, axis=1) if following else on.root
    return misfit


def _tangents_of_radials(on: OnSet) -> list[RadialTangent]:
    """Return the tangents of the radial elements at their present offsets."""
    found = []
    for j, status, k in on.radial:
        if j in on.linear:
            found.append(on.linear[j])
            continue
        pair = slice(k, k + 2)
        x, force = on.lean
        offset = on.offset(j, x)
        law = on.graph(j, offset)
        on.refused = on.refused | ~law.valid
        push = on.library.maximum(on.push, 1e-300)
        now = tangent(pair, status, law, offset, force[:, pair], push)
        if status in (at.STICK, at.PINNED) and j in on.fixed:
            on.linear[j] = now
        found.append(now)
    return found


def _slipped_out(on: OnSet) -> Flags:
    """Return which samples have a radial element that has left its level piece or rigid stop.

    It stays far beyond the end of that piece, or friction that follows the torque has vanished; or
    a rigid stop goes on holding inward.
    """
    xp, out = on.library, on.push < 0.0
    for j, status, k in on.radial:
        offset = on.offset(j)
        law = on.graph(j, offset)
        if status == at.SLIP:
            left = lengths(offset) > HOT.beyond * law.reach
            left = left | (law.bound <= HOT.sign * on.push)
        elif status == at.WALL:
            left = xp.sum(offset * on.force[:, k : k + 2], axis=1) < 0.0
        else:
            continue
        before = on.outside.get(j, xp.zeros_like(left, dtype=xp.int64))
        on.outside[j] = xp.where(left, before + 1, 0)
        out = out | (on.outside[j] >= on.patience[j])
    return out


def _give_up_gross(on: OnSet, these: Flags) -> None:
    """Give up sets that are clearly wrong before they are settled."""
    xp = on.library
    these = these & ~xp.any(on.gross, axis=1)
    if not xp.any(these):
        return
    before, on.settled = on.settled, these
    wrong, moved = wrong_elements(on, HOT.gross)
    on.settled = before
    on.gross = on.gross | (wrong & these[:, None])
    on.gross_to = xp.where(these[:, None], moved, on.gross_to)


def change(now: Array, before: Array) -> Array:
    """Return the largest change of each row over its largest entry."""
    found: Array = largest(now - before) / library_of(now).maximum(largest(now), 1e-300)
    return found
