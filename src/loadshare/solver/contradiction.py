"""Which rigid limits of a scene cannot hold together, if any."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from loadshare.contact.law import PowerLaw
from loadshare.contact.problem import Row
from loadshare.contact.programme import Array
from loadshare.scene.scene import GearRadial, Scene
from loadshare.settings import PLACES

RIGID = PowerLaw(0.0, 0.0)
AXES = np.vstack([np.eye(2), -np.eye(2)])
"""Directions of the first tangents."""


def contradiction(scene: Scene, overlap: float = PLACES.overlap) -> tuple[str, ...]:
    r"""Return the rigid limits that contradict one another; empty if all can hold.

    The least overlap t of any displacement,

    .. math:: \min_{x, t} t \quad \text{s.t.}\; a_e\cdot x - t \le g_e \;\text{ for rigid rows } e,
        \; \lVert P_j x - m_j\rVert - t \le R_j \;\text{ for round limits } j,

    is positive where they contradict, and those with a multiplier are those that do. Round limits
    count by tangents: these leave more room, so that a positive overlap is one all the same.
    """
    from scipy.optimize import linprog

    laws = {r: r.at_rest for r in scene.radials if not r.follows_torque}
    rounds = [(r, law.reach) for r, law in laws.items() if law and math.isfinite(law.reach)]
    rows = list(_straight(scene, rounds))
    rows += [_tangent(r, reach, along) for r, reach in rounds for along in AXES]
    if not rows:
        return ()
    unit = max(scene.length_unit(), *(abs(r.gap) for r in rows))
    bounds = [(None, None)] * scene.size + [(-1.0, None)]
    cost = np.append(np.zeros(scene.size), 1.0)
    for _ in range(PLACES.programmes):
        matrix = np.array([[*r.vector, -1.0] for r in rows])
        found = linprog(cost, matrix, [r.gap / unit for r in rows], bounds=bounds, method="highs")
        if found.status != 0 or found.x is None:
            return ()
        least = float(found.x[-1])
        if least > overlap:
            weights = np.abs(np.asarray(found.ineqlin.marginals))
            named = (
                r.name
                for r, w in zip(rows, weights, strict=True)
                if w > PLACES.named * weights.max()
            )
            return tuple(dict.fromkeys(named))
        offsets = [r.matrix @ found.x[:-1] * unit - r.centre for r, _ in rounds]
        beyond = [
            _tangent(r, reach, offset / np.linalg.norm(offset))
            for (r, reach), offset in zip(rounds, offsets, strict=True)
            if np.linalg.norm(offset) - reach > max(least, overlap) * unit
        ]
        if not beyond:
            return ()
        rows += beyond
    return ()


def _straight(scene: Scene, rounds: list[tuple[GearRadial, float]]) -> Iterator[Row]:
    """Rigid contacts, and rigid arcs as faces set back as far as the floats may bend them."""
    rest = np.zeros(scene.size)
    yield from (r for r in scene.rows if _is_rigid(r))
    for arc in scene.arcs:
        row = arc.row(rest)
        across = math.sqrt(2.0 * arc.arc.distance * arc.sagitta)
        for r, reach in rounds:
            if (arc.relative.any(axis=0) & r.matrix.any(axis=0)).any():
                across += reach + float(np.linalg.norm(r.centre))
        if _is_rigid(row):
            yield replace(row, gap=row.gap + across**2 / (2.0 * arc.arc.distance))


def _is_rigid(row: Row) -> bool:
    return isinstance(row.law, PowerLaw) and row.law.is_rigid


def _tangent(radial: GearRadial, reach: float, along: Array) -> Row:
    """Half-plane that holds a round limit, where that meets a direction (2,)."""
    return Row(
        radial.name,
        "stop",
        along @ radial.matrix,
        reach + float(along @ radial.centre),
        RIGID,
    )
