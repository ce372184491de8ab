"""moreau: a batched conic solver, for one sample at a time or a whole batch in step."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from benchmarks.peers.clock import Clock
from benchmarks.peers.form import Array, Form
from benchmarks.peers.layout import Layout
from benchmarks.peers.loop import (
    PASSES,
    Claim,
    Failure,
    faces,
    linearised,
    misfit_of,
    next_forces,
)
from loadshare.contact.radial import RadialLaw


class Moreau:
    """Batched interior-point method."""

    def __init__(self, tolerance: float) -> None:
        self.tolerance = tolerance
        self._layout: Layout | None = None
        self.clock = Clock()
        self._solvers: dict[int, Any] = {}

    def prepare(self, form: Form) -> None:
        """Set up the pattern."""
        self._lay_out(form, form.laws(np.ones(len(form.gaps))))

    def _lay_out(self, form: Form, laws: Sequence[RadialLaw]) -> Layout:
        self._layout, self._solvers = Layout(form, laws), {}
        quadratic = self._layout.quadratic(form, laws)
        rows, columns = np.nonzero(quadratic)
        self._pattern = (np.searchsorted(rows, np.arange(self._layout.size + 1)), columns)
        self._quadratic = quadratic[rows, columns]
        rows, columns = np.nonzero(self._layout.pattern)
        self._rows = (np.searchsorted(rows, np.arange(self._layout.pattern.shape[0] + 1)), columns)
        self._places = (rows, columns)
        return self._layout

    def _solver(self, count: int) -> Any:
        import moreau

        if count not in self._solvers:
            layout = self._layout
            assert layout is not None
            ipm = moreau.IPMSettings(
                tol_gap_abs=self.tolerance, tol_gap_rel=self.tolerance, tol_feas=self.tolerance
            )
            self._solvers[count] = moreau.CompiledSolver(
                n=layout.size,
                m=layout.pattern.shape[0],
                P_row_offsets=self._pattern[0],
                P_col_indices=self._pattern[1],
                A_row_offsets=self._rows[0],
                A_col_indices=self._rows[1],
                cones=moreau.Cones(
                    num_zero_cones=layout.equal,
                    num_nonneg_cones=layout.below,
                    so_cone_dims=[3] * layout.discs,
                ),
                # By default it uses an active-set method for QPs, which stays at 1e-4 here.
                settings=moreau.Settings(
                    solver="ipm", device="cpu", batch_size=count, ipm_settings=ipm
                ),
            )
        return self._solvers[count]

    def solve(self, form: Form) -> Claim:
        """See `Peer`."""
        (claim,) = self.solve_many([form])
        if isinstance(claim, Failure):
            raise claim
        return claim

    def _alone(self, form: Form) -> Claim | Failure:
        try:
            return self.solve(form)
        except Failure as failure:
            return failure

    def solve_many(self, forms: Sequence[Form]) -> list[Claim | Failure]:
        """Answer a batch; all samples are in the same pass of the outer loop."""
        layout = self._layout
        assert layout is not None
        solver = self._solver(len(forms))
        forces = [np.ones(len(f.gaps)) for f in forms]
        at: list[Array] = [np.zeros(f.size) for f in forms]
        found: list[Claim | Failure] = [Failure(f"no end after {PASSES} passes")] * len(forms)
        going = set(range(len(forms)))
        for number in range(1, PASSES + 1):
            used = []
            for k, form in enumerate(forms):
                rows, gaps = faces(form, at[k], wide=number == 1)
                compliance, offset = linearised(form, forces[k], "newton")
                laws = form.laws(forces[k])
                used.append((rows, gaps, compliance, offset, laws))
            if len(forms) == 1 and not layout.fits(used[0][4]):
                layout = self._lay_out(forms[0], used[0][4])
                solver = self._solver(1)
            if not all(layout.fits(u[4]) for u in used):
                # Radial laws with different pieces cannot share a batch.
                return [self._alone(form) for form in forms]
            values = [layout.matrix(u[0], u[2])[self._places] for u in used]
            self.clock.call(solver.setup, [self._quadratic] * len(forms), values)
            pairs = list(zip(forms, used, strict=True))
            data = (
                [layout.linear(f, u[4]) for f, u in pairs],
                [layout.bounds(f, u[1] + u[3], u[4]) for f, u in pairs],
            )
            answer = self.clock.call(solver.solve, *data)
            for k in sorted(going):
                status = solver.info.status[k]
                if "Solved" not in str(status.name if hasattr(status, "name") else status):
                    found[k] = Failure(f"moreau: {getattr(status, 'name', status)}")
                    going.discard(k)
                    continue
                claim = layout.claim(np.asarray(answer.x[k]), np.asarray(answer.z[k]))
                claim = Claim(claim.x, claim.forces, claim.pulls, number)
                rows, gaps, _, _, laws = used[k]
                misfit = misfit_of(forms[k], claim, False, rows, gaps, laws)
                found[k] = claim
                if not forms[k].curved or misfit <= self.tolerance:
                    going.discard(k)
                    continue
                forces[k] = next_forces(forms[k], claim, forces[k], "newton")
                at[k] = claim.x
            if not going:
                break
        return found


def make(tolerance: float) -> Moreau:
    """Return moreau."""
    return Moreau(tolerance)
