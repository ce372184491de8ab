r"""DAQP: a dual active-set method, applied to the force form, which is positive definite.

The Hessian of the primal form is singular if only contacts hold a gear. In the forces F of the
rows, with :math:`H^{+}` the pseudo-inverse and Z a basis of the null space of H,

.. math:: \min_{F \ge 0} \tfrac12 F^T (B + A H^{+} A^T) F + (g - A H^{+} f)^T F
          \quad \text{s.t.} \quad Z^T A^T F = Z^T f ,

and the multipliers of the equations are the coordinates that no spring holds.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from benchmarks.peers.clock import Clock
from benchmarks.peers.form import Array, Form
from benchmarks.peers.loop import Claim, Failure, NotForThis, settle
from loadshare.contact.radial import RadialLaw

EQUATION = 5
"""DAQP's code for an equation."""


class Daqp:
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
        self._spread = form.rows @ self._inverse
        self._flexible = self._spread @ form.rows.T
        self._ties = form.rows @ self._loose
        count, free = self._ties.shape
        self._upper = np.concatenate([np.full(count, 1e30), np.zeros(free)])
        self._lower = np.zeros(count + free)
        self._sense = np.concatenate([np.zeros(count), np.full(free, EQUATION)]).astype(np.int32)
        self._model = daqp.Model()
        upper, lower = self._limits(form)
        matrix = self._flexible + np.diag(form.linear + form.hertz)
        # Opposed rigid contacts make the Hessian singular, which needs proximal passes.
        sizes = np.linalg.eigvalsh(matrix)
        singular = len(sizes) > 0 and sizes[0] < 1e-10 * sizes[-1]
        self._model.settings = {
            "primal_tol": self.tolerance,
            "dual_tol": self.tolerance,
            "eps_prox": 1e-8 if singular else 0.0,
        }
        flag, _ = self._model.setup(
            matrix, self._linear(form, form.gaps), self._ties.T.copy(), upper, lower, self._sense
        )
        if flag < 0:
            raise Failure(f"DAQP: set-up ends with exit flag {flag}")

    def _limits(self, form: Form) -> tuple[Array, Array]:
        count = len(form.gaps)
        self._upper[count:] = self._lower[count:] = self._loose.T @ form.load
        return self._upper, self._lower

    def _linear(self, form: Form, gaps: Array) -> Array:
        return np.asarray(gaps - self._spread @ form.load)

    def solve(self, form: Form) -> Claim:
        """See `Peer`."""
        return settle(form, self._inner, max(self.tolerance, 1e-13))

    def _inner(
        self, form: Form, rows: Array, gaps: Array, compliance: Array, laws: Sequence[RadialLaw]
    ) -> Claim:
        if len(form.arcs.rows):
            k = form.arcs.rows
            self._spread[k] = rows[k] @ self._inverse
            self._flexible[k] = self._spread[k] @ rows.T
            self._flexible[:, k] = self._flexible[k].T
            self._ties[k] = rows[k] @ self._loose
        upper, lower = self._limits(form)
        matrix = self._flexible + np.diag(compliance) if form.curved else None
        ties = self._ties.T.copy() if len(form.arcs.rows) else None
        linear = self._linear(form, gaps)
        self.clock.call(self._model.update, matrix, linear, ties, upper, lower)
        forces, _, flag, info = self.clock.call(self._model.solve)
        self.clock.report(info["solve_time"])
        if flag < 1:
            raise Failure(f"DAQP: exit flag {flag}")
        forces = np.asarray(forces)
        loose = -np.asarray(info["lam"])[len(gaps) :]
        x = self._inverse @ (form.load - rows.T @ forces) + self._loose @ loose
        return Claim(x, forces, ())


def make(tolerance: float) -> Daqp:
    """Return DAQP."""
    return Daqp(tolerance)
