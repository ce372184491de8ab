"""Hertz's closed forms: point contact, and the compression of a body in line contact.

Sources: K. L. Johnson, Contact Mechanics (1985), sections 4.2 and 5.6; C. Weber and K. Banaschek,
Formänderung und Profilrücknahme bei gerad- und schrägverzahnten Rädern (1953).
"""

from dataclasses import dataclass
from math import pi

import numpy as np

from loadshare.tooth.contact.compiled import shape
from loadshare.tooth.contact.problem import ContactBatch, ToothContact
from loadshare.tooth.contact.strips import axis_ratio, strip_table


@dataclass(frozen=True, slots=True)
class PointContact:
    """Hertz contact of two bodies that touch at a point.

    Parameters
    ----------
    curvatures : tuple of float
        Relative principal curvatures [1/m], both positive, in any order.
    modulus : float
        E* [Pa].
    """

    curvatures: tuple[float, float]
    modulus: float

    def __post_init__(self):
        if min(self.curvatures) <= 0.0 or self.modulus <= 0.0:
            raise ValueError(
                f"point contact needs two positive relative curvatures and a positive E*, given "
                f"{self.curvatures} 1/m and {self.modulus} Pa; where one curvature is 0 the "
                "contact is a line"
            )

    @property
    def axis_ratio(self):
        """Ratio b/a."""
        return float(axis_ratio(min(self.curvatures) / max(self.curvatures)))

    def _integrals(self):
        """Return K(e) and (K − E)/e² of the ellipse."""
        from scipy.special import ellipe, ellipkm1

        beta = self.axis_ratio
        k, m = float(ellipkm1(beta**2)), 1.0 - beta**2
        return k, (k - float(ellipe(m))) / m if m > 1e-6 else pi / 4.0

    def axes(self, force):
        """Return the semi-axes a ≥ b [m] under `force` [N]."""
        _, part = self._integrals()
        force = np.asarray(force, dtype=float)
        a = np.cbrt(3.0 * force * part / (pi * self.modulus * min(self.curvatures)))
        return a, self.axis_ratio * a

    def approach(self, force):
        """Return the approach δ [m] of distant points under `force` [N]."""
        return np.asarray(self.coefficient * np.cbrt(np.asarray(force, dtype=float)) ** 2)

    def tangent(self, force):
        """Return the tangent compliance dδ/dF [m/N]; infinite at no load."""
        force = np.asarray(force, dtype=float)
        with np.errstate(divide="ignore"):
            return np.asarray(2.0 / 3.0 * self.coefficient / np.cbrt(force))

    @property
    def coefficient(self):
        """The c of δ = c F^(2/3) [m/N^(2/3)]."""
        k, _ = self._integrals()
        a = float(self.axes(1.0)[0])
        return 3.0 * k / (2.0 * pi * self.modulus * a)

    def pressure(self, force):
        """Return the largest pressure [Pa] under `force` [N]; 0 without load."""
        a, b = self.axes(force)
        area = pi * a * b
        return np.where(area > 0.0, 1.5 * np.asarray(force) / np.where(area > 0.0, area, 1.0), 0.0)


def compression(load, width, depth, modulus, poisson: float):
    """Return the compression [m] of one body between its surface and a depth, in line contact.

    Parameters
    ----------
    load : array_like
        q [N/m].
    width : array_like
        Half-width b of the contact [m].
    depth : array_like
        h [m].
    modulus, poisson : float
        E [Pa] and ν of the body.

    Returns
    -------
    array
        2q(1 − ν²)/(πE) · [asinh(h/b) − ν/(1 − ν) · h/(√(h² + b²) + h)].
    """
    q, b, h = (np.asarray(x, dtype=float) for x in (load, width, depth))
    shape = np.arcsinh(h / b) - poisson / (1.0 - poisson) * h / (np.hypot(h, b) + h)
    return np.asarray(2.0 * q * (1.0 - poisson**2) / (pi * modulus) * shape)


def compression_tangent(width, depth, modulus, poisson: float):
    """Return the derivative of :func:`compression` over the load [m²/N]; half-width grows as √q."""
    b, h = np.asarray(width, dtype=float), np.asarray(depth, dtype=float)
    root = np.hypot(h, b)
    shape = np.arcsinh(h / b) - poisson / (1.0 - poisson) * h / (root + h)
    slope = -h / root + poisson / (1.0 - poisson) * h * b**2 / (root * (root + h) ** 2)
    return np.asarray(2.0 * (1.0 - poisson**2) / (pi * modulus) * (shape + 0.5 * slope))


def strip_shape(tau):
    """Return g(τ) and τ g'(τ) of a strip, from its table."""
    return np.vectorize(lambda one: shape(one, strip_table()))(tau)


def surfaces(*positions):
    """Return positions of lines between bodies that yield at their surfaces only."""
    problems = []
    for lines in positions:
        count = sum(len(line.length) for line in lines)
        problems.append(ToothContact(np.zeros((count, count)), np.zeros(count), tuple(lines)))
    return ContactBatch(problems)
