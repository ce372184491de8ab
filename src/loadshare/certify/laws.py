"""Deformation laws of flanks (formulation, section 3), for many samples.

A certificate shares no code with a solver: the roots and tables here are not those of the fast
method, so that a mistake in one of them shows in the other.
"""

from __future__ import annotations

import numpy as np

from loadshare.array_types import Array
from loadshare.settings import CERTIFY


def strain_energy(b: Array, c: Array, approach: Array, root: Array) -> Array:
    """Return the strain energy [J] of power laws at an approach, from roots of claimed forces.

    The energy is ∫F dδ at the claimed approach, so the force there has to be found. Where the
    deformation law holds, one step of Newton's method from the claimed force arrives at it;
    elsewhere Newton's method starts from above.

    Parameters
    ----------
    b, c : ndarray, shape (flanks, S or 1)
        [m/N], [m/N^(2/3)].
    approach, root : ndarray, shape (flanks, S)
        [m], cube roots of the claimed forces [N^(1/3)].
    """
    pressed = np.maximum(approach, 0.0)
    linear = np.where(b > 0.0, pressed / np.where(b > 0.0, b, 1.0), 0.0)
    energy = 0.5 * linear * pressed
    if c.any():
        curve, rise = (b * root + c) * root * root, (3.0 * b * root + 2.0 * c) * root
        step = (curve - pressed) / rise
        y = root - step
        powers = c > 0.0
        far = powers & (pressed > 0.0) & ~(np.abs(step) <= CERTIFY.near_root * root)
        if far.any():
            wide = (np.broadcast_to(v, far.shape)[far] for v in (b, c, pressed))
            y[far] = _root(*wide)
        square = y * y
        curved = (0.5 * b * y + 0.4 * c) * (square * square * y)
        energy = np.where(powers, curved, energy)
    return np.asarray(np.where(approach <= 0.0, 0.0, energy))


def _root(b: Array, c: Array, compression: Array) -> Array:
    """Return F^(1/3) of the law b F + c F^(2/3), c > 0, by Newton's method from above."""
    y = np.sqrt(compression / c)
    y = np.where(b > 0.0, np.minimum(y, np.cbrt(compression / np.where(b > 0.0, b, 1.0))), y)
    left = np.ones(y.shape, dtype=bool)
    for _ in range(CERTIFY.roots):
        step = ((b * y + c) * y * y - compression) / ((3.0 * b * y + 2.0 * c) * y)
        # A root that has converged stays, so that no digit depends on how long the others take.
        left &= ~(np.abs(step) <= CERTIFY.root * y)
        if not left.any():
            break
        y = np.where(left, y - step, y)
    return np.asarray(y)


def interpolated(axis: Array, values: Array, at: Array) -> Array:
    """Return values of k tables (k, points, S or 1) at `at` (k, S), linear beyond the ends."""
    last = (~np.isnan(axis)).sum(axis=1) - 2
    left = np.clip((axis <= at[:, None]).sum(axis=1) - 1, 0, last)
    table, sample = np.ogrid[: len(at), : axis.shape[2]]
    x0, x1, y0, y1 = (a[table, left + step, sample] for a in (axis, values) for step in (0, 1))
    return np.asarray(y0 + (y1 - y0) / (x1 - x0) * (at - x0))


def area(forces: Array, compressions: Array, force: Array) -> Array:
    """Return ∫δ dF of k tables (k, points, S or 1) up to `force` (k, S)."""
    total = np.zeros(force.shape)
    points = (~np.isnan(forces)).sum(axis=1)
    for at in range(forces.shape[1] - 1):
        inside = at + 1 < points
        start = forces[:, at]
        end = np.where(at + 2 < points, forces[:, at + 1], np.inf)
        upper = np.minimum(force, end)
        low = compressions[:, at]
        slope = (compressions[:, at + 1] - low) / (forces[:, at + 1] - start)
        width = np.where(inside, np.maximum(upper - start, 0.0), 0.0)
        part = width * (low + 0.5 * slope * width)
        total += np.where(inside & (width > 0.0), part, 0.0)
    return total
