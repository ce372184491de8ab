"""Elements that are not convex, in many answers: the cheap part of `certify.uniqueness`.

Where none of them carries, an answer is the only one of least energy. Elsewhere arcs take F/a from
the stiffness across them; which share of the stiffness that is, is computed for single answers
only.
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
    """Return the forces of the arcs of every drum [N], shape (S, drums, 2)."""
    arcs = answers.ring_force[:, answers.names.arcs]
    return arcs.reshape(len(arcs), len(train.drums), 2)


def _largest(numbers: Array) -> Array:
    """Return the largest of the numbers (S, k) of every answer, at least zero, (S,)."""
    # Column by column: rows are too short to be worth a loop each.
    return np.asarray(np.maximum.reduce([np.zeros(len(numbers)), *numbers.T]))


def arc_curvature(train: Train, answers: Equilibria) -> Array:
    """Return the stiffness [N/m] that arcs take across them, the largest Σ F/a of a drum, (S,)."""
    # Not from `mechanics_of`, which would cost more: most batches come with a train of their own.
    distance = np.sqrt((arms_of_drums(train) ** 2).sum(axis=2))
    taken = np.maximum(_arc_forces(train, answers), 0.0) / distance
    return _largest(taken[:, :, 0] + taken[:, :, 1])


def is_convex(train: Train, situations: Situations, answers: Equilibria, load: Array) -> Array:
    """Return whether no element that is not convex carries, (S,) of bool.

    Parameters
    ----------
    train : Train
    situations : Situations
    answers : Equilibria
        S of them.
    load : ndarray, shape (S,)
        Load of each case [N].
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
