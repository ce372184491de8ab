"""Elements with the wrong sign in settled samples, and elements in the way of drifting ones."""

from __future__ import annotations

import numpy as np

from loadshare.array_types import Array, Flags, States
from loadshare.settings import HOT
from loadshare.solver.hot import contact_states as at
from loadshare.solver.hot.elements import arc_at, pick
from loadshare.solver.hot.on_set import OnSet
from loadshare.solver.hot.radials import beyond, right_state, until
from loadshare.solver.hot.rest import rest


def wrong_elements(on: OnSet, sign: float) -> tuple[Flags, States]:
    """Return which elements have the wrong sign, and the states that they should have."""
    structure = on.structure
    wrong = np.zeros((len(on.rows), structure.switches), dtype=bool)
    moved = np.repeat(on.states[None, :], len(on.rows), axis=0)
    largest_force = np.maximum(np.abs(on.force).max(axis=1, initial=0.0), on.push)
    furthest = np.abs(on.x).max(axis=1, initial=0.0)
    yielded = np.abs(on.compression[:, on.scalar]).max(axis=1, initial=0.0)
    force_band, faint = sign * largest_force, HOT.sign * largest_force
    length_band = sign * np.maximum(yielded, HOT.of_way * furthest)
    rows = structure.columns.contacts
    closed = on.states[: structure.rows] == at.CLOSED
    wrong[:, : structure.rows] = on.room() < -length_band[:, None]
    row = np.flatnonzero((on.basis.columns >= rows.start) & (on.basis.columns < rows.stop))
    switch = on.basis.columns[row] - rows.start
    wrong[:, switch] = on.force[:, row] < -force_band[:, None]
    moved[:, : structure.rows] = np.where(closed, at.OPEN, at.CLOSED)
    acting = {j: k for j, _, k in on.radial}
    for j in range(structure.switches - structure.rows):
        s, k = structure.rows + j, acting.get(j)
        force = on.force[:, k : k + 2] if k is not None else np.zeros((len(on.rows), 2))
        offset = on.offset(j)
        wrong[:, s], moved[:, s] = right_state(
            int(on.states[s]),
            on.graph(j, offset),
            offset,
            force,
            force_band,
            length_band,
            faint,
        )
    slipped = (on.outside >= on.patience) & ~on.settled[:, None]
    pulled = wrong & on.burst[:, None] & np.append(closed, np.zeros_like(slipped[0]))
    wrong &= on.settled[:, None]
    wrong[:, structure.rows :] |= slipped
    wrong |= pulled
    # Passes that did not settle may still show which flank is open.
    power = on.basis.columns[on.power] - structure.springs
    opening = (on.loose >= HOT.patience) & ~on.settled[:, None]
    wrong[:, power] |= opening
    return wrong, moved


def left_in_place(
    on: OnSet, before: Array, these: Flags, wrong: Flags, moved: States
) -> tuple[Flags, States]:
    """Put what no acting element holds back to where it was, if that corrects all signs."""
    least, loose = on.x, on.basis.loose
    on.move(these, (before - least) @ loose)
    other, states = wrong_elements(on, HOT.sign)
    these = these & ~other.any(axis=1)
    on.x = np.where(these[:, None], on.x, least)
    return np.where(these[:, None], other, wrong), np.where(these[:, None], states, moved)


def drift(on: OnSet) -> Array:
    """Return the move (k, n) that no acting element resists and the load drives; zero without."""
    along = on.load @ on.basis.loose
    drifting = np.abs(along).max(axis=1, initial=0.0) > HOT.drift * on.push
    return np.asarray(np.where(drifting[:, None], along @ on.basis.loose.T, 0.0))


def stopped_by(on: OnSet, drift: Array) -> tuple[Flags, States]:
    """Go along a drift (k, n) to the first element in the way; return it and its new state."""
    structure = on.structure
    stopping = np.zeros((len(on.rows), structure.switches), dtype=bool)
    rows = structure.columns.contacts
    speed = drift @ structure.vectors[rows].T
    fast = HOT.drift * np.abs(drift).max(axis=1, initial=0.0)[:, None]
    way = np.where(speed > fast, np.maximum(on.room(), 0.0) / speed, np.inf)
    way[:, on.states[: structure.rows] == at.CLOSED] = np.inf
    states = np.repeat(on.states[None, :], len(on.rows), axis=0)
    states[:, : structure.rows] = at.CLOSED
    ends = [way]
    for j in range(structure.switches - structure.rows):
        offset = on.offset(j)
        law = on.graph(j, offset)
        velocity = drift @ structure.radials[j].matrix.T
        reached = until(offset, velocity, law.reach, fast[:, 0])
        free = on.states[structure.rows + j] == at.OPEN
        ends.append(np.where(free, reached, np.inf)[:, None])
        states[:, structure.rows + j] = beyond(law)
    ways = np.concatenate(ends, axis=1)
    everyone, nearest = np.arange(len(on.rows)), ways.argmin(axis=1)
    way = ways[everyone, nearest]
    stopping[everyone, nearest] = stopped = np.isfinite(way)
    # From elsewhere the passes may end at the far side of a ring, held inward.
    on.x += np.where(stopped, way, 0.0)[:, None] * drift
    return stopping, states


def rests(on: OnSet, k: int, wrong: Flags) -> bool:
    """Find a place for sample `k` without overlaps of open elements, if only these are wrong."""
    if (wrong & (on.states != at.OPEN)).any():
        return False
    before, this = on.x, np.arange(len(on.rows)) == k
    for _ in range(HOT.rolls):
        size = float(np.abs(on.x[k]).max())
        share = rest(*_room(on, k), size)
        if share is None:
            on.x = before
            return False
        on.move(this, share[None, :])
        # A body that rolls along an arc ends only near the place that was sought.
        if not len(on.arc) or float(np.abs(share).max()) <= HOT.sign * size:
            break
    return True


def _room(on: OnSet, k: int) -> tuple[Array, Array, list[tuple[Array, Array, float]]]:
    """Return the open elements around sample `k`, as arguments of `rest`."""
    structure, rows, here = on.structure, on.structure.rows, on.rows[k : k + 1]
    opened = np.flatnonzero(on.states[:rows] == at.OPEN)
    x, loose = on.x[k : k + 1], on.basis.loose
    vectors = np.array(structure.vectors[structure.springs + opened])
    room = pick(on.loading.gap, here)[0, structure.springs + opened] - vectors @ x[0]
    first = structure.flat
    for a, row in zip(
        opened[opened >= first] - first, np.flatnonzero(opened >= first), strict=True
    ):
        normal, margin = arc_at(on.loading, a, here, x)
        vectors[row], room[row] = (-normal @ on.loading.relative[a])[0], margin[0]
    discs = []
    for j in np.flatnonzero(on.states[rows:] == at.OPEN).tolist():
        matrix = structure.radials[j].matrix @ loose
        offset = on.offset(j)
        # A wall with a power law begins at the clearance, not where its present tangent begins.
        reach = float(on.graph(j, np.zeros_like(offset)).reach[k])
        # A spline without friction and without a stop limits nothing.
        discs += [(matrix, offset[k], reach)] if np.isfinite(reach) else []
    closes = vectors @ loose
    finite = np.isfinite(room)
    return closes[finite], room[finite], discs
