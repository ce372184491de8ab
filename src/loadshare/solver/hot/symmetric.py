"""Many small symmetric systems at once."""

from __future__ import annotations

import numpy as np

from loadshare.array_types import Array
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
    scale = np.abs(matrix).max(axis=(1, 2))
    scale = np.where(scale > 0.0, scale, 1.0)
    normed, target = matrix / scale[:, None, None], sides / scale[:, None]
    solved: Array = np.zeros(sides.shape)
    regular = np.ones(len(sides), dtype=bool)
    try:
        solved[:] = np.linalg.solve(normed, target[:, :, None])[:, :, 0]
    except np.linalg.LinAlgError:
        regular = np.linalg.slogdet(normed)[0] != 0.0
        solved[regular] = np.linalg.solve(normed[regular], target[regular][:, :, None])[:, :, 0]
    residual = np.abs(times(normed, solved) - target).max(axis=1)
    regular &= residual <= HOT.refined * np.maximum(np.abs(solved).max(axis=1), 1e-300)
    if not regular.all():
        sign = np.where(np.arange(matrix.shape[1]) < size, 1.0, -1.0)
        normed, target = normed[~regular], target[~regular]
        proximal = normed + HOT.proximal * np.diag(sign)
        found: Array = np.zeros(target.shape)
        for _ in range(HOT.refinements):
            left = target - times(normed, found)
            found += np.linalg.solve(proximal, left[:, :, None])[:, :, 0]
        solved[~regular] = found
    return solved
