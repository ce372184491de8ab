"""Which rigid limits of a scene cannot hold together, if any."""

from __future__ import annotations

import numpy as np

from loadshare.contact.law import PowerLaw
from loadshare.scene.scene import Scene

OVERLAP = 1e-12
"""Overlap, over the lengths at hand, that counts as round-off."""
SHARE = 1e-6
"""Share in a contradiction from which on a limit is named."""


def contradiction(scene: Scene, overlap: float = OVERLAP) -> tuple[str, ...]:
    r"""Return the rigid limits that contradict one another; empty if all can hold.

    The least overlap t of any displacement,

    .. math:: \min_{x, t} t \quad \text{s.t.}\; a_e\cdot x - t \le g_e \;\text{ for rigid rows } e,

    is positive where they contradict, and the rows with a multiplier are those that do.
    """
    from scipy.optimize import linprog

    rows = [
        r
        for r in scene.rows_at(np.zeros(scene.size), wide=True)
        if isinstance(r.law, PowerLaw) and r.law.is_rigid
    ]
    if not rows:
        return ()
    unit = max(scene.length_unit(), *(abs(r.gap) for r in rows))
    matrix = np.array([[*r.vector, -1.0] for r in rows])
    bounds = [(None, None)] * scene.size + [(-1.0, None)]
    cost = np.append(np.zeros(scene.size), 1.0)
    found = linprog(cost, matrix, [r.gap / unit for r in rows], bounds=bounds, method="highs")
    if found.status != 0 or found.x is None or found.x[-1] <= overlap:
        return ()
    weights = np.abs(np.asarray(found.ineqlin.marginals))
    return tuple(r.name for r, w in zip(rows, weights, strict=True) if w > SHARE * weights.max())
