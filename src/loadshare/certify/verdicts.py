"""What a judge says of many answers."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from loadshare.array_types import Array
from loadshare.certify.bound import Bounds


@dataclass(frozen=True, eq=False)
class Verdicts:
    """Certificates of S answers.

    Attributes
    ----------
    worst : ndarray, shape (S,)
        Largest scaled residual; infinite where an answer cannot be judged.
    tolerance : float
    load, deflection : ndarray, shape (S,)
        Scales [N], [m].
    displaced : ndarray, shape (S,)
        How far displacements go to a warning (see `Measuring.worst`).
    bounds : Bounds
        How far the answers are from the exact ones, at most.
    """

    worst: Array
    tolerance: float
    load: Array
    deflection: Array
    displaced: Array
    bounds: Bounds

    @cached_property
    def passed(self) -> NDArray[np.bool_]:
        """Whether every residual, and the error of every torque, is within the tolerance."""
        return np.asarray((self.worst <= self.tolerance) & (self.bounds.relative <= self.tolerance))
