"""Bodies that nothing holds, moved to where they have most room.

What floats may rest anywhere; a place on a limit would make its gauge vanish for no reason. Rooms
are compared in deflections, and all points are asked in one linear programme, a block for each.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import block_diag

from loadshare.scene.scene import Array
from loadshare.solver.hot import places as at
from loadshare.study.follow.equations import Equations, free_moves, scaling
from loadshare.study.follow.line import Numbers

FACETS = 24
"""Sides of the polygon that stands for a round ring in which a body floats."""
BINDS = 1e-6
"""Room [deflections] left by the linear programme at which a limit binds."""
ROOM = 1.0
"""Room [deflections] around a floating body that is as good as any more."""
FELT = 1e-9
"""Speed at which a move closes a limit, over that of the move, below which it does not."""


def centred(equations: Equations, z: Array, numbers: Numbers) -> Array:
    """Move bodies that nothing holds, at points z (S, size), away from what they may touch."""
    jacobian = np.nan_to_num(equations.jacobian(z, numbers))
    if not equations.leaves_free(jacobian):
        return z
    factor = scaling(jacobian)
    right, null = free_moves(jacobian * factor[:, :, None] * factor[:, None, :])
    rows = np.flatnonzero(null.any(axis=1))
    if not len(rows):
        return z
    moves = [(right[k][null[k]] * factor[k])[:, : equations.n] for k in rows.tolist()]
    z = z.copy()
    z[rows] = _into_the_middle(equations, z[rows], numbers.take(rows), moves)
    return z


def _into_the_middle(
    equations: Equations, z: Array, numbers: Numbers, moves: Sequence[Array]
) -> Array:
    """Move points (S, size) along moves (k, n) that nothing resists, to where room is largest."""
    z = z.copy()
    moves = [m / np.maximum(np.abs(m).max(axis=1, initial=0.0), 1e-300)[:, None] for m in moves]
    curved = len(equations.arc_acts) or (equations.places == at.OPEN).any()
    # Limits that curve are straight around the point: the second time they are nearly exact.
    for _ in range(2 if curved else 1):
        room, closing = _rooms(equations, z, numbers)
        blocks: list[tuple[int, Array, Array]] = []
        for k, mine in enumerate(moves):
            speed = closing[k] @ mine.T
            near = (np.abs(speed).max(axis=1, initial=0.0) > FELT) & np.isfinite(room[k])
            if near.any():
                rows = np.hstack([speed[near], np.ones((int(near.sum()), 1))])
                blocks.append((k, rows, room[k, near]))
        for (k, *_), step in zip(blocks, _widest([b[1:] for b in blocks]), strict=True):
            z[k, : equations.n] += step @ moves[k]
    return z


def _widest(blocks: Sequence[tuple[Array, Array]]) -> list[Array]:
    """How far to go along every move of a block, so that its least room becomes largest.

    Parameters
    ----------
    blocks : sequence of (ndarray, ndarray), shapes (rows, moves + 1) and (rows,)
        How fast the moves close every limit, then 1 for the least room; rooms.
    """
    if not blocks:
        return []
    widths = [rows.shape[1] for rows, _ in blocks]
    last = np.cumsum(widths) - 1
    cost = np.zeros(sum(widths))
    cost[last] = -1.0
    upper = np.full(len(cost), np.inf)
    upper[last] = ROOM
    answer = linprog(  # type: ignore[call-overload]
        cost,
        A_ub=block_diag([rows for rows, _ in blocks], format="csc"),
        b_ub=np.concatenate([room for _, room in blocks]),
        bounds=np.stack([np.full(len(cost), -np.inf), upper], axis=1),
        method="highs-ds",
    )
    if answer.x is None:
        return [np.zeros(width - 1) for width in widths]
    steps = []
    for (rows, room), found in zip(blocks, np.split(answer.x, last[:-1] + 1), strict=True):
        # The programme is solved to its tolerance; what binds is met to round-off.
        left = room - rows @ found
        binds = left <= BINDS
        more = np.linalg.lstsq(rows[binds], left[binds], rcond=None)[0]
        steps.append((found + more)[:-1])
    return steps


def _rooms(equations: Equations, z: Array, numbers: Numbers) -> tuple[Array, Array]:
    """Room before open limits (S, k), infinite where there is none, and how fast it closes."""
    state = equations.state(z, numbers)
    count, n = len(z), equations.n
    idle = np.flatnonzero(~equations.acts[equations.elements.springs :])
    idle = idle[idle < equations.scalars - equations.elements.springs] + equations.elements.springs
    approach = state.approach[:, idle]
    room = [np.where(np.isfinite(approach), -approach, np.inf)]
    vectors = np.broadcast_to(numbers.vectors, (count, *numbers.vectors.shape[1:]))
    closing = [vectors[:, idle]]
    for a, polar in state.arcs.items():
        if a not in equations.arc_at:
            room.append(state.margin[:, [a]])
            closing.append(-polar.along[:, None, :] @ polar.matrix)
    turns = 2.0 * np.pi * np.arange(FACETS) / FACETS
    ways = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    for j, polar in state.radials.items():
        if equations.places[j] == at.OPEN:
            room.append(state.laws[j].reach[:, None] - polar.offset @ ways.T)
            closing.append(ways @ np.broadcast_to(polar.matrix, (count, 2, n)))
    return np.concatenate(room, axis=1), np.concatenate(closing, axis=1)
