"""Newton passes of samples on one set (see `kernel.passes` for the compiled ones)."""

from __future__ import annotations

import numpy as np

from loadshare.array_types import Array, Flags
from loadshare.contact.law import roots
from loadshare.settings import HOT
from loadshare.solver.hot import contact_states as at
from loadshare.solver.hot.elements import piece, times
from loadshare.solver.hot.on_set import OnSet
from loadshare.solver.hot.radials import RadialTangent, block
from loadshare.solver.hot.signs import wrong_elements
from loadshare.solver.hot.symmetric import solve


def run(on: OnSet, patient: Flags) -> None:
    """Make passes until every sample is settled, refused, or needs another set.

    Parameters
    ----------
    patient : ndarray of bool, shape (k,)
        Samples whose signs are checked only when they are settled.
    """
    straight = (at.STICK, at.PINNED)
    bent = [status for _, status, _ in on.radial if status not in straight]
    curved = len(on.arc) + len(bent) + len(on.table) > 0
    previous = np.full(len(on.rows), np.inf)
    for number in range(HOT.passes):
        x, force = on.x, on.force
        _pass(on, _blocks(on))
        roots = on.root
        laws = _renew_laws(on)
        on.lean = on.x, on.force
        if number % HOT.swing >= HOT.swing - HOT.damped:
            # Newton steps that swing to and fro around an answer settle at the mean.
            on.lean = 0.5 * (x + on.x), 0.5 * (force + on.force)
            on.root = 0.5 * (roots + on.root)
        if curved and number < 2:
            _give_up_gross(on, (laws <= HOT.nearly) & ~patient)
        yielded = np.abs(on.compression[:, on.contact]).max(axis=1, initial=0.0)
        closing = on.misfit / np.where(yielded > 0.0, yielded, np.inf)
        misfit = np.maximum(closing, laws * (HOT.settled / HOT.law))
        if curved:
            misfit = np.maximum(misfit, change(on.force, force))
            balanced = misfit <= HOT.settled
            misfit = np.maximum(misfit, change(on.x, x))
        else:
            balanced = misfit <= HOT.settled
        # A law's tangent leaves a misfit of second order, so a small one need not be repeated.
        stalled = (number > 2) & (misfit <= HOT.stalled) & (misfit >= 0.5 * previous)
        on.settled = (misfit <= HOT.settled) | stalled
        on.refused |= ~np.isfinite(on.x).all(axis=1)
        previous = misfit
        on.burst = np.abs(on.force).max(axis=1, initial=0.0) > HOT.burst * on.unit
        hopeless = (on.loose >= HOT.patience).any(axis=1) | _slipped_out(on) | on.burst
        hopeless |= on.gross.any(axis=1)
        if (on.settled | on.refused | hopeless).all():
            break
    # Samples that creep on without end are left to the certificate.
    # Where the forces no longer change, no force holds the coordinates that still move.
    on.settled |= (previous <= HOT.creep) | balanced
    on.settled &= ~on.burst
    on.settled &= ~on.refused


def _pass(on: OnSet, blocks: list[RadialTangent]) -> None:
    """Make one Newton pass: redundants, forces, compressions, coordinates."""
    particular, n = on.basis.particular, on.basis.redundant
    tangent, shift = _tangents(on)
    load, gap = on.at_arcs()
    statics = load @ particular.T + on.z @ n.T
    stretch = gap + shift + tangent * statics
    size, count = n.shape[1], len(on.rows)
    borders = [b for b in blocks if b.bound is not None]
    matrix = np.zeros((count, size + len(borders), size + len(borders)))
    sides = np.zeros((count, size + len(borders)))
    matrix[:, :size, :size] = (tangent @ on.products).reshape(count, size, size)
    for b in blocks:
        stretch[:, b.columns] += b.offset + times(b.compliance, statics[:, b.columns])
        part = n[b.columns]
        matrix[:, :size, :size] += part.T @ b.compliance @ part
    for e, b in enumerate(borders, start=size):
        matrix[:, e, :size] = matrix[:, :size, e] = b.along @ n[b.columns]
        sides[:, e] = b.bound - (b.along * statics[:, b.columns]).sum(axis=1)
    sides[:, :size] = -stretch @ n
    if on.shared.shape[1]:
        _set_apart(on, matrix, sides, np.abs(stretch).max(axis=1))
    solved = solve(matrix, sides, size)
    on.z = on.z + solved[:, :size]
    on.force = statics + solved[:, :size] @ n.T
    on.compression = shift + tangent * on.force
    for b in blocks:
        moved = b.offset + times(b.compliance, on.force[:, b.columns])
        on.compression[:, b.columns] = moved
    for e, b in enumerate(borders, start=size):
        on.compression[:, b.columns] += solved[:, e, None] * b.along
    on.x = (gap + on.compression) @ particular
    on.misfit = np.abs((gap + on.compression) @ n).max(axis=1, initial=0.0)


