"""Clarabel, called directly: the default back-end, for every class of programme."""

from __future__ import annotations

from typing import Any

import numpy as np

from loadshare.contact.backends.backend import KINDS_CONIC, Backend, BackendFailure
from loadshare.contact.backends.conic import ConicForm, conic_form
from loadshare.contact.programme import Point, Programme
from loadshare.settings import CONTACT


def cones_of(form: ConicForm) -> list[Any]:
    """Return the cones of a form, as Clarabel names them."""
    import clarabel

    kinds = {
        "zero": clarabel.ZeroConeT,
        "nonnegative": clarabel.NonnegativeConeT,
        "second-order": clarabel.SecondOrderConeT,
    }
    return [
        clarabel.PowerConeT(size) if kind == "power" else kinds[kind](int(size))
        for kind, size in form.cones
    ]


def settings_of(tolerance: float) -> Any:
    """Return the settings of Clarabel for a tolerance."""
    import clarabel

    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.presolve_enable = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = tolerance
    settings.max_iter = CONTACT.interior_steps
    return settings


class Clarabel(Backend):
    """Interior-point method for QP, SOCP and power cones."""

    name = "clarabel"
    kinds = KINDS_CONIC

    def solve(self, programme: Programme) -> Point:
        """See :meth:`loadshare.contact.backends.backend.Backend.solve`."""
        import clarabel

        form = conic_form(programme)
        answer = clarabel.DefaultSolver(
            form.quadratic,
            form.linear,
            form.matrix,
            form.bounds,
            cones_of(form),
            settings_of(CONTACT.interior),
        ).solve()
        z, dual = np.array(answer.x), np.array(answer.z)
        if not (np.isfinite(z).all() and np.isfinite(dual).all()):
            raise BackendFailure(f"Clarabel gave no point (status {answer.status})")
        if "Infeasible" in str(answer.status):
            raise BackendFailure(f"Clarabel reports {answer.status}")
        return form.point(z, dual)
