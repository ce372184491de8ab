"""Opposed limits of a rigid ring without clearance between them.

A gear that both touch may be squeezed by any pair of equal forces: only their difference is
determined. Source: formulation, sections 4 and 6.
"""

from __future__ import annotations

import numpy as np

from loadshare.array_types import Flags
from loadshare.certify.bound.claim import EPS, Claim
from loadshare.settings import BOUND


def squeezed(claim: Claim) -> Flags:
    """Return the columns of limits between which a gear may be squeezed, shape (S, m)."""
    columns, here = claim.columns, claim.situations
    found = np.zeros((claim.count, len(columns.names)), dtype=bool)
    rigid = here.wall == 0.0
    stop = here.stop
    closed = rigid & (stop.sum(axis=2) <= EPS * np.abs(stop).sum(axis=2))
    found[:, columns.stops] = np.repeat(closed, 2, axis=1)
    way = claim.arcs[0].reshape(claim.count, here.stop.shape[1], 2, 2)
    along = way / np.sqrt((way**2).sum(axis=3, keepdims=True))
    one, other = along[:, :, 0], along[:, :, 1]
    # Off the line between its neighbours a float leans on one arc, and no squeeze can hold it.
    across = np.abs(one[:, :, 0] * other[:, :, 1] - one[:, :, 1] * other[:, :, 0])
    opposed = (across <= BOUND.in_line) & ((one * other).sum(axis=2) < 0.0)
    room = here.arc_clearance
    closed = opposed & rigid & (room.sum(axis=2) <= EPS * np.abs(room).sum(axis=2))
    found[:, columns.arcs] = np.repeat(closed, 4, axis=1)
    return found
