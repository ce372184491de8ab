"""A programme in the standard conic form: min ½zᵀPz + qᵀz, Az + s = b, s in a product of cones."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from loadshare.contact.programme import Array, Point, Programme

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix


@dataclass
class _Block:
    """Rows of A and b that belong to one cone."""

    cone: tuple[str, float]
    rows: list[dict[int, float]] = field(default_factory=list)
    bounds: list[float] = field(default_factory=list)

    def add(self, row: dict[int, float], bound: float) -> None:
        self.rows.append(row)
        self.bounds.append(bound)


@dataclass(frozen=True, eq=False)
class ConicForm:
    """Standard form of a programme.

    Attributes
    ----------
    quadratic : csc_matrix
        P, upper triangle.
    linear : ndarray
        q.
    matrix : csc_matrix
        A.
    bounds : ndarray
        b.
    cones : tuple of (str, float)
        Kind and dimension (or exponent) in order: "zero", "nonnegative", "second-order", "power".
    row_of : ndarray of int
        Row of A that holds each contact of the programme.
    cone_rows : tuple of int
        First row of the offset equation of each radial element.
    size : int
        Number of coordinates x, which come first in z.
    """

    quadratic: csc_matrix
    linear: Array
    matrix: csc_matrix
    bounds: Array
    cones: tuple[tuple[str, float], ...]
    row_of: list[int]
    cone_rows: tuple[int, ...]
    size: int

    def point(self, z: Array, dual: Array) -> Point:
        """Read coordinates, contact forces and radial forces from a primal-dual answer."""
        forces = np.array([dual[r] for r in self.row_of])
        # The offset equation Px − Σs = m has the multiplier that stationarity in x reads as Pᵀν.
        radial = np.array([dual[r : r + 2] for r in self.cone_rows]).reshape(-1, 2)
        return Point(np.asarray(z[: self.size], dtype=float), forces, radial)


def conic_form(programme: Programme) -> ConicForm:
    """Write a programme in standard conic form."""
    from scipy.sparse import csc_matrix

    n = programme.stiffness.shape[0]
    costs: list[float] = []  # diagonal quadratic costs of the variables after x
    charges: list[float] = []  # their linear costs

    def variable(quadratic: float, charge: float) -> int:
        costs.append(quadratic)
        charges.append(charge)
        return int(n) + len(costs) - 1

    equal, below = _Block(("zero", 0)), _Block(("nonnegative", 0))
    others: list[_Block] = []
    places: list[tuple[_Block, int]] = []
    for e, gap in enumerate(programme.gaps):
        row = {j: float(v) for j, v in enumerate(programme.rows[e]) if v}
        if programme.linear[e] > 0.0:
            row[variable(1.0, 0.0)] = -float(np.sqrt(programme.linear[e]))
        if programme.hertz[e] > 0.0:
            w = variable(0.0, 0.0)
            energy = variable(0.0, 0.4 * float(programme.hertz[e]) ** -1.5)
            row[w] = -1.0
            power = _Block(("power", 0.4))
            power.add({energy: -1.0}, 0.0)
            power.add({}, 1.0)
            power.add({w: -1.0}, 0.0)
            others.append(power)
        block = equal if programme.assumed_closed[e] else below
        places.append((block, len(block.rows)))
        block.add(row, float(gap))
    cone_places = []
    for cone in programme.cones:
        parts = []
        for piece in cone.law.pieces:
            s = (variable(piece.stiffness, 0.0), variable(piece.stiffness, 0.0))
            t = variable(0.0, piece.force)
            parts.append(s)
            disc = _Block(("second-order", 3))
            disc.add({t: -1.0}, 0.0)
            disc.add({s[0]: -1.0}, 0.0)
            disc.add({s[1]: -1.0}, 0.0)
            others.append(disc)
            if np.isfinite(piece.length):
                below.add({t: 1.0}, float(piece.length))
        cone_places.append(len(equal.rows))
        for axis in range(2):
            row = {j: float(v) for j, v in enumerate(cone.matrix[axis]) if v}
            row |= {s[axis]: -1.0 for s in parts}
            equal.add(row, float(cone.centre[axis]))
    blocks = [b for b in (equal, below, *others) if b.rows]
    first = {id(b): sum(len(c.rows) for c in blocks[:k]) for k, b in enumerate(blocks)}
    entries = [
        (first[id(b)] + k, j, v)
        for b in blocks
        for k, row in enumerate(b.rows)
        for j, v in row.items()
    ]
    total, size = sum(len(b.rows) for b in blocks), n + len(costs)
    data = np.array([v for _, _, v in entries])
    where = ([i for i, _, _ in entries], [j for _, j, _ in entries])
    quadratic = np.diag(np.concatenate([np.zeros(n), np.array(costs)]))
    quadratic[:n, :n] = np.triu(programme.stiffness)
    return ConicForm(
        quadratic=csc_matrix(quadratic),
        linear=np.concatenate([-programme.load, np.array(charges)]),
        matrix=csc_matrix((data, where), shape=(total, size)),
        bounds=np.array([v for b in blocks for v in b.bounds]),
        cones=tuple(
            (b.cone[0], b.cone[1] if b.cone[0] == "power" else float(len(b.rows))) for b in blocks
        ),
        row_of=[first[id(b)] + k for b, k in places],
        cone_rows=tuple(first[id(equal)] + k for k in cone_places),
        size=n,
    )
