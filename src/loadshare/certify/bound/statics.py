"""Statics of a set of columns that act: what balances a load, and what balances itself."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from loadshare.settings import BOUND

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Statics:
    """Statics of the columns that act.

    Attributes
    ----------
    directions : ndarray, shape (k, n)
        Their rows of A.
    particular : ndarray, shape (k, n)
        P, with Aᵀ P f = f for every load f that they can carry.
    redundant : ndarray, shape (k, r)
        N, orthonormal, with Aᵀ N = 0.
    moves : ndarray, shape (n, l)
        Moves that nothing resists, orthonormal.
    """

    directions: Array
    particular: Array
    redundant: Array
    moves: Array

    @classmethod
    def of(cls, directions: Array) -> Statics:
        """Return the statics of some rows of A."""
        left, sizes, right = np.linalg.svd(directions, full_matrices=True)
        rank = int((sizes > BOUND.rank * sizes.max(initial=0.0)).sum())
        particular = left[:, :rank] / sizes[:rank] @ right[:rank]
        return cls(directions, particular, left[:, rank:], right[rank:].T)

    @cached_property
    def loose(self) -> NDArray[np.bool_]:
        """Coordinates that a move shifts, shape (n,)."""
        return np.asarray(np.abs(self.moves).max(axis=1, initial=0.0) > BOUND.loose)
