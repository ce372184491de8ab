r"""The contact problem of one meshing position, in SI units.

The unknowns are the forces p ≥ 0 [N] on the points of all lines and the approach Z [m] of the two
gears. With u(p) the deflection of teeth and surfaces, w the unloaded gap and P the load,

    d = u(p) + w − Z ≥ 0,    p ≥ 0,    p·d = 0,    Σ p = P.

Source: formulation, section 9.

Far from a strip its width has little effect. There the displacement of
:mod:`loadshare.tooth.contact.strips` is the series

.. math:: g(\tau) = \ln\tau + \text{const} + \sum_{k\ge1} c_k\tau^{-2k},\qquad
    c_k = \frac{(-1)^{k+1}}{2k(k+1)}\left[\frac{(2k)!}{4^k (k!)^2}\right]^2

(asinh expanded under its integral), so that between two points it is a polynomial in the strip's
b² with coefficients that the geometry determines. Only next to a strip is g itself needed.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import comb, pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from loadshare.settings import TEETH
from loadshare.tooth.contact.strips import StripLine, StripTable, strip_table
from loadshare.tooth.geometry.body import Array


@dataclass(frozen=True, eq=False)
class ToothContact:
    """Compliance and gaps of the points of one position.

    Parameters
    ----------
    bulk : array (N, N)
        Compliance [m/N] of both gears' teeth at their middle surfaces; zero for half-spaces.
    gap : array (N,)
        Unloaded distance w [m] of the flanks.
    lines : tuple of StripLine
        Local contact of the lines, whose points come line by line in `bulk` and `gap`.
    name : str
        Name in the message of a refusal.
    """

    bulk: Array
    gap: Array
    lines: tuple[StripLine, ...]
    name: str = ""

    @cached_property
    def parts(self) -> tuple[slice, ...]:
        """Points of each line."""
        ends = np.cumsum([0] + [len(line.length) for line in self.lines])
        return tuple(slice(a, b) for a, b in pairwise(ends.tolist()))

    @cached_property
    def fixed(self) -> Array:
        """The part of the compliance (N, N) [m/N] that does not depend on the load."""
        total = self.bulk.copy()
        for line, part in zip(self.lines, self.parts, strict=True):
            total[part, part] -= line.removed
        return total

    @cached_property
    def alone(self) -> ContactBatch:
        """The problem as a batch of one."""
        return ContactBatch((self,))

    def compliance(self, force: Array) -> tuple[Array, Array]:
        """Return secant and tangent compliance (N, N) [m/N] at the forces (N,) [N].

        u = secant @ force, and the tangent is du/dp.
        """
        secant, tangent = self.alone.compliance(force[None])
        return secant[0], tangent[0]


class Strips(NamedTuple):
    """Strips of M positions, N of each, in the form that compiled code reads.

    Lines are numbered within a position and do not interact here, because the bulk compliance
    includes that.
    """

    number: Array  # (M, N)
    place: Array  # (M, N) along the line [m]
    half: Array  # (M, N): half of the length [m]
    scale: Array  # (M, N): displacement per force and unit of g [m/N]
    square: Array  # (M, N): b² per force [m²/N]
    widest: Array  # (M, N): the largest b² [m²]
    alone: Array  # (M, N): A of slices of narrow faces [m/N]; 0 for others
    level: Array  # (M, N): their B
    series: Array  # (M, TEETH.terms + 1, N, N): coefficients of b²ᵏ [m/N]
    far: float
    table: StripTable


class ContactBatch:
    """Contact problems of K positions with N points each, stacked to be solved together.

    Parameters
    ----------
    problems : sequence of ToothContact

    Attributes
    ----------
    gap : array (K, N)
        [m].
    names : tuple of str
    which : array (K,) of int
        Numbers of the problems among the M that the batch was made of.
    fixed : array (M, N, N)
        The part of their compliance [m/N] that does not depend on the load.
    strips : Strips
        Local compliance of their surfaces.
    """

    def __init__(self, problems: Sequence[ToothContact]) -> None:
        from loadshare.tooth.contact.compiled import expand

        self.names = tuple(problem.name for problem in problems)
        self.which = np.arange(len(problems))
        self.gap = np.stack([problem.gap for problem in problems])
        self.fixed = np.stack([problem.fixed for problem in problems])
        strips = np.stack([_strips(problem.lines) for problem in problems], axis=1)
        series = np.empty((len(problems), TEETH.terms + 1, *self.fixed.shape[1:]))
        self.strips = Strips._make([*strips, series, TEETH.far, strip_table()])
        expand(self.strips, COEFFICIENTS, series)

    def rows(self, chosen: NDArray[np.int64]) -> ContactBatch:
        """Return some of the problems, or some of them several times."""
        part = copy(self)
        part.gap, part.which = self.gap[chosen], self.which[chosen]
        part.names = tuple(self.names[k] for k in chosen)
        return part

    def compliance(self, force: Array) -> tuple[Array, Array]:
        """Return secant and tangent compliance (K, N, N) [m/N] at the forces (K, N) [N]."""
        from loadshare.tooth.contact.compiled import surfaces

        force = np.array(force, float, order="C")
        least = TEETH.faint * np.sum(np.maximum(force, 0.0), axis=1)
        secant, tangent = np.empty((2, *force.shape, force.shape[1]))
        surfaces(self.strips, self.which, force, least, secant, tangent)
        fixed = self.fixed[self.which]
        return secant + fixed, tangent + fixed

    def yielded(self, force: Array) -> Array:
        """Return u(p) (K, N) [m]."""
        return np.asarray((self.compliance(force)[0] @ force[..., None])[..., 0])


COEFFICIENTS = np.array(
    [1.0]
    + [
        -((-1.0) ** k) * (comb(2 * k, k) / 4.0**k) ** 2 / (2.0 * k * (k + 1.0))
        for k in range(1, TEETH.terms + 1)
    ]
)
"""Coefficients of the series above; the first is the logarithm's."""


def _strips(lines: Sequence[StripLine]) -> Array:
    """Return the fields of `Strips` for a position, from `number` to `level` (8, N)."""
    found = []
    for number, line in enumerate(lines):
        scale = (1.0 - line.narrow) / (pi * line.effective * line.length)
        numbers, widest = (np.full_like(scale, value) for value in (number, line.widest**2))
        half = 0.5 * line.length
        found.append([numbers, line.place, half, scale, line.square, widest, *line.slices])
    return np.hstack(found)
