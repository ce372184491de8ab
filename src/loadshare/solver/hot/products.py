"""Products of many samples with one sparse matrix, compiled with Numba."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from loadshare import compilation
from loadshare.array_types import Array, Numbers

compiled = compilation.jit(nogil=True, error_model="numpy")


class SparseRows(NamedTuple):
    """Entries of a matrix that are not zero, row by row."""

    start: Numbers
    at: Numbers
    value: Array


def rows_of(matrix: Array) -> SparseRows:
    """Return the entries of a matrix that are not zero."""
    # Always contiguous, whatever NumPy returns: code is compiled for each layout separately.
    rows, at = map(np.ascontiguousarray, np.nonzero(matrix))
    return SparseRows(np.searchsorted(rows, np.arange(len(matrix) + 1)), at, matrix[rows, at])


def products(table: Array, rows: SparseRows) -> Array:
    """Return every row of a table (S, n) times every row of a matrix (k, n), shape (S, k)."""
    found = np.empty((len(table), len(rows.start) - 1))
    # Entry by entry: most rows have one or none.
    row = np.repeat(np.arange(found.shape[1]), np.diff(rows.start))
    _multiply(table, row, rows.at, rows.value, found)
    return found


@compiled
def _multiply(table, row, at, value, found):  # type: ignore[no-untyped-def]
    for s in range(found.shape[0]):
        for k in range(found.shape[1]):
            found[s, k] = 0.0
        for i in range(row.shape[0]):
            found[s, row[i]] += value[i] * table[s, at[i]]
