"""Products of tall tables with matrices of few entries, compiled with Numba.

A coordinate belongs to one gear or two, and a force to one element: a dense product would spend
nearly all its time on zeros.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from loadshare.compilation import jit
from loadshare.scene.scene import Array


class Entries(NamedTuple):
    """Entries of a matrix (n, q) that are not zero, column by column."""

    starts: NDArray[np.intp]  # (q + 1,)
    rows: NDArray[np.intp]
    values: Array


def entries(matrix: Array) -> Entries:
    """Return the entries of a matrix of shape (n, q)."""
    at_column, rows = np.nonzero(matrix.T)
    starts = np.searchsorted(at_column, np.arange(matrix.shape[1] + 1))
    return Entries(starts, rows.copy(), matrix[rows, at_column])


def times(table: Array, matrix: Entries) -> Array:
    """Return a table (S, n) times the matrix, shape (S, q)."""
    product = np.empty((len(table), len(matrix.starts) - 1))
    _times(table, matrix.starts, matrix.rows, matrix.values, product)
    return product


@jit(nogil=True)
def _times(table, starts, rows, values, product):  # type: ignore[no-untyped-def]
    for s in range(product.shape[0]):
        for c in range(product.shape[1]):
            total = 0.0
            for k in range(starts[c], starts[c + 1]):
                total += values[k] * table[s, rows[k]]
            product[s, c] = total


def pushes(force: Array, first: int, last: int, unit: float) -> Array:
    """Forces of contacts (S, last − first) [N]; see `answer.equilibria`."""
    found = np.empty((len(force), last - first))
    _push(force, first, unit, found)
    return found


@jit(nogil=True)
def _push(force, first, unit, found):  # type: ignore[no-untyped-def]
    for s in range(found.shape[0]):
        for k in range(found.shape[1]):
            pushed = force[s, first + k]
            found[s, k] = (0.0 if pushed < 0.0 else pushed) * unit
