"""The contact problem of one meshing position, in SI units.

Unknown are the forces p ≥ 0 [N] on the points of all lines and the approach Z [m] of the two
gears. With u(p) the yielding of teeth and surfaces, w the unloaded gap and P the load,

    d = u(p) + w − Z ≥ 0,    p ≥ 0,    p·d = 0,    Σ p = P.

Source: formulation, section 9.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from loadshare.tooth.body import Array
from loadshare.tooth.strips import FAINT, StripLine
from loadshare.tooth.surface import Surface


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
    """

    bulk: Array
    gap: Array
    lines: tuple[StripLine, ...]

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
    def surface(self) -> Surface:
        """What the surfaces yield."""
        return Surface(self.lines)

    def compliance(self, force: Array) -> tuple[Array, Array]:
        """Secant and tangent compliance (N, N) [m/N] at the forces (N,) [N].

        u = secant @ force, and the tangent is du/dp.
        """
        least = FAINT * float(np.sum(np.maximum(force, 0.0)))
        secant, tangent = self.surface.compliance(force, least)
        secant += self.fixed
        tangent += self.fixed
        return secant, tangent

    def yielded(self, force: Array) -> Array:
        """u(p) (N,) [m]."""
        return np.asarray(self.compliance(force)[0] @ force)
