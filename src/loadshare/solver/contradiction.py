"""Rigid limits of a scene that contradict one another."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from loadshare.contact.conflict import Rounds, contradicting_limits, is_rigid, rounds_of
from loadshare.contact.problem import Row
from loadshare.scene.scene import Scene
from loadshare.settings import PLACES


def contradiction(scene: Scene, overlap: float = PLACES.overlap) -> tuple[str, ...]:
    """Return the rigid limits that contradict one another; empty if all can hold."""
    rounds = rounds_of(scene)
    rows = list(_straight(scene, rounds))
    return contradicting_limits(rows, rounds, scene.size, scene.length_unit(), overlap)


def _straight(scene: Scene, rounds: Rounds) -> Iterator[Row]:
    """Yield rigid contacts, and rigid arcs as faces set back by the arc's rise over the floats."""
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
