"""Whether every force and gap that decides which elements act keeps its sign within errors.

Source: formulation, section 16.
"""

from __future__ import annotations

import numpy as np

from loadshare.array_types import Array, Flags, Numbers
from loadshare.certify.bound.acts import Act, Acts
from loadshare.certify.bound.claim import Claim
from loadshare.certify.bound.elements import Elements


def doubts(
    claim: Claim, found: Elements, rows: Numbers, errors: Array, moved: Array
) -> tuple[Flags, Flags]:
    """Return elements whose force or gap may change sign within errors, shape (rows, elements).

    Parameters
    ----------
    claim : Claim
    found : Elements
    rows : ndarray of int
        Claims.
    errors, moved : ndarray, shape (rows, m)
        Errors of the forces [N] and of the lengths [m] of all columns.

    Returns
    -------
    doubtful, above : ndarray of bool
        As in `Box`.
    """
    columns = claim.columns
    pick = slice(None) if len(rows) == claim.count else rows
    act = found.act[pick]
    length = claim.lengths[0].value[pick]
    doubtful, above = np.zeros(act.shape, bool), np.zeros(act.shape, bool)
    scalar = columns.contacts
    acting = found.force[pick][:, scalar] > errors[:, scalar]
    away = -length[:, scalar] > moved[:, scalar] + found.width[pick][:, scalar]
    closed = act[:, : len(scalar)] != Act.OPEN
    doubtful[:, : len(scalar)] = ~np.where(closed, acting, away)
    if columns.pairs:
        first = columns.first_pair
        error, way = (
            np.sqrt((v[:, first:].reshape(len(v), -1, 2) ** 2).sum(axis=2)) for v in (errors, moved)
        )
        level = _level_errors(claim, errors, pick)
        low, high = _room(claim, found, pick, act[:, len(scalar) :], error, way, level)
        doubtful[:, len(scalar) :] = ~(low & high)
        above[:, len(scalar) :] = ~high
    return doubtful, above


def _level_errors(claim: Claim, errors: Array, rows: Numbers | slice) -> Array:
    """Return errors of the levels of splines that follow the torque, shape (rows, radials) [N]."""
    columns = claim.columns
    found = np.zeros((len(errors), len(columns.claims.radials)))
    torque = errors[:, columns.flanks] @ np.abs(columns.moments).T
    for q, k in columns.claims.on_splines:
        spline = claim.situations.spline[:, k]
        spline = spline[rows] if len(spline) > 1 else spline
        rate, follows = np.abs(spline[:, 4]), np.isnan(spline[:, 3])
        found[:, q] = np.where(follows, np.where(follows, rate, 0.0) * torque[:, k], 0.0)
    return found


def _room(
    claim: Claim,
    found: Elements,
    rows: Numbers | slice,
    act: Acts,
    error: Array,
    moved: Array,
    level_error: Array,
) -> tuple[Flags, Flags]:
    """Return whether each arc and radial element stays above and below the ends of its piece."""
    arcs = claim.arcs[1].shape[1]
    size, distance = found.size[rows], found.distance[rows]
    low, high = np.ones(act.shape, bool), np.ones(act.shape, bool)
    gap = claim.arcs[1][rows]
    low[:, :arcs] = np.where(
        act[:, :arcs] != Act.OPEN, size[:, :arcs] > error[:, :arcs], gap > moved[:, :arcs]
    )
    stiffness, stick, level, reach, _ = claim.graphs[rows].transpose(2, 0, 1)
    part, acts = slice(arcs, None), act[:, arcs:]
    size, distance, error, moved = (v[:, part] for v in (size, distance, error, moved))
    ends = np.isfinite(stick) & (stiffness > 0.0)
    stick_error = np.where(ends, level_error / np.where(ends, stiffness, 1.0), 0.0)
    end = np.where(np.isinf(stick), np.inf, np.where(stick > 0.0, stiffness * stick, 0.0))
    is_low = {
        Act.STEP: size - error > end,
        Act.SLIP: distance - moved > stick + stick_error,
        Act.STOP: size - error > level + level_error,
    }
    is_high = {
        Act.OPEN: distance + moved < reach,
        Act.STICK: (
            np.isinf(stick)
            | (reach == 0.0)
            | (size + error < end - level_error)
            | (found.centred[rows][:, part] > 0.0)
        ),
        Act.PINNED: (level == 0.0) | (size + error < level - level_error),
        Act.STEP: size + error < level - level_error,
        Act.SLIP: distance + moved < reach,
    }
    for kind, held in is_low.items():
        low[:, part] &= (acts != kind) | held
    for kind, held in is_high.items():
        high[:, part] &= (acts != kind) | held
    return low, high
