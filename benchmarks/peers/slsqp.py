"""SciPy's SLSQP: sequential quadratic programming on the energy of displacements."""

from __future__ import annotations

from typing import Any

import numpy as np

from benchmarks.peers.form import Form
from benchmarks.peers.loop import Claim, Failure
from benchmarks.peers.smooth import Smooth


class Slsqp:
    """Dense SQP with BFGS."""

    def __init__(self, tolerance: float) -> None:
        self.tolerance = tolerance

    def prepare(self, form: Form) -> None:
        """Do nothing: nothing is kept."""

    def solve(self, form: Form) -> Claim:
        """See `Peer`."""
        from scipy.optimize import minimize

        smooth = Smooth(form)
        limits: Any = {"type": "ineq", "fun": smooth.room, "jac": smooth.room_slope}
        answer = minimize(
            smooth.energy,
            np.zeros(form.size),
            jac=smooth.gradient,
            method="SLSQP",
            constraints=[limits] if smooth.constrained else [],
            options={"ftol": self.tolerance, "maxiter": 1000},
        )
        if not answer.success:
            raise Failure(f"SLSQP: {answer.message}")
        return smooth.claim(np.asarray(answer.x))


def make(tolerance: float) -> Slsqp:
    """Return SLSQP."""
    return Slsqp(tolerance)
