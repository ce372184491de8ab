r"""A contact problem: springs, loads, unilateral contacts, arcs, radial elements. No gear in it.

.. math::

    \min_x \; \tfrac12 x^\mathsf{T} H x - f^\mathsf{T} x + \sum_e U_e(a_e\cdot x - g_e)
        + \sum_j W_j(\lVert P_j x - m_j \rVert)

U is the energy of a contact that only pushes, W that of a radial element; arcs are contacts whose
row turns with x. Any consistent units will do: a train's scene has coordinates in metres and forces
in newtons. Source: formulation, sections 4 to 6.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Protocol, runtime_checkable

import numpy as np

from loadshare.array_types import Array, floats
from loadshare.contact.arc import Arc
from loadshare.contact.condense import Condensation, condense
from loadshare.contact.law import Law
from loadshare.contact.radial import RadialLaw, RollingLaw
from loadshare.settings import CONTACT


@dataclass(frozen=True, slots=True, eq=False)
class Row:
    """A unilateral contact: approach a·x − g, force F ≥ 0.

    Attributes
    ----------
    name : str
    kind : str
        "drive flank", "coast flank", "stop", "arc", or any other word.
    vector : ndarray, shape (n,)
        a.
    gap : float
        g.
    law : Law
    """

    name: str
    kind: str
    vector: Array
    gap: float
    law: Law

    def __post_init__(self) -> None:
        _as_floats(self, "vector")


@dataclass(frozen=True, slots=True, eq=False)
class ArcRow:
    """An exclusion arc, which becomes a row at each iterate.

    Attributes
    ----------
    name : str
    arc : Arc
    relative : ndarray, shape (3, n)
        Matrix from the coordinates to the relative displacement of the two centres.
    law : Law
    sagitta : float
        Distance that the arc leaves beyond its face at rest, at the end of the float.
    """

    name: str
    arc: Arc
    relative: Array
    law: Law
    sagitta: float

    def __post_init__(self) -> None:
        _as_floats(self, "relative")

    def row(self, x: Array, wide: bool = False) -> Row:
        """Return the tangent face at the coordinates x: −n·Δ ≤ g.

        A wide face is set back by the sagitta, so that all of the float lies inside. Two opposite
        arcs may let a float pass that their faces at rest would wedge in.
        """
        normal, bound = self.arc.face(self.relative @ x)
        bound += self.sagitta if wide else 0.0
        return Row(self.name, "arc", -(normal @ self.relative), bound, self.law)


@runtime_checkable
class FollowingLaw(Protocol):
    """A radial law whose friction may follow a torque, such as that of a spline."""

    @property
    def friction_force(self) -> float | None:
        """Friction if it is fixed; None if it follows the torque."""

    def law(self, torque: float) -> RadialLaw:
        """Return the law at a torque."""

    def bound(self, torque: float) -> float:
        """Return the friction at a torque."""


@dataclass(frozen=True, slots=True, eq=False)
class Radial:
    """A radial element on p = P x − m.

    Attributes
    ----------
    name : str
    matrix : ndarray, shape (2, n)
        P.
    centre : ndarray, shape (2,)
        m.
    source : RadialLaw, RollingLaw or FollowingLaw
    levers : mapping of row name to float
        Torque over the element per unit of the row's force, for a law that follows it.
    """

    name: str
    matrix: Array
    centre: Array
    source: RadialLaw | RollingLaw | FollowingLaw
    levers: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        _as_floats(self, "matrix", "centre")

    @property
    def follows_torque(self) -> bool:
        """Whether the law must be settled in the outer loop."""
        if isinstance(self.source, RadialLaw | RollingLaw):
            return False
        return self.source.friction_force is None

    @property
    def at_rest(self) -> RadialLaw | None:
        """Law without torque; None if it is not valid, which solving reports."""
        try:
            return self.law(0.0)
        except ValueError:
            return None

    @property
    def lengths(self) -> tuple[float, ...]:
        """Finite lengths of the pieces of `at_rest` [m]."""
        pieces = self.at_rest.pieces if self.at_rest else ()
        return tuple(p.length for p in pieces if p.length < np.inf)

    def torque(self, forces: Mapping[str, float]) -> float:
        """Return the torque over the element; a row that is not named carries nothing."""
        return sum(lever * forces.get(name, 0.0) for name, lever in self.levers.items())

    def offset(self, x: Array) -> Array:
        """Return the vector from its centre at coordinates x, (2,) [m]."""
        return np.asarray(self.matrix @ x - self.centre)

    def radius(self, x: Array) -> float:
        """Return the distance from its centre at coordinates x [m]."""
        return float(np.linalg.norm(self.offset(x)))

    def law(self, torque: float, x: Array | None = None) -> RadialLaw:
        """Return the law at a torque over the element; for a rolling law, its tangent at x."""
        if isinstance(self.source, RollingLaw):
            return self.source.touching(0.0 if x is None else self.radius(x))
        return self.source if isinstance(self.source, RadialLaw) else self.source.law(torque)

    def friction_change(self, before: float, after: float) -> float:
        """Return the change of the friction from one torque to another."""
        if isinstance(self.source, RadialLaw | RollingLaw) or not self.follows_torque:
            return 0.0
        return self.source.bound(after) - self.source.bound(before)


def _symmetric(stiffness: Any) -> Any:
    """Make a matrix symmetric whose halves differ by round-off, as those of a product BᵀKB."""
    if not isinstance(stiffness, np.ndarray) or stiffness.shape != stiffness.T.shape:
        return stiffness
    with np.errstate(invalid="ignore"):
        off = np.abs(stiffness - stiffness.T).max(initial=0.0)
    if 0.0 < off <= CONTACT.singular * np.abs(stiffness).max(initial=0.0):
        return 0.5 * (stiffness + stiffness.T)
    return stiffness


@dataclass(frozen=True, eq=False)
class ContactProblem:
    """A contact problem in the module's form.

    Attributes
    ----------
    coordinates : tuple of str
        Names.
    stiffness : ndarray, shape (n, n)
        H, of springs; symmetric up to round-off, which is removed.
    load : ndarray, shape (n,)
        f.
    rows : tuple of Row
    arcs : tuple of ArcRow
    radials : tuple of Radial
    """

    coordinates: tuple[str, ...]
    stiffness: Array
    load: Array
    rows: tuple[Row, ...] = ()
    arcs: tuple[ArcRow, ...] = ()
    radials: tuple[Radial, ...] = ()

    def __post_init__(self) -> None:
        _as_floats(self, "stiffness", "load")
        for name in ("coordinates", "rows", "arcs", "radials"):
            given = getattr(self, name)
            object.__setattr__(self, name, tuple(given) if isinstance(given, Iterable) else given)
        object.__setattr__(self, "stiffness", _symmetric(self.stiffness))

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

    @cached_property
    def laws(self) -> dict[str, Law]:
        """Laws of rows and arcs by name."""
        return {r.name: r.law for r in self.rows} | {a.name: a.law for a in self.arcs}

    def rows_at(self, x: Array, wide: bool = False) -> tuple[Row, ...]:
        """Return all rows, arcs replaced by their faces at x, wide or tangent."""
        return self.rows + tuple(a.row(x, wide) for a in self.arcs)

    def force_unit(self) -> float:
        """Return the unit of force of the problem: the largest load.

        Without loads it is the force of springs and contacts that yield by the overlap of contacts
        at rest or, if none overlaps, by the largest gap; 1 if nothing has a size.
        """
        return float(np.abs(self.load).max(initial=0.0)) or self._unloaded() or 1.0

    def _unloaded(self) -> float:
        """Return a typical force that gaps alone cause; 0 if nothing has a size."""
        rest = np.zeros(self.size)
        room = [r.gap for r in self.rows] + [a.arc.margin(a.relative @ rest) for a in self.arcs]
        graphs = [(r.radius(rest), r.at_rest) for r in self.radials]
        for radius, graph in graphs:
            free = (graph.level(0.0, 0.0) if graph else None) or (0.0, 0.0)
            room.append(free[1] - radius)
        overlap = -min(room, default=0.0)
        yielded = overlap if overlap > 0.0 else max(self._gaps(), default=0.0)
        forces = [k * yielded for k in np.diag(self.stiffness).tolist()]
        laws = self.laws.values()
        forces += [law.force(yielded) for law in laws if law.compression(1.0) > 0.0]
        for piece in (p for _, graph in graphs if graph for p in graph.pieces):
            forces += [piece.force, piece.stiffness * yielded]
        return float(np.median([f for f in forces if 0.0 < f < np.inf] or [0.0]))

    def _gaps(self) -> list[float]:
        """Return gaps of contacts, clearances of arcs and lengths of graphs."""
        gaps = [abs(r.gap) for r in self.rows] + [a.arc.clearance for a in self.arcs]
        return gaps + [length for r in self.radials for length in r.lengths]

    def length_unit(self) -> float:
        """Return the unit of length of the problem.

        It is the compression of contacts and springs under the force unit, or 1/1000 of the gaps if
        that is larger: in units of compressions that are far smaller, the gaps would exceed the
        range that a solver resolves.
        """
        force = self.force_unit()
        yielded = [r.law.compression(force) for r in self.rows]
        yielded += [force / k for k in np.diag(self.stiffness).tolist() if k > 0.0]
        soft = float(np.median([v for v in yielded if v > 0.0] or [0.0]))
        return max(soft, CONTACT.of_gaps * max(self._gaps(), default=0.0)) or 1.0

    def first_torques(self) -> dict[str, float]:
        """Return a first guess of the torques over radial elements that follow them."""
        force = self.force_unit()
        return {r.name: force * max(map(abs, r.levers.values()), default=0.0) for r in self.radials}


def _as_floats(part: object, *names: str) -> None:
    """Turn attributes that a user may give as lists or whole numbers into arrays of floats."""
    for name in names:
        object.__setattr__(part, name, floats(getattr(part, name)))


def of_unit_norm(rows: Array) -> Array:
    """Return the rows (k, n) that are not zero, each divided by its norm, whatever its size."""
    _, exponent = np.frexp(np.abs(rows).max(axis=1, initial=0.0))
    # Squares of the entries may overflow; scaling by a power of two is exact.
    rows = np.ldexp(rows, -exponent[:, None])
    norm = np.linalg.norm(rows, axis=1, keepdims=True)
    there = norm[:, 0] > 0.0
    return np.asarray(rows[there] / norm[there])
