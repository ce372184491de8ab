r"""The body of a gear as an elastic ring, loaded by the roots of its teeth.

The ring is held at one radius; at the other a tooth's root carries a shear force Q, a moment M and
a pull N, as tractions over the root's thickness t that are uniform (Q, N) or linear (M). Every
harmonic of the tractions, :math:`\sigma_r\cos n\theta` and :math:`\tau\sin n\theta`, has a closed
form of N. I. Muskhelishvili (*Some Basic Problems of the Mathematical Theory of Elasticity*),

.. math:: 2G(u_r + iu_\theta) = e^{-i\theta}\left(\kappa\varphi - z\overline{\varphi'}
    - \overline\psi\right),\qquad \kappa = 3 - 4\nu,

with powers of z as φ and ψ, so the effect of a root is a sum over n. P. Sainsot, P. Velex and
O. Duverger (J. Mech. Des. 126 (2004), 748) fitted it by polynomials. The sum holds for thin and
thick, external and internal bodies alike, and gives how far a loaded tooth moves its neighbours.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import ceil, pi

import numpy as np

from loadshare.tooth.geometry.body import Array

FINEST = 12.0
"""Last harmonic, in radians over half a root; higher ones count by their mean over a wave."""
REFLECTED_SHARE = 1e-8
"""Share of a harmonic returned by the held circle, below which the ring counts as solid."""


@dataclass(frozen=True, eq=False)
class Ring:
    """A ring under the roots of teeth.

    Parameters
    ----------
    loaded, held : float
        Radii of the teeth's roots and of the circle at which the ring is held [m]; `held` is the
        greater of the two for an internal gear.
    thickness : float
        Thickness t of the teeth at the root [m].
    width : float
        Face width [m].
    teeth : float
        Pitches around the whole ring.
    poisson : float
        ν.
    """

    loaded: float
    held: float
    thickness: float
    width: float
    teeth: float
    poisson: float

    def root(self, k: int) -> Array:
        """Return the compliance of a root for loads on the root `k` teeth before it.

        Returns
        -------
        array (3, 3)
            In units of (1 − ν²)/E over the face width. Rows are deflection towards the tooth's side
            +1, lean that way times t, and lift; columns Q, M/t and N in the same senses.
        """
        here, beside = self._sums(abs(k))
        found = (here - beside if k < 0 else here + beside).reshape(3, 3)
        load_per_torque, swollen = self._mean
        found[0, 0] += 0.5 * load_per_torque
        found[2, 2] += 0.5 * swollen
        if k == 0:
            # Higher harmonics: 2/n of a half-plane times the means 1/2x² (uniform), 18/x² (linear).
            found += np.diag([1.0, 36.0, 1.0]) / (2.0 * FINEST**2)
        if self.held > self.loaded:  # teeth that point inwards lean and lift the other way
            found[0, 1:] *= -1.0
            found[1:, 0] *= -1.0
        return np.asarray(found / pi)

    def _sums(self, k: int) -> tuple[Array, Array]:
        """Return sums (9,) over the orders at `k` teeth from the load: even and odd in k."""
        angle = 2.0 * pi * k / self.teeth * self._orders
        here, beside = self._weights
        return here @ np.cos(angle), beside @ np.sin(angle)

    @cached_property
    def _weights(self) -> tuple[Array, Array]:
        """Terms (9, n) of every order, in the cosine and in the sine of the angle from the load."""
        even, odd = self._shares
        (rr, rt), (tr, tt) = self._harmonics
        still = np.zeros_like(even)
        here = [tt * even * even, tr * even * odd, still]
        here += [rt * odd * even, rr * odd * odd, still, still, still, rr * even * even]
        beside = [still, still, tr * even * even, still, still, rr * odd * even]
        beside += [-rt * even * even, -rr * even * odd, still]
        return np.array(here), np.array(beside)

    @cached_property
    def _orders(self) -> Array:
        """Orders n of the harmonics, from 1."""
        half = 0.5 * self.thickness / self.loaded
        return np.arange(1.0, ceil(FINEST / half) + 1.0)

    @cached_property
    def _shares(self) -> tuple[Array, Array]:
        """Harmonics of a uniform and of a linear traction on a root, over those of a point load."""
        x = 0.5 * self.thickness / self.loaded * self._orders
        even = np.sin(x) / x
        return even, 6.0 * (even - np.cos(x)) / x

    @cached_property
    def _harmonics(self) -> Array:
        """Displacements u_r, u_θ (first index) for tractions σ, τ of every order (2, 2, n).

        A harmonic that reaches less deep than half the width is in plane strain, because Poisson's
        strain across the width is prevented; one that reaches deeper is in plane stress.
        """
        n, ratio = self._orders, self.held / self.loaded
        deep = self.loaded / n > 0.5 * self.width
        thick = deep | (n * abs(np.log(ratio)) < -0.5 * np.log(REFLECTED_SHARE))
        nu = np.where(deep, self._in_plane_stress, self.poisson)
        found = np.empty((2, 2, len(n)))
        found[..., thick] = _displacements(n[thick], ratio, nu[thick])
        found[..., ~thick] = _displacements(n[~thick], ratio, nu[~thick], count=2)
        return np.where(deep, found / (1.0 - self.poisson**2), found)

    @property
    def _in_plane_stress(self) -> float:
        """The ν' at which plane strain is this material's plane stress, (1 − ν'²)/E' = 1/E."""
        return self.poisson / (1.0 + self.poisson)

    @cached_property
    def _mean(self) -> tuple[float, float]:
        """Displacements u_θ, u_r for uniform tractions all around, plane stress: torsion, Lamé."""
        ratio, nu = self.held / self.loaded, self._in_plane_stress
        outwards = 1.0 if ratio < 1.0 else -1.0
        scale = outwards / ((1.0 - nu) * (1.0 - self.poisson**2))
        load_per_torque = (1.0 - ratio**2) / ratio**2
        rise, pull = 1.0 - ratio**2, 1.0 + ratio**2
        swollen = rise / (nu / (1.0 - 2.0 * nu) * 2.0 + pull)
        return scale * load_per_torque, scale * swollen


def _displacements(n: Array, ratio: float, poisson: Array, count: int = 4) -> Array:
    """Return displacements u_r, u_θ at radius 1 for tractions σ, τ there of orders n (2, 2, n).

    The ring is held at the radius `ratio`; with two fields, the effect of that is neglected.
    """
    near = _fields(n, 1.0, ratio, poisson, count)
    if count == 2:
        (a, b), (c, d) = near[2:]
        shares = np.array([[d, -b], [-c, a]]) / (a * d - b * c)
        return np.asarray(np.einsum("uf...,ft...->ut...", near[:2], shares))
    equations = np.concatenate([near[2:], _fields(n, ratio, ratio, poisson, count)[:2]])
    # Fields are scaled to equal size, because those from the held circle are faint.
    size = np.abs(equations).max(axis=0)
    shares = np.linalg.solve(np.moveaxis(equations / size, -1, 0), np.eye(4, 2))
    return np.moveaxis(np.moveaxis(near[:2] / size, -1, 0) @ shares, 0, -1)


def _fields(n: Array, radius: float, ratio: float, poisson: Array, count: int) -> Array:
    """Return fields of orders n at a radius: u_r, u_θ, tractions σ, τ on the loaded side (4, …, n).

    Displacements are in units of (1 − ν²)/E. Of the `count` fields, the first two fade from
    radius 1 into the ring, the others from the held circle towards radius 1.
    """
    kappa, outwards, one = 3.0 - 4.0 * poisson, ratio < 1.0, np.ones_like(n)
    grow = (n + 1.0, kappa - n - 1.0, kappa + n + 1.0), (n - 1.0, one, -one)
    fade = (1.0 - n, kappa - 1.0 + n, n - 1.0 - kappa), (-1.0 - n, one, one)
    side = (1.0 if outwards else -1.0) / radius
    fading = [(k < 2) != outwards for k in range(count)]
    chosen = [(fade if fades else grow)[k % 2] for k, fades in enumerate(fading)]
    power, u, v = np.moveaxis(np.array(chosen), 1, 0)
    size = np.array([radius, radius, radius / ratio, radius / ratio])[:count, None] ** power
    u, v = u * size, v * size
    u_slope, v_slope = power * u, power * v
    for k in range(0, count, 2):
        if fading[k]:
            # Both r^(1 − n) and r^(n − 1) are translations for n = 1; the force needs a logarithm.
            first, growth = n == 1.0, 2.0 * kappa[n == 1.0]
            turn = growth * np.log(radius)
            u[k, first], v[k, first] = turn - 1.0, -turn - 1.0
            u_slope[k, first], v_slope[k, first] = growth, -growth
    dilation = poisson / (1.0 - 2.0 * poisson) * (u_slope + u + n * v)
    moved = np.stack([u, v]) / (1.0 - poisson)
    stress = side * np.stack([dilation + u_slope, 0.5 * (v_slope - v - n * u)])
    return np.concatenate([moved, stress])
