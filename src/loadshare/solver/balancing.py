"""The torque on a gear with which a load moves nothing without end."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from loadshare.contact.runaway import runaway
from loadshare.scene.scene import Scene


def balancing(scene: Scene, moves: Mapping[str, float], gear: str) -> float | None:
    """Return the torque [N·m] on a turning gear with which nothing moves without end any more.

    None if there is none, for instance where several things move independently.
    """
    index = {c: k for k, c in enumerate(scene.coordinates)}
    work = math.fsum(float(scene.load[index[c]]) * d for c, d in moves.items())
    change = -work / moves[f"gear {gear} rotation"]
    load = scene.load.copy()
    load[index[f"gear {gear} rotation"]] += change
    if runaway(replace(scene, load=load)):
        return None
    return float(scene.torques[gear]) + change / scene.rotation[gear].rate
