"""What is not convex in many answers: the cheap part of `certify.uniqueness`.

Where nothing of it carries, an answer is the only one of least energy. Elsewhere F/a of the arcs is
what they take from the stiffness across them; how large that is in parts of the stiffness is found
for single answers.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from loadshare.certify.uniqueness import CARRIES
from loadshare.train.equilibria import Equilibria
from loadshare.train.ring import transverse
from loadshare.train.situations import Situations
from loadshare.train.train import Train

Array = NDArray[np.float64]


def arc_curvature(train: Train, answers: Equilibria) -> Array:
    """Stiffness [N/m] that arcs take across them, Σ F/a of the drum where it is largest, (S,)."""
    drums = train.drums
    largest = np.zeros(len(answers.rotation))
    for d, ring in enumerate(drums):
        here, total = train.gears[ring.gear], np.zeros(len(largest))
        for side, neighbour in enumerate(ring.neighbours):
            apart = transverse(here.centre - train.gears[neighbour].centre, here.axis)
            force = answers.ring_force[:, 2 * len(drums) + 2 * d + side]
            total += np.maximum(force, 0.0) / float(np.linalg.norm(apart))
        largest = np.maximum(largest, total)
    return largest


def is_convex(train: Train, situations: Situations, answers: Equilibria, load: Array) -> Array:
    """Whether nothing that is not convex carries, (S,) of bool.

    Parameters
    ----------
    train : Train
    situations : Situations
    answers : Equilibria
        S of them.
    load : ndarray, shape (S,)
        Of each case [N].
    """
    band = CARRIES * load
    arcs = answers.ring_force[:, 2 * len(train.drums) :]
    convex = arcs.max(axis=1, initial=0.0) <= band
    for k, gear in enumerate(train.splines):
        _, _, _, fixed, per_torque = situations.spline[:, k].T
        levers = [
            mesh.direction(drive)[0 if gear == mesh.driver else 1]
            if gear in (mesh.driver, mesh.driven)
            else 0.0
            for mesh in train.meshes.values()
            for drive in mesh.flanks
        ]
        bound = per_torque * np.abs(answers.flank_force @ np.array(levers))
        reaction = answers.radial_reaction[:, len(train.rounds) + k]
        slips = np.sqrt((reaction**2).sum(axis=1)) >= bound - band
        convex &= ~(np.isnan(fixed) & (per_torque > 0.0) & slips)
    return np.asarray(convex)
