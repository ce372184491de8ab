"""Slips that friction and the end of the clearance hold at once.

Where the slip of a spline with memory is at the end of its clearance and does not change, it is
open how friction and stop share its force. Together they hold it as friction with a larger bound
would alone: the force stays within both as long as it changes by less than the friction that is
left beside the stop. Where friction follows a torque, so does the room: its opening is allowed for
up to a small error of that torque, which the bound then has to prove. Source: formulation, sections
5 and 16.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from loadshare.array_types import Array, Flags, Numbers
from loadshare.certify.bound.claim import EPS, Claim
from loadshare.settings import BOUND


@dataclass(frozen=True, eq=False)
class HeldSlips:
    """Claims with their held slips.

    Attributes
    ----------
    claim : Claim
        The claim, with the force of every such stop carried by its friction.
    shared : ndarray of int
        Columns of which only the sum is determined.
    turned : ndarray, shape (S, splines)
        Errors of the torques over splines [N·m] for which this holds.
    """

    claim: Claim
    shared: Numbers
    turned: Array

    def denied(self, force: Array) -> Flags:
        """Return whether errors (S, m) of the forces may change torques by more, (S,)."""
        if not np.isfinite(self.turned).any():
            return np.zeros(len(force), dtype=bool)
        return np.asarray((_torque_errors(self.claim, force) > self.turned).any(axis=1))


def _torque_errors(claim: Claim, force: Array) -> Array:
    """Bound the errors of the torques over splines by those of forces, (S, splines) [N·m].

    The forces of an exact equilibrium balance at every rotation. So the flanks of a gear may be off
    together by no more than the claim's imbalance there and the other forces of the gear are, even
    if each of them may be off by more.
    """
    columns = claim.columns
    errors = force[:, columns.flanks] @ np.abs(columns.moments).T
    left, rounding = claim.balance(claim.forces)
    for k, gear in enumerate(columns.train.splines):
        at = columns.turns[gear].coordinate
        if at is None:
            continue
        moments = -columns.units[at] * columns.matrix.high[:, at]
        moments[columns.flanks] += columns.moments[k]
        rest = np.flatnonzero(moments)
        balanced = columns.units[at] * (np.abs(left[:, at]) + rounding[:, at])
        balanced += force[:, rest] @ np.abs(moments[rest])
        errors[:, k] = np.minimum(errors[:, k], balanced)
    return np.asarray(errors)


def with_held_slips(claim: Claim, scale: Array, still: tuple[float, float]) -> HeldSlips:
    """Hold the slips that friction and the end of the clearance hold at once.

    Parameters
    ----------
    claim : Claim
    scale : ndarray, shape (S,)
        Load of the claims [N].
    still : (float, float)
        One of `BOUND.still`.
    """
    slight, unchanged = still
    train, columns = claim.columns.train, claim.columns
    turned = np.full((claim.count, len(train.splines)), np.inf)
    if train.slip is None:
        return HeldSlips(claim, np.zeros(0, dtype=np.intp), turned)
    reactions = claim.answers.radial_reaction.copy()
    limits = claim.graphs[:, :, 2:4].copy()
    slack = np.zeros(len(columns.names))
    shared: list[int] = []
    first, last = columns.claims.splines.start, columns.claims.spline_stops.start
    for k, gear in enumerate(train.splines):
        friction, stop = first + k, last + k
        before = np.asarray(train.slip[gear])
        reach = float(np.linalg.norm(before))
        slips = columns.both(friction)
        slipped = np.abs(claim.lengths[0].value[:, slips]).max(axis=1)
        both = reactions[:, friction] + reactions[:, stop]
        stiffness, rate = claim.situations.spline[:, k, 0], _rate(claim, k)
        arm = float(np.abs(columns.moments[k]).max(initial=0.0))
        least = BOUND.turned * scale * arm
        gives = arm * stiffness * (claim.graphs[:, stop, 3] + reach)
        room, torque = _widest(claim, k, rate, np.maximum(least, gives))
        if float((stiffness * (room + reach)).max()) <= slight * float(scale.min()):
            # It does not move, except within the room that it has.
            limits[:, friction, 0], limits[:, stop, 1] = np.inf, np.inf
            slack[slips] = float(room.max()) + reach
            turned[:, k] = torque
            reactions[:, friction], reactions[:, stop] = both, 0.0
            shared += _columns(claim, friction, stop)
            continue
        place = np.abs(claim.answers.displacement[:, columns.order[gear]]).max(axis=1)
        held = (slipped <= unchanged * reach + EPS * place) & (reach > 0.0)
        room = limits[:, stop, 1] - reach
        held &= room <= BOUND.at_end * reach + BOUND.next_to * place
        if not held.any():
            continue
        outward = before / reach
        inward = -(both @ outward)
        beside = np.linalg.norm(both + inward[:, None] * outward, axis=1)
        size = np.linalg.norm(both, axis=1)
        left = limits[:, friction, 0] - np.where(inward > 0.0, beside, size) - rate * least
        held &= left > 0.0
        reactions[held, friction], reactions[held, stop] = both[held], 0.0
        limits[held, friction, 0], limits[held, stop, 1] = size[held] + left[held], np.inf
        if held.any():
            # It may have slipped as far as to the end of the clearance.
            room = room + rate * least / stiffness
            slack[slips] = max(float(room[held].max()), 0.0)
            turned[held & (rate > 0.0), k] = least[held & (rate > 0.0)]
            shared += _columns(claim, friction, stop)
    if shared:
        answers = replace(claim.answers, radial_reaction=reactions)
        every = np.broadcast_to(slack, (claim.count, len(slack)))
        claim = replace(claim, answers=answers, limits=limits, slack=every)
    return HeldSlips(claim, np.array(shared, dtype=np.intp), turned)


def _rate(claim: Claim, spline: int) -> Array:
    """Return the friction per torque of a spline [1/m], (S or 1,); 0 where it is fixed."""
    fixed, rate = (claim.situations.spline[:, spline, j] for j in (3, 4))
    return np.where(np.isnan(fixed), np.abs(rate), 0.0)


def _widest(claim: Claim, spline: int, rate: Array, least: Array) -> tuple[Array, Array]:
    """Return the most room that friction leaves a spline, (S,) [m], up to a torque error [N·m].

    Where friction follows the torque, less torque leaves more room.
    """
    stiffness, clearance = (claim.situations.spline[:, spline, j] for j in (0, 2))
    claims = claim.columns.claims
    bound = claim.graphs[:, claims.splines][:, spline, 2]
    follows, per_torque = rate > 0.0, np.where(rate > 0.0, rate, 1.0)
    over = (bound * (1.0 - EPS) - stiffness * clearance) / per_torque
    wider = np.maximum(least - over, 0.0) * per_torque / stiffness
    room = np.where(follows, wider, claim.graphs[:, claims.spline_stops][:, spline, 3])
    return room, np.where(follows, np.maximum(over, least), np.inf)


def _columns(claim: Claim, *radials: int) -> list[int]:
    """Return the numbers of the columns of some radial elements."""
    each = map(claim.columns.both, radials)
    return [column for both in each for column in range(both.start, both.stop)]
