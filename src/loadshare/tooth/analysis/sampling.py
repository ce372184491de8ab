"""Means over the part of the mesh cycle that a position represents.

Where a pair of teeth enters or leaves contact, the law of a spur mesh jumps, and a few positions
catch this only by chance. The mean over a position's part of the cycle is integrated between these
changes by Gauss's rule, so that the mean over the cycle is the same whatever the number of
positions. The changes are those without load; under load a relieved tip comes into contact earlier
and gradually, which is a kink to the rule.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from loadshare.tooth.geometry.body import Array

LONGEST = 0.1
"""Longest stretch of the cycle over which Gauss's rule is applied."""
NODES = 2
"""Nodes on a stretch: exact for a cubic."""


@dataclass(frozen=True, eq=False)
class Cells:
    """Phases and weights of means over the parts of the mesh cycle.

    Attributes
    ----------
    phase : array (m,)
        0 ≤ phase < 1.
    weight : array (K, m)
        Weights of the phases in the mean of each position; rows sum to 1.
    """

    phase: Array
    weight: Array

    def mean(self, values: ArrayLike) -> Array:
        """Return means (K, …) of values (m, …) at the phases."""
        return np.asarray(np.tensordot(self.weight, np.asarray(values, float), axes=1))


def at_each(phases: ArrayLike) -> Cells:
    """Return cells in which the value of every position is that at its own phase."""
    phase = np.asarray(phases, float)
    return Cells(phase, np.eye(len(phase)))


def cells(count: int, changes: Sequence[float]) -> Cells:
    """Divide the mesh cycle into parts around `count` positions, and these at changes of contact.

    Parameters
    ----------
    count : int
        Number of positions; position k represents the phases (k − ½)/count to (k + ½)/count.
    changes : sequence of float
        Phases at which pairs enter or leave contact, or their lines reach an end of the face.
    """
    from scipy.linalg import block_diag

    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    places: list[Array] = []
    shares: list[Array] = []
    for k in range(count):
        low, high = (k - 0.5) / count, (k + 0.5) / count
        turns = np.array([c + turn for c in changes for turn in (-1.0, 0.0, 1.0)])
        within = turns[(turns > low) & (turns < high)]
        even = np.linspace(low, high, int(np.ceil((high - low) / LONGEST - 1e-9)) + 1)
        ends = np.unique(np.concatenate([even, within]))
        half = 0.5 * np.diff(ends)
        places.append((0.5 * (ends[1:] + ends[:-1])[:, None] + half[:, None] * nodes).ravel())
        shares.append((half[:, None] * weights).ravel() * count)
    return Cells(np.concatenate(places) % 1.0, np.asarray(block_diag(*shares)))
