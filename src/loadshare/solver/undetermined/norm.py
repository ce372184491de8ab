r"""The norm by which one place among many is chosen.

.. math:: \lVert x \rVert^2 = \sum_i \bigl(r_{bi}^2 \varphi_i^2 + \lVert p_i \rVert^2\bigr)

over all gears i: rotations count as arc lengths on the base circles, so that all are lengths, and
every gear counts, also those that turn as one. It does not depend on names, frames or on which gear
of a rigid shaft gave its name to the coordinate. Source: formulation, section 4.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from loadshare.array_types import Array
from loadshare.scene.scene import Scene


class Norm(NamedTuple):
    """The norm in a scene's coordinates x: Σ (root (x − origin))².

    Attributes
    ----------
    root : ndarray, shape (n,)
        Square roots of the coordinates' weights [-].
    origin : ndarray, shape (n,)
        Where the norm is least [m]; not 0 for gears on a rigid shaft with clocking.
    """

    root: Array
    origin: Array

    def lengths(self, x: Array) -> Array:
        """Return lengths y (n,) [m], whose norm is the plain Euclidean one, from coordinates."""
        return self.root * (x - self.origin)


def norm_of(scene: Scene) -> Norm:
    """Return the norm of a scene's coordinates."""
    weight, moment = np.ones(scene.size), np.zeros(scene.size)
    turning = [r.index for r in scene.rotation.values() if r.index is not None]
    weight[turning] = 0.0
    for gear, r in scene.rotation.items():
        if r.index is not None:
            radius = scene.train.gears[gear].base_radius
            weight[r.index] += (radius * r.rate) ** 2
            moment[r.index] += radius**2 * r.rate * scene.turned[gear]
    return Norm(np.sqrt(weight), -moment / weight)
