"""What a judge says of many answers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from loadshare.certify.bound import Bounds

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Verdicts:
    """Certificates of S answers.

    Attributes
    ----------
    residuals : ndarray, shape (S, 7)
        Scaled, in the order of `residuals.RESIDUALS`; infinite where an answer cannot be judged.
    tolerance : float
    load, deflection : ndarray, shape (S,)
        Scales [N], [m].
    bounds : Bounds
        How far the answers are from the exact ones, at most.
    """

    residuals: Array
    tolerance: float
    load: Array
    deflection: Array
    bounds: Bounds

    @classmethod
    def joined(cls, parts: Sequence[Verdicts], bounds: Bounds) -> Verdicts:
        """Return the verdicts of parts, one after another, with the bounds of all of them."""
        return cls(
            np.concatenate([v.residuals for v in parts]),
            parts[0].tolerance,
            np.concatenate([v.load for v in parts]),
            np.concatenate([v.deflection for v in parts]),
            bounds,
        )

    @cached_property
    def worst(self) -> Array:
        """Largest scaled residual of every answer."""
        # Column by column: rows are too short to be worth a loop each.
        return np.asarray(np.maximum.reduce(list(self.residuals.T)))

    @cached_property
    def passed(self) -> NDArray[np.bool_]:
        """Whether every residual, and the error of every torque, is within the tolerance."""
        return np.asarray((self.worst <= self.tolerance) & (self.bounds.relative <= self.tolerance))
