"""Gears that rigid shafts join: which turn as one, and what each shaft between them carries."""

from __future__ import annotations

import math
from dataclasses import dataclass

from loadshare.train.train import Train


@dataclass(frozen=True, slots=True)
class RigidShafts:
    """The rigid shafts of a train.

    Attributes
    ----------
    paths : tuple of mapping of gear to mapping of shaft to float
        Gears that turn as one, each with the shafts that lead to it from the first one: +1 where
        the way is from a shaft's second gear to its first, else −1.
    beyond : mapping of shaft to mapping of gear to float
        The gears beyond every rigid shaft, seen from a held gear (or any gear of a group
        without one). Their balance gives its torque from the first gear to the second, the sum of
        their moments times these signs; clocking does work against it. A shaft that closes a loop
        of rigid ones carries no torque of its own.
    """

    paths: tuple[dict[str, dict[str, float]], ...]
    beyond: dict[str, dict[str, float]]


def rigid_shafts(train: Train) -> RigidShafts:
    """Walk along the rigid shafts of a train, from held gears, then from every gear left."""
    rigid = [s for s in train.shafts.values() if math.isinf(s.stiffness)]
    groups: list[dict[str, dict[str, float]]] = []
    reached: set[str] = set()
    for seed in (*train.held, *train.gears):
        if seed in reached:
            continue
        between: dict[str, dict[str, float]] = {seed: {}}
        queue = [seed]
        while queue:
            here = queue.pop()
            for shaft in rigid:
                ends = ((shaft.first, shaft.second, -1.0), (shaft.second, shaft.first, 1.0))
                for near, far, sign in ends:
                    if near == here and far not in between:
                        between[far] = between[here] | {shaft.name: sign}
                        queue.append(far)
        groups.append(between)
        reached |= between.keys()
    beyond: dict[str, dict[str, float]] = {shaft.name: {} for shaft in rigid}
    for between in groups:
        for gear, path in between.items():
            for name, sign in path.items():
                beyond[name][gear] = sign
    return RigidShafts(tuple(groups), beyond)
