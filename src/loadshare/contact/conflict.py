"""Which rigid rows cannot hold together, if any."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from loadshare.array_types import Array
from loadshare.contact.law import PowerLaw
from loadshare.contact.problem import ContactProblem, Row
from loadshare.settings import PLACES


@dataclass(frozen=True, slots=True, eq=False)
class Overlap:
    """The place at which rows overlap least.

    Attributes
    ----------
    size : float
        By how much, in the unit of lengths; negative where all have room.
    place : ndarray, shape (size,)
        In that unit.
    names : tuple of str
        Rows that leave it no room.
    """

    size: float
    place: Array
    names: tuple[str, ...]


def least_overlap(rows: Sequence[Row], size: int, unit: float) -> Overlap | None:
    r"""Return the least overlap of rows; None if the linear programme was not solved.

    .. math:: \min_{x, t} t \quad \text{s.t.}\; a_e\cdot x - t \le g_e

    Where it is positive the rows contradict one another, and those with a multiplier are those that
    do.

    Parameters
    ----------
    rows : sequence of Row
    size : int
        Coordinates.
    unit : float
        Of lengths [m].
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
    """Whether nothing yields at a row."""
    return isinstance(row.law, PowerLaw) and row.law.is_rigid


def conflict(problem: ContactProblem) -> tuple[str, ...]:
    """Return the rigid rows that contradict one another; empty if all can hold.

    Arcs and round limits leave room that turns with the place; they are not judged here.
    """
    rows = []
    for row in filter(is_rigid, problem.rows):
        norm = float(np.linalg.norm(row.vector))
        rows.append(replace(row, vector=row.vector / norm, gap=row.gap / norm))
    if not rows:
        return ()
    unit = max(abs(row.gap) for row in rows) or 1.0
    found = least_overlap(rows, problem.size, unit)
    # The programme is solved to some 1e-9 of the unit: less than that is no proof.
    return found.names if found is not None and found.size > PLACES.pushed else ()
