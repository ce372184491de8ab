"""Contacts and radial elements at a point of a branch: forces, and how they change.

Source: formulation, sections 3, 5 and 6.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from loadshare.contact.law import Law
from loadshare.contact.problem import ArcRow, Row
from loadshare.contact.radial import RadialLaw
from loadshare.scene.scene import Array, GearRadial


@dataclass(frozen=True, slots=True, eq=False)
class Touch:
    """A contact.

    Attributes
    ----------
    row : Row or ArcRow
    vector : ndarray, shape (n,)
        Gradient of its approach with respect to the coordinates.
    approach : float
        [m].
    force, slope : float
        [N], dF/dδ [N/m].
    unknown : int or None
        Where its force stands among the unknowns, if it is one.
    """

    row: Row | ArcRow
    vector: Array
    approach: float
    force: float
    slope: float
    unknown: int | None

    def turning(self, x: Array) -> Array:
        """How the gradient of an arc's margin turns with the coordinates x [m], (n, n) [1/m]."""
        assert isinstance(self.row, ArcRow)
        relative = self.row.relative @ x
        normal = self.row.arc.normal(relative)
        across = np.eye(3) - np.outer(normal, normal)
        distance = float(np.linalg.norm(self.row.arc.start + relative))
        return np.asarray(self.row.relative.T @ across @ self.row.relative / distance)


@dataclass(frozen=True, slots=True, eq=False)
class Hold:
    """A radial element.

    Attributes
    ----------
    radial : GearRadial
    law : RadialLaw
    piece : int
        Of the law on which it stands, or in front of which.
    offset : ndarray, shape (2,)
        [m].
    force : ndarray, shape (2,)
        Along the offset [N].
    unknown : slice or None
        Where its force stands among the unknowns, on a step; None on a piece.
    """

    radial: GearRadial
    law: RadialLaw
    piece: int
    offset: Array
    force: Array
    unknown: slice | None

    @property
    def radius(self) -> float:
        """Length of the offset [m]."""
        return float(np.linalg.norm(self.offset))

    @property
    def limit(self) -> float:
        """Radius at which the piece begins [m]."""
        return self.law.start(self.piece)

    @property
    def along(self) -> Array:
        """Direction of the offset (2,), zero at the centre."""
        return np.asarray(self.offset / (self.radius or 1.0))

    @property
    def across(self) -> Array:
        """Projector (2, 2) across the offset."""
        return np.asarray(np.eye(2) - np.outer(self.along, self.along))

    @property
    def springs(self) -> bool:
        """Whether the force on the piece is proportional to the offset."""
        return springs(self.law, self.piece)

    def stiffness(self) -> Array:
        """Derivative (2, 2) of the force with respect to the offset, on a piece [N/m]."""
        slope, radius = self.law.pieces[self.piece].stiffness, self.radius
        if self.springs or radius == 0.0:
            return np.asarray(slope * np.eye(2))
        along = self.along
        size = float(along @ self.force)
        return np.asarray(slope * np.outer(along, along) + size / radius * self.across)


def pressed(law: Law, approach: float) -> tuple[float, float]:
    """Force [N] of a closed contact and its slope [N/m], continued oddly below zero."""
    if approach == 0.0:
        # Both one-sided slopes agree: the law is continued oddly.
        return 0.0, 1.0 / law.tangent(0.0)[0]
    force = law.force(abs(approach))
    return float(np.copysign(force, approach)), 1.0 / law.tangent(force)[0]


def pulled(law: RadialLaw, piece: int, offset: Array) -> Array:
    """Force [N] along an offset (2,) [m] on a piece of a law, which may be continued beyond it."""
    here = law.pieces[piece]
    if springs(law, piece):
        return np.asarray(here.stiffness * offset)
    radius = float(np.linalg.norm(offset))
    size = here.force + here.stiffness * (radius - law.start(piece))
    return np.asarray(size * offset / (radius or 1.0))


def springs(law: RadialLaw, piece: int) -> bool:
    """Whether the force on a piece is proportional to the offset."""
    here = law.pieces[piece]
    return here.force == here.stiffness * law.start(piece)
