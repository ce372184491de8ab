"""Compliance laws of a single unilateral contact.

A law gives the compression δ [m] along the line of action of a contact that carries the force F ≥ 0
[N]. It is strictly increasing (or zero: a rigid contact), so it has an inverse and two convex
potentials. Source: formulation, section 3.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol, runtime_checkable

from loadshare.array_library import cube_root, library_of
from loadshare.array_types import Array
from loadshare.settings import CONTACT


@runtime_checkable
class Law(Protocol):
    """Interface of every compliance law."""

    def compression(self, force: float) -> float:
        """Return the compression [m] under `force` [N]."""

    def force(self, compression: float) -> float:
        """Return the force [N] that gives `compression` [m]; 0 for an open contact."""

    def secant(self, force: float) -> float:
        """Return the secant compliance δ/F [m/N]; its limit at F = 0 may be infinite."""

    def tangent(self, force: float) -> tuple[float, float]:
        """Return the tangent compliance [m/N] and the offset [m] of the tangent line at `force`."""

    def energy(self, compression: float) -> float:
        """Return the strain energy ∫F dδ [J]; 0 for an open contact."""

    def scaled(self, force_unit: float, length_unit: float) -> Law:
        """Return the same law for F in units of `force_unit` and δ in units of `length_unit`."""

    @property
    def is_linear(self) -> bool:
        """Whether the secant compliance does not depend on the force."""


@dataclass(frozen=True, slots=True)
class PowerLaw:
    r"""The law of a mesh, :math:`\delta = bF + cF^{2/3}`.

    Parameters
    ----------
    b : float
        Bending and root compliance [m/N], ≥ 0.
    c : float
        Contact (Hertz) coefficient [m/N^(2/3)], ≥ 0. With b = c = 0 the contact is rigid.
    """

    b: float
    c: float = 0.0

    @property
    def is_linear(self) -> bool:
        """Whether c = 0."""
        return self.c == 0.0

    @property
    def is_rigid(self) -> bool:
        """Whether the contact does not yield at all."""
        return self.b == 0.0 and self.c == 0.0

    def compression(self, force: float) -> float:
        """Return the compression bF + cF^(2/3) [m]."""
        if self.c == 0.0:
            return self.b * force
        return self.b * force + self.c * math.cbrt(force) ** 2

    def force(self, compression: float) -> float:
        """Return the force [N]: the root of b y³ + c y² = δ, y = F^(1/3).

        Both single-term roots are upper bounds, and the cubic is convex and increasing, so Newton's
        method descends monotonically from the smaller bound and stops at round-off.

        Raises
        ------
        ZeroDivisionError
            If the contact is rigid: its force does not follow from its compression.
        """
        if compression <= 0.0:
            return 0.0
        b, c = self.b, self.c
        if c == 0.0:
            return compression / b
        y = math.sqrt(compression / c)
        if b > 0.0:
            y = min(y, math.cbrt(compression / b))
            for _ in range(CONTACT.roots):
                step = (b * y**3 + c * y**2 - compression) / (3.0 * b * y**2 + 2.0 * c * y)
                y -= step
                if abs(step) <= CONTACT.root * y:
                    break
        return y**3

    def secant(self, force: float) -> float:
        """Return the secant compliance b + cF^(-1/3) [m/N]."""
        if self.c == 0.0:
            return self.b
        return self.b + self.c / math.cbrt(force) if force > 0.0 else math.inf

    def tangent(self, force: float) -> tuple[float, float]:
        """Return the tangent compliance b + ⅔cF^(-1/3) [m/N] and its offset ⅓cF^(2/3) [m]."""
        if self.c == 0.0:
            return self.b, 0.0
        root = math.cbrt(force)
        if root <= 0.0:
            return math.inf, 0.0
        return self.b + 2.0 / 3.0 * self.c / root, self.c * root**2 / 3.0

    def energy(self, compression: float) -> float:
        """Return the conjugate of the complementary energy, Fδ − U*(F) [J]."""
        if compression <= 0.0 or self.is_rigid:
            return 0.0
        force = self.force(compression)
        return 0.5 * self.b * force**2 + 0.4 * self.c * math.cbrt(force) ** 5

    def scaled(self, force_unit: float, length_unit: float) -> PowerLaw:
        """Return the law with forces in `force_unit` [N] and lengths in `length_unit` [m]."""
        return PowerLaw(
            self.b * force_unit / length_unit, self.c * math.cbrt(force_unit) ** 2 / length_unit
        )


def roots(b: Array, c: Array, compression: Array) -> Array:
    """Return F^(1/3) of many compressed contacts with c > 0, from above as in `PowerLaw.force`.

    Parameters
    ----------
    b, c, compression : ndarray
        [m/N], [m/N^(2/3)], [m].
    """
    xp = library_of(compression)
    y: Array = xp.sqrt(compression / c)
    y = xp.where(b > 0.0, xp.minimum(y, cube_root(compression / xp.where(b > 0.0, b, 1.0))), y)
    for _ in range(CONTACT.roots):
        step = ((b * y + c) * y**2 - compression) / ((3.0 * b * y + 2.0 * c) * y)
        y = y - step
        if xp.all(xp.abs(step) <= CONTACT.many_roots * y):
            break
    return y


RIGID = PowerLaw(0.0, 0.0)


@dataclass(frozen=True, slots=True)
class TableLaw:
    """A law given by points, linear between them and beyond the last one.

    Parameters
    ----------
    forces, compressions : tuple of float
        Strictly increasing, beginning with 0 [N], [m].
    """

    forces: tuple[float, ...]
    compressions: tuple[float, ...]

    @property
    def is_linear(self) -> bool:
        """Whether all points lie on one straight line through the origin."""
        first = self.compressions[1] / self.forces[1]
        return all(
            abs(d - first * f) <= CONTACT.straight * d
            for f, d in zip(self.forces[1:], self.compressions[1:], strict=True)
        )

    def _piece(self, values: tuple[float, ...], at: float) -> tuple[float, float, float]:
        """Return start force, start compression and compliance of the piece that holds `at`."""
        k = min(max(bisect_right(values, at) - 1, 0), len(values) - 2)
        df = self.forces[k + 1] - self.forces[k]
        dd = self.compressions[k + 1] - self.compressions[k]
        return self.forces[k], self.compressions[k], dd / df

    def compression(self, force: float) -> float:
        """Return the interpolated compression [m]."""
        f0, d0, slope = self._piece(self.forces, force)
        return d0 + slope * (force - f0)

    def force(self, compression: float) -> float:
        """Return the interpolated force [N]."""
        if compression <= 0.0:
            return 0.0
        f0, d0, slope = self._piece(self.compressions, compression)
        return f0 + (compression - d0) / slope

    def secant(self, force: float) -> float:
        """Return the secant compliance [m/N]."""
        return self.compression(force) / force if force > 0.0 else self.tangent(0.0)[0]

    def tangent(self, force: float) -> tuple[float, float]:
        """Return the compliance [m/N] of the piece at `force` and the offset [m] of its line."""
        f0, d0, slope = self._piece(self.forces, force)
        return slope, d0 - slope * f0

    def energy(self, compression: float) -> float:
        """Return ∫F dδ [J], exact for the straight pieces."""
        total = 0.0
        for d0, d1 in pairwise((*self.compressions[:-1], math.inf)):
            upper = min(compression, d1)
            if upper <= d0:
                break
            total += 0.5 * (self.force(d0) + self.force(upper)) * (upper - d0)
        return total

    def scaled(self, force_unit: float, length_unit: float) -> TableLaw:
        """Return the law with forces in `force_unit` [N] and lengths in `length_unit` [m]."""
        return TableLaw(
            tuple(f / force_unit for f in self.forces),
            tuple(d / length_unit for d in self.compressions),
        )
