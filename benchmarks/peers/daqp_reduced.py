r"""DAQP on the problem reduced to its redundants: no equations, and few variables.

With :math:`F = F_0 + N z`, where :math:`Z^T A^T F_0 = Z^T f` and :math:`Z^T A^T N = 0`,

.. math:: \min_z \tfrac12 z^T N^T M N z + N^T (M F_0 + g - A H^{+} f)^T z
          \quad \text{s.t.} \quad N z \ge -F_0 , \qquad M = B + A H^{+} A^T .

It is the force method of `loadshare`, but DAQP finds the active set. The basis N is computed again
when the faces of arcs change direction; this is not part of the time of its calls.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from benchmarks.peers.clock import Clock
from benchmarks.peers.form import Array, Form
from benchmarks.peers.loop import Claim, Failure, NotForThis, settle
from loadshare.contact.radial import RadialLaw


class DaqpReduced:
    """Dual active-set method; QPs only."""

    def __init__(self, tolerance: float) -> None:
        self.tolerance = tolerance
        self.clock = Clock()
        self._model: Any = None

    def prepare(self, form: Form) -> None:
        """Factorise the stiffness matrix and set up the model."""
        import daqp

        if form.kind != "QP":
            raise NotForThis("DAQP solves QPs only")
        values, vectors = np.linalg.eigh(form.stiffness)
        held = values > 1e-12 * max(values.max(initial=0.0), 1e-300)
        self._inverse = (vectors[:, held] / values[held]) @ vectors[:, held].T
        self._loose = vectors[:, ~held]
        self._reduce(form.rows)
        self._model = daqp.Model()
        flexible = self._flexible + np.diag(form.linear + form.hertz)
        matrix = self._basis.T @ flexible @ self._basis
        sizes = np.linalg.eigvalsh(matrix)
        singular = len(sizes) > 0 and sizes[0] < 1e-10 * sizes[-1]
        self._model.settings = {
            "primal_tol": self.tolerance,
            "dual_tol": self.tolerance,
            "eps_prox": 1e-8 if singular else 0.0,
        }
        count, size = self._basis.shape
        if not size:
            raise NotForThis("nothing is left to be solved")
        linear, lower = self._right(form, flexible, form.gaps)
        upper, sense = np.full(count, 1e30), np.zeros(count, dtype=np.int32)
        self._upper = upper
        flag, _ = self._model.setup(matrix, linear, self._basis.copy(), upper, lower, sense)
        if flag < 0:
            raise Failure(f"DAQP: set-up ends with exit flag {flag}")

    def _reduce(self, rows: Array) -> None:
        """Compute the statics of rows: a particular solution, and the basis of redundants."""
        self._spread = rows @ self._inverse
        self._flexible = self._spread @ rows.T
        self._ties = rows @ self._loose
        left, sizes, right = np.linalg.svd(self._ties, full_matrices=True)
        rank = int((sizes > 1e-10 * sizes.max(initial=0.0)).sum())
        self._particular = left[:, :rank] / sizes[:rank] @ right[:rank]
        self._basis = np.ascontiguousarray(left[:, rank:])

    def _right(self, form: Form, flexible: Array, gaps: Array) -> tuple[Array, Array]:
        self._first = self._particular @ (self._loose.T @ form.load)
        self._gaps = gaps - self._spread @ form.load
        linear = self._basis.T @ (flexible @ self._first + self._gaps)
        return linear, -self._first

    def solve(self, form: Form) -> Claim:
        """See `Peer`."""
        return settle(form, self._inner, max(self.tolerance, 1e-13))

    def _inner(
        self, form: Form, rows: Array, gaps: Array, compliance: Array, laws: Sequence[RadialLaw]
    ) -> Claim:
        turned = len(form.arcs.rows) > 0
        if turned:
            self._reduce(rows)
        flexible = self._flexible + np.diag(compliance)
        linear, lower = self._right(form, flexible, gaps)
        matrix = self._basis.T @ flexible @ self._basis if form.curved else None
        basis = self._basis.copy() if turned else None
        self.clock.call(self._model.update, matrix, linear, basis, self._upper, lower)
        z, _, flag, info = self.clock.call(self._model.solve)
        self.clock.report(info["solve_time"])
        if flag < 1:
            raise Failure(f"DAQP: exit flag {flag}")
        forces = self._first + self._basis @ np.asarray(z)
        # Coordinates without springs follow from compatibility at the rows that carry.
        carries = np.asarray(info["lam"]) == 0.0
        off = flexible @ forces + self._gaps
        loose = np.linalg.lstsq(self._ties[carries], off[carries], rcond=1e-12)[0]
        x = self._inverse @ (form.load - rows.T @ forces) + self._loose @ loose
        return Claim(x, forces, ())


def make(tolerance: float) -> DaqpReduced:
    """Return DAQP on redundants."""
    return DaqpReduced(tolerance)
