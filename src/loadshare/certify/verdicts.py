"""Verdicts of a judge on many answers."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from loadshare.array_types import Array, Flags, Numbers
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
        How close displacements come to a warning (see `Measuring.worst`).
    bounds : Bounds
        Bounds on the distance of the answers from the exact equilibria.
    """

    worst: Array
    tolerance: float
    load: Array
    deflection: Array
    displaced: Array
    bounds: Bounds

    def replaced(self, samples: Numbers, others: Verdicts) -> Verdicts:
        """Return the same with other verdicts on some samples."""
        arrays = _replaced(self, others, samples, ("worst", "load", "deflection", "displaced"))
        names = ("relative", "torque", "force", "coordinate")
        bounds = replace(self.bounds, **_replaced(self.bounds, others.bounds, samples, names))
        return replace(self, **arrays, bounds=bounds)

    @cached_property
    def passed(self) -> Flags:
        """Whether every residual, and the error of every torque, is within the tolerance."""
        return np.asarray((self.worst <= self.tolerance) & (self.bounds.relative <= self.tolerance))


def _replaced(
    mine: object, others: object, samples: Numbers, names: tuple[str, ...]
) -> dict[str, Any]:
    """Return arrays with some samples replaced by others; None where either has none."""
    found: dict[str, Any] = dict.fromkeys(names)
    for name in names:
        here, there = getattr(mine, name), getattr(others, name)
        if here is not None and there is not None:
            found[name] = here.copy()
            found[name][samples] = there
    return found
