r"""The surfaces of all contact lines of a position, at any load.

Far from a strip its width hardly matters. There the displacement of
:mod:`loadshare.tooth.strips` is the series

.. math:: g(\tau) = \ln\tau + \text{const} + \sum_{k\ge1} c_k\tau^{-2k},\qquad
    c_k = \frac{(-1)^{k+1}}{2k(k+1)}\left[\frac{(2k)!}{4^k (k!)^2}\right]^2

(asinh expanded under its integral), so that between two points it is a polynomial in the strip's
b² with coefficients that geometry fixes. Only next to a strip g itself is needed.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import comb, pi

import numpy as np

from loadshare.tooth.body import Array
from loadshare.tooth.strips import StripLine, strip_shape

TERMS = 5
"""Powers of b² that are kept."""
FAR = 4.0
"""Distance, in half-widths, from which they are good to 4e-11."""


class Surface:
    """Compliance of the surfaces under the strips of several lines.

    Parameters
    ----------
    lines : sequence of StripLine
        Lines do not feel one another here: that is what the bulk compliance is for.
    """

    def __init__(self, lines: Sequence[StripLine]) -> None:
        number = np.repeat(np.arange(len(lines)), [len(line.length) for line in lines])
        together = number[:, None] == number
        place = np.concatenate([line.place for line in lines])
        half = 0.5 * np.concatenate([line.length for line in lines])
        away = place[:, None] - place
        self._ends = np.stack([away + half, away - half])
        self._nearest = np.where(together, np.abs(self._ends).min(axis=0), np.inf)
        np.fill_diagonal(self._nearest, 0.0)
        self._scale = np.concatenate([1.0 / (pi * a.effective * a.length) for a in lines])
        # b² per force: half-width of line contact at the strip's load per length.
        self._square = np.concatenate(
            [line.widths(np.ones_like(line.length)) ** 2 for line in lines]
        )
        side = self._scale * np.sign(away) * together  # g is odd
        ends = np.where(side != 0.0, self._ends, 1.0)
        inverse = power = 1.0 / ends**2
        self._series = np.empty((TERMS + 1, *away.shape))
        self._series[0] = side * np.log(np.abs(ends[0] / ends[1]))
        for k in range(1, TERMS + 1):
            coefficient = -((-1.0) ** k) * (comb(2 * k, k) / 4.0**k) ** 2 / (2.0 * k * (k + 1.0))
            self._series[k] = coefficient * side * (power[0] - power[1])
            power = power * inverse

    def compliance(self, force: Array, least: float) -> tuple[Array, Array]:
        """Compliance of the two surfaces at the widths that belong to the forces.

        Parameters
        ----------
        force : array (N,)
            [N].
        least : float
            Force below which a strip narrows no further [N].

        Returns
        -------
        secant, tangent : array (N, N)
            [m/N]; displacement is secant @ force, its derivative over force is the tangent.
        """
        square = np.maximum(force, least) * self._square
        order = np.arange(TERMS + 1.0)[:, None]
        powers = square**order
        secant = np.einsum("kij,kj->ij", self._series, powers)
        # b² grows as p, so p ∂S/∂p counts every power of b² by its exponent.
        tangent = np.einsum("kij,kj->ij", self._series, (1.0 + order) * powers)
        width = np.sqrt(square)
        i, j = np.nonzero(self._nearest < FAR * width)
        value, slope = strip_shape(self._ends[:, i, j] / width[j])
        scale = self._scale[j]
        near = scale * (value[0] - value[1])
        secant[i, j] = near
        # b grows as √p, so p ∂S/∂p = −½ Σ ± τ g'(τ).
        tangent[i, j] = near - 0.5 * scale * (slope[0] - slope[1])
        return secant, tangent