def _set_apart(on: OnSet, matrix: Array, sides: Array, lengths: Array) -> None:
    """Fix the shares of rigid elements, unless they contradict one another."""
    q = on.shared
    size, largest = len(q), np.abs(matrix).max(axis=(1, 2))
    against = sides[:, :size] @ q
    against[np.abs(against) <= HOT.noise * lengths[:, None]] = 0.0
    apart = np.where(largest > 0.0, largest, 1.0)
    matrix[:, :size, :size] += apart[:, None, None] * (q @ q.T)
    mild = sides[:, :size] - (sides[:, :size] @ q) @ q.T
    sides[:, :size] = mild + (against / HOT.proximal) @ q.T


def _tangents(on: OnSet) -> tuple[Array, Array]:
    """Return the tangent compliance of every scalar element, and its compression at no force."""
    tangent, shift = np.array(on.bending), np.zeros_like(on.gap)
    if len(on.power):
        root, c = on.root[:, on.power], on.hertz[:, on.power]
        tangent[:, on.power] += 2.0 / 3.0 * c / root
        shift[:, on.power] = c * root**2 / 3.0
    if len(on.table):
        force, start, slope = piece(*on.points, on.root[:, on.table] ** 3)
        tangent[:, on.table], shift[:, on.table] = slope, start - slope * force
    return tangent, shift


def _renew_laws(on: OnSet) -> Array:
    """Take the next tangents at the compressions; return the laws' relative misfit."""
    misfit = np.zeros(len(on.rows))
    if len(on.power):
        b, c = on.bending[:, on.power], on.hertz[:, on.power]
        force, compression = on.force[:, on.power], on.compression[:, on.power]
        root, floor = on.root[:, on.power], on.floor[:, None]
        touching = (force > 0.0) & (compression > 0.0)
        on.loose = np.where(touching, 0, on.loose + 1)
        true = b * force + c * np.cbrt(np.maximum(force, 0.0)) ** 2
        off = np.where(touching, np.abs(true - compression), 0.0)
        # A flank that carries nothing has settled once its root is at the floor.
        waiting = ~touching & (root > floor)
        largest = np.abs(on.compression[:, on.scalar]).max(axis=1)
        misfit = off.max(axis=1) / largest
        misfit[waiting.any(axis=1)] = 1.0
        on.loose[touching | (np.abs(force) <= HOT.sign * on.push[:, None])] = 0
        following = roots(b, c, np.where(touching, compression, 1.0))
        on.root[:, on.power] = np.maximum(np.where(touching, following, HOT.shrink * root), floor)
    if len(on.table):
        compression = on.compression[:, on.table]
        start, force, slope = piece(*on.points[::-1], compression)
        force = force + slope * (compression - start)
        on.root[:, on.table] = np.cbrt(np.maximum(force, 0.0))
    return misfit


def _blocks(on: OnSet) -> list[RadialTangent]:
    """Return the tangents of the radial elements at their present offsets."""
    blocks = []
    for j, status, k in on.radial:
        if j in on.linear:
            blocks.append(on.linear[j])
            continue
        columns = slice(k, k + 2)
        x, force = on.lean
        offset = on.offset(j, x)
        law = on.graph(j, offset)
        on.refused |= ~law.valid
        size = np.maximum(on.push, 1e-300)
        found = block(columns, status, law, offset, force[:, columns], size)
        if status in (at.STICK, at.PINNED) and j in on.fixed:
            on.linear[j] = found
        blocks.append(found)
    return blocks


def _slipped_out(on: OnSet) -> Flags:
    """Return which samples have a radial element that has left its level piece or rigid stop.

    It stays far beyond the end of that piece, or friction that follows the torque has vanished; or
    a rigid stop goes on holding inward.
    """
    for j, status, k in on.radial:
        offset = on.offset(j)
        law = on.graph(j, offset)
        if status == at.SLIP:
            radius = np.sqrt((offset**2).sum(axis=1))
            left = (radius > HOT.beyond * law.reach) | (law.bound <= HOT.sign * on.push)
        elif status == at.WALL:
            left = (offset * on.force[:, k : k + 2]).sum(axis=1) < 0.0
        else:
            continue
        on.outside[:, j] = np.where(left, on.outside[:, j] + 1, 0)
    return np.asarray((on.outside >= on.patience).any(axis=1))


def _give_up_gross(on: OnSet, these: Flags) -> None:
    """Give up sets that are clearly wrong before they are settled."""
    these = these & ~on.gross.any(axis=1)
    if not these.any():
        return
    before, on.settled = on.settled, these
    wrong, moved = wrong_elements(on, HOT.gross)
    on.settled = before
    wrong &= these[:, None]
    on.gross |= wrong
    on.gross_to[these] = moved[these]


def change(now: Array, before: Array) -> Array:
    """Return the largest change of each row over its largest entry."""
    size = np.abs(now).max(axis=1, initial=0.0)
    return np.asarray(np.abs(now - before).max(axis=1, initial=0.0) / np.maximum(size, 1e-300))
