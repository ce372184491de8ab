"""The one-shot form: b + c laws as exact power cones, Clarabel, no outer loop for the laws."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from benchmarks.peers.clock import Clock
from benchmarks.peers.form import Array, Form
from benchmarks.peers.loop import Claim, Failure, settle
from loadshare.contact.backends.clarabel_ import cones_of
from loadshare.contact.backends.conic import conic_form
from loadshare.contact.programme import Cone, Programme
from loadshare.contact.radial import RadialLaw


class PowerCone:
    """Clarabel's power cones; ring faces and friction bounds still need passes."""

    def __init__(self, tolerance: float) -> None:
        self.tolerance = tolerance
        self.clock = Clock()

    def prepare(self, form: Form) -> None:
        """Do nothing: nothing is kept."""

    def solve(self, form: Form) -> Claim:
        """See `Peer`."""
        return settle(form, self._inner, self.tolerance, "exact")

    def _inner(
        self, form: Form, rows: Array, gaps: Array, compliance: Array, laws: Sequence[RadialLaw]
    ) -> Claim:
        import clarabel

        graphs = zip(form.graphs, laws, strict=True)
        written = conic_form(
            Programme(
                coordinates=form.scene.coordinates,
                stiffness=form.stiffness,
                load=form.load,
                names=form.names,
                rows=rows,
                gaps=gaps,
                linear=form.linear,
                hertz=form.hertz,
                assumed_closed=np.zeros(len(gaps), dtype=bool),
                cones=tuple(Cone(g.radial.name, g.matrix, g.centre, law) for g, law in graphs),
            )
        )
        cones = cones_of(written)
        settings = clarabel.DefaultSettings()
        settings.verbose = settings.presolve_enable = False
        settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = self.tolerance
        settings.max_iter = 200
        data = written.quadratic, written.linear, written.matrix, written.bounds
        solver = self.clock.call(clarabel.DefaultSolver, *data, cones, settings)
        answer = self.clock.call(solver.solve)
        self.clock.report(answer.solve_time)
        if str(answer.status) not in ("Solved", "AlmostSolved"):
            raise Failure(f"Clarabel: {answer.status}")
        point = written.point(np.array(answer.x), np.array(answer.z))
        return Claim(point.x, point.forces, list(point.cone_forces))


def make(tolerance: float) -> PowerCone:
    """Return the power-cone form."""
    return PowerCone(tolerance)
