"""Redundants of a set that act in few elements, and what of their matrix is not zero.

Both keep the work of a pass proportional to the number of branches.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from loadshare.array_types import Array, Flags, Numbers
from loadshare.scene.statics import Basis
from loadshare.settings import STATICS


class Factor(NamedTuple):
    """Where the Cholesky factor of a matrix is not zero.

    Attributes
    ----------
    starts : ndarray of int, shape (r + 1,)
        Where the rows of each column begin.
    below : ndarray of int
        Numbers below the diagonal, column by column.
    """

    starts: Numbers
    below: Numbers

    def entries(self, borders: int) -> tuple[Numbers, Numbers]:
        """Numbers and columns of all entries, each column from its diagonal on, without borders."""
        r = len(self.starts) - 1 - borders
        column = np.repeat(np.arange(r + borders), np.diff(self.starts))
        kept = self.below < r
        row = np.concatenate([np.arange(r), self.below[kept]])
        column = np.concatenate([np.arange(r), column[kept]])
        order = np.lexsort((row, column))
        return row[order], column[order]


def local(basis: Basis) -> tuple[Array, Array]:
    """P and N of the same statics, each redundant the force of one element.

    It acts in few others, so that most entries are zero, however many branches there are; elements
    are chosen that leave the space as well conditioned as can be had so. Where nothing moves freely
    the other elements carry the loads alone, few of them each; otherwise P stays the
    pseudo-inverse, for the sake of coordinates of least norm.
    """
    from scipy.linalg import qr

    n = basis.redundant
    _, _, by_size = qr(n.T, mode="economic", pivoting=True)
    chosen, others = by_size[: n.shape[1]], by_size[n.shape[1] :]
    redundant = _chained(_clean(np.linalg.solve(n[chosen].T, n.T).T))
    redundant /= np.sqrt((redundant * redundant).sum(axis=0))
    particular = basis.particular
    if not basis.loose.shape[1]:
        particular = np.zeros_like(particular)
        particular[others] = _clean(np.linalg.inv(basis.directions[others]).T)
    return particular, redundant


def _clean(matrix: NDArray[np.floating]) -> Array:
    """The matrix without what is round-off beside its largest entry."""
    small = np.abs(matrix) < STATICS.nothing * np.abs(matrix).max()
    return np.asarray(np.where(small, 0.0, matrix), dtype=np.float64)


def _chained(redundant: Array) -> Array:
    """Redundants that pass an element in which many act on to one another, one after the other.

    All would be coupled through it, the matrix full.
    """
    for row in range(len(redundant)):
        at = np.flatnonzero(redundant[row])
        if len(at) <= STATICS.many:
            continue
        ratio = redundant[row, at[:-1]] / redundant[row, at[1:]]
        if np.abs(np.log(np.abs(ratio))).max() < STATICS.uneven:
            passed = redundant.copy()
            passed[:, at[:-1]] -= ratio * redundant[:, at[1:]]
            passed = _clean(passed)
            if _coupled(passed).sum() < _coupled(redundant).sum():
                redundant = passed
    return redundant


def _coupled(redundant: Array) -> Flags:
    """Which redundants act in one element, (r, r)."""
    acts = (redundant != 0.0).astype(float)
    return np.asarray(acts.T @ acts > 0.0)


def eliminated(redundant: Array, turned: Array, borders: int) -> tuple[Array, Factor]:
    """Redundants (k, r) in an order that leaves little fill, and the factor of their matrix then.

    Of columns that are left, the one that acts on the fewest others goes first.

    Parameters
    ----------
    redundant : ndarray, shape (k, r)
    turned : ndarray, shape (2 t, r)
        Those of radial elements that turn, whose two columns act together.
    borders : int
        Numbers that are added below, full.
    """
    r = redundant.shape[1]
    coupled = _coupled(redundant) | _coupled(np.abs(turned[::2]) + np.abs(turned[1::2]))
    if coupled.all():
        return redundant, full(r, borders)
    order, place, left = np.arange(r), np.arange(r), np.ones(r, dtype=bool)
    below = []
    for k in range(r):
        c = int(np.where(left, coupled.sum(axis=1, where=left), r + 1).argmin())
        left[c] = False
        order[k], place[c] = c, k
        rows = np.flatnonzero(coupled[c] & left)
        coupled[np.ix_(rows, rows)] = True
        below.append(rows)
    factor = _factor([np.sort(place[rows]) for rows in below], borders)
    return np.ascontiguousarray(redundant[:, order]), factor


def full(r: int, borders: int) -> Factor:
    """Return a factor of which nothing is zero."""
    return _factor([np.arange(c + 1, r) for c in range(r)], borders)


def _factor(below: Sequence[Numbers], borders: int) -> Factor:
    """Factor of some columns, with borders, which are full, as further rows and columns."""
    at_border = np.arange(len(below), len(below) + borders)
    columns = [np.concatenate([rows, at_border]) for rows in below]
    columns += [at_border[k + 1 :] for k in range(borders)]
    starts = np.zeros(len(columns) + 1, dtype=np.intp)
    np.cumsum([len(rows) for rows in columns], out=starts[1:])
    return Factor(starts, np.concatenate([np.zeros(0, dtype=np.intp), *columns]))
