"""Clarabel, called directly: a new solver in every pass, or one that is updated.

Best practice: presolve off (updates are refused after it), tolerances of at least 1e-11, and
Newton's outer loop; Picard's is a variant.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from benchmarks.peers.clock import Clock
from benchmarks.peers.form import Array, Form
from benchmarks.peers.layout import Layout
from benchmarks.peers.loop import Claim, Failure, settle
from loadshare.contact.radial import RadialLaw


class Clarabel:
    """Interior-point method.

    Parameters
    ----------
    tolerance : float
    update : bool
        Keep one solver and update its data.
    method : {"newton", "picard"}
    """

    def __init__(self, tolerance: float, update: bool, method: str = "newton") -> None:
        self.tolerance, self.update, self.method = tolerance, update, method
        self.clock = Clock()
        self._solver: Any = None
        self._layout: Layout | None = None

    def prepare(self, form: Form) -> None:
        """Set up the pattern, and the solver if it is kept."""
        laws = form.laws(np.ones(len(form.gaps)))
        self._layout, self._solver = Layout(form, laws), None
        if self.update:
            compliance = form.linear + form.hertz
            self._new(form, form.rows, form.gaps, compliance, laws)

    def solve(self, form: Form) -> Claim:
        """See `Peer`."""
        return settle(form, self._inner, self.tolerance, self.method)

    def _new(
        self, form: Form, rows: Array, gaps: Array, compliance: Array, laws: Sequence[RadialLaw]
    ) -> Any:
        import clarabel
        from scipy.sparse import csc_matrix

        layout = self._layout
        assert layout is not None
        settings = clarabel.DefaultSettings()
        settings.verbose = settings.presolve_enable = False
        settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = self.tolerance
        settings.max_iter = 200
        sizes = [(clarabel.ZeroConeT, layout.equal), (clarabel.NonnegativeConeT, layout.below)]
        cones = [kind(size) for kind, size in sizes if size]
        cones += [clarabel.SecondOrderConeT(3)] * layout.discs
        data = (
            csc_matrix(np.triu(layout.quadratic(form, laws))),
            layout.linear(form, laws),
            layout.sparse(layout.values(rows, compliance)),
            layout.bounds(form, gaps, laws),
        )
        self._solver = self.clock.call(clarabel.DefaultSolver, *data, cones, settings)
        return self._solver

    def _inner(
        self, form: Form, rows: Array, gaps: Array, compliance: Array, laws: Sequence[RadialLaw]
    ) -> Claim:
        layout = self._layout
        if layout is None or not layout.fits(laws):
            layout = self._layout = Layout(form, laws)
            self._new(form, rows, gaps, compliance, laws)
        elif self.update:
            data = {
                "q": layout.linear(form, laws),
                "A": layout.values(rows, compliance),
                "b": layout.bounds(form, gaps, laws),
            }
            self.clock.call(self._solver.update, **data)
        else:
            self._new(form, rows, gaps, compliance, laws)
        answer = self.clock.call(self._solver.solve)
        self.clock.report(answer.solve_time)
        if str(answer.status) not in ("Solved", "AlmostSolved"):
            raise Failure(f"Clarabel: {answer.status}")
        return layout.claim(np.array(answer.x), np.array(answer.z))


def make(tolerance: float) -> Clarabel:
    """Return Clarabel with a new solver in every pass."""
    return Clarabel(tolerance, update=False)
