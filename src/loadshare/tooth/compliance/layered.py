"""Cholesky factors of a stiffness matrix whose nodes lie in layers.

A swept mesh couples only neighbouring layers, so its matrix is block tridiagonal; the blocks are
sections, dense enough for LAPACK to be faster on them than a general sparse factorisation.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from loadshare.tooth.geometry.body import Array

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


class LayeredFactor:
    """Factor of a symmetric positive definite, block tridiagonal matrix.

    Parameters
    ----------
    matrix : csr_matrix, shape (n, n)
    group : array (n,) of int
        Block of each row, rising from 0; rows couple only within a block and with its neighbours.

    Raises
    ------
    numpy.linalg.LinAlgError
        If the matrix is not positive definite.
    """

    def __init__(self, matrix: csr_matrix, group: NDArray[np.int64]) -> None:
        from scipy.linalg import cholesky, solve_triangular
        from scipy.linalg.blas import dsyrk

        ends = np.searchsorted(group, np.arange(int(group[-1]) + 2))
        rows = [slice(a, b) for a, b in pairwise([*ends.tolist(), len(group)])]
        self._parts: list[tuple[slice, Array, Array]] = []
        diagonal = matrix[rows[0], rows[0]].toarray(order="F")
        for here, after in pairwise(rows):
            # Only the lower triangle is read from here on, and written below.
            factor = cholesky(diagonal, lower=True, overwrite_a=True, check_finite=False)
            coupling = matrix[here, after].tocsc()
            reach = int(np.flatnonzero(np.diff(coupling.indptr)).max(initial=-1)) + 1
            link = coupling[:, :reach].toarray(order="F")
            link = solve_triangular(factor, link, lower=True, overwrite_b=True, check_finite=False)
            self._parts.append((here, factor, link))
            diagonal = matrix[after, after].toarray(order="F")
            if reach:
                diagonal[:reach, :reach] -= dsyrk(1.0, link, trans=1, lower=1)

    def solve(self, right: Array) -> Array:
        """Solve for right-hand sides (n, k)."""
        from scipy.linalg import solve_triangular

        found = right.copy()
        for rows, factor, link in self._parts:
            found[rows] = solve_triangular(factor, found[rows], lower=True, check_finite=False)
            found[rows.stop : rows.stop + link.shape[1]] -= link.T @ found[rows]
        for rows, factor, link in reversed(self._parts):
            found[rows] -= link @ found[rows.stop : rows.stop + link.shape[1]]
            found[rows] = solve_triangular(
                factor, found[rows], lower=True, trans=1, check_finite=False
            )
        return found
