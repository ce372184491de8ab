"""Hertz contact of two elastic bodies: the widths of ellipses and of long lines.

Sources: K. L. Johnson, Contact Mechanics (1985), sections 4.2 and 5.6; C. Weber and K. Banaschek,
Formänderung und Profilrücknahme bei gerad- und schrägverzahnten Rädern (1953). Formulation,
sections 3 and 9.
"""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.typing import ArrayLike

from loadshare.tooth.geometry.body import Array

LONGEST = 1e-7
"""Axis ratio below which an ellipse counts as a line."""


def contact_modulus(modulus: tuple[float, float], poisson: tuple[float, float]) -> float:
    """E* [Pa] of two bodies, 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂."""
    return 1.0 / sum((1.0 - v**2) / e for e, v in zip(modulus, poisson, strict=True))


def axis_ratio(curvature_ratio: ArrayLike) -> Array:
    """Axis ratio b/a of the contact ellipse.

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
    beta = np.maximum(np.clip(wanted, 0.0, 1.0) ** (2.0 / pi), LONGEST)
    for _ in range(30):
        k, e = ellipkm1(beta**2), ellipe(1.0 - beta**2)
        near = beta > 1.0 - 1e-5
        # Both differences vanish as e² for a circle, where their ratio tends to β^(3/2).
        minor, major = k - e, np.where(near, 1.0, e / beta**2 - k)
        found = np.where(near, beta**1.5, minor / major)
        # The slope of the ratio's logarithm over ln β: 1.5 for a circle, towards 2 for a line.
        slope = np.where(
            near, 1.5, (2.0 * e / beta**2 - k) / major - e / np.where(near, 1.0, minor)
        )
        step = (np.maximum(wanted, 1e-300) / found) ** (1.0 / slope)
        beta = np.clip(beta * step, LONGEST, 1.0)
        if np.all((np.abs(step - 1.0) < 1e-9) | (beta <= LONGEST) | (beta >= 1.0)):
            break
    return np.where(beta <= LONGEST, 0.0, beta)


def width_factor(along: ArrayLike, across: ArrayLike) -> Array:
    """Square of a contact's half-width over that of line contact under the same load per length.

    An ellipse that carries q [N/m] at a section is narrower there than a long line under q. With
    κ(b/a) the half-width of every section is b² = κ · 4q/(π E* k), k the curvature across, so a
    row of strips reproduces the ellipse: κ = (E − β²K)/(1 − β²) with the complete elliptic
    integrals, 1 for a line and π/4 for a circle.

    Parameters
    ----------
    along, across : array_like
        Relative curvatures along and across the line [1/m]; a line that is straight or hollow
        along itself (`along` ≤ 0) is a line contact.

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
    beta = np.maximum(axis_ratio(np.where(turned, 1.0 / np.where(turned, ratio, 1.0), ratio)), 1e-9)
    k, e, m = ellipkm1(beta**2), ellipe(1.0 - beta**2), 1.0 - beta**2
    circle = m < 1e-6
    m = np.where(circle, 1.0, m)
    factor = np.where(turned, beta * (k - e) / m, (e - beta**2 * k) / m)
    return np.where(flat, 1.0, np.where(circle, pi / 4.0, factor))


def half_width(load: ArrayLike, curvature: ArrayLike, modulus: float) -> Array:
    """Half-width b [m] of line contact under `load` [N/m], relative `curvature` [1/m], E* [Pa]."""
    load, curvature = np.asarray(load, dtype=float), np.asarray(curvature, dtype=float)
    return np.asarray(np.sqrt(4.0 * load / (pi * modulus * curvature)))
