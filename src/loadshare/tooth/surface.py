r"""The surfaces of all contact lines of several positions, at any load.

Far from a strip its width hardly matters. There the displacement of
:mod:`loadshare.tooth.strips` is the series

.. math:: g(\tau) = \ln\tau + \text{const} + \sum_{k\ge1} c_k\tau^{-2k},\qquad
    c_k = \frac{(-1)^{k+1}}{2k(k+1)}\left[\frac{(2k)!}{4^k (k!)^2}\right]^2

(asinh expanded under its integral), so that between two points it is a polynomial in the strip's
b² with coefficients that geometry fixes. Only next to a strip g itself is needed.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from math import comb, pi

import numpy as np
from numpy.typing import NDArray

from loadshare.tooth.body import Array
from loadshare.tooth.strips import StripLine, strip_shape

TERMS = 5
"""Powers of b² that are kept."""
FAR = 4.0
"""Distance, in half-widths, from which they are good to 4e-11."""


class Surface:
    """Compliance of the surfaces under the strips of K positions, each with several lines.

    Positions with fewer points than the largest, N, are filled up with points that yield nothing.

    Parameters
    ----------
    positions : sequence of sequence of StripLine
        Lines do not feel one another here: that is what the bulk compliance is for.
    """

    def __init__(self, positions: Sequence[Sequence[StripLine]]) -> None:
        count = max(sum(len(line.length) for line in lines) for lines in positions)
        strips = np.stack([_strips(lines, count) for lines in positions], axis=1)
        number, place, half, self._scale, self._square = strips
        real = number >= 0.0
        together = (number[:, :, None] == number[:, None, :]) & real[:, None, :]
        away = place[:, :, None] - place[:, None, :]
        half = half[:, None, :]
        self._ends = np.stack([away + half, away - half])
        self._nearest = np.where(together, np.abs(self._ends).min(axis=0), np.inf)
        diagonal = np.arange(count)
        self._nearest[:, diagonal, diagonal] = np.where(real, 0.0, np.inf)
        side = self._scale[:, None, :] * np.sign(away) * together  # g is odd
        ends = np.where(side != 0.0, self._ends, 1.0)
        inverse = power = 1.0 / ends**2
        self._series = np.empty((TERMS + 1, *away.shape))
        self._series[0] = side * np.log(np.abs(ends[0] / ends[1]))
        for k in range(1, TERMS + 1):
            coefficient = -((-1.0) ** k) * (comb(2 * k, k) / 4.0**k) ** 2 / (2.0 * k * (k + 1.0))
            self._series[k] = coefficient * side * (power[0] - power[1])
            power = power * inverse

    def compliance(self, force: Array, least: Array | float) -> tuple[Array, Array]:
        """Compliance of the two surfaces at the widths that belong to the forces.

        Parameters
        ----------
        force : array (K, N)
            [N].
        least : array (K,) or float
            Force below which a strip narrows no further [N].

        Returns
        -------
        secant, tangent : array (K, N, N)
            [m/N]; displacement is secant @ force, its derivative over force is the tangent.
        """
        square = np.maximum(force, np.asarray(least)[..., None]) * self._square
        order = np.arange(TERMS + 1.0)[:, None, None]
        powers = square**order
        secant = np.einsum("knij,knj->nij", self._series, powers)
        # b² grows as p, so p ∂S/∂p counts every power of b² by its exponent.
        tangent = np.einsum("knij,knj->nij", self._series, (1.0 + order) * powers)
        width = np.sqrt(square)
        n, i, j = np.nonzero(self._nearest < FAR * width[:, None, :])
        value, slope = strip_shape(self._ends[:, n, i, j] / width[n, j])
        scale = self._scale[n, j]
        near = scale * (value[0] - value[1])
        secant[n, i, j] = near
        # b grows as √p, so p ∂S/∂p = −½ Σ ± τ g'(τ).
        tangent[n, i, j] = near - 0.5 * scale * (slope[0] - slope[1])
        return secant, tangent

    def rows(self, chosen: NDArray[np.int64]) -> Surface:
        """The surfaces of some of the positions."""
        part = copy(self)
        part._ends, part._series = self._ends[:, chosen], self._series[:, chosen]
        part._nearest = self._nearest[chosen]
        part._scale, part._square = self._scale[chosen], self._square[chosen]
        return part


def _strips(lines: Sequence[StripLine], count: int) -> Array:
    """Number of the line, place, half length, scale and b² per force of `count` strips (5, count).

    Those that fill up have the number −1.
    """
    table = np.zeros((5, count))
    table[0] = -1.0
    start = 0
    for number, line in enumerate(lines):
        part = slice(start, start := start + len(line.length))
        # b² per force: half-width of line contact at the strip's load per length.
        square = line.widths(np.ones_like(line.length)) ** 2
        scale = 1.0 / (pi * line.effective * line.length)
        table[0, part], table[1, part] = number, line.place
        table[2, part], table[3, part], table[4, part] = 0.5 * line.length, scale, square
    return table
