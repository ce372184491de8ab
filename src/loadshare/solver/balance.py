"""Whether any forces at all can balance a load, found at once.

Exchange and search find out as well, but take their time: nothing they try is an answer.
"""

from __future__ import annotations

import numpy as np

from loadshare.scene.scene import Array
from loadshare.scene.structure import Structure
from loadshare.settings import PLACES


def is_unbalanced(structure: Structure, load: Array) -> bool:
    r"""Whether the load drives a move that nothing resists.

    The forces nearest to balance, :math:`\min_\mu \lVert f - A^T\mu\rVert` with contacts that push
    only, leave a residual r. Where it is not zero it is such a move (Farkas):
    :math:`A r = 0` for springs and radial elements, :math:`a_e\cdot r \le 0` for contacts, and
    :math:`f\cdot r = \lVert r\rVert^2`. An arc may push any way here.

    Parameters
    ----------
    structure : Structure
    load : ndarray, shape (n,)
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
    left = load / size - np.concatenate([held, -held, pushing]).T @ forces
    length = float(np.linalg.norm(left))
    if left @ load <= PLACES.work * size * length:
        return False
    gives = float(np.abs(held @ left).max(initial=0.0)) <= PLACES.yields * length
    return gives and bool((pushing @ left <= PLACES.yields * length).all())
