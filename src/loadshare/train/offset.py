"""Geometric errors as centre offsets (formulation, section 1).

An offset acts on approaches exactly as a displacement of the centre does, and costs no energy. An
installation error is a fixed vector; a manufacturing eccentricity turns with its gear.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from loadshare.train.gear import Gear, Vector


@dataclass(frozen=True, slots=True, eq=False)
class Offset:
    """Errors of one gear.

    Attributes
    ----------
    installation : ndarray, shape (3,)
        Fixed offset [m].
    eccentricity : ndarray, shape (2,)
        Offset that turns with the gear [m], before it turns, in the gear's transverse frame.
    """

    installation: Vector
    eccentricity: Vector

    def at(self, gear: Gear, rotation: float) -> Vector:
        """Offset (3,) [m] of `gear` turned by `rotation` [rad] in its running sense."""
        turn = gear.sense * rotation
        turned = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
        return np.asarray(self.installation + self.eccentricity @ (turned @ gear.frame))


def polar(amount: float, direction: float) -> Vector:
    """Vector (2,) of a size and a direction [rad]."""
    return np.stack([amount * np.cos(direction), amount * np.sin(direction)], axis=-1)
