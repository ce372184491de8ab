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
        self._rows = [slice(int(a), int(b)) for a, b in pairwise(ends)]
        self._factors: list[Array] = []
        self._links: list[Array] = []
        diagonal = matrix[self._rows[0], self._rows[0]].toarray(order="F")
        for rows, after in pairwise([*self._rows, slice(0, 0)]):
            # Only the lower triangle is read from here on, and written below.
            factor = cholesky(diagonal, lower=True, overwrite_a=True, check_finite=False)
            self._factors.append(factor)
            if after.stop == 0:
                break
            coupling = matrix[rows, after].tocsc()
            reach = int(coupling.indices.size and np.flatnonzero(np.diff(coupling.indptr))[-1] + 1)
            link = solve_triangular(
                factor,
                coupling[:, :reach].toarray(order="F"),
                lower=True,
                overwrite_b=True,
                check_finite=False,
            )
            self._links.append(link)
            diagonal = matrix[after, after].toarray(order="F")
            diagonal[:reach, :reach] -= dsyrk(1.0, link, trans=1, lower=1)

    def solve(self, right: Array) -> Array:
        """Solve for right-hand sides (n, k)."""
        from scipy.linalg import solve_triangular

        parts = [right[rows].copy() for rows in self._rows]
        for g, factor in enumerate(self._factors):
            parts[g] = solve_triangular(factor, parts[g], lower=True, check_finite=False)
            if g < len(self._links):
                parts[g + 1][: self._links[g].shape[1]] -= self._links[g].T @ parts[g]
        for g in reversed(range(len(self._factors))):
            if g < len(self._links):
                parts[g] -= self._links[g] @ parts[g + 1][: self._links[g].shape[1]]
            parts[g] = solve_triangular(
                self._factors[g], parts[g], lower=True, trans=1, check_finite=False
            )
        return np.concatenate(parts)
