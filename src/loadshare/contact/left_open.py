"""Find the coordinates that the forces of an answer leave open.

Places with the same forces form a convex set. Springs, contacts that carry, and graphs on a rising
piece or a step hold what they act on; contacts that just touch, and the ends of level pieces, only
let it move away from them. Ends that nothing can leave, such as two stops that face one another,
hold as well.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from loadshare.array_types import Array
from loadshare.contact.problem import ArcRow, ContactProblem, Radial, of_unit_norm
from loadshare.contact.radial import RadialLaw
from loadshare.settings import CONTACT, PLACES


class Round(NamedTuple):
    """A disc in which a radial element carries nothing: ‖P x − m‖ ≤ R."""

    radial: Radial
    radius: float


class MoveLimits(NamedTuple):
    """Limits of contacts and radial elements on moves that leave all forces as they are.

    Attributes
    ----------
    ties : list of ndarray, shape (n,)
        Directions along which nothing moves.
    limits : list of (ndarray, shape (n,), float)
        Directions of approach, and how far each may still close.
    arcs : list of ArcRow
        Arcs that carry nothing.
    rounds : list of Round
    """

    ties: list[Array]
    limits: list[tuple[Array, float]]
    arcs: list[ArcRow]
    rounds: list[Round]


class _End(NamedTuple):
    """An end of moves: none goes along `along`; if none goes away, it holds all of `holds`."""

    along: Array
    holds: Array


def held_by(
    problem: ContactProblem,
    x: Array,
    forces: Mapping[str, float],
    pulls: Mapping[str, Array],
    laws: Mapping[str, RadialLaw],
) -> MoveLimits:
    """Return what limits moves that leave the forces of an answer as they are.

    Parameters
    ----------
    problem : ContactProblem
    x : ndarray, shape (n,)
        Coordinates of the answer.
    forces : mapping of row or arc to float
    pulls : mapping of radial element to ndarray, shape (2,)
        Force along its offset.
    laws : mapping of radial element to RadialLaw
        Laws at the transmitted torques.
    """
    every = [*(abs(f) for f in forces.values()), *(math.hypot(*p) for p in pulls.values())]
    carries = PLACES.carries * max([problem.force_unit(), *every])
    found = MoveLimits([], [], [], [])
    for row in problem.rows:
        if forces.get(row.name, 0.0) > carries:
            found.ties.append(row.vector)
        else:
            # A force that counts as none may still compress a soft contact far.
            end = row.gap + row.law.compression(max(forces.get(row.name, 0.0), 0.0))
            found.limits.append((row.vector, max(end - float(row.vector @ x), 0.0)))
    for arc in problem.arcs:
        if forces.get(arc.name, 0.0) > carries:
            # Moved along the arc, the body would be pushed in another direction.
            found.ties.extend(arc.relative)
        else:
            end = arc.arc.clearance + arc.law.compression(max(forces.get(arc.name, 0.0), 0.0))
            found.arcs.append(replace(arc, arc=replace(arc.arc, clearance=end)))
    for radial in problem.radials:
        pull, law = pulls[radial.name], laws[radial.name]
        size = float(np.linalg.norm(pull))
        level = law.level(size, carries)
        if level is None or (size <= carries and level[1] <= 0.0):
            # A disc without clearance is a point.
            found.ties.extend(radial.matrix)
        elif size <= carries:
            found.rounds.append(Round(radial, level[1]))
        else:
            along = pull / size
            found.ties.append(np.array([-along[1], along[0]]) @ radial.matrix)
            radius = float(along @ radial.offset(x))
            for sign, end in ((1.0, level[1]), (-1.0, level[0])):
                room = max(sign * (end - radius), 0.0)
                found.limits.append((sign * along @ radial.matrix, room))
    return found


def left_open(
    problem: ContactProblem, x: Array, force: Mapping[str, float], pull: Mapping[str, Array]
) -> frozenset[str]:
    """Return the coordinates that can move while all forces stay.

    Parameters
    ----------
    problem : ContactProblem
    x : ndarray, shape (n,)
        Coordinates of an answer.
    force : mapping of row or arc to float
    pull : mapping of radial element to ndarray, shape (2,)
    """
    near = CONTACT.tolerance * problem.length_unit()
    laws = {r.name: r.law(r.torque(force), x) for r in problem.radials}
    held = held_by(problem, x, force, pull, laws)
    ties, faces = [*problem.stiffness, *held.ties], [arc.row(x) for arc in held.arcs]
    limits = held.limits + [(face.vector, face.gap - float(face.vector @ x)) for face in faces]
    ends = [_End(along, along[None, :]) for along, room in limits if room <= near]
    for radial, reach in held.rounds:
        offset = radial.offset(x)
        if reach <= near:
            ties += [*radial.matrix]
        elif float(np.linalg.norm(offset)) >= reach - near:
            # The edge is round: an offset that cannot leave it cannot move along it either.
            ends.append(_End(offset @ radial.matrix, radial.matrix))
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


def _unresisted(ties: Sequence[Array], size: int) -> Array:
    """Return an orthonormal basis (n, k) of moves that none of the rows resists."""
    rows = of_unit_norm(np.array(ties).reshape(-1, size))
    _, values, right = np.linalg.svd(rows, full_matrices=True)
    rank = int((values > CONTACT.loose * values.max(initial=0.0)).sum())
    return np.asarray(right[rank:].T)


def _left_behind(ends: Sequence[_End], moves: Array) -> list[bool]:
    """Return whether moves that respect all ends can go away from each.

    Moves that respect the ends form a cone, so that one of them goes away from all ends that can be
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
