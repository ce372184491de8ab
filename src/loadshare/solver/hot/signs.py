"""Elements with the wrong sign in settled samples, and elements in the way of drifting ones."""

from __future__ import annotations

import math

import numpy as np

from loadshare.array_library import in_places, largest, to_numpy
from loadshare.array_types import Array, Flags, States
from loadshare.settings import HOT
from loadshare.solver.hot import contact_states as at
from loadshare.solver.hot.elements import arcs_at, arcs_of, pick
from loadshare.solver.hot.on_set import OnSet
from loadshare.solver.hot.radials import beyond, right_state, until
from loadshare.solver.hot.rest import rest


def wrong_elements(on: OnSet, sign: float) -> tuple[Flags, States]:
    """Return which elements have the wrong sign, and the states that they should have."""
    xp, structure = on.library, on.structure
    largest_force = xp.maximum(largest(on.force), on.push)
    yielded = xp.maximum(largest(on.compression[:, on.scalar]), HOT.of_way * largest(on.x))
    force_band, faint, length_band = sign * largest_force, HOT.sign * largest_force, sign * yielded
    pulls = in_places(on.force[:, on.contact] < -force_band[:, None], on.contact_of)
    wrong = xp.where(on.acts, pulls, on.room() < -length_band[:, None])
    pulled = wrong & on.burst[:, None] & on.closed
    wrong = (wrong & on.settled[:, None]) | pulled
    late = (on.loose >= HOT.patience) & ~on.settled[:, None]
    if xp.any(late):
        # Passes that did not settle may still show which flank is open.
        wrong = wrong | in_places(late, on.power_of)
    wrongs = [wrong]
    other = 1 - xp.astype(on.closed, xp.int8)
    moves = [xp.broadcast_to(other[None, :], wrong.shape)]
    acting = {j: k for j, _, k in on.radial}
    for j in range(len(structure.radials)):
        offset, k = on.offset(j), acting.get(j)
        force = on.force[:, k : k + 2] if k is not None else xp.zeros_like(offset)
        law, state = on.graph(j, offset), int(on.states[structure.rows + j])
        left, moved = right_state(state, law, offset, force, force_band, length_band, faint)
        left = left & on.settled
        if j in on.outside:
            left = left | ((on.outside[j] >= on.patience[j]) & ~on.settled)
        wrongs.append(left[:, None])
        moves.append(moved[:, None])
    return xp.concat(wrongs, axis=1), xp.concat(moves, axis=1)


def left_in_place(
    on: OnSet, before: Array, these: Flags, wrong: Flags, moved: States
) -> tuple[Flags, States]:
    """Put what no acting element holds back to where it was, if that corrects all signs."""
    xp, least = on.library, on.x
    on.move(these, (before - least) @ on.basis.loose)
    other, states = wrong_elements(on, HOT.sign)
    these = (these & ~xp.any(other, axis=1))[:, None]
    on.x = xp.where(these, on.x, least)
    return xp.where(these, other, wrong), xp.where(these, states, moved)


def drift(on: OnSet) -> Array:
    """Return the move (k, n) that no acting element resists and the load drives; zero without."""
    along = on.load @ on.basis.loose
    drifting = largest(along) > HOT.drift * on.push
    found: Array = on.library.where(drifting[:, None], along @ on.basis.loose.T, 0.0)
    return found


def stopped_by(on: OnSet, drift: Array) -> tuple[Flags, States]:
    """Go along a drift (k, n) to the first element in the way; return it and its new state."""
    xp, structure = on.library, on.structure
    speed = drift @ on.vectors.T
    fast = HOT.drift * largest(drift)[:, None]
    way = xp.where(speed > fast, xp.maximum(on.room(), 0.0) / speed, math.inf)
    ways = [xp.where(on.closed, math.inf, way)]
    states = [xp.full_like(way, at.CLOSED, dtype=xp.int8)]
    for j in range(len(structure.radials)):
        offset = on.offset(j)
        law = on.graph(j, offset)
        reached = until(offset, drift @ on.matrices[j].T, law.reach, fast[:, 0])
        free = on.states[structure.rows + j] == at.OPEN
        ways.append((reached if free else xp.full_like(reached, math.inf))[:, None])
        states.append(beyond(law)[:, None])
    way = xp.concat(ways, axis=1)
    nearest, shortest = xp.argmin(way, axis=1), xp.min(way, axis=1)
    stopped = xp.isfinite(shortest)
    numbers = xp.asarray(np.arange(structure.switches), device=way.device)
    stopping = (numbers == nearest[:, None]) & stopped[:, None]
    # From elsewhere the passes may end at the far side of a ring, held inward.
    on.x = on.x + xp.where(stopped, shortest, 0.0)[:, None] * drift
    return stopping, xp.concat(states, axis=1)


def rests(on: OnSet, k: int, wrong: Flags) -> bool:
    """Find a place for sample `k` without overlaps of open elements, if only these are wrong."""
    if (wrong & (on.states != at.OPEN)).any():
        return False
    xp, before = on.library, on.x
    this = xp.asarray(np.arange(len(on.rows)) == k, device=before.device)
    for _ in range(HOT.rolls):
        size = float(xp.max(xp.abs(on.x[k, :])))
        share = rest(*_room(on, k), size)
        if share is None:
            on.x = before
            return False
        on.move(this, xp.asarray(share[None, :], device=before.device))
        # A body that rolls along an arc ends only near the place that was sought.
        if not on.arc or float(np.abs(share).max()) <= HOT.sign * size:
            break
    return True


def _room(on: OnSet, k: int) -> tuple[Array, Array, list[tuple[Array, Array, float]]]:
    """Return the open elements around sample `k`, as arguments of `rest`."""
    structure, rows, here = on.structure, on.structure.rows, on.rows[k : k + 1]
    opened = np.flatnonzero(on.states[:rows] == at.OPEN)
    x, loose = to_numpy(on.x)[k : k + 1], structure.basis(on.states).loose
    vectors = np.array(structure.vectors[structure.springs + opened])
    room = pick(on.loading.gap, here)[0, structure.springs + opened] - vectors @ x[0]
    arcs, first = arcs_of(on.loading, here), structure.flat
    normals, margins = arcs_at(arcs, x)
    for a, row in zip(
        opened[opened >= first] - first, np.flatnonzero(opened >= first), strict=True
    ):
        vectors[row], room[row] = -normals[0, a] @ arcs.relative[a], margins[0, a]
    discs = []
    for j in np.flatnonzero(on.states[rows:] == at.OPEN).tolist():
        offset = on.offset(j)
        # A wall with a power law begins at the clearance, not where its present tangent begins.
        reach = float(on.graph(j, on.library.zeros_like(offset)).reach[k])
        # A spline without friction and without a stop limits nothing.
        disc = structure.radials[j].matrix @ loose, to_numpy(offset)[k], reach
        discs += [disc] if np.isfinite(reach) else []
    closes = vectors @ loose
    finite = np.isfinite(room)
    return closes[finite], room[finite], discs
