"""From the state of a batch to answers in physical terms."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from loadshare.scene.elements import Elements, wind_up
from loadshare.solver.hot.state import State
from loadshare.train.equilibria import Equilibria, Names

CARRIES = 1e-12
"""Force, over the largest, below which a contact ties no displacement (see `least_norm`)."""


def equilibria(elements: Elements, state: State) -> Equilibria:
    """Return displacements and forces of all samples in SI units."""
    scene, train = elements.scene, elements.scene.train
    names = Names(train)
    x = state.x * elements.length
    force = state.force * elements.force
    rotation = np.zeros((len(x), len(names.gears)))
    displacement = np.zeros((len(x), len(names.gears), 3))
    for g, gear in enumerate(names.gears):
        r = scene.rotation[gear]
        rotation[:, g] = r.constant
        if r.index is not None:
            rotation[:, g] += r.rate * x[:, r.index]
        where = scene.displacement.get(gear)
        if where is not None:
            displacement[:, g] = x[:, where] @ train.gears[gear].frame
    rows = np.maximum(force[:, elements.springs : elements.springs + elements.rows], 0.0)
    flanks = len(names.flanks)
    radial_reaction = np.zeros((len(x), len(names.radials), 3))
    for j, (_, gear) in enumerate(names.radials):
        k = elements.radial_column(j)
        radial_reaction[:, j] = -force[:, k : k + 2] @ train.gears[gear].frame
    shaft_torque = np.zeros((len(x), len(train.shafts)))
    support_force = np.zeros((len(x), len(names.gears), 2))
    spring = 0
    for s, shaft in enumerate(train.shafts.values()):
        if not math.isinf(shaft.stiffness):
            _, rate = wind_up(scene, shaft.first, shaft.second)
            shaft_torque[:, s] = force[:, spring] / rate
            spring += 1
    for g, name in enumerate(names.gears):
        support = train.gears[name].support
        if name in scene.displacement and support is not None:
            for k in np.flatnonzero(support > 0.0).tolist():
                support_force[:, g, k] = force[:, spring]
                spring += 1
    return Equilibria(
        names,
        rotation,
        displacement,
        rows[:, :flanks],
        rows[:, flanks:],
        radial_reaction,
        shaft_torque,
        support_force,
    )


def tied(elements: Elements, state: State, code: NDArray[np.int8]) -> NDArray[np.bool_]:
    """Whether every closed contact of a sample carries a force, shape (S,).

    One that is closed without force ties no displacement, although the set says so.
    """
    rows = state.force[:, elements.springs : elements.springs + elements.rows]
    largest = np.maximum(np.abs(rows).max(axis=1, initial=0.0), np.finfo(float).tiny)
    idle = (code[:, : elements.rows] != 0) & (np.abs(rows) <= CARRIES * largest[:, None])
    return np.asarray(~idle.any(axis=1))
