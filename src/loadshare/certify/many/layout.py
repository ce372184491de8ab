"""Arrays whose samples lie next to one another in memory.

Sums and largest values over a few elements then run along the samples, which is several times
faster.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def lying(array: Array) -> Array:
    """Return the same array with its first axis next to one another in memory."""
    return np.moveaxis(np.ascontiguousarray(np.moveaxis(array, 0, -1)), -1, 0)


def flat(array: Array) -> Array:
    """Put the inner axes of such an array (S, …) together, (S, all of them)."""
    inner = np.moveaxis(array, 0, -1)
    return np.asarray(inner.reshape(-1, inner.shape[-1]).T)


def times(array: Array, matrix: Array) -> Array:
    """Return the product of such an array with a matrix, lying as it does."""
    return np.asarray((matrix.T @ array.T).T)


def size(vectors: Array) -> Array:
    """Lengths (S,) of vectors (S, d)."""
    return np.asarray(np.sqrt((vectors**2).sum(axis=1)))
