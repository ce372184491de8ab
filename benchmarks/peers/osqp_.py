"""OSQP: set up once, updated, warm-started, polished."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from benchmarks.peers.clock import Clock
from benchmarks.peers.form import Array, Form
from benchmarks.peers.layout import Layout
from benchmarks.peers.loop import Claim, Failure, NotForThis, settle
from loadshare.contact.radial import RadialLaw


class Osqp:
    """Operator splitting; QPs only."""

    def __init__(self, tolerance: float) -> None:
        self.tolerance = tolerance
        self.clock = Clock()
        self._solver: Any = None
        self._layout: Layout | None = None

    def prepare(self, form: Form) -> None:
        """Set up the solver."""
        import osqp
        from scipy.sparse import csc_matrix

        if form.kind != "QP":
            raise NotForThis("OSQP solves QPs only")
        layout = self._layout = Layout(form, ())
        self._solver = osqp.OSQP()
        self._solver.setup(
            csc_matrix(np.triu(layout.quadratic(form, ()))),
            layout.linear(form, ()),
            layout.sparse(layout.values(form.rows, form.linear + form.hertz)),
            np.full(layout.below, -np.inf),
            layout.bounds(form, form.gaps, ()),
            verbose=False,
            polishing=True,
            eps_abs=self.tolerance,
            eps_rel=self.tolerance,
            max_iter=20_000,
        )

    def solve(self, form: Form) -> Claim:
        """See `Peer`."""
        return settle(form, self._inner, self.tolerance)

    def _inner(
        self, form: Form, rows: Array, gaps: Array, compliance: Array, laws: Sequence[RadialLaw]
    ) -> Claim:
        layout = self._layout
        assert layout is not None
        data = {"q": layout.linear(form, ()), "u": layout.bounds(form, gaps, ())}
        if form.curved:
            self.clock.call(self._solver.update, Ax=layout.values(rows, compliance))
        self.clock.call(self._solver.update, **data)
        answer = self.clock.call(self._solver.solve, raise_error=False)
        self.clock.report(answer.info.run_time)
        if answer.info.status not in ("solved", "solved inaccurate"):
            raise Failure(f"OSQP: {answer.info.status}")
        return layout.claim(np.asarray(answer.x), np.asarray(answer.y))


def make(tolerance: float) -> Osqp:
    """Return OSQP."""
    return Osqp(tolerance)
