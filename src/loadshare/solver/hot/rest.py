"""Where what no force holds may rest.

A set whose forces are right may leave bodies loose. At their displacement of least norm they may
be in one another's way, though there is room for all: closing what is in the way carries nothing
and opens again. So a place in the free room is sought instead. Source: formulation, section 4.
"""

from __future__ import annotations

import numpy as np

from loadshare.array_types import Array
from loadshare.settings import EXCHANGE


def rest(
    rows: Array, rooms: Array, discs: list[tuple[Array, Array, float]], size: float
) -> Array | None:
    """Return the least shares of loose moves that fit, or None.

    Parameters
    ----------
    rows : ndarray, shape (k, l)
        How the shares close contacts.
    rooms : ndarray, shape (k,)
        How far these may close; negative where they overlap.
    discs : list of (ndarray (2, l), ndarray (2,), float)
        Offset of a radial element by the shares, where it is, and how far out it may be.
    size : float
        Largest displacement, of which round-off is a part.
    """
    share = np.zeros(rows.shape[1])
    limits, bounds = rows, rooms
    for _ in range(EXCHANGE.renewals):
        # Those of former passes stay: without, two discs may send the place to and fro.
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
    """Every disc with its outward normal towards its element."""
    found = []
    for matrix, start, reach in discs:
        offset = start + matrix @ share
        radius = float(np.linalg.norm(offset))
        if radius > 0.0:
            found.append((matrix, start, reach, offset / radius))
    return found


def _least(limits: Array, bounds: Array) -> Array | None:
    """Least-norm u with `limits` u ≤ `bounds` by non-negative least squares (Lawson, Hanson)."""
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
