"""Slips that friction and the end of the clearance hold at once.

Where the slip of a spline with memory stands at the end of its clearance and does not change, how
friction and stop share its force is open. Together they hold it as friction alone would whose bound
is larger: the force stays within both as long as it changes by less than friction has left beside
the stop. Source: formulation, sections 5 and 16.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from loadshare.certify.bound.claim import EPS, Claim

Array = NDArray[np.float64]

SLIGHT = 1e-10
"""Force by which a spline may give way, in loads of the claim, and still stand still."""

UNCHANGED, AT_END = 1e-4, 1e-6
"""Change of a slip, and distance from the end, over the slip, that are a solver's.

What they leave of the law is bounded."""


def with_held_slips(claim: Claim, scale: Array) -> tuple[Claim, NDArray[np.intp]]:
    """The claims with the force of every such stop carried by its friction.

    Parameters
    ----------
    claim : Claim
    scale : ndarray, shape (S,)
        Load of the claims [N].

    Returns
    -------
    claim : Claim
    columns : ndarray of int
        Columns of which only the sum is determined.
    """
    train, columns = claim.columns.train, claim.columns
    none = np.zeros(0, dtype=np.intp)
    if train.slip is None:
        return claim, none
    rounds, splines = len(train.rounds), len(train.splines)
    reactions = claim.answers.radial_reaction.copy()
    limits = claim.graphs[:, :, 2:4].copy()
    slack = np.zeros(len(columns.names))
    shared: list[int] = []
    for k, gear in enumerate(train.splines):
        friction, stop = rounds + k, rounds + splines + k
        before = np.asarray(train.slip[gear])
        reach = float(np.linalg.norm(before))
        at = columns.radials.start + 2 * friction
        slipped = np.abs(claim.lengths[0].value[:, at : at + 2]).max(axis=1)
        both = reactions[:, friction] + reactions[:, stop]
        if _gives_way(claim, k, stop, reach) <= SLIGHT * float(scale.min()):
            # It stands still, up to what room it has.
            limits[:, friction, 0], limits[:, stop, 1] = np.inf, np.inf
            slack[at : at + 2] = float(claim.graphs[:, stop, 3].max()) + reach
            reactions[:, friction], reactions[:, stop] = both, 0.0
            shared += _columns(claim, friction, stop)
            continue
        place = np.abs(claim.answers.displacement[:, columns.order[gear]]).max(axis=1)
        held = (slipped <= UNCHANGED * reach + EPS * place) & (reach > 0.0)
        room = limits[:, stop, 1] - reach
        held &= room <= AT_END * reach
        if not held.any():
            continue
        outward = before / reach
        inward = -(both @ outward)
        beside = np.linalg.norm(both + inward[:, None] * outward, axis=1)
        size = np.linalg.norm(both, axis=1)
        left = limits[:, friction, 0] - np.where(inward > 0.0, beside, size)
        held &= left > 0.0
        reactions[held, friction], reactions[held, stop] = both[held], 0.0
        limits[held, friction, 0], limits[held, stop, 1] = size[held] + left[held], np.inf
        if held.any():
            # As far as the end is from there, it may have slipped.
            slack[at : at + 2] = max(float(room[held].max()), 0.0)
            shared += _columns(claim, friction, stop)
    if not shared:
        return claim, none
    answers = replace(claim.answers, radial_reaction=reactions)
    return replace(claim, answers=answers, limits=limits, slack=slack), np.array(shared)


def _gives_way(claim: Claim, spline: int, stop: int, before: float) -> float:
    """Force by which a spline may give way in what clearance friction leaves it [N]."""
    stiffness, fixed = (claim.situations.spline[:, spline, j] for j in (0, 3))
    if np.isnan(fixed).any():
        return np.inf
    return float((stiffness * (claim.graphs[:, stop, 3] + before)).max())


def _columns(claim: Claim, *radials: int) -> list[int]:
    """Numbers of the columns of some radial elements."""
    start = claim.columns.radials.start
    return [start + 2 * q + k for q in radials for k in (0, 1)]
