"""A quick test whether any forces at all can balance a load.

Exchange and search find this out as well, but slowly, because nothing they try is an answer.
"""

from __future__ import annotations

import numpy as np

from loadshare.array_types import Array
from loadshare.scene.structure import Structure
from loadshare.settings import CERTIFY, PLACES


def is_unbalanced(structure: Structure, load: Array, tolerance: float = CERTIFY.tolerance) -> bool:
    r"""Return whether the load drives a move that nothing resists.

    The forces nearest to balance, :math:`\min_\mu \lVert f - A^T\mu\rVert` with contacts that only
    push, leave a residual r. If it is not zero, it is such a move (Farkas):
    :math:`A r = 0` for springs and radial elements, :math:`a_e\cdot r \le 0` for contacts, and
    :math:`f\cdot r = \lVert r\rVert^2`. An arc may push in any direction here.

    Parameters
    ----------
    structure : Structure
    load : ndarray, shape (n,)
    tolerance : float
        Largest scaled residual of a certified answer: a residual of that size counts as zero.
    """
    from scipy.optimize import nnls

    size = float(np.linalg.norm(load))
    if not size:
        return False
    columns, vectors = structure.columns, structure.vectors
    pushing, arcs = vectors[columns.flat], [a.relative for a in structure.arcs]
    held = np.vstack([vectors[columns.springs], vectors[columns.radials], *arcs])
    try:
        forces, _ = nnls(np.vstack([held, -held, pushing]).T, load / size)
    except RuntimeError:
        return False
    # The residual has the load's round-off; its part along what acts should be 0 and is removed.
    acting = np.vstack([held, pushing[forces[2 * len(held) :] > 0.0]])
    left = load / size - np.concatenate([held, -held, pushing]).T @ forces
    left -= np.linalg.lstsq(acting, acting @ left)[0]
    length = float(np.linalg.norm(left))
    work = float(left @ load) / size
    if work <= PLACES.work * tolerance * length:
        return False
    resists = np.append(np.abs(held @ left), pushing @ left).max(initial=0.0)
    return bool(resists <= PLACES.yields * work)
