"""OSQP, called directly and polished: a first-order method, for QPs only."""

from __future__ import annotations

import numpy as np

from loadshare.contact.backends.backend import KINDS_QP, Backend, BackendFailure
from loadshare.contact.forms import quadratic_form
from loadshare.contact.programme import Point, Programme
from loadshare.settings import CONTACT


class Osqp(Backend):
    """Operator splitting with polish."""

    name = "osqp"
    kinds = KINDS_QP

    def solve(self, programme: Programme) -> Point:
        """See :meth:`loadshare.contact.backends.backend.Backend.solve`."""
        import osqp

        form = quadratic_form(programme)
        solver = osqp.OSQP()
        solver.setup(
            form.quadratic,
            form.linear,
            form.matrix,
            form.lower,
            form.upper,
            verbose=False,
            polishing=True,
            eps_abs=CONTACT.splitting,
            eps_rel=CONTACT.splitting,
            max_iter=CONTACT.splitting_steps,
        )
        answer = solver.solve(raise_error=False)
        z, dual = np.asarray(answer.x, dtype=float), np.asarray(answer.y, dtype=float)
        if z.size == 0 or not (np.isfinite(z).all() and np.isfinite(dual).all()):
            raise BackendFailure(f"OSQP gave no point (status {answer.info.status})")
        return form.point(z, dual)
