"""Find rigid limits that contradict one another."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from loadshare.array_types import Array
from loadshare.contact.law import PowerLaw
from loadshare.contact.problem import ContactProblem, Radial, Row
from loadshare.settings import PLACES

RIGID = PowerLaw(0.0, 0.0)
AXES = np.vstack([np.eye(2), -np.eye(2)])
"""Directions of the first tangents."""
Rounds = list[tuple[Radial, float]]
"""Round limits, each with how far it lets its offset go."""


@dataclass(frozen=True, slots=True, eq=False)
class Overlap:
    """The place at which rows overlap least.

    Attributes
    ----------
    size : float
        The largest overlap there, in the unit of length; negative if all rows leave room.
    place : ndarray, shape (size,)
        In that unit.
    names : tuple of str
        Rows that determine it.
    """

    size: float
    place: Array
    names: tuple[str, ...]


def least_overlap(rows: Sequence[Row], size: int, unit: float) -> Overlap | None:
    r"""Return the least overlap of rows; None if the linear programme was not solved.

    .. math:: \min_{x, t} t \quad \text{s.t.}\; a_e\cdot x - t \le g_e

    If it is positive the rows contradict one another, namely those with a multiplier.

    Parameters
    ----------
    rows : sequence of Row
    size : int
        Number of coordinates.
    unit : float
        Unit of length [m].
    """
    from scipy.optimize import linprog

    found = linprog(
        np.append(np.zeros(size), 1.0),
        np.array([[*r.vector, -1.0] for r in rows]),
        [r.gap / unit for r in rows],
        bounds=[(None, None)] * size + [(-1.0, None)],
        method="highs",
    )
    if found.status != 0 or found.x is None:
        return None
    shares = np.abs(np.asarray(found.ineqlin.marginals))
    part = (shares > PLACES.named * shares.max()).tolist()
    names = dict.fromkeys(r.name for r, has in zip(rows, part, strict=True) if has)
    return Overlap(float(found.x[-1]), found.x[:-1], tuple(names))


def is_rigid(row: Row) -> bool:
    """Return whether nothing yields at a row."""
    return isinstance(row.law, PowerLaw) and row.law.is_rigid


def rounds_of(problem: ContactProblem) -> Rounds:
    """Return the round limits of a problem that end at a rigid wall."""
    laws = {r: r.at_rest for r in problem.radials if not r.follows_torque}
    return [(r, law.reach) for r, law in laws.items() if law and math.isfinite(law.reach)]


def contradicting_limits(
    rows: Sequence[Row], rounds: Rounds, size: int, unit: float, overlap: float
) -> tuple[str, ...]:
    r"""Return the limits that contradict one another; empty if all can hold.

    They determine the least overlap t of any displacement (see `least_overlap`), to which round
    limits j add

    .. math:: \lVert P_j x - m_j\rVert - t \le R_j

    Tangents stand for these limits. They leave more room, so that a positive overlap is a proof all
    the same.

    Parameters
    ----------
    rows : sequence of Row
        Rigid ones.
    rounds : list of (Radial, float)
    size : int
        Number of coordinates.
    unit : float
        Unit of length [m], enlarged if a gap is larger.
    overlap : float
        Overlap in that unit that counts as round-off.
    """
    rows = [*rows, *(_tangent(r, reach, along) for r, reach in rounds for along in AXES)]
    if not rows:
        return ()
    unit = max(unit, *(abs(r.gap) for r in rows)) or 1.0
    for _ in range(PLACES.programmes):
        found = least_overlap(rows, size, unit)
        if found is None:
            return ()
        if found.size > overlap:
            return found.names
        offsets = [r.matrix @ found.place * unit - r.centre for r, _ in rounds]
        beyond = [
            _tangent(r, reach, offset / np.linalg.norm(offset))
            for (r, reach), offset in zip(rounds, offsets, strict=True)
            if np.linalg.norm(offset) - reach > max(found.size, overlap) * unit
        ]
        if not beyond:
            return ()
        rows += beyond
    return ()


def _tangent(radial: Radial, reach: float, along: Array) -> Row:
    """Return the tangent half-plane that contains a round limit, in a direction (2,)."""
    return Row(
        radial.name,
        "stop",
        along @ radial.matrix,
        reach + float(along @ radial.centre),
        RIGID,
    )


def conflict(problem: ContactProblem) -> tuple[str, ...]:
    """Return the rigid limits that contradict one another; empty if all can hold.

    Arcs are not judged here: the half-plane that they leave turns with the displacement.
    """
    rows = []
    for row in filter(is_rigid, problem.rows):
        norm = float(np.linalg.norm(row.vector))
        rows.append(replace(row, vector=row.vector / norm, gap=row.gap / norm))
    # The programme is solved to some 1e-9 of the unit: a smaller overlap proves nothing.
    return contradicting_limits(rows, rounds_of(problem), problem.size, 0.0, PLACES.pushed)
