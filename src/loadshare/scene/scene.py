"""Everything that happens at one position, in SI: coordinates, rows and radial elements."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from loadshare.scene.condense import Condensation, condense
from loadshare.train.law import Law
from loadshare.train.memory import SlipFriction, SlipStop
from loadshare.train.radial import RadialLaw
from loadshare.train.ring import Arc
from loadshare.train.train import Situation, Spline, Train

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Rotation:
    """How the rotation of a gear follows from the coordinates: φ = rate · x[index] + constant.

    Attributes
    ----------
    index : int or None
        Coordinate (an arc length on the base circle [m]), or None for a gear that cannot turn.
    rate : float
        [rad/m].
    constant : float
        [rad], from the clocking of rigid shafts.
    """

    index: int | None
    rate: float
    constant: float


@dataclass(frozen=True, slots=True, eq=False)
class Row:
    """A unilateral contact: approach a·x − g, force F ≥ 0.

    Attributes
    ----------
    name : str
    kind : str
        "drive flank", "coast flank", "stop" or "arc".
    vector : ndarray, shape (n,)
        a, dimensionless.
    gap : float
        g [m].
    law : Law
    """

    name: str
    kind: str
    vector: Array
    gap: float
    law: Law


@dataclass(frozen=True, slots=True, eq=False)
class ArcRow:
    """A ring's exclusion arc, which becomes a row at each iterate.

    Attributes
    ----------
    name : str
    arc : Arc
    relative : ndarray, shape (3, n)
        Relative displacement of the two centres from the coordinates.
    law : Law
    sagitta : float
        Room [m] that the arc leaves beyond its face at rest, at the end of the float.
    """

    name: str
    arc: Arc
    relative: Array
    law: Law
    sagitta: float

    def row(self, x: Array, wide: bool = False) -> Row:
        """Tangent face at the coordinates x [m]: −n·Δ ≤ g.

        A wide face stands off by the sagitta, so that all of the float lies inside. Faces at rest
        of two opposite arcs can wedge a float in that the arcs themselves let pass.
        """
        normal, bound = self.arc.face(self.relative @ x)
        bound += self.sagitta if wide else 0.0
        return Row(self.name, "arc", -(normal @ self.relative), bound, self.law)


@dataclass(frozen=True, slots=True, eq=False)
class Radial:
    """A radial element on p = P x − m.

    Attributes
    ----------
    name, gear : str
    matrix : ndarray, shape (2, n)
        P.
    centre : ndarray, shape (2,)
        m [m].
    source : RadialLaw, Spline, SlipFriction or SlipStop
        A fixed law, or a spline, as a whole or in its parts, whose friction may follow the torque.
    """

    name: str
    gear: str
    matrix: Array
    centre: Array
    source: RadialLaw | Spline | SlipFriction | SlipStop

    @property
    def follows_torque(self) -> bool:
        """Whether the law must be settled in the outer loop."""
        return not isinstance(self.source, RadialLaw) and self.source.friction_force is None

    def law(self, torque: float) -> RadialLaw:
        """Law when the gear takes `torque` [N·m] from its shafts."""
        return self.source if isinstance(self.source, RadialLaw) else self.source.law(torque)


@dataclass(frozen=True, eq=False)
class Scene:
    """The whole contact problem of a position: minimise ½xᵀHx − fᵀx + Σ U(a·x − g) + Σ W(|Px − m|).

    Attributes
    ----------
    train, situation
        Where it comes from.
    coordinates : tuple of str
        Names; every coordinate is a length [m].
    stiffness : ndarray, shape (n, n)
        H [N/m], from shafts and supports.
    load : ndarray, shape (n,)
        f [N].
    rows : tuple of Row
    arcs : tuple of ArcRow
    radials : tuple of Radial
    rotation : mapping of gear to Rotation
    displacement : mapping of gear to slice
        Where the two displacement components of a moving gear stand.
    removed : tuple of (str, str)
        What never became a coordinate or row, and why.
    """

    train: Train
    situation: Situation
    coordinates: tuple[str, ...]
    stiffness: Array
    load: Array
    rows: tuple[Row, ...]
    arcs: tuple[ArcRow, ...]
    radials: tuple[Radial, ...]
    rotation: dict[str, Rotation]
    displacement: dict[str, slice]
    removed: tuple[tuple[str, str], ...]

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return len(self.coordinates)

    @cached_property
    def condensation(self) -> Condensation:
        """Coordinates that no contact touches, as linear functions of the others."""
        touched = np.zeros(self.size, dtype=bool)
        for row in self.rows:
            touched |= row.vector != 0.0
        for matrix in (*(a.relative for a in self.arcs), *(r.matrix for r in self.radials)):
            touched |= (matrix != 0.0).any(axis=0)
        return condense(self.stiffness, self.load, touched)

    def rows_at(self, x: Array, wide: bool = False) -> tuple[Row, ...]:
        """All rows, arcs replaced by their faces at x, wide or tangent."""
        return self.rows + tuple(a.row(x, wide) for a in self.arcs)

    def force_unit(self) -> float:
        """Force that the scene is measured by [N]: the largest external push, or 1 N at rest."""
        pushes = [
            abs(t) / self.train.gears[g].base_radius for g, t in self.situation.torque.items()
        ]
        return max(pushes, default=0.0) or 1.0

    def length_unit(self) -> float:
        """Length that the scene is measured by [m]: what flanks yield, or 1/1000 of their gaps.

        Under a light load the gaps are far larger than the compressions; measured by the latter,
        their size would overflow what a solver resolves.
        """
        force = self.force_unit()
        flanks = [r for r in self.rows if r.kind == "drive flank"]
        if not flanks:
            return 1e-6
        yielded = float(np.median([r.law.compression(force) for r in flanks]))
        return max(yielded, 1e-3 * max(abs(r.gap) for r in flanks))

    def angle(self, gear: str, x: Array) -> float:
        """Rotation φ [rad] of a gear at the coordinates x."""
        r = self.rotation[gear]
        return r.constant + (r.rate * float(x[r.index]) if r.index is not None else 0.0)

    def moved(self, gear: str, x: Array) -> Array:
        """Displacement p (3,) [m] of a gear at the coordinates x."""
        where = self.displacement.get(gear)
        if where is None:
            return np.zeros(3)
        return np.asarray(x[where] @ self.train.gears[gear].frame)
