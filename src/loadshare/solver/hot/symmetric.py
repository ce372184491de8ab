"""Many small symmetric systems at once."""

from __future__ import annotations

import numpy as np

from loadshare.array_library import largest, library_of, put_rows
from loadshare.array_types import Array, Flags
from loadshare.settings import HOT
from loadshare.solver.hot.elements import times


def solve(matrix: Array, sides: Array, size: int) -> Array:
    """Solve (k, n, n) symmetric systems; singular ones through a proximal term.

    Rigid contacts that push along one line leave their shares open: the matrix is singular, and any
    solution will do. The refined proximal solution tends to the one of least norm; shares that
    contradict one another grow without bound and are recognised by their signs.

    Parameters
    ----------
    matrix : ndarray, shape (k, n, n)
    sides : ndarray, shape (k, n)
    size : int
        Size of the positive semidefinite part; the rest are constraints.
    """
    if not matrix.shape[1]:
        return sides
    xp = library_of(matrix)
    scale = xp.max(xp.abs(matrix), axis=(1, 2))
    scale = xp.where(scale > 0.0, scale, 1.0)
    normed, target = matrix / scale[:, None, None], sides / scale[:, None]
    regular, solved = _regular(normed, target)
    residual = largest(times(normed, solved) - target)
    regular = regular & (residual <= HOT.refined * xp.maximum(largest(solved), 1e-300))
    if not xp.all(regular):
        pulls = HOT.proximal * np.diag(np.where(np.arange(matrix.shape[1]) < size, 1.0, -1.0))
        normed, target = normed[~regular], target[~regular]
        proximal = normed + xp.asarray(pulls, device=matrix.device)
        found = xp.zeros_like(target)
        for _ in range(HOT.refinements):
            left = target - times(normed, found)
            found = found + xp.linalg.solve(proximal, left[:, :, None])[:, :, 0]
        solved = put_rows(~regular, found, solved)
    return solved


def _regular(matrix: Array, sides: Array) -> tuple[Flags, Array]:
    """Return which systems are regular, as far as can be told before, and their solutions."""
    xp = library_of(matrix)
    every = xp.ones_like(sides[:, 0], dtype=xp.bool)
    try:
        return every, xp.linalg.solve(matrix, sides[:, :, None])[:, :, 0]
    except (ValueError, RuntimeError):
        # Libraries differ in whether and how they refuse a singular matrix among others.
        regular = xp.linalg.slogdet(matrix)[0] != 0.0
        found = xp.linalg.solve(matrix[regular], sides[regular][:, :, None])[:, :, 0]
        return regular, put_rows(regular, found, xp.zeros_like(sides))
