"""What is not convex in many answers: the cheap part of `certify.uniqueness`.

Where nothing of it carries, an answer is the only one of least energy. Elsewhere F/a of the arcs is
what they take from the stiffness across them; how large that is in parts of the stiffness is found
for single answers.
"""

from __future__ import annotations

import numpy as np

from loadshare.array_types import Array
from loadshare.certify.mechanics import arms_of_drums, mechanics_of
from loadshare.settings import CERTIFY
from loadshare.train.equilibria import Equilibria
from loadshare.train.situations import Situations
from loadshare.train.train import Train


def _arc_forces(train: Train, answers: Equilibria) -> Array:
    """Forces of the arcs of every drum [N], shape (S, drums, 2)."""
    arcs = answers.ring_force[:, answers.names.arcs]
    return arcs.reshape(len(arcs), len(train.drums), 2)


def _largest(numbers: Array) -> Array:
    """Largest of the numbers of every answer, (S, k), and zero: (S,)."""
    # Column by column: rows are too short to be worth a loop each.
    return np.asarray(np.maximum.reduce([np.zeros(len(numbers)), *numbers.T]))


def arc_curvature(train: Train, answers: Equilibria) -> Array:
    """Stiffness [N/m] that arcs take across them, Σ F/a of the drum where it is largest, (S,)."""
    # All of the mechanics is more than this takes: most batches come with a train of their own.
    distance = np.sqrt((arms_of_drums(train) ** 2).sum(axis=2))
    taken = np.maximum(_arc_forces(train, answers), 0.0) / distance
    return _largest(taken[:, :, 0] + taken[:, :, 1])


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
    band = CERTIFY.carries * load
    forces = _arc_forces(train, answers)
    convex = _largest(forces.reshape(len(forces), -1)) <= band
    fixed, per_torque = situations.spline[:, :, 3], situations.spline[:, :, 4]
    follows = np.isnan(fixed) & (per_torque > 0.0)
    if not follows.any():
        return np.asarray(convex)
    torque = answers.flank_force @ mechanics_of(train).spline_moment.T
    reaction = answers.radial_reaction[:, answers.names.splines]
    slips = np.sqrt((reaction**2).sum(axis=2)) >= per_torque * np.abs(torque) - band[:, None]
    return np.asarray(convex & ~(follows & slips).any(axis=1))
