"""The contact problem of one meshing position, in SI units.

Unknown are the forces p ≥ 0 [N] on the points of all lines and the approach Z [m] of the two
gears. With u(p) the yielding of teeth and surfaces, w the unloaded gap and P the load,

    d = u(p) + w − Z ≥ 0,    p ≥ 0,    p·d = 0,    Σ p = P.

Source: formulation, section 9.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from loadshare.tooth.contact.strips import FAINT, StripLine
from loadshare.tooth.contact.surface import Surface
from loadshare.tooth.geometry.body import Array

FAR_OFF = 1.0
"""Gap [m] of points that only fill up a batch: they never close."""


@dataclass(frozen=True, eq=False)
class ContactProblem:
    """What yields between the points of one position.

    Parameters
    ----------
    bulk : array (N, N)
        Compliance [m/N] of both gears' teeth at their middle surfaces; zero for half-spaces.
    gap : array (N,)
        Unloaded distance w [m] of the flanks.
    lines : tuple of StripLine
        Local contact of the lines, whose points follow one another in `bulk` and `gap`.
    name : str
        What it is called where it is refused.
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
        """Secant and tangent compliance (N, N) [m/N] at the forces (N,) [N].

        u = secant @ force, and the tangent is du/dp.
        """
        secant, tangent = self.alone.compliance(force[None])
        return secant[0], tangent[0]

    def yielded(self, force: Array) -> Array:
        """u(p) (N,) [m]."""
        return np.asarray(self.alone.yielded(force[None])[0])


class ContactBatch:
    """Contact problems of K positions, stacked so that one pass serves all.

    Problems with fewer points than the largest, N, are filled up with points that yield nothing
    and stand far off.

    Parameters
    ----------
    problems : sequence of ContactProblem

    Attributes
    ----------
    count : array (K,) of int
        Points of each problem; they come first.
    gap : array (K, N)
        [m].
    fixed : array (M, N, N)
        The part of the compliance [m/N] that does not depend on the load, of the M problems that
        the batch was made of.
    surface : Surface
        What the surfaces yield.
    """

    def __init__(self, problems: Sequence[ContactProblem]) -> None:
        self.count = np.array([len(problem.gap) for problem in problems])
        largest = int(self.count.max())
        self.gap = np.full((len(problems), largest), FAR_OFF)
        self.fixed = np.zeros((len(problems), largest, largest))
        for k, (problem, count) in enumerate(zip(problems, self.count, strict=True)):
            self.gap[k, :count] = problem.gap
            self.fixed[k, :count, :count] = problem.fixed
        self.surface = Surface([problem.lines for problem in problems])
        self.names = tuple(problem.name for problem in problems)

    @property
    def which(self) -> NDArray[np.int64]:
        """Numbers (K,) of the problems in `fixed`."""
        return self.surface.which

    def rows(self, chosen: NDArray[np.int64]) -> ContactBatch:
        """Some of the problems, or some of them several times."""
        part = copy(self)
        part.count, part.gap = self.count[chosen], self.gap[chosen]
        part.surface = self.surface.rows(chosen)
        part.names = tuple(self.names[k] for k in chosen)
        return part

    def compliance(self, force: Array) -> tuple[Array, Array]:
        """Secant and tangent compliance (K, N, N) [m/N] at the forces (K, N) [N]."""
        least = FAINT * np.sum(np.maximum(force, 0.0), axis=1)
        secant, tangent = self.surface.compliance(force, least)
        fixed = self.fixed[self.which]
        secant += fixed
        tangent += fixed
        return secant, tangent

    def yielded(self, force: Array) -> Array:
        """u(p) (K, N) [m]."""
        return times(self.compliance(force)[0], force)


def times(matrices: Array, vectors: Array) -> Array:
    """Products (K, N) of stacked matrices and vectors."""
    return np.asarray((matrices @ vectors[..., None])[..., 0])
