"""Bodies that nothing holds, moved to where they have most room.

A floating body may rest anywhere; on a limit it would make the limit's gauge vanish for no reason.
Rooms are compared in deflections, and all points are found in one linear programme, with a block
for each.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from loadshare.array_types import Array
from loadshare.libraries import optimize
from loadshare.settings import FOLLOW
from loadshare.study.follow.equations import Equations, balanced, free_moves
from loadshare.study.follow.numbers import Numbers


def centred(equations: Equations, z: Array, numbers: Numbers) -> Array:
    """Move bodies that nothing holds, at points z (S, size), away from what they may touch."""
    jacobian = np.nan_to_num(equations.jacobian(z, numbers))
    if not equations.leaves_free(jacobian):
        return z
    factor, scaled = balanced(jacobian)
    right, null = free_moves(scaled)
    rows = np.flatnonzero(null.any(axis=1))
    if not len(rows):
        return z
    moves = [(right[k][null[k]] * factor[k])[:, : equations.n] for k in rows.tolist()]
    z = z.copy()
    z[rows] = _to_centre(equations, z[rows], numbers.take(rows), moves)
    return z


def _to_centre(equations: Equations, z: Array, numbers: Numbers, moves: Sequence[Array]) -> Array:
    """Move points (S, size) along moves (k, n) that nothing resists, to where room is largest.

    A round limit is replaced by a polygon of tangents, at first at equal angles, then refined
    around the points reached, until there is as much room as the polygon promises.
    """
    z = z.copy()
    moves = [m / np.maximum(np.abs(m).max(axis=1, initial=0.0), 1e-300)[:, None] for m in moves]
    turns = 2.0 * np.pi * np.arange(FOLLOW.facets) / FOLLOW.facets
    ways = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    apart = turns[1] * np.arange(1 - FOLLOW.finer // 2, FOLLOW.finer // 2) / FOLLOW.finer
    facets = np.broadcast_to(ways, (len(z), len(equations.radials), FOLLOW.facets, 2))
    bends = any(k not in equations.polar_at for k in equations.arcs)
    rows, scale = np.arange(len(z)), np.ones(len(z))
    for number in range(FOLLOW.polygons):
        here = numbers.take(rows)
        room, closing = _rooms(equations, z[rows], here, facets)
        blocks: dict[int, tuple[Array, Array]] = {}
        for i, k in enumerate(rows.tolist()):
            speed = closing[i] @ moves[k].T
            near = (np.abs(speed).max(axis=1, initial=0.0) > FOLLOW.felt) & np.isfinite(room[i])
            if near.any():
                limits = np.hstack([speed[near], np.ones((int(near.sum()), 1))])
                blocks[i] = limits, room[i, near] / scale[i]
        promised = np.full(len(rows), -np.inf)
        steps = _widest(list(blocks.values()), FOLLOW.room / scale[list(blocks)])
        for i, step in zip(blocks, steps, strict=True):
            z[rows[i], : equations.n] += scale[i] * step[:-1] @ moves[rows[i]]
            promised[i] = scale[i] * step[-1]
        along, actual = _round(equations, z[rows], here)
        short = (promised > FOLLOW.spent) & (actual < (1.0 - FOLLOW.full) * promised)
        # Arcs are linearised at the point: in the second pass they are nearly exact.
        again = short | (bends and number == 0) & np.isfinite(promised)
        if not again.any():
            break
        rows, facets = rows[again], np.concatenate([facets, _turned(along, apart)], axis=2)[again]
        apart = apart / FOLLOW.finer
        scale = np.clip(np.where(short, promised - actual, 1.0), FOLLOW.unit_of_room, 1.0)[again]
    return z


def _turned(ways: Array, angles: Array) -> Array:
    """Return directions (…, 2) turned by every angle (k), as (…, k, 2)."""
    across = np.stack([-ways[..., 1], ways[..., 0]], axis=-1)
    return (
        ways[..., None, :] * np.cos(angles)[:, None]
        + across[..., None, :] * np.sin(angles)[:, None]
    )


def _widest(blocks: Sequence[tuple[Array, Array]], most: Array) -> list[Array]:
    """Return the steps along a block's moves that make its least room largest, and that room.

    Parameters
    ----------
    blocks : sequence of (ndarray, ndarray), shapes (rows, moves + 1) and (rows,)
        How fast the moves close every limit, then 1 for the least room; the rooms.
    most : ndarray, shape (blocks,)
        Room beyond which more is of no use.
    """
    if not blocks:
        return []
    from scipy.sparse import block_diag

    widths = [rows.shape[1] for rows, _ in blocks]
    last = np.cumsum(widths) - 1
    cost = np.zeros(sum(widths))
    cost[last] = -1.0
    upper = np.full(len(cost), np.inf)
    upper[last] = most
    answer = optimize.linprog(  # type: ignore[call-overload]
        cost,
        A_ub=block_diag([rows for rows, _ in blocks], format="csc"),
        b_ub=np.concatenate([room for _, room in blocks]),
        bounds=np.stack([np.full(len(cost), -np.inf), upper], axis=1),
        method="highs-ds",
    )
    if answer.x is None:
        return [np.zeros(width) for width in widths]
    steps = []
    for (rows, room), found in zip(blocks, np.split(answer.x, last[:-1] + 1), strict=True):
        # The programme is solved to its tolerance only; binding limits are then met to round-off.
        left = room - rows @ found
        binds = left <= FOLLOW.binds
        more = np.linalg.lstsq(rows[binds], left[binds], rcond=None)[0]
        steps.append(found + more)
    return steps


def _rooms(equations: Equations, z: Array, numbers: Numbers, facets: Array) -> tuple[Array, Array]:
    """Return the room before open limits (S, k), infinite without one, and how fast it closes.

    Round limits are polygons whose sides face the directions `facets` (S, radials, sides, 2).
    """
    state = equations.state(z, numbers)
    count, n = len(z), equations.n
    # Springs always act.
    idle = np.flatnonzero(~equations.acts)
    approach = state.approach[:, idle]
    room = [np.where(np.isfinite(approach), -approach, np.inf)]
    vectors = np.broadcast_to(numbers.vectors, (count, *numbers.vectors.shape[1:]))
    closing = [vectors[:, idle]]
    for k in equations.arcs:
        polar = state.polars[k]
        if k not in equations.polar_at:
            room.append(state.margin[k][:, None])
            closing.append(-polar.along[:, None, :] @ polar.matrix)
    for j, k in enumerate(equations.radials):
        polar = state.polars[k]
        if k not in equations.polar_at:
            ways = facets[:, j]
            room.append(state.laws[k].reach[:, None] - (ways @ polar.offset[:, :, None])[:, :, 0])
            closing.append(ways @ np.broadcast_to(polar.matrix, (count, 2, n)))
    return np.concatenate(room, axis=1), np.concatenate(closing, axis=1)


def _round(equations: Equations, z: Array, numbers: Numbers) -> tuple[Array, Array]:
    """Return directions (S, radials, 2) of floats from centres of round limits, and least room."""
    state = equations.state(z, numbers)
    ways, least = np.zeros((len(z), len(equations.radials), 2)), np.full(len(z), np.inf)
    for j, k in enumerate(equations.radials):
        if k not in equations.polar_at:
            ways[:, j] = state.polars[k].along
            least = np.minimum(least, state.laws[k].reach - state.polars[k].radius)
    return ways, least
