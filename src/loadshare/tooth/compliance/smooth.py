"""A tooth between root section and tip as polynomials: fast to evaluate, with exact slopes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from loadshare.tooth.compliance.middle import MiddleSurface, both_sides, under
from loadshare.tooth.geometry.body import Array, ToothBody

DEGREE = 9
"""Degree of the polynomials, in u on either side of the end of the fillet and in w."""


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """The tooth at n places of its middle surface.

    Attributes
    ----------
    middle, half : array (n, 3)
        Point half-way between the two sides, and vector from it to side +1 [m].
    middle_u, half_u, middle_w, half_w : array (n, 3)
        Their derivatives with respect to u and w.
    """

    middle: Array
    half: Array
    middle_u: Array
    half_u: Array
    middle_w: Array
    half_w: Array


class Polynomials(NamedTuple):
    """Chebyshev series, piecewise in u, and in w, in the form that compiled code reads."""

    pieces: Array  # (2, 2): first and last u
    coefficients: Array  # (2, DEGREE + 1, (DEGREE + 1)·18): of u, then of w and of each number


class SmoothMiddle(MiddleSurface):
    """Middle surface fitted to the outline at Chebyshev points.

    For the shipped pairs the polynomials miss the outline by 3 µm at most (next to the end of the
    fillet, where involute or envelope begins with a square root), a thousandth of the thickness.

    Parameters
    ----------
    body : ToothBody
    waist : float
        As for :class:`MiddleSurface`; the polynomials begin there.
    """

    def __init__(self, body: ToothBody, waist: float) -> None:
        super().__init__(body, waist)
        count = DEGREE + 1
        unit, fit, _ = _chebyshev()
        self._pieces = ((waist, body.foot), (body.foot, 1.0))
        u = np.concatenate([_spread(unit, *piece) for piece in self._pieces])[:, None]
        sides = both_sides(body, u, _spread(unit, 0.0, 1.0))
        values = 0.5 * np.concatenate([sides[0] + sides[1], sides[0] - sides[1]], axis=-1)
        over_w = np.einsum("jb,abk->ajk", fit, values)
        pieces = [np.tensordot(fit, part, 1) for part in np.split(over_w, 2)]
        slopes = [
            _slopes(part, 2.0 / (high - low))
            for part, (low, high) in zip(pieces, self._pieces, strict=True)
        ]
        whole = np.concatenate(pieces)
        across = np.swapaxes(_slopes(np.swapaxes(whole, 0, 1), 2.0), 0, 1)
        coefficients = np.concatenate([whole, np.concatenate(slopes), across], axis=-1)
        self._polynomials = Polynomials(
            pieces=np.array(self._pieces),
            coefficients=np.ascontiguousarray(coefficients).reshape(2, count, -1),
        )

        # Length of the middle line at mid-width, integrated from its exact slope.
        rise = self.sample(u[:, 0], np.full(2 * count, 0.5)).middle_u
        speed = np.linalg.norm(rise, axis=1).reshape(2, count)
        self._height, start = [], 0.0
        for part, domain in zip(speed, self._pieces, strict=True):
            slope = chebyshev.Chebyshev(fit @ part, domain)
            line = slope.integ(lbnd=domain[0]) + start
            self._height.append((line, slope))
            start = float(line(domain[1]))
        self.whole_height = start

    def height(self, z: Array) -> tuple[Array, Array]:
        """Return the height above the root section at mid-width, over the whole, and its slope."""
        upper = z > self.body.foot
        (low, low_slope), (high, high_slope) = self._height
        value, slope = (
            np.where(upper, high(z), low(z)),
            np.where(upper, high_slope(z), low_slope(z)),
        )
        return value / self.whole_height, slope / self.whole_height

    def points(self, zw: Array) -> Array:
        """See :meth:`MiddleSurface.points`."""
        return self.surface(zw)[0]

    def surface(self, zw: Array) -> tuple[Array, Array, Array]:
        """See :meth:`MiddleSurface.surface`."""
        z, w = zw[:, 0], zw[:, 1]
        at = self.sample(np.maximum(z, self.waist), w)
        below = np.maximum(self.waist - z, 0.0) / (1.0 + self.waist)
        if not below.any():
            return at.middle, at.middle_u, at.middle_w
        down = under(self.body, at.middle) - at.middle
        sunk = below[:, None]
        over_z = np.where(sunk > 0.0, -down / (1.0 + self.waist), at.middle_u)
        return at.middle + sunk * down, over_z, at.middle_w

    def facing(self, uw: Array, side: int) -> tuple[Array, Array]:
        """See :meth:`MiddleSurface.facing`."""
        at = self.sample(*uw.T)
        normal = np.cross(at.middle_u + side * at.half_u, at.middle_w + side * at.half_w)
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        inside = -side * np.sum(normal * at.half, axis=1)
        return at.middle + side * at.half, np.asarray(np.sign(inside)[:, None] * normal)

    def sample(self, u: Array, w: Array) -> Sample:
        """Evaluate the tooth at places u and w (n,), none of them below the waist."""
        from loadshare.tooth.compliance.compiled_smooth import read

        found = np.empty((len(u), 18))
        read(self._polynomials, self.body.foot, np.array(u, float), np.array(w, float), found)
        return Sample(*(found[:, k : k + 3] for k in range(0, 18, 3)))


def _spread(unit: Array, low: float, high: float) -> Array:
    """Map places from −1 to 1 to an interval."""
    return low + (high - low) * 0.5 * (unit + 1.0)


def _slopes(coefficients: Array, scale: float) -> Array:
    """Return coefficients of the derivative along axis 0, as many as the polynomial has."""
    _, _, derivative = _chebyshev()
    return np.asarray(scale * np.tensordot(derivative, coefficients, 1))


@cache
def _chebyshev() -> tuple[Array, Array, Array]:
    """Return points −1 to 1, and matrices: values to coefficients, and these to the slope's."""
    points = np.asarray(chebyshev.chebpts1(DEGREE + 1))
    derivative = np.zeros((DEGREE + 1, DEGREE + 1))
    derivative[:-1] = chebyshev.chebder(np.eye(DEGREE + 1))
    fit = np.asarray(np.linalg.inv(chebyshev.chebvander(points, DEGREE)), np.float64)
    return points, fit, derivative
