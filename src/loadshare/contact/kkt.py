"""Symmetric saddle-point systems, solved to round-off; rank defects are settled by least norm."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from loadshare.array_types import Array
from loadshare.settings import CONTACT


@dataclass(frozen=True, slots=True, eq=False)
class LinearSolution:
    """Solution of a system, and what it leaves open.

    Attributes
    ----------
    values : ndarray, shape (N,)
    moves : ndarray, shape (size, f)
        Directions in which the coordinates are free.
    stresses : ndarray, shape (N - size, s)
        Forces that balance one another and move nothing.
    """

    values: Array
    moves: Array
    stresses: Array


def solve_symmetric(matrix: Array, right: Array, size: int) -> LinearSolution | None:
    """Solve K z = r for a symmetric K, least-norm in the first `size` unknowns where K is singular.

    Parameters
    ----------
    matrix : ndarray, shape (N, N)
        K, indefinite.
    right : ndarray, shape (N,)
        r.
    size : int
        Number of leading unknowns (coordinates); the rest are forces.

    Returns
    -------
    Solved or None
        None if the system contradicts itself or its numbers are not finite.
    """
    from scipy.linalg import lapack

    if not len(right):
        return _determined(right, size)
    scale = _equilibrate(matrix)
    scaled = matrix * scale[:, None] * scale
    if not (np.isfinite(scaled).all() and np.isfinite(right).all()):
        return None
    factor, pivots, fault = lapack.dgetrf(scaled)
    if fault == 0:
        reciprocal, _ = lapack.dgecon(factor, np.abs(scaled).sum(axis=0).max())
        if reciprocal > CONTACT.rank:
            values = np.zeros_like(right)
            for _ in range(CONTACT.refined):
                residual = right - matrix @ values
                values = values + scale * lapack.dgetrs(factor, pivots, scale * residual)[0]
            return _determined(values, size)
    return _least_norm(matrix, scaled, scale, right, size)


def _determined(values: Array, size: int) -> LinearSolution:
    """Return a solution that leaves nothing free."""
    return LinearSolution(values, np.zeros((size, 0)), np.zeros((len(values) - size, 0)))


def _equilibrate(matrix: Array) -> Array:
    """Return a symmetric scaling that brings every row's largest entry near 1."""
    scale = np.ones(len(matrix))
    for _ in range(CONTACT.equilibrated):
        largest = np.abs(matrix * scale[:, None] * scale).max(axis=1)
        scale = scale / np.sqrt(np.where(largest > 0.0, largest, 1.0))
    return scale


def _least_norm(
    matrix: Array, scaled: Array, scale: Array, right: Array, size: int
) -> LinearSolution | None:
    eigenvalues, vectors = np.linalg.eigh(scaled)
    kept = np.abs(eigenvalues) > CONTACT.rank * np.abs(eigenvalues).max()
    basis = vectors[:, kept]
    values = np.zeros_like(right)
    for _ in range(CONTACT.refined):
        residual = scale * (right - matrix @ values)
        values = values + scale * (basis @ ((basis.T @ residual) / eigenvalues[kept]))
    left = np.abs(scale * (right - matrix @ values)).max()
    if left > CONTACT.consistent * max(np.abs(scale * right).max(), np.finfo(float).tiny):
        return None
    null = scale[:, None] * vectors[:, ~kept]
    if null.shape[1] == 0:
        return _determined(values, size)
    null /= np.linalg.norm(null, axis=0)
    outer, sizes, inner = np.linalg.svd(null[:size], full_matrices=True)
    freedom = int((sizes > CONTACT.moves).sum())
    moves = null @ inner[:freedom].T / sizes[:freedom]
    values = values - moves @ (outer[:, :freedom].T @ values[:size])
    forces_only = null @ inner[freedom:].T
    if forces_only.shape[1]:
        share = np.linalg.lstsq(forces_only[size:], values[size:], rcond=None)[0]
        values = values - forces_only @ share
    return LinearSolution(values, moves[:size], forces_only[size:])
