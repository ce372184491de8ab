"""The programme of a pass in standard conic form, with the same pattern for all samples.

    min ½zᵀPz + qᵀz   s.t.  Az + s = b,  s in zero, nonnegative and second-order cones

z = (x, y, and s, t of every piece of every graph). Only q, b and the values of A change from pass
to pass, so a solver that keeps its factorisation pattern can keep it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from benchmarks.peers.form import Array, Form
from benchmarks.peers.loop import Claim
from loadshare.contact.radial import RadialLaw

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix


class Layout:
    """Positions of all variables and rows in the conic form of samples like this one.

    Parameters
    ----------
    form : Form
        Any sample of the workload.
    laws : sequence of RadialLaw
        Its radial laws: the number of pieces, and which of them are finite, are part of the
        pattern.
    """

    def __init__(self, form: Form, laws: Sequence[RadialLaw]) -> None:
        n, m = form.size, len(form.gaps)
        self.n, self.m = n, m
        self.yields = np.flatnonzero((form.linear > 0.0) | (form.hertz > 0.0))
        pieces = [(j, k) for j, law in enumerate(laws) for k in range(len(law.pieces))]
        self.pieces = pieces
        self.first = n + len(self.yields)
        self.size = self.first + 3 * len(pieces)
        ends = [p for p in pieces if np.isfinite(laws[p[0]].pieces[p[1]].length)]
        self.ends = ends
        self.equal, self.below, self.discs = 2 * len(laws), m + len(ends), len(pieces)
        total = self.equal + self.below + 3 * self.discs
        matrix = np.zeros((total, self.size))
        pattern = np.zeros((total, self.size), dtype=bool)
        for j, graph in enumerate(form.graphs):
            matrix[2 * j : 2 * j + 2, :n] = graph.matrix
            for p, (owner, _) in enumerate(pieces):
                if owner == j:
                    matrix[2 * j : 2 * j + 2, self._s(p)] = -np.eye(2)
        # Faces of arcs change with the iterate, so the pattern includes every coordinate that moves
        # one.
        rows = slice(self.equal, self.equal + m)
        pattern[rows, :n] = form.rows != 0.0
        for row, relative in zip(form.arcs.rows, form.arcs.relative, strict=True):
            pattern[self.equal + row, :n] |= (relative != 0.0).any(axis=0)
        matrix[self.equal + self.yields, n + np.arange(len(self.yields))] = -1.0
        for e, piece in enumerate(ends):
            matrix[self.equal + m + e, self._t(pieces.index(piece))] = 1.0
        for p in range(len(pieces)):
            disc = self.equal + self.below + 3 * p
            matrix[disc, self._t(p)] = -1.0
            matrix[[disc + 1, disc + 2], self._s(p)] = -1.0
        pattern |= matrix != 0.0
        self._matrix, self.pattern = matrix, pattern
        columns, places = np.nonzero(pattern.T)
        self._take = (places, columns)
        self.indices = places
        self.indptr = np.searchsorted(columns, np.arange(self.size + 1))

    def fits(self, laws: Sequence[RadialLaw]) -> bool:
        """Whether radial laws have the pieces that the pattern was made for."""
        pieces = [(j, k) for j, law in enumerate(laws) for k in range(len(law.pieces))]
        ends = [p for p in pieces if np.isfinite(laws[p[0]].pieces[p[1]].length)]
        return pieces == self.pieces and ends == self.ends

    def _s(self, piece: int) -> list[int]:
        return [self.first + 3 * piece, self.first + 3 * piece + 1]

    def _t(self, piece: int) -> int:
        return self.first + 3 * piece + 2

    def matrix(self, rows: Array, compliance: Array) -> Array:
        """Return A, dense."""
        matrix = self._matrix
        matrix[self.equal : self.equal + self.m, : self.n] = rows
        where = (self.equal + self.yields, self.n + np.arange(len(self.yields)))
        matrix[where] = -np.sqrt(compliance[self.yields])
        return matrix

    def values(self, rows: Array, compliance: Array) -> Array:
        """Return the values of A in the order of its compressed columns."""
        return self.matrix(rows, compliance)[self._take]

    def sparse(self, values: Array) -> csc_matrix:
        """Return A in compressed columns."""
        from scipy.sparse import csc_matrix

        shape = self.pattern.shape
        return csc_matrix((values, self.indices, self.indptr), shape=shape)

    def bounds(self, form: Form, gaps: Array, laws: Sequence[RadialLaw]) -> Array:
        """Return the right-hand sides b."""
        centres = [g.centre for g in form.graphs]
        lengths = [laws[j].pieces[k].length for j, k in self.ends]
        return np.concatenate([*centres, gaps, lengths, np.zeros(3 * self.discs)])

    def linear(self, form: Form, laws: Sequence[RadialLaw]) -> Array:
        """Return the linear costs q."""
        costs = np.zeros(self.size)
        costs[: self.n] = -form.load
        for p, (j, k) in enumerate(self.pieces):
            costs[self._t(p)] = laws[j].pieces[k].force
        return costs

    def quadratic(self, form: Form, laws: Sequence[RadialLaw]) -> Array:
        """Return P, dense and with both triangles."""
        diagonal = np.ones(self.size)
        for p, (j, k) in enumerate(self.pieces):
            diagonal[self._s(p)] = laws[j].pieces[k].stiffness
            diagonal[self._t(p)] = 0.0
        quadratic = np.diag(diagonal)
        quadratic[: self.n, : self.n] = form.stiffness
        return quadratic

    def claim(self, z: Array, dual: Array) -> Claim:
        """Return coordinates, row forces and pulls from a primal-dual answer."""
        pulls = [dual[2 * j : 2 * j + 2] for j in range(self.equal // 2)]
        return Claim(z[: self.n], dual[self.equal : self.equal + self.m], pulls)
