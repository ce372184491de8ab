"""Which coordinates the forces of an answer leave open.

Places with the same forces are a convex set. Springs, contacts that carry and graphs where they
rise or step hold what they act on; contacts that just touch, and the ends of level pieces, let it
go away from them only. Ends that nothing can leave, such as two stops that face one another, hold
as well.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from loadshare.array_types import Array
from loadshare.contact.problem import ContactProblem, Radial, of_unit_norm
from loadshare.settings import CONTACT, PLACES


class _End(NamedTuple):
    """An end of moves: none leads along it, and what it holds if none leads away from it."""

    along: Array
    holds: Array


def left_open(
    problem: ContactProblem, x: Array, force: Mapping[str, float], pull: Mapping[str, Array]
) -> frozenset[str]:
    """Return the coordinates that can move while all forces stay.

    Parameters
    ----------
    problem : ContactProblem
    x : ndarray, shape (n,)
        Place of an answer.
    force : mapping of row or arc to float
    pull : mapping of radial element to ndarray, shape (2,)
    """
    every = [*force.values(), *(float(np.linalg.norm(p)) for p in pull.values())]
    carries = PLACES.carries * max([problem.force_unit(), *every])
    near = CONTACT.tolerance * problem.length_unit()
    ties, ends = [*problem.stiffness], list[_End]()
    # Moved along an arc that it presses, a body would be pushed another way.
    pressed = {arc.name: arc.relative for arc in problem.arcs}
    for row in problem.rows_at(x):
        if force[row.name] > carries:
            ties += [*pressed.get(row.name, row.vector[None, :])]
        elif float(row.vector @ x) - row.gap >= -near:
            ends.append(_End(row.vector, row.vector[None, :]))
    for radial in problem.radials:
        tied, ended = _graph(radial, x, pull[radial.name], radial.torque(force), carries, near)
        ties += tied
        ends += ended
    moves = _unresisted(ties, problem.size)
    while ends and moves.size:
        leaves = _left_behind(ends, moves)
        for end, left in zip(ends, leaves, strict=True):
            ties += [] if left else [*end.holds]
        if all(leaves):
            break
        ends = [end for end, left in zip(ends, leaves, strict=True) if left]
        moves = _unresisted(ties, problem.size)
    moved = np.abs(moves).max(axis=1, initial=0.0)
    return frozenset(
        c for c, v in zip(problem.coordinates, moved, strict=True) if v > CONTACT.loose
    )


def _graph(
    radial: Radial, x: Array, pull: Array, torque: float, carries: float, near: float
) -> tuple[list[Array], list[_End]]:
    """Directions in which a radial element holds, and its ends."""
    offset, size = radial.matrix @ x - radial.centre, float(np.linalg.norm(pull))
    level = radial.law(torque, x).level(size, carries)
    if level is None:
        return [*radial.matrix], []
    if size <= carries:
        radius = float(np.linalg.norm(offset))
        if level[1] <= near:
            return [*radial.matrix], []
        # The edge is round: who cannot leave it cannot move along it either.
        inside = radius < level[1] - near
        return [], [] if inside else [_End(offset @ radial.matrix, radial.matrix)]
    out = pull @ radial.matrix / size
    radius = float(pull @ offset) / size
    ends = [(out, level[1] - radius), (-out, radius - level[0])]
    across = np.array([-pull[1], pull[0]]) @ radial.matrix / size
    return [across], [_End(way, way[None, :]) for way, room in ends if room <= near]


def _unresisted(ties: Sequence[Array], size: int) -> Array:
    """Moves (n, k) that none of the rows resists, an orthonormal basis."""
    rows = of_unit_norm(np.array(ties).reshape(-1, size))
    _, values, right = np.linalg.svd(rows, full_matrices=True)
    rank = int((values > CONTACT.loose * values.max(initial=0.0)).sum())
    return np.asarray(right[rank:].T)


def _left_behind(ends: Sequence[_End], moves: Array) -> list[bool]:
    """Whether a move that keeps to all ends leads away from each.

    Moves that keep to the ends are a cone, so that one of them leads away from all ends that can be
    left at all.
    """
    from scipy.optimize import linprog

    along = np.array([end.along for end in ends])
    norms = np.linalg.norm(along, axis=1, keepdims=True)
    ways = along / np.where(norms > 0.0, norms, 1.0) @ moves
    count, width = ways.shape
    far = 1.0 / CONTACT.least_way
    found = linprog(
        np.concatenate([np.zeros(width), -np.ones(count)]),
        np.hstack([ways, np.eye(count)]),
        np.zeros(count),
        bounds=[(-far, far)] * width + [(0.0, 1.0)] * count,
        method="highs",
    )
    if found.x is None:
        return [True] * count
    return [bool(left > 0.5) for left in found.x[width:]]
