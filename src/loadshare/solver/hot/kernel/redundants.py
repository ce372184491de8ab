"""Redundants of a set that act in few elements, and the entries of their matrix that are not zero.

Both keep the work of a pass proportional to the number of branches.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import accumulate, chain
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
        Where each column begins in `below`.
    below : ndarray of int
        Rows below the diagonal, column by column.
    rows, columns : ndarray of int
        All entries, each column from its diagonal on, without borders.
    """

    starts: Numbers
    below: Numbers
    rows: Numbers
    columns: Numbers


def local(basis: Basis) -> tuple[Array, Array]:
    """Return P and N of the same statics, with each redundant the force of one element.

    Each acts in few others, so that most entries are zero, however many branches there are; the
    elements are chosen so that N is as well conditioned as it can be in this form. Where nothing
    moves freely, the other elements alone carry the loads, few elements for each load; otherwise P
    stays the pseudo-inverse, so that coordinates are those of least norm.
    """
    from scipy.linalg import qr

    n = basis.redundant
    _, by_size = qr(n.T, mode="r", pivoting=True, check_finite=False)
    chosen, others = by_size[: n.shape[1]], by_size[n.shape[1] :]
    redundant = _chained(_clean(np.linalg.solve(n[chosen].T, n.T).T))
    redundant /= np.sqrt((redundant * redundant).sum(axis=0))
    particular = basis.particular
    if not basis.loose.shape[1]:
        particular = np.zeros_like(particular)
        particular[others] = _clean(np.linalg.inv(basis.directions[others]).T)
    return particular, redundant


def _clean(matrix: NDArray[np.floating]) -> Array:
    """Return a matrix without entries that are round-off of its largest."""
    size = np.abs(matrix)
    return np.asarray(np.where(size < STATICS.nothing * size.max(), 0.0, matrix), dtype=np.float64)


def _chained(redundant: Array) -> Array:
    """Replace many redundants that act in one element by differences of consecutive ones.

    Otherwise all of them would be coupled through that element, and their matrix would be full.
    """
    acts = redundant != 0.0
    for row in range(len(redundant)):
        if np.count_nonzero(acts[row]) <= STATICS.many:
            continue
        at = np.flatnonzero(acts[row])
        ratio = redundant[row, at[:-1]] / redundant[row, at[1:]]
        if np.abs(np.log(np.abs(ratio))).max() < STATICS.uneven:
            passed = redundant.copy()
            passed[:, at[:-1]] -= ratio * redundant[:, at[1:]]
            passed = _clean(passed)
            if _coupled(passed).sum() < _coupled(redundant).sum():
                redundant, acts = passed, passed != 0.0
    return redundant


def _coupled(redundant: Array) -> Flags:
    """Return which pairs of redundants act in a common element, (r, r)."""
    acts = (redundant != 0.0).astype(float)
    return np.asarray(acts.T @ acts > 0.0)


def eliminated(redundant: Array, turned: Array, borders: int) -> tuple[Array, Factor]:
    """Return redundants (k, r) in an order with little fill-in, and the factor of their matrix.

    Of the columns that are left, the one coupled to the fewest others comes next.

    Parameters
    ----------
    redundant : ndarray, shape (k, r)
    turned : ndarray, shape (2 t, r)
        Their rows in radial elements that turn, the two of an element acting together.
    borders : int
        Full rows that are added below.
    """
    r = redundant.shape[1]
    coupled = _coupled(redundant) | _coupled(np.abs(turned[::2]) + np.abs(turned[1::2]))
    if coupled.all():
        return redundant, full(r, borders)
    # Sets of redundants as the bits of whole numbers.
    beside = [_bits_of(row) for row in coupled]
    left, order, found = (1 << r) - 1, list[int](), list[int]()
    for _ in range(r):
        c = min(_members(left), key=lambda one: (beside[one] & left).bit_count())
        left &= ~(1 << c)
        order.append(c)
        found.append(beside[c] & left)
        for one in _members(found[-1]):
            beside[one] |= found[-1]
    place = {c: k for k, c in enumerate(order)}
    below = [sorted(place[c] for c in _members(rows)) for rows in found]
    return np.ascontiguousarray(redundant[:, order]), _factor(below, borders)


def _factor(below: Sequence[Sequence[int]], borders: int) -> Factor:
    """Return the factor with given rows below the diagonal of each column; borders are full."""
    r = len(below)
    at = range(r, r + borders)
    all_below = [*([*rows, *at] for rows in below), *(at[k + 1 :] for k in range(borders))]
    entries = [(row, c) for c, rows in enumerate(below) for row in (c, *rows)]
    rows, columns = np.array(entries, dtype=np.intp).reshape(-1, 2).T.copy()
    starts = np.array([0, *accumulate(map(len, all_below))], dtype=np.intp)
    return Factor(starts, np.array([*chain.from_iterable(all_below)], np.intp), rows, columns)


def _bits_of(flags: Flags) -> int:
    return int.from_bytes(np.packbits(flags, bitorder="little").tobytes(), "little")


def _members(bits: int) -> Iterator[int]:
    """Yield the numbers of the bits that are set, from the lowest on."""
    while bits:
        lowest = bits & -bits
        yield lowest.bit_length() - 1
        bits ^= lowest


@lru_cache
def full(r: int, borders: int) -> Factor:
    """Return a factor without zeros."""
    return _factor([range(c + 1, r) for c in range(r)], borders)
