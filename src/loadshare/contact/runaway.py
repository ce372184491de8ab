"""Find coordinates that the load of a contact problem moves without end."""

from __future__ import annotations

import math

import numpy as np

from loadshare.array_types import Array
from loadshare.contact.problem import ContactProblem
from loadshare.settings import PLACES


def runaway(problem: ContactProblem) -> dict[str, float]:
    r"""Return the coordinates that the load moves without end, with their parts of the move.

    Empty if it moves none; those on which it does most work come first. Of all moves d that no
    contact, spring or limit resists, however far they go,

    .. math:: \max_d f\cdot d - \sum_j F_j \lVert P_j d \rVert \quad \text{s.t.}\; H d = 0,\;
        P_k d = 0,\; a_e\cdot d \le 0,\; |d_i| \le 1 ,

    the move is the one along which the work of the load exceeds most that of friction F, of graphs
    that end in a level piece. If the excess is positive the potential falls without bound: the
    problem has no equilibrium. Arcs are replaced by their faces at rest.
    """
    from scipy.optimize import linprog

    strengths = {r.name: r.at_rest.strength if r.at_rest else math.inf for r in problem.radials}
    rubbing = [r for r in problem.radials if strengths[r.name] < math.inf]
    held = np.vstack(
        [
            _resisted(problem.stiffness),
            *(r.matrix for r in problem.radials if strengths[r.name] == math.inf),
        ]
    )
    rows = problem.rows_at(np.zeros(problem.size))
    against = np.array([r.vector for r in rows]).reshape(-1, problem.size)
    count, facets = len(rubbing), _facets()
    slides = [
        np.hstack([facets @ r.matrix, np.tile(-np.eye(count)[j], (len(facets), 1))])
        for j, r in enumerate(rubbing)
    ]
    below = np.vstack([np.pad(against, ((0, 0), (0, count))), *slides])
    unit = problem.force_unit()
    found = linprog(
        np.concatenate([-problem.load, [strengths[r.name] for r in rubbing]]) / unit,
        below,
        np.zeros(len(below)),
        np.pad(held, ((0, 0), (0, count))),
        np.zeros(len(held)),
        bounds=[(-1.0, 1.0)] * problem.size + [(0.0, None)] * count,
        method="highs",
    )
    if found.status != 0 or found.fun is None or found.x is None or found.fun >= -PLACES.pushed:
        return {}
    move = found.x[: problem.size]
    work = problem.load * move
    moving = np.flatnonzero(np.abs(move) > PLACES.named).tolist()
    moving.sort(key=lambda k: -float(work[k]))
    return {problem.coordinates[k]: float(move[k]) for k in moving}


def _resisted(stiffness: Array) -> Array:
    """Return rows (k, n), largest entry 1, that vanish along moves that no spring resists.

    They come from elimination; its pivot has the largest part left of its original diagonal, so
    that the row of the softest spring is as accurate as that of the stiffest.
    """
    left, rows = stiffness.copy(), [np.zeros(len(stiffness))]
    alone = np.where(np.diag(stiffness) > 0.0, np.diag(stiffness), math.inf)
    while np.any(np.diag(left) > PLACES.resists * alone):
        pivot = np.argmax(np.diag(left) / alone)
        row = left[pivot]
        rows.append(row / np.abs(row).max())
        # Divided first: a product of two entries may lie outside the range of doubles.
        left = left - np.outer(row, row / row[pivot])
    return np.array(rows)


def _facets() -> Array:
    """Return directions (k, 2) whose largest product with a vector is at least its length."""
    angles = 2.0 * math.pi * np.arange(PLACES.facets) / PLACES.facets
    way = np.column_stack([np.cos(angles), np.sin(angles)])
    return np.asarray(way / math.cos(math.pi / PLACES.facets))
