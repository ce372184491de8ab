r"""A contact line as a row of strips on two elastic bodies.

Each point of a line represents a strip of length ℓ and half-width b that carries its force as a
half-ellipse of pressure across. On a half-space such a strip displaces the middle of the line, at
the distance x, by

.. math:: \frac{1-\nu^2}{\pi E}\,\frac{p}{\ell}\left[g\left(\frac{x+\ell/2}{b}\right)
    - g\left(\frac{x-\ell/2}{b}\right)\right],\qquad
    g(\tau) = \frac{4}{\pi}\int_0^1 \sqrt{1-y^2}\,\operatorname{asinh}\frac{\tau}{y}\,dy

(Boussinesq), with b² = κ·4q/(πE*k) of :func:`width_factor`. A long row is
Hertz's line contact, a crowned one Hertz's ellipse; contacts in between need no special treatment.

The bulk compliance of a tooth is that of its middle surface, so only the compression between the
flank and the depth h may be added here: the half-space's displacement at the depth h is subtracted.
For a long line this is Weber and Banaschek's compression to the depth h.

A half-space continues beyond the ends of the face, and a load spreads there. A face that is
narrower than its tooth is thick has no material beyond its ends: in the limit every strip is an
independent slice in plane stress, with Weber and Banaschek's compression for that state,

.. math:: \frac{2q}{\pi}\sum\frac1E\left(\ln\frac{2h}{b}-\frac\nu2\right),\qquad
    b^2 = \frac{4q}{\pi k}\sum\frac1E .

In between, both are mixed in proportion to how much narrower than thick the face is; on wider faces
it is the half-space alone, whose ends are a few per cent too stiff.

Sources: K. L. Johnson, Contact Mechanics (1985), sections 4.2 and 5.6; C. Weber and K. Banaschek,
Formänderung und Profilrücknahme bei gerad- und schrägverzahnten Rädern (1953). Formulation,
sections 3 and 9.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from math import inf, pi
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from loadshare.errors import Refused
from loadshare.settings import TEETH
from loadshare.tooth.geometry.body import Array


def contact_modulus(modulus: tuple[float, float], poisson: tuple[float, float]) -> float:
    """Return E* [Pa] of two bodies, 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂."""
    return 1.0 / sum((1.0 - v**2) / e for e, v in zip(modulus, poisson, strict=True))


def axis_ratio(curvature_ratio: ArrayLike) -> Array:
    """Return the axis ratio b/a of the contact ellipse.

    Parameters
    ----------
    curvature_ratio : array_like
        Relative principal curvature along the major axis over that along the minor axis, 0 to 1.

    Returns
    -------
    array
        b/a, 0 to 1; 0 for a ratio so small that the ellipse is a line.
    """
    from scipy.special import ellipe, ellipkm1

    wanted = np.asarray(curvature_ratio, dtype=float)
    beta = np.maximum(np.clip(wanted, 0.0, 1.0) ** (2.0 / pi), TEETH.longest)
    for _ in range(TEETH.meets):
        k, e = ellipkm1(beta**2), ellipe(1.0 - beta**2)
        near = beta > 1.0 - TEETH.circle
        # Both differences vanish as e² for a circle, where their ratio tends to β^(3/2).
        minor, major = k - e, np.where(near, 1.0, e / beta**2 - k)
        found = np.where(near, beta**1.5, minor / major)
        # The slope of the ratio's logarithm over ln β: 1.5 for a circle, towards 2 for a line.
        slope = np.where(
            near, 1.5, (2.0 * e / beta**2 - k) / major - e / np.where(near, 1.0, minor)
        )
        step = (np.maximum(wanted, np.finfo(float).tiny) / found) ** (1.0 / slope)
        beta = np.clip(beta * step, TEETH.longest, 1.0)
        if np.all((np.abs(step - 1.0) < TEETH.fits) | (beta <= TEETH.longest) | (beta >= 1.0)):
            break
    return np.where(beta <= TEETH.longest, 0.0, beta)


def width_factor(along: ArrayLike, across: ArrayLike) -> Array:
    """Return a contact's half-width squared over that of line contact at the same load per length.

    An ellipse that carries q [N/m] at a section is narrower there than a long line under q. With
    κ(b/a) the half-width of every section is b² = κ · 4q/(π E* k), k the curvature across, so a
    row of strips reproduces the ellipse: κ = (E − β²K)/(1 − β²) with the complete elliptic
    integrals, 1 for a line and π/4 for a circle.

    Parameters
    ----------
    along, across : array_like
        Relative curvatures along and across the line [1/m]; a line that is straight or concave
        lengthwise (`along` ≤ 0) is a line contact.

    Returns
    -------
    array
        κ.
    """
    from scipy.special import ellipe, ellipkm1

    along, across = np.broadcast_arrays(
        np.asarray(along, dtype=float), np.asarray(across, dtype=float)
    )
    flat = along <= 0.0
    if flat.all():
        return np.ones(along.shape)
    ratio = np.where(flat, 0.0, along / across)
    turned = ratio > 1.0  # the line runs along the minor axis
    beta = np.maximum(
        axis_ratio(np.where(turned, 1.0 / np.where(turned, ratio, 1.0), ratio)), TEETH.longest
    )
    k, e, m = ellipkm1(beta**2), ellipe(1.0 - beta**2), 1.0 - beta**2
    circle = m < 1e-6
    m = np.where(circle, 1.0, m)
    factor = np.where(turned, beta * (k - e) / m, (e - beta**2 * k) / m)
    return np.where(flat, 1.0, np.where(circle, pi / 4.0, factor))


def half_width(load: ArrayLike, curvature: ArrayLike, modulus: float) -> Array:
    """Return b [m] of line contact under `load` [N/m], relative `curvature` [1/m], E* [Pa]."""
    load, curvature = np.asarray(load, dtype=float), np.asarray(curvature, dtype=float)
    return np.asarray(np.sqrt(4.0 * load / (pi * modulus * curvature)))


def _slope(tau: Array) -> Array:
    """Return g'(τ) = (4/π) √(1 + τ²) (K − E), parameter 1/(1 + τ²), for τ > 0."""
    from scipy.special import ellipe, ellipkm1

    m = 1.0 / (1.0 + tau**2)
    far = tau > 1e3  # K − E cancels there; its series does not
    exact = 4.0 / pi * np.sqrt(1.0 + tau**2) * (ellipkm1(tau**2 * m) - ellipe(m))
    return np.where(far, np.sqrt(m) * (1.0 + 0.375 * m), exact)


