"""Polynomials of a tooth, compiled with Numba: see :mod:`loadshare.tooth.compliance.smooth`."""

from __future__ import annotations

import numpy as np

from loadshare.compilation import jit

compiled = jit(nogil=True, error_model="numpy")


@compiled
def read(polynomials, foot, u, w, found):  # type: ignore[no-untyped-def]
    """Evaluate the numbers (n, m) of the tooth at places u and w (n,)."""
    coefficients, count = polynomials.coefficients, polynomials.coefficients.shape[1]
    numbers = found.shape[1]
    line, over_u, over_w = np.empty(coefficients.shape[2]), np.empty(count), np.empty(count)
    for n in range(len(u)):
        piece = 1 if u[n] > foot else 0
        low, high = polynomials.pieces[piece]
        _basis(min(max(2.0 * (u[n] - low) / (high - low) - 1.0, -1.0), 1.0), over_u)
        _basis(2.0 * w[n] - 1.0, over_w)
        line[:] = 0.0
        for j in range(count):
            for k in range(len(line)):
                line[k] += over_u[j] * coefficients[piece, j, k]
        found[n] = 0.0
        for j in range(count):
            for k in range(numbers):
                found[n, k] += over_w[j] * line[j * numbers + k]


@compiled
def _basis(x, values):  # type: ignore[no-untyped-def]
    """Evaluate the Chebyshev polynomials at a place from −1 to 1."""
    values[0], values[1] = 1.0, x
    for k in range(2, len(values)):
        values[k] = 2.0 * x * values[k - 1] - values[k - 2]
