"""Which rigid limits of a scene cannot hold together, if any."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from loadshare.array_types import Array
from loadshare.contact.conflict import is_rigid, least_overlap
from loadshare.contact.law import PowerLaw
from loadshare.contact.problem import Row
from loadshare.scene.scene import GearRadial, Scene
from loadshare.settings import PLACES

RIGID = PowerLaw(0.0, 0.0)
AXES = np.vstack([np.eye(2), -np.eye(2)])
"""Directions of the first tangents."""


def contradiction(scene: Scene, overlap: float = PLACES.overlap) -> tuple[str, ...]:
    r"""Return the rigid limits that contradict one another; empty if all can hold.

    They are those of the least overlap t of any displacement (see `least_overlap`), with

    .. math:: \lVert P_j x - m_j\rVert - t \le R_j

    of round limits j besides. These count by tangents, which leave more room, so that a positive
    overlap is one all the same.
    """
    laws = {r: r.at_rest for r in scene.radials if not r.follows_torque}
    rounds = [(r, law.reach) for r, law in laws.items() if law and math.isfinite(law.reach)]
    rows = list(_straight(scene, rounds))
    rows += [_tangent(r, reach, along) for r, reach in rounds for along in AXES]
    if not rows:
        return ()
    unit = max(scene.length_unit(), *(abs(r.gap) for r in rows))
    for _ in range(PLACES.programmes):
        found = least_overlap(rows, scene.size, unit)
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


def _straight(scene: Scene, rounds: list[tuple[GearRadial, float]]) -> Iterator[Row]:
    """Rigid contacts, and rigid arcs as faces set back as far as the floats may bend them."""
    rest = np.zeros(scene.size)
    yield from (r for r in scene.rows if is_rigid(r))
    for arc in scene.arcs:
        row = arc.row(rest)
        across = math.sqrt(2.0 * arc.arc.distance * arc.sagitta)
        for r, reach in rounds:
            if (arc.relative.any(axis=0) & r.matrix.any(axis=0)).any():
                across += reach + float(np.linalg.norm(r.centre))
        if is_rigid(row):
            yield replace(row, gap=row.gap + across**2 / (2.0 * arc.arc.distance))


def _tangent(radial: GearRadial, reach: float, along: Array) -> Row:
    """Half-plane that holds a round limit, where that meets a direction (2,)."""
    return Row(
        radial.name,
        "stop",
        along @ radial.matrix,
        reach + float(along @ radial.centre),
        RIGID,
    )