class StripTable(NamedTuple):
    """Knots, evenly spaced in ln τ, with g and dg/d ln τ, in the form that compiled code reads."""

    first: float
    last: float
    values: Array  # (n,)
    slopes: Array  # (n,)


@cache
def strip_table() -> StripTable:
    """Return the table of g."""
    knots = np.linspace(np.log(TEETH.first_knot), np.log(TEETH.last_knot), 1200)
    nodes, weights = np.polynomial.legendre.leggauss(6)
    middle, half = 0.5 * (knots[1:] + knots[:-1]), 0.5 * np.diff(knots)
    inner = np.exp(middle[:, None] + half[:, None] * nodes)
    parts = half * ((inner * _slope(inner)) @ weights)
    tau = np.exp(knots)
    first = 4.0 / pi * tau[0] * np.log(4.0 / tau[0])  # leading order near 0
    values = first + np.concatenate([[0.0], np.cumsum(parts)])
    return StripTable(TEETH.first_knot, TEETH.last_knot, values, tau * _slope(tau))


@dataclass(frozen=True, eq=False)
class StripLine:
    """The local contact of one line.

    Parameters
    ----------
    length : array (n,)
        Length of line of each point [m]; the points are in line, one after another.
    curvature, curvature_along : array (n,)
        Relative curvatures across and along the line [1/m].
    modulus, poisson : tuple of float
        E [Pa] and ν of the driver and of the driven tooth.
    depth : tuple of array (n,), optional
        Distance from flank to middle surface [m] in the driver and in the driven tooth; without
        it the bodies are half-spaces and the approach is that of distant points.
    factor : array (n,), optional
        κ of the points, if it is known already.
    face_width : float
        Of the narrower tooth [m].

    Raises
    ------
    Refused
        If the flanks do not part across the line.
    """

    length: Array
    curvature: Array
    curvature_along: Array
    modulus: tuple[float, float]
    poisson: tuple[float, float]
    depth: tuple[Array, Array] | None = None
    factor: Array | None = None
    face_width: float = inf

    def __post_init__(self) -> None:
        if np.any(self.curvature <= 0.0):
            raise Refused(
                "the flanks do not separate on both sides of a contact line (relative curvature "
                f"{float(np.min(self.curvature)):.4g} 1/m); make the modifications "
                "(driver.modification, driven.modification) smaller, or longer"
            )

    @cached_property
    def narrow(self) -> float:
        """Share of plane-stress slices in the compression, 0 to 1; the half-space has the rest."""
        if self.depth is None:
            return 0.0
        thickness = float(np.max(self.depth[0] + self.depth[1]))
        return max(0.0, 1.0 - self.face_width / thickness)

    @cached_property
    def slices(self) -> tuple[Array, Array]:
        """A and B (n,) of the slices' share of the compression, A p (B − ½ ln p) [m]."""
        none = np.zeros_like(self.length)
        if self.depth is None or self.narrow == 0.0:
            return none, none
        soft = [1.0 / e for e in self.modulus]
        # b² per force of line contact in plane stress, as `square` is in plane strain.
        square = self.square * self.effective * sum(soft)
        ends = (
            part * (0.5 * np.log(4.0 * depth**2 / square) - 0.5 * nu)
            for part, depth, nu in zip(soft, self.depth, self.poisson, strict=True)
        )
        scale = self.narrow * 2.0 * sum(soft) / (pi * self.length)
        return scale, np.asarray(sum(ends, none) / sum(soft))

    @cached_property
    def place(self) -> Array:
        """Coordinates (n,) of the points along the line [m]."""
        return np.asarray(np.cumsum(self.length) - 0.5 * self.length)

    @cached_property
    def effective(self) -> float:
        """E* [Pa]."""
        return contact_modulus(self.modulus, self.poisson)

    @cached_property
    def _bend(self) -> Array:
        """Curvature of the line contact that has the strips' width [1/m]."""
        factor = self.factor
        if factor is None:
            factor = width_factor(self.curvature_along, self.curvature)
        return self.curvature / factor

    @cached_property
    def square(self) -> Array:
        """b² per force (n,) [m²/N]: of line contact at the strip's load per length."""
        return half_width(1.0 / self.length, self._bend, self.effective) ** 2

    @property
    def widest(self) -> float:
        """Largest half-width b [m] that enters the compliance.

        With wider contacts a line would carry more load the shorter it is.
        """
        return float(np.sum(self.length))

    def widths(self, force: Array) -> Array:
        """Return half-widths b (n,) [m] under the points' forces (n,) [N]."""
        return np.sqrt(force * self.square)

    def pressure(self, force: Array) -> Array:
        """Return the largest pressure (n,) [Pa] across each strip under `force` (n,) [N]."""
        width = self.widths(force)
        loaded = width > 0.0
        safe = np.where(loaded, width, 1.0)
        return np.where(loaded, 2.0 * force / (self.length * pi * safe), 0.0)

    @cached_property
    def removed(self) -> Array:
        """Compliance (n, n) [m/N] of two half-spaces at the depths of the middle surfaces.

        For a narrow face it is the half-spaces' share of that.
        """
        from loadshare.tooth.contact.compiled import add_below

        total = np.zeros((len(self.length),) * 2)
        if self.depth is not None:
            for depth, e, nu in zip(self.depth, self.modulus, self.poisson, strict=True):
                scale = (1.0 + nu) / (2.0 * pi * e * self.length)
                add_below(self.place, self.length, scale, depth, float(nu), total)
        return total * (1.0 - self.narrow) if self.narrow else total
