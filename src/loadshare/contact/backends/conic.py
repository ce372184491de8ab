"""A programme in the standard conic form: min ½zᵀPz + qᵀz, Az + s = b, s in a product of cones."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from loadshare.array_types import Array, Numbers, shaped
from loadshare.contact.programme import Point, Programme

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix


Row = tuple[dict[int, float], float]
"""Entries of a row of A by column, and its bound."""


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
    row_of: Numbers
    cone_rows: tuple[int, ...]
    size: int

    def point(self, z: Array, dual: Array) -> Point:
        """Read coordinates, contact forces and radial forces from a primal-dual answer."""
        z = shaped("z", z, self.linear.shape)
        dual = shaped("dual", dual, self.bounds.shape)
        forces = dual[self.row_of]
        # The offset equation Px − Σs = m has the multiplier that stationarity in x reads as Pᵀν.
        radial = np.array([dual[r : r + 2] for r in self.cone_rows]).reshape(-1, 2)
        return Point(z[: self.size], forces, radial)


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

    equal: list[Row] = []
    below: list[Row] = []
    others: list[tuple[tuple[str, float], list[Row]]] = []
    contacts: list[int] = []  # where each is in its block
    for e, closed in enumerate(programme.assumed_closed):
        entries = _entries(programme.rows[e])
        b, c = float(programme.linear[e]), float(programme.hertz[e])
        if b > 0.0:
            entries[variable(1.0, 0.0)] = -math.sqrt(b)
        if c > 0.0:
            w, energy = variable(0.0, 0.0), variable(0.0, 0.4 * c**-1.5)
            entries[w] = -1.0
            power: list[Row] = [({energy: -1.0}, 0.0), ({}, 1.0), ({w: -1.0}, 0.0)]
            others.append((("power", 0.4), power))
        block = equal if closed else below
        contacts.append(len(block))
        block.append((entries, float(programme.gaps[e])))
    offsets: list[int] = []
    for cone in programme.cones:
        parts = []
        for piece in cone.law.pieces:
            s = variable(piece.stiffness, 0.0), variable(piece.stiffness, 0.0)
            t = variable(0.0, piece.force)
            parts.append(s)
            others.append((("second-order", 3.0), [({k: -1.0}, 0.0) for k in (t, *s)]))
            if np.isfinite(piece.length):
                below.append(({t: 1.0}, float(piece.length)))
        offsets.append(len(equal))
        for axis, centre in enumerate(cone.centre.tolist()):
            entries = _entries(cone.matrix[axis])
            equal.append((entries | {s[axis]: -1.0 for s in parts}, centre))
    blocks = [(("zero", float(len(equal))), equal), (("nonnegative", float(len(below))), below)]
    blocks = [block for block in (*blocks, *others) if block[1]]
    rows = [row for _, block in blocks for row in block]
    found = [(i, j, v) for i, (entries, _) in enumerate(rows) for j, v in entries.items()]
    at, columns, data = ([entry[k] for entry in found] for k in range(3))
    quadratic = np.diag(np.concatenate([np.zeros(n), np.array(costs)]))
    quadratic[:n, :n] = np.triu(programme.stiffness)
    return ConicForm(
        quadratic=csc_matrix(quadratic),
        linear=np.concatenate([-programme.load, np.array(charges)]),
        matrix=csc_matrix((data, (at, columns)), shape=(len(rows), n + len(costs))),
        bounds=np.array([bound for _, bound in rows]),
        cones=tuple(cone for cone, _ in blocks),
        row_of=np.where(programme.assumed_closed, 0, len(equal))
        + np.array(contacts, dtype=np.intp),
        cone_rows=tuple(offsets),
        size=n,
    )


def _entries(row: Array) -> dict[int, float]:
    """Return the nonzero entries of a row, by column."""
    return {j: v for j, v in enumerate(row.tolist()) if v}
