r"""The surfaces of all contact lines of several positions, at any load.

Far from a strip its width hardly matters. There the displacement of
:mod:`loadshare.tooth.contact.strips` is the series

.. math:: g(\tau) = \ln\tau + \text{const} + \sum_{k\ge1} c_k\tau^{-2k},\qquad
    c_k = \frac{(-1)^{k+1}}{2k(k+1)}\left[\frac{(2k)!}{4^k (k!)^2}\right]^2

(asinh expanded under its integral), so that between two points it is a polynomial in the strip's
b² with coefficients that geometry fixes. Only next to a strip g itself is needed.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from math import comb, pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from loadshare.tooth.contact.strips import StripLine, StripTable, strip_table
from loadshare.tooth.geometry.body import Array

TERMS = 5
"""Powers of b² that are kept."""
FAR = 4.0
"""Distance, in half-widths, from which they are good to 4e-11."""


class Strips(NamedTuple):
    """Strips of K positions, N of each, as compiled code reads them.

    Lines are numbered within a position; what only fills it up has the number −1.
    """

    number: Array  # (K, N)
    place: Array  # (K, N) along the line [m]
    half: Array  # (K, N): half of the length [m]
    scale: Array  # (K, N): displacement per force and unit of g [m/N]
    square: Array  # (K, N): b² per force [m²/N]
    series: Array  # (K, TERMS + 1, N, N): coefficients of b²ᵏ [m/N]
    far: float
    table: StripTable


class Surface:
    """Compliance of the surfaces under the strips of K positions, each with several lines.

    Positions with fewer points than the largest, N, are filled up with points that yield nothing.

    Parameters
    ----------
    positions : sequence of sequence of StripLine
        Lines do not feel one another here: that is what the bulk compliance is for.

    Attributes
    ----------
    strips : Strips
    which : array (K,) of int
        Numbers of the positions among the strips.
    """

    def __init__(self, positions: Sequence[Sequence[StripLine]]) -> None:
        from loadshare.tooth.contact.compiled import expand

        count = max(sum(len(line.length) for line in lines) for lines in positions)
        number, place, half, scale, square = np.stack(
            [_strips(lines, count) for lines in positions], axis=1
        )
        series = np.empty((len(positions), TERMS + 1, count, count))
        self.strips = Strips(number, place, half, scale, square, series, FAR, strip_table())
        expand(self.strips, COEFFICIENTS, series)
        self.which = np.arange(len(positions))

    def compliance(self, force: Array, least: Array) -> tuple[Array, Array]:
        """Compliance of the two surfaces at the widths that belong to the forces.

        Parameters
        ----------
        force : array (K, N)
            [N].
        least : array (K,)
            Force below which a strip narrows no further [N].

        Returns
        -------
        secant, tangent : array (K, N, N)
            [m/N]; displacement is secant @ force, its derivative over force is the tangent.
        """
        from loadshare.tooth.contact.compiled import surfaces

        force, least = np.array(force, float, order="C"), np.array(least, float)
        secant, tangent = np.empty((2, *force.shape, force.shape[1]))
        surfaces(self.strips, self.which, force, least, secant, tangent)
        return secant, tangent

    def rows(self, chosen: NDArray[np.int64]) -> Surface:
        """The surfaces of some of the positions."""
        part = copy(self)
        part.which = self.which[chosen]
        return part


COEFFICIENTS = np.array(
    [1.0]
    + [
        -((-1.0) ** k) * (comb(2 * k, k) / 4.0**k) ** 2 / (2.0 * k * (k + 1.0))
        for k in range(1, TERMS + 1)
    ]
)
"""Of the series above; the first is the logarithm's."""


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
