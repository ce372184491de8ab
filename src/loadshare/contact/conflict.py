"""Which rigid rows of a contact problem cannot hold together, if any."""

from __future__ import annotations

import numpy as np

from loadshare.contact.law import PowerLaw
from loadshare.contact.problem import ContactProblem
from loadshare.settings import PLACES


def conflict(problem: ContactProblem) -> tuple[str, ...]:
    r"""Return the rigid rows that contradict one another; empty if all can hold.

    The least overlap t of any place, :math:`\min t` subject to :math:`a_e\cdot x - \lvert a_e\rvert
    t \le g_e`, is positive where they do, and those with a multiplier are those that do. Arcs and
    round limits leave room that turns with the place; they are not judged here.
    """
    from scipy.optimize import linprog

    rows = [r for r in problem.rows if isinstance(r.law, PowerLaw) and r.law.is_rigid]
    if not rows:
        return ()
    vectors = np.array([r.vector / np.linalg.norm(r.vector) for r in rows])
    gaps = np.array([r.gap / np.linalg.norm(r.vector) for r in rows])
    unit = float(np.abs(gaps).max()) or 1.0
    found = linprog(
        np.append(np.zeros(problem.size), 1.0),
        np.hstack([vectors, -np.ones((len(rows), 1))]),
        gaps / unit,
        bounds=[(None, None)] * problem.size + [(-1.0, None)],
        method="highs",
    )
    # Highs leaves some 1e-9 of the bounds: less than that is no proof.
    if found.status != 0 or found.x is None or not float(found.x[-1]) > PLACES.pushed:
        return ()
    shares = np.abs(np.asarray(found.ineqlin.marginals))
    part = shares > PLACES.named * shares.max()
    return tuple(r.name for r, has in zip(rows, part.tolist(), strict=True) if has)
