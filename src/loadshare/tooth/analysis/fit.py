"""The law Δφ(T) = a + bT + cT^(2/3) of a mesh, per meshing position, from computed angles.

Source: formulation, section 3.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from loadshare.tooth.geometry.body import Array

FIT_LOADS = (0.1, 0.5, 0.9)
"""Parts of the rated torque from which a, b and c follow."""


@dataclass(frozen=True, slots=True, eq=False)
class LawFit:
    """Coefficients of the law at K positions.

    Attributes
    ----------
    a : array (K,)
        [rad].
    b : array (K,)
        [rad/(N·m)], ≥ 0.
    c : array (K,)
        [rad/(N·m)^(2/3)], ≥ 0.
    bounded : array (K,) of bool
        Where the three angles call for a negative b or c, which would not be a valid law: the
        coefficient is 0 there, and the other two are the best in the least-squares sense.
    """

    a: Array
    b: Array
    c: Array
    bounded: np.ndarray

    def angle(self, torque: float) -> Array:
        """Return Δφ (K,) [rad] under `torque` [N·m]."""
        return np.asarray(self.a + self.b * torque + self.c * np.cbrt(torque) ** 2)


def fit_law(torque: Array, angle: Array) -> LawFit:
    """Fit a, b and c to angles under three torques or more.

    Parameters
    ----------
    torque : array (L,)
        [N·m], positive.
    angle : array (K, L)
        Δφ [rad].

    Raises
    ------
    ValueError
        If there are fewer than three different torques, or one is not positive.
    """
    if len(np.unique(torque)) < 3 or np.any(torque <= 0.0):
        raise ValueError(
            f"torques {[float(t) for t in torque]} N·m: a, b and c need three different torques, "
            "each above 0"
        )
    unit = float(torque.max())
    t = torque / unit
    terms = np.column_stack([np.ones_like(t), t, np.cbrt(t) ** 2])
    found = np.array([_bounded(terms, row) for row in angle])
    return LawFit(
        a=found[:, 0],
        b=found[:, 1] / unit,
        c=found[:, 2] / np.cbrt(unit) ** 2,
        bounded=(found[:, 1] == 0.0) | (found[:, 2] == 0.0),
    )


def _bounded(terms: Array, angle: Array) -> Array:
    """Solve for least squares with the last two coefficients not below zero."""
    from scipy.optimize import lsq_linear

    scale = float(np.abs(angle).max()) or 1.0
    bounds = [-np.inf, 0.0, 0.0], np.inf
    return np.asarray(lsq_linear(terms, angle / scale, bounds, method="bvls").x * scale)
