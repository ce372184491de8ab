"""PIQP: proximal interior point, set up once and updated; dense if the problem is small."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from benchmarks.peers.clock import Clock
from benchmarks.peers.form import Array, Form
from benchmarks.peers.layout import Layout
from benchmarks.peers.loop import Claim, Failure, NotForThis, settle
from loadshare.contact.radial import RadialLaw

DENSE = 120
"""Number of variables up to which the dense solver is faster."""


class Piqp:
    """Proximal interior-point method; QPs only."""

    def __init__(self, tolerance: float) -> None:
        self.tolerance = tolerance
        self.clock = Clock()
        self._solver: Any = None
        self._layout: Layout | None = None
        self._dense = True

    def prepare(self, form: Form) -> None:
        """Set up the solver."""
        import piqp
        from scipy.sparse import csc_matrix

        if form.kind != "QP":
            raise NotForThis("PIQP solves QPs only")
        layout = self._layout = Layout(form, ())
        self._dense = layout.size <= DENSE
        self._solver = piqp.DenseSolver() if self._dense else piqp.SparseSolver()
        settings = self._solver.settings
        settings.verbose = False
        settings.eps_abs = settings.eps_rel = self.tolerance
        settings.eps_duality_gap_abs = settings.eps_duality_gap_rel = self.tolerance
        quadratic = layout.quadratic(form, ())
        self._solver.setup(
            np.asfortranarray(quadratic) if self._dense else csc_matrix(quadratic),
            layout.linear(form, ()),
            None,
            None,
            self._rows(form.rows, form.linear + form.hertz),
            None,
            layout.bounds(form, form.gaps, ()),
        )

    def _rows(self, rows: Array, compliance: Array) -> Any:
        layout = self._layout
        assert layout is not None
        if self._dense:
            return np.asfortranarray(layout.matrix(rows, compliance))
        return layout.sparse(layout.values(rows, compliance))

    def solve(self, form: Form) -> Claim:
        """See `Peer`."""
        return settle(form, self._inner, self.tolerance)

    def _inner(
        self, form: Form, rows: Array, gaps: Array, compliance: Array, laws: Sequence[RadialLaw]
    ) -> Claim:
        layout = self._layout
        assert layout is not None
        changed = {"c": layout.linear(form, ()), "h_u": layout.bounds(form, gaps, ())}
        if form.curved:
            changed["G"] = self._rows(rows, compliance)
        self.clock.call(self._solver.update, **changed)
        status = self.clock.call(self._solver.solve)
        if "SOLVED" not in str(status) or "UNSOLVED" in str(status):
            raise Failure(f"PIQP: {str(status).removeprefix('Status.')}")
        result = self._solver.result
        self.clock.report(result.info.run_time)
        return layout.claim(np.array(result.x), np.array(result.z_u))


def make(tolerance: float) -> Piqp:
    """Return PIQP."""
    return Piqp(tolerance)
