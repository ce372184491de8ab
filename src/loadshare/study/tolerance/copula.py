"""Correlated inputs: the Gaussian copula."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from loadshare.array_types import Array
from loadshare.settings import TOLERANCE


@dataclass(frozen=True, eq=False)
class Copula:
    """Inputs whose normal scores are correlated.

    Each input keeps its own distribution. For two normal inputs the correlation of the scores is
    that of the inputs; in general their rank correlation is 6/π asin(ρ/2).

    Attributes
    ----------
    members : tuple of int
        Numbers of the inputs.
    matrix : ndarray, shape (n, n)
        Correlations of the scores, positive definite.
    """

    members: tuple[int, ...]
    matrix: Array

    @cached_property
    def factor(self) -> Array:
        """Lower Cholesky factor."""
        return np.asarray(np.linalg.cholesky(self.matrix), dtype=float)

    def applied(self, uniforms: Array) -> Array:
        """Return uniforms, shape (S, inputs), with those of the members correlated."""
        from scipy import special

        columns = list(self.members)
        scores = special.ndtri(uniforms[:, columns])
        # Term by term: a product of matrices could round differently for another number of rows.
        mixed = np.zeros_like(scores)
        for i in range(len(columns)):
            for j in range(i + 1):
                mixed[:, i] += self.factor[i, j] * scores[:, j]
        result = uniforms.copy()
        result[:, columns] = special.ndtr(mixed)
        return result


def correlation_matrix(given: float | Sequence[Sequence[float]], size: int) -> Array | str:
    """Return a correlation matrix, or what is wrong with it.

    Parameters
    ----------
    given : float or rows of floats
        One correlation for all pairs, or the matrix.
    size : int
        Number of inputs.

    Returns
    -------
    ndarray, shape (size, size), or str
    """
    if size < 2:
        return "means a single input: a correlation needs two"
    if isinstance(given, int | float):
        matrix = np.full((size, size), float(given))
        np.fill_diagonal(matrix, 1.0)
    else:
        if [len(row) for row in given] != [size] * size:
            return f"is not a matrix of {size} rows with {size} numbers each"
        matrix = np.array(given, dtype=float)
        if not np.array_equal(matrix, matrix.T):
            return "is not symmetric"
        if not (np.diag(matrix) == 1.0).all():
            return "does not have ones on its diagonal"
    smallest = float(np.linalg.eigvalsh(matrix)[0])
    if smallest < TOLERANCE.definite:
        return f"is not positive definite: its smallest eigenvalue is {smallest:.3g}"
    return matrix
