"""Statics of a set of columns that act: forces that balance a load, and self-stresses."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from loadshare.array_types import Array, Flags
from loadshare.settings import BOUND


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
        """Return the statics of some rows of A.

        Few rows are decomposed into singular values. Many are factorised as Q R = Aᵀ, with columns
        in the order of their pivots, and the rows of R that are not zero, transposed, as Z T: that
        takes a tenth of the work, but loads a library for which a small case need not wait.
        """
        count, n = directions.shape
        if not directions.any():
            return cls(directions, np.zeros((count, n)), np.eye(count), np.eye(n))
        if max(count, n) <= BOUND.by_singular_values:
            u, sizes, vt = np.linalg.svd(directions)
            rank = int((sizes > BOUND.rank * sizes[0]).sum())
            particular = (u[:, :rank] / sizes[:rank]) @ vt[:rank]
            return cls(directions, particular, u[:, rank:], vt[rank:].T)
        from scipy.linalg import lapack

        factors, order, scales, *_ = lapack.dgeqp3(directions.T)
        sizes = np.abs(np.diagonal(factors))
        rank = int((sizes > BOUND.rank * sizes.max()).sum())
        q = _orthogonal(factors[:, :n], scales, n)
        rest, scales, *_ = lapack.dgeqrf(np.triu(factors[:rank]).T)
        z = np.empty((count, count))
        z[order - 1] = _orthogonal(rest, scales, count)
        # Aᵀ P = 1 on what they can carry: Tᵀ Zᵀ P = Qᵀ.
        solved, _ = lapack.dtrtrs(rest[:rank], q[:, :rank].T, trans=1)
        return cls(directions, z[:, :rank] @ solved, z[:, rank:], q[:, rank:])

    @cached_property
    def loose(self) -> Flags:
        """Coordinates that a move shifts, shape (n,)."""
        return np.asarray(np.abs(self.moves).max(axis=1, initial=0.0) > BOUND.loose)


def _orthogonal(factors: Array, scales: Array, size: int) -> Array:
    """Return the square orthogonal matrix of a factorisation by reflections."""
    from scipy.linalg import lapack

    reflections = np.zeros((size, size), order="F")
    reflections[:, : factors.shape[1]] = factors
    return np.asarray(lapack.dorgqr(reflections, scales)[0])


def force_at_end(moves: Array, contacts: Array, pairs: Array) -> float:
    """Return the force of a contact that ends an unresisted move, per load along it; at least 1.

    A contact that a move hardly closes takes more force than the load along the move.

    Parameters
    ----------
    moves : ndarray, shape (n, l)
        Orthonormal.
    contacts, pairs : ndarray, shape (k, n) and (q, 2, n)
        Directions of contacts, and of elements that resist in two directions.
    """
    if not moves.size:
        return 1.0
    closing = np.concatenate(
        [np.linalg.norm(contacts @ moves, axis=1), np.linalg.norm(pairs @ moves, axis=(1, 2))]
    )
    least = closing[closing > BOUND.loose].min(initial=1.0)
    return float(np.sqrt(moves.shape[1]) / least)


def free_moves(moves: Array, directions: Array) -> Array:
    """Return those of moves (n, l), orthonormal, that some directions (q, n) do not resist."""
    if not (moves.size and directions.size):
        return moves
    _, sizes, turn = np.linalg.svd(directions @ moves)
    return np.asarray(moves @ turn[int((sizes > BOUND.rank).sum()) :].T)


def held_moves(
    moves: Array, directions: Array, at_end: Callable[[Array], float]
) -> tuple[Array, Array]:
    """Return moves (n, k) that others hold; their lengths bound all forces of these per load.

    The others may also let go, and the moves end elsewhere.

    Parameters
    ----------
    moves : ndarray, shape (n, l)
        Orthonormal; those that the carrying elements leave.
    directions : ndarray, shape (k, n)
        Directions of the others.
    at_end : callable
        Returns the force of an element that ends one of some moves, per load along it.

    Returns
    -------
    held : ndarray, shape (n, k)
    shared : ndarray, shape (n, j)
        Those held only by elements whose forces do not follow from balance alone.
    """
    if not (moves.size and directions.size):
        return moves[:, :0], moves[:, :0]
    along = directions @ moves
    holding = np.abs(along).max(axis=1) > BOUND.rank
    part, sizes, turn = np.linalg.svd(along[holding])
    count = int((sizes > BOUND.rank).sum())
    held = moves @ turn[:count].T
    most = np.maximum(count**1.5 / sizes[:count], at_end(held))
    # Balance determines the force of an element that takes part in no self-stress of the others.
    alone = np.abs(part[:, count:]).max(axis=1, initial=0.0) < BOUND.idle
    return np.asarray(held * most), free_moves(held, directions[holding][alone])
