"""CVXPY with parameters: compiled once, re-solved with new values (DPP)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from benchmarks.peers.cvxpy_rebuilt import radial, solve_with_clarabel, square_root
from benchmarks.peers.form import Array, Form
from benchmarks.peers.loop import Claim, settle
from loadshare.contact.radial import RadialLaw


class CvxpyParameters:
    """Disciplined parametrised programming; recompiled when the pieces of a radial law change."""

    def __init__(self, tolerance: float) -> None:
        self.tolerance = tolerance

    def prepare(self, form: Form) -> None:
        """Write the problem."""
        self._write(form, form.laws(np.ones(len(form.gaps))))

    def _write(self, form: Form, laws: Sequence[RadialLaw]) -> None:
        import cvxpy as cp

        count = len(form.gaps)
        self._x, y = cp.Variable(form.size), cp.Variable(count)
        self._load, self._gaps = cp.Parameter(form.size), cp.Parameter(count)
        self._root = cp.Parameter(count, nonneg=True)
        # Only the faces of arcs change direction; the rows of flanks and stops are constants.
        fixed = np.setdiff1d(np.arange(count), form.arcs.rows)
        self._fixed, self._turning = fixed, form.arcs.rows
        self._faces = cp.Parameter((len(form.arcs.rows), form.size)) if count > len(fixed) else None
        energy = 0.5 * cp.sum_squares(square_root(form.stiffness).T @ self._x)
        energy += 0.5 * cp.sum_squares(y) - self._load @ self._x
        yielded = cp.multiply(self._root, y)
        self._contacts = [form.rows[fixed] @ self._x - yielded[fixed] <= self._gaps[fixed]]
        if self._faces is not None:
            turning = self._turning
            self._contacts.append(self._faces @ self._x - yielded[turning] <= self._gaps[turning])
        self._offsets, discs = [], []
        self._pieces, self._graphs = _shape(laws), []
        self._centres = [cp.Parameter(2) for _ in form.graphs]
        for graph, law, centre in zip(form.graphs, laws, self._centres, strict=True):
            kept: list[Any] = []
            more, offset, inside = radial(graph.matrix @ self._x - centre, law, kept)
            self._graphs.append(kept)
            energy += more
            self._offsets.append(offset)
            discs += inside
        self._problem = cp.Problem(cp.Minimize(energy), [*self._contacts, *self._offsets, *discs])

    def solve(self, form: Form) -> Claim:
        """See `Peer`."""
        return settle(form, self._inner, self.tolerance)

    def _inner(
        self, form: Form, rows: Array, gaps: Array, compliance: Array, laws: Sequence[RadialLaw]
    ) -> Claim:
        if _shape(laws) != self._pieces:
            self._write(form, laws)
        for graph, law, kept, centre in zip(
            form.graphs, laws, self._graphs, self._centres, strict=True
        ):
            centre.value = graph.centre
            for piece, (force, length) in zip(law.pieces, kept, strict=True):
                force.value = piece.force
                if np.isfinite(piece.length):
                    length.value = piece.length
        self._load.value, self._gaps.value = form.load, gaps
        self._root.value = np.sqrt(compliance)
        if self._faces is not None:
            self._faces.value = rows[self._turning]
        solve_with_clarabel(self._problem, self.tolerance)
        forces = np.zeros(len(gaps))
        forces[self._fixed] = self._contacts[0].dual_value
        if self._faces is not None:
            forces[self._turning] = self._contacts[1].dual_value
        return Claim(np.asarray(self._x.value), forces, [o.dual_value for o in self._offsets])


def _shape(laws: Sequence[RadialLaw]) -> list[tuple[tuple[float, bool], ...]]:
    """Return the part of radial laws that is written into the problem as constants."""
    return [tuple((p.stiffness, bool(np.isfinite(p.length))) for p in law.pieces) for law in laws]


def make(tolerance: float) -> CvxpyParameters:
    """Return CVXPY with parameters."""
    return CvxpyParameters(tolerance)
