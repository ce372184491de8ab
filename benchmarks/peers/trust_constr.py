"""SciPy's trust-constr: a trust-region interior-point method on the energy of displacements."""

from __future__ import annotations

import warnings

import numpy as np

from benchmarks.peers.form import Form
from benchmarks.peers.loop import Claim, Failure
from benchmarks.peers.smooth import Smooth


class TrustConstr:
    """Trust region with BFGS."""

    def __init__(self, tolerance: float) -> None:
        self.tolerance = tolerance

    def prepare(self, form: Form) -> None:
        """Do nothing: nothing is kept."""

    def solve(self, form: Form) -> Claim:
        """See `Peer`."""
        from scipy.optimize import BFGS, NonlinearConstraint, minimize

        smooth = Smooth(form)
        limits = NonlinearConstraint(smooth.room, 0.0, np.inf, jac=smooth.room_slope, hess=BFGS())
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            answer = minimize(
                smooth.energy,
                np.zeros(form.size),
                jac=smooth.gradient,
                hess=BFGS(),
                method="trust-constr",
                constraints=[limits] if smooth.constrained else [],
                options={
                    "gtol": self.tolerance,
                    "xtol": 1e-2 * self.tolerance,
                    "barrier_tol": self.tolerance,
                    "maxiter": 300,
                },
            )
        if answer.status not in (1, 2):
            raise Failure(f"trust-constr: {answer.message}")
        return smooth.claim(np.asarray(answer.x))


def make(tolerance: float) -> TrustConstr:
    """Return trust-constr."""
    return TrustConstr(tolerance)
