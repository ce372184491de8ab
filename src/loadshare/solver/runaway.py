"""What a scene's load moves without end, if anything."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from loadshare.scene.scene import Scene
from loadshare.settings import PLACES


def runaway(scene: Scene) -> dict[str, float]:
    r"""Return what the load moves without end, with its part of the move; empty if all is held.

    What it does work on comes first. Of all moves d that no contact, spring or limit resists,
    however far they lead,

    .. math:: \max_d f\cdot d \quad \text{s.t.}\; H d = 0,\; P d = 0,\; a_e\cdot d \le 0,\;
        |d_i| \le 1 ,

    it is the one along which the load does most work. Where that is positive the potential falls
    without bound: the scene has no equilibrium. Arcs count by their faces at rest.
    """
    from scipy.optimize import linprog

    stiffest = float(np.abs(scene.stiffness).max(initial=0.0)) or 1.0
    held = np.vstack([scene.stiffness / stiffest, *(r.matrix for r in scene.radials)])
    rows = scene.rows_at(np.zeros(scene.size))
    against = np.array([r.vector for r in rows]).reshape(-1, scene.size)
    found = linprog(
        -scene.load / scene.force_unit(),
        against,
        np.zeros(len(against)),
        held,
        np.zeros(len(held)),
        bounds=(-1.0, 1.0),
        method="highs",
    )
    if found.status != 0 or found.fun is None or found.x is None or found.fun >= -PLACES.pushed:
        return {}
    work = scene.load * found.x
    moving = np.flatnonzero(np.abs(found.x) > PLACES.named).tolist()
    moving.sort(key=lambda k: -float(work[k]))
    return {scene.coordinates[k]: float(found.x[k]) for k in moving}


def balancing(scene: Scene, moves: Mapping[str, float], gear: str) -> float | None:
    """Return the torque [N·m] on a gear that turns at which nothing moves any more.

    None if there is none, as where several things move by themselves.
    """
    index = {c: k for k, c in enumerate(scene.coordinates)}
    work = math.fsum(float(scene.load[index[c]]) * d for c, d in moves.items())
    change = -work / moves[f"gear {gear} rotation"]
    load = scene.load.copy()
    load[index[f"gear {gear} rotation"]] += change
    if runaway(replace(scene, load=load)):
        return None
    return float(scene.torques[gear]) + change / scene.rotation[gear].rate
