"""Statics of acting elements: what balances a load, self-balanced forces, unresisted moves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from loadshare.array_types import Array, Numbers
from loadshare.settings import STATICS


@dataclass(frozen=True, slots=True, eq=False)
class Basis:
    """Statics of one set of acting elements.

    Attributes
    ----------
    columns : ndarray of int, shape (k,)
        The acting elements.
    directions : ndarray, shape (k, n)
        Their rows of A.
    particular : ndarray, shape (k, n)
        P.
    redundant : ndarray, shape (k, r)
        N, orthonormal.
    loose : ndarray, shape (n, l)
        Moves of the coordinates that no acting element resists, orthonormal. P is the
        pseudo-inverse, so that coordinates are of least norm.
    """

    columns: Numbers
    directions: Array
    particular: Array
    redundant: Array
    loose: Array


def unresisted(directions: Array) -> Array:
    """Return orthonormal moves (n, l) that are perpendicular to all of some directions (k, n)."""
    _, sizes, right = np.linalg.svd(directions, full_matrices=True)
    return np.asarray(right[_rank(sizes) :].T)


def _rank(sizes: Array) -> int:
    return int((sizes > STATICS.rank * sizes.max(initial=0.0)).sum())


def basis_of(columns: Numbers, directions: Array) -> Basis:
    """Return the statics of an active set whose elements push along some directions (k, n)."""
    left, sizes, right = np.linalg.svd(directions, full_matrices=True)
    rank = _rank(sizes)
    particular = left[:, :rank] / sizes[:rank] @ right[:rank]
    redundant = np.ascontiguousarray(left[:, rank:])
    # Rows of elements that the load alone determines are exactly 0: a soft shaft's large wind-up
    # would magnify their round-off.
    redundant[np.abs(redundant).max(axis=1, initial=0.0) <= STATICS.nothing] = 0.0
    return Basis(columns, directions, particular, redundant, right[rank:].T)
