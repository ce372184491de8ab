"""Sums and products in twice the working precision, on arrays.

Where parts of very different stiffness share a load, a residual that is small in double precision
still leaves the torques open; in twice the precision its rounding no longer matters. The error-free
transformations are those of Knuth and Dekker (Ogita, Rump, Oishi, SIAM J. Sci. Comput. 26, 2005).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from loadshare.array_types import Array

SPLIT = 134217729.0
"""2²⁷ + 1: cuts a double into two halves whose products are exact."""


class Twofold(NamedTuple):
    """An unevaluated sum of two arrays, the second below the last digit of the first."""

    high: Array
    low: Array

    @property
    def value(self) -> Array:
        """The nearest doubles."""
        return self.high + self.low


def two_sum(a: Array, b: Array) -> Twofold:
    """Return the sum of two arrays and its exact rounding error."""
    total = a + b
    part = total - a
    return Twofold(total, (a - (total - part)) + (b - part))


def _halves(a: Array) -> tuple[Array, Array]:
    large = SPLIT * a
    high = large - (large - a)
    return high, a - high


def two_product(a: Array, b: Array) -> Twofold:
    """Return the product of two arrays and its exact rounding error."""
    product = a * b
    ah, al = _halves(a)
    bh, bl = _halves(b)
    return Twofold(product, ((ah * bh - product) + ah * bl + al * bh) + al * bl)


def plus(one: Twofold, other: Twofold) -> Twofold:
    """Return the sum of two twofold arrays."""
    high, low = two_sum(one.high, other.high)
    return Twofold(*two_sum(high, low + (one.low + other.low)))


def minus(one: Twofold, other: Twofold) -> Twofold:
    """Return the difference of two twofold arrays."""
    return plus(one, Twofold(-other.high, -other.low))


def product(a: Array, b: Array) -> tuple[Twofold, Array]:
    """Return the matrix product (S, k) by (k, m) of doubles, and the sum of its terms' sizes.

    Only entries of `b` that are not zero are multiplied; all columns are added up at once.
    """
    some = b != 0.0
    most = int(some.sum(axis=0).max(initial=0))
    rows = np.argsort(~some, axis=0, kind="stable")[:most]
    terms = two_product(a[:, rows], np.take_along_axis(b, rows, axis=0))
    shape = len(a), b.shape[1]
    total, sizes = Twofold(np.zeros(shape), np.zeros(shape)), np.zeros(shape)
    for k in range(most):
        total = plus(total, Twofold(terms.high[:, k], terms.low[:, k]))
        sizes += np.abs(terms.high[:, k])
    return total, sizes


def exact(a: Array) -> Twofold:
    """Return doubles as a twofold array."""
    return Twofold(a, np.zeros_like(a))


def quotient(a: Array, b: Array) -> Twofold:
    """Return the quotient of two arrays."""
    q = a / b
    p, e = two_product(q, b)
    return Twofold(q, ((a - p) - e) / b)


def power_two_thirds(force: Array) -> Twofold:
    """Return F^(2/3) of arrays F ≥ 0, from the double cube root and one step of Newton's method."""
    y = np.cbrt(force)
    safe = np.where(y > 0.0, y, 1.0)
    square = two_product(safe, safe)
    cube = plus(two_product(square.high, safe), exact(square.low * safe))
    off = (force - cube.high) - cube.low
    # F^(2/3) = y² + ⅔ (F − y³)/y up to the square of the rounding of y.
    moved = plus(square, exact(2.0 / 3.0 * off / safe))
    return Twofold(np.where(y > 0.0, moved.high, 0.0), np.where(y > 0.0, moved.low, 0.0))
