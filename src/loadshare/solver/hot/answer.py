"""From the state of a batch to answers in physical terms."""

from __future__ import annotations

import math
from typing import NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from loadshare.scene.elements import Elements, wind_up
from loadshare.scene.scene import Array
from loadshare.solver.hot.state import State
from loadshare.train.equilibria import Equilibria, Names

CARRIES = 1e-12
"""Force, over the largest, below which a contact ties no displacement (see `least_norm`)."""


def equilibria(elements: Elements, state: State) -> Equilibria:
    """Return displacements and forces of all samples in SI units."""
    names = Names(elements.scene.train)
    map_ = _map(elements, names)
    x, force = state.x, state.force
    count, gears, radials = len(x), len(names.gears), len(names.radials)
    rows = np.maximum(force[:, elements.springs : elements.springs + elements.rows], 0.0)
    rows *= elements.force
    flanks = len(names.flanks)
    return Equilibria(
        names,
        x @ map_.rotation + map_.turned,
        (x @ map_.displacement).reshape(count, gears, 3),
        rows[:, :flanks],
        rows[:, flanks:],
        (force @ map_.reaction).reshape(count, radials, 3),
        force @ map_.torque,
        (force @ map_.support).reshape(count, gears, 2),
    )


class _Map(NamedTuple):
    """Matrices from coordinates (n) and forces (m) to physical quantities in SI units."""

    rotation: Array  # (n, gears)
    turned: Array  # (gears,)
    displacement: Array  # (n, 3 gears)
    reaction: Array  # (m, 3 radial elements)
    torque: Array  # (m, shafts)
    support: Array  # (m, 2 gears)


def _map(elements: Elements, names: Names) -> _Map:
    """Return the matrices of a machine, written down once."""
    known = elements.kept.get(("map",))
    if known is not None:
        return cast(_Map, known)
    scene, train = elements.scene, elements.scene.train
    gears, n, m = len(names.gears), elements.scene.size, len(elements.kinds)
    rotation, turned = np.zeros((n, gears)), np.zeros(gears)
    displacement, support = np.zeros((n, gears, 3)), np.zeros((m, gears, 2))
    reaction, torque = np.zeros((m, len(names.radials), 3)), np.zeros((m, len(train.shafts)))
    spring = 0
    for s, shaft in enumerate(train.shafts.values()):
        if not math.isinf(shaft.stiffness):
            torque[spring, s] = 1.0 / wind_up(scene, shaft.first, shaft.second)[1]
            spring += 1
    for g, name in enumerate(names.gears):
        gear, r, where = train.gears[name], scene.rotation[name], scene.displacement.get(name)
        turned[g] = r.constant
        if r.index is not None:
            rotation[r.index, g] = r.rate
        if where is not None:
            displacement[where, g] = gear.frame
            if gear.support is not None:
                for k in np.flatnonzero(gear.support > 0.0).tolist():
                    support[spring, g, k] = 1.0
                    spring += 1
    for j, (_, name) in enumerate(names.radials):
        column = elements.radial_column(j)
        reaction[column : column + 2, j] = -train.gears[name].frame
    found = _Map(
        rotation * elements.length,
        turned,
        displacement.reshape(n, -1) * elements.length,
        reaction.reshape(m, -1) * elements.force,
        torque * elements.force,
        support.reshape(m, -1) * elements.force,
    )
    elements.keep(("map",), found)
    return found


def tied(elements: Elements, state: State, code: NDArray[np.int8]) -> NDArray[np.bool_]:
    """Whether every closed contact of a sample carries a force, shape (S,).

    One that is closed without force ties no displacement, although the set says so.
    """
    rows = np.abs(state.force[:, elements.springs : elements.springs + elements.rows])
    largest = np.maximum(rows.max(axis=1, initial=0.0), np.finfo(float).tiny)
    idle = (code[:, : elements.rows] != 0) & (rows <= CARRIES * largest[:, None])
    return np.asarray(~idle.any(axis=1))
