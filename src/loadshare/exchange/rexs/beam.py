"""A rigid beam on springs: how far it yields at a place, and what each spring takes."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import solve_triangular

STIFF = 1e15
"""Stiffness from which on a spring counts as rigid [N/m]."""
NEAR = 1e-9
"""Distance up to which places are one [m]."""


def beam(stiffness: np.ndarray, places: np.ndarray) -> tuple[np.ndarray, float]:
    """Return what of a unit force at 0 each spring takes, and how far the beam yields there.

    Parameters
    ----------
    stiffness : ndarray (n,)
        Of the springs [N/m].
    places : ndarray (n,)
        Where they are along the beam [m].

    Returns
    -------
    ndarray (n,)
        The parts k (1, u) S⁻¹ (1, 0)ᵀ with S = Σ k (1, u)ᵀ (1, u); they add up to one.
    float
        The compliance (1, 0) S⁻¹ (1, 0)ᵀ [m/N].

    Notes
    -----
    With √k (1, u) = Q R and y = R⁻ᵀ (1, 0)ᵀ they are √k Q y and yᵀ y. S = Rᵀ R itself would lose a
    spring that is softer than another by the precision of numbers; with the stiff rows first, R
    does not.
    """
    arms, here = _arms(places)
    stiff_first = np.argsort(-stiffness, kind="stable")
    root = np.sqrt(stiffness[stiff_first])
    q, r = np.linalg.qr(root[:, None] * arms[stiff_first])
    y = solve_triangular(r.T, here, lower=True)
    parts = np.empty(len(stiffness))
    parts[stiff_first] = root * (q @ y)
    length = math.hypot(*y.tolist())
    return parts, length * length


def _arms(places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(1, u) of the springs and of the place 0, in units of suitable size."""
    size = float(np.ptp(places))
    if is_one(places):
        return np.ones((len(places), 1)), np.ones(1)
    # About the middle of the springs, in units of their distance: better numbers.
    middle = float(places.mean())
    arms = np.column_stack([np.ones(len(places)), (places - middle) / size])
    return arms, np.array([1.0, -middle / size])


def is_one(places: ArrayLike) -> bool:
    """Whether springs are all at one place: then the beam only moves and does not tilt."""
    return float(np.ptp(places)) < NEAR
