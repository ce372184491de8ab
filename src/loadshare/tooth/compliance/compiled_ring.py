"""Harmonics of an elastic ring, compiled with Numba: see :mod:`loadshare.tooth.compliance.ring`."""

from __future__ import annotations

import numpy as np

from loadshare.compilation import jit

compiled = jit(nogil=True, error_model="numpy")


@compiled
def harmonics(ring, found):  # type: ignore[no-untyped-def]
    """Displacements u_r, u_θ (first index) for tractions σ, τ of orders 1, 2, … (2, 2, n).

    Poisson's strain across the width is held back where a harmonic reaches less deep than half the
    width, and free where it reaches deeper: plane strain and plane stress.
    """
    near, far, system = np.empty((4, 4)), np.empty((4, 4)), np.empty((4, 6))
    ratio, depth = ring.held / ring.loaded, abs(np.log(ring.held / ring.loaded))
    for k in range(found.shape[2]):
        n, here = k + 1.0, found[:, :, k]
        if ring.loaded / n > 0.5 * ring.width:
            scale = 1.0 / (1.0 - ring.poisson**2)
            _thick(n, ratio, ring.in_plane_stress, scale, near, far, system, here)
        elif n * depth < -0.5 * np.log(ring.felt):
            _thick(n, ratio, ring.poisson, 1.0, near, far, system, here)
        else:
            _solid(n, ratio, ring.poisson, near, here)


@compiled
def _thick(n, ratio, poisson, scale, near, far, system, found):  # type: ignore[no-untyped-def]
    """Displacements (2, 2) at radius 1 for tractions there, held at the radius `ratio`."""
    _fields(n, 1.0, ratio, poisson, 4, near)
    _fields(n, ratio, ratio, poisson, 4, far)
    system[:] = 0.0
    system[0, 4] = system[1, 5] = 1.0
    for j in range(4):
        # Of equal size, for what comes from the held circle is faint.
        size = max(abs(near[2, j]), abs(near[3, j]), abs(far[0, j]), abs(far[1, j]))
        for k in range(2):
            near[k, j] /= size
            system[k, j], system[2 + k, j] = near[2 + k, j] / size, far[k, j] / size
    _eliminate(system)
    for u in range(2):
        for t in range(2):
            total = 0.0
            for j in range(4):
                total += near[u, j] * system[j, 4 + t]
            found[u, t] = scale * total


@compiled
def _eliminate(system):  # type: ignore[no-untyped-def]
    """Solve n equations in place, their right sides in the columns from n on: Gauss and Jordan."""
    count, columns = system.shape
    for k in range(count):
        pivot = k
        for i in range(k + 1, count):
            if abs(system[i, k]) > abs(system[pivot, k]):
                pivot = i
        over = 1.0 / system[pivot, k]
        for j in range(k, columns):
            value = system[pivot, j] * over
            system[pivot, j] = system[k, j]
            system[k, j] = value
        for i in range(count):
            if i != k:
                part = system[i, k]
                for j in range(k, columns):
                    system[i, j] -= part * system[k, j]


@compiled
def _solid(n, ratio, poisson, near, found):  # type: ignore[no-untyped-def]
    """The same where the held circle is out of reach."""
    _fields(n, 1.0, ratio, poisson, 2, near)
    sigma, tau = near[2], near[3]
    over = 1.0 / (sigma[0] * tau[1] - sigma[1] * tau[0])
    for k in range(2):
        x = near[k]
        found[k, 0] = (x[0] * tau[1] - x[1] * tau[0]) * over
        found[k, 1] = (x[1] * sigma[0] - x[0] * sigma[1]) * over


@compiled
def _fields(n, radius, ratio, poisson, count, found):  # type: ignore[no-untyped-def]
    """Fields of order n at a radius: u_r, u_θ and the tractions σ, τ on the loaded side.

    Displacements are in units of (1 − ν²)/E. Of the first `count` fields, two fade from radius 1
    into the ring, the others from the held circle towards it.
    """
    kappa, outwards = 3.0 - 4.0 * poisson, ratio < 1.0
    grow = ((n + 1.0, kappa - n - 1.0, kappa + n + 1.0), (n - 1.0, 1.0, -1.0))
    fade = ((1.0 - n, kappa - 1.0 + n, n - 1.0 - kappa), (-1.0 - n, 1.0, 1.0))
    side = (1.0 if outwards else -1.0) / radius
    for k in range(count):
        fading = (k < 2) != outwards
        power, u, v = fade[k % 2] if fading else grow[k % 2]
        size = (radius if k < 2 else radius / ratio) ** power
        u, v = u * size, v * size
        u_slope, v_slope = power * u, power * v
        if n == 1.0 and fading and k % 2 == 0:
            # Both r^(1 − n) and r^(n − 1) are translations; the force needs a logarithm.
            turn = 2.0 * kappa * np.log(radius)
            u, v, u_slope, v_slope = turn - 1.0, -turn - 1.0, 2.0 * kappa, -2.0 * kappa
        dilation = poisson / (1.0 - 2.0 * poisson) * (u_slope + u + n * v)
        found[0, k], found[1, k] = u / (1.0 - poisson), v / (1.0 - poisson)
        found[2, k] = side * (dilation + u_slope)
        found[3, k] = 0.5 * side * (v_slope - v - n * u)
