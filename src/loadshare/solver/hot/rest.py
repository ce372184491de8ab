"""Places for bodies that no force holds.

A set whose forces are right may leave bodies loose. At the displacement of least norm they may
overlap, although there is room for all: a contact closed for that reason carries nothing and opens
again. So a place without overlap is sought instead. Source: formulation, section 4.
"""

from __future__ import annotations

import numpy as np

from loadshare.array_types import Array
from loadshare.settings import EXCHANGE


def rest(
    rows: Array, rooms: Array, discs: list[tuple[Array, Array, float]], size: float
) -> Array | None:
    """Return the least shares of loose moves that leave no overlap, or None.

    Parameters
    ----------
    rows : ndarray, shape (k, l)
        How the shares close contacts.
    rooms : ndarray, shape (k,)
        How far these may close; negative where they overlap.
    discs : list of (ndarray (2, l), ndarray (2,), float)
        Of each radial element: offset per share, present offset, and largest radius.
    size : float
        Largest displacement, of which round-off is a part.
    """
    share = np.zeros(rows.shape[1])
    limits, bounds = rows, rooms
    for _ in range(EXCHANGE.renewals):
        # Faces of earlier passes stay: without them, two discs may send the place to and fro.
        faces = [(along @ m, reach - along @ q) for m, q, reach, along in _tangents(discs, share)]
        limits = np.vstack([limits, *(f[0] for f in faces)])
        bounds = np.append(bounds, [f[1] for f in faces])
        found = _least(limits, bounds)
        if found is None:
            return None
        share = found
        over = [float((rows @ share - rooms).max(initial=0.0))]
        over += [float(np.linalg.norm(q + m @ share)) - reach for m, q, reach in discs]
        if max(over) <= EXCHANGE.fits * max(size, float(np.abs(bounds).max(initial=0.0))):
            return share
    return None


def _tangents(
    discs: list[tuple[Array, Array, float]], share: Array
) -> list[tuple[Array, Array, float, Array]]:
    """Return every disc with its outward normal in the direction of its element."""
    found = []
    for matrix, start, reach in discs:
        offset = start + matrix @ share
        radius = float(np.linalg.norm(offset))
        if radius > 0.0:
            found.append((matrix, start, reach, offset / radius))
    return found


def _least(limits: Array, bounds: Array) -> Array | None:
    """Return u of least norm with `limits` u ≤ `bounds`, by NNLS (Lawson, Hanson)."""
    scale = float(np.abs(bounds).max(initial=0.0)) or 1.0
    columns = np.vstack([-limits.T, -bounds[None, :] / scale])
    target = np.zeros(len(columns))
    target[-1] = 1.0
    try:
        # Imported late: most runs need nothing of SciPy, which takes a third of a second.
        from scipy.optimize import nnls

        weights, _ = nnls(columns, target)
    except RuntimeError:
        return None
    left = columns @ weights - target
    return None if left[-1] == 0.0 else -scale * left[:-1] / left[-1]
