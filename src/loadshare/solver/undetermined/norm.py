r"""The norm by which one place among many is chosen.

.. math:: \lVert x \rVert^2 = \sum_i \bigl(r_{bi}^2 \varphi_i^2 + \lVert p_i \rVert^2\bigr)

over all gears i: rotations count as arc lengths on the base circles, so that all are lengths, and
every gear counts, also those that turn as one. It does not depend on names, frames or on which gear
of a rigid shaft gave its name to the coordinate. Source: formulation, section 4.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from loadshare.array_types import Array
from loadshare.scene.coordinates import Rotation
from loadshare.scene.scene import Scene
from loadshare.train.train import Train


class Norm(NamedTuple):
    """The norm in a scene's coordinates x: Σ (root (x − origin))².

    Attributes
    ----------
    root : ndarray, shape (n,)
        Square roots of the coordinates' weights [-].
    origin : ndarray, shape (n,) or (S, n)
        Where the norm is least [m]; not 0 for gears on a rigid shaft with clocking.
    """

    root: Array
    origin: Array

    def lengths(self, x: Array) -> Array:
        """Return lengths y (n,) [m], whose norm is the plain Euclidean one, from coordinates."""
        return self.root * (x - self.origin)


def norm_of(scene: Scene) -> Norm:
    """Return the norm of a scene's coordinates."""
    turned = np.array([[*scene.turned.values()]])
    root, origin = norms_of(scene.train, scene.rotation, scene.size, turned)
    return Norm(root, origin[0])


def norms_of(train: Train, rotation: Mapping[str, Rotation], size: int, turned: Array) -> Norm:
    """Return the norm of the coordinates of a train, with the origins (S, n) of S samples.

    Parameters
    ----------
    train : Train
    rotation : mapping of gear to Rotation
        How each gear turns with the coordinates.
    size : int
        Number of coordinates n.
    turned : ndarray, shape (S, gears)
        Rotations at zero coordinates [rad].
    """
    weight, moment = np.ones(size), np.zeros((len(turned), size))
    turning = [r.index for r in rotation.values() if r.index is not None]
    weight[turning] = 0.0
    for gear, r in rotation.items():
        if r.index is not None:
            radius = train.gears[gear].base_radius
            weight[r.index] += (radius * r.rate) ** 2
            moment[:, r.index] += radius**2 * r.rate * turned[:, train.order[gear]]
    return Norm(np.sqrt(weight), -moment / weight)
