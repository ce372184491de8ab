"""How forces and coordinates of a set of columns respond to loads and gaps, to first order.

For the claims in which the same columns act. Source: formulation, section 16.
"""

from __future__ import annotations

import numpy as np

from loadshare.array_types import Array, Numbers
from loadshare.certify.bound.claim import EPS, Claim
from loadshare.certify.bound.elements import Elements
from loadshare.settings import BOUND


class ActingGroup:
    """Claims in which the same columns act."""

    def __init__(
        self,
        claim: Claim,
        found: Elements,
        rows: Numbers,
        columns: Numbers,
        left: Array,
        rounding: Array,
    ) -> None:
        self.claim, self.found, self.rows, self.columns = claim, found, rows, columns
        self.statics = claim.columns.statics(columns)
        pick = np.ix_(rows, columns)
        self.soft, self.misfit, self.width = found.soft[pick], found.misfit[pick], found.width[pick]
        self.left, self.rounding = left[rows], rounding[rows]
        moves = self.statics.moves
        # Balance along moves that nothing resists is a property of the case; only rounding may be
        # left: that of balances, and the part along rounded moves of errors of forces, which are
        # smaller than the forces.
        self.stray = np.abs(self.left @ moves).max(axis=1, initial=0.0)
        if moves.size:
            known, force = self.statics.directions, np.abs(found.force[pick])
            along = np.abs(known @ moves) + EPS * (np.abs(known) @ np.abs(moves))
            spread = (self.rounding @ np.abs(moves) + force @ along).max(axis=1)
            self.stray += np.minimum(spread, EPS * force.max(axis=1, initial=0.0))
        # A load along a free move may end at any contact, and push what that joins.
        self.ended = self.stray * claim.columns.force_at_end(moves)
        self.left = self.left - self.left @ moves @ moves.T
        first = claim.columns.first_pair
        at = np.searchsorted(columns, np.arange(first, found.active.shape[1], 2))
        self.pairs = np.flatnonzero(found.active[rows[0], first::2])
        self.at = at[self.pairs]
        self.skew = found.skew[np.ix_(rows, self.pairs)]
        self._set_following()
        self.shared = np.zeros((len(rows), len(columns)))

    def _set_following(self) -> None:
        """Find the torques over splines [N·m], and what follows them.

        This is a level [1/m] and a room [1/N] per torque along the line of each pair, (rows, pairs,
        2). Where the torque is so small that its sense is uncertain, nothing is taken to follow it.
        Where nothing follows, torques are left out.
        """
        columns, found, where = self.claim.columns, self.found, np.ix_(self.rows, self.pairs)
        rates = found.follows[where], found.shrinks[where], found.spare[self.rows]
        splines = len(columns.moments) if any(v.any() for v in rates) else 0
        flanks = self.columns[self.columns < columns.flanks.stop]
        self.twist = np.zeros((splines, len(self.columns)))
        self.twist[:, : len(flanks)] = columns.moments[:splines, flanks]
        self.splined = columns.splined[self.pairs, :splines]
        claimed = found.force[np.ix_(self.rows, self.columns)]
        torque = claimed @ self.twist.T
        sure = np.abs(torque) > BOUND.light * (np.abs(claimed) @ np.abs(self.twist).T)
        self.torque = np.where(sure, np.abs(torque), 0.0)
        sense = np.where(sure, np.sign(torque), 0.0) @ self.splined.T
        line = found.line[where] * sense[:, :, None]
        self.level, self.room = (v[:, :, None] * line for v in rates[:2])

    def spread(self, pairs: Array) -> Array:
        """Put vectors of pairs (R, pairs, 2) in their columns by spline: (R, columns, splines)."""
        spread = np.zeros((len(pairs), len(self.columns), len(self.twist)))
        for k in (0, 1):
            spread[:, self.at + k] = pairs[:, :, k, None] * self.splined
        return spread

    def per_torque(self, vectors: Array, torque: Array) -> Array:
        """Return vectors of pairs per torque, (S, pairs, 2), times torques, in their columns."""
        total = np.zeros((len(torque), len(self.columns)))
        for k in (0, 1):
            total[:, self.at + k] = vectors[:, :, k] * (torque @ self.splined.T)
        return total


def yielding(soft: Array, skew: Array, at: Numbers, force: Array) -> Array:
    """Return D F: compliances, and those off the diagonal of pairs that begin at some columns."""
    moved = soft * force
    moved[..., at] += skew * force[..., at + 1]
    moved[..., at + 1] += skew * force[..., at]
    return np.asarray(moved)


class Response:
    """Responses of forces and coordinates to loads [N] and gaps [m], with R claims' compliances.

    Friction that follows a torque T is part of the response: with levels B per torque, rooms C per
    torque and T = M F of the response without them, the resulting torque is
    (1 + M P Aᵀ B − M G C)⁻¹ T, with G the forces per gap.

    Parameters
    ----------
    part : ActingGroup
    rows : ndarray of int, shape (R,)
        The claims: one, whose response others share, or as many as respond.
    """

    def __init__(self, part: ActingGroup, rows: Numbers) -> None:
        known = part.statics
        p, n = known.particular, known.redundant
        self.soft, self.skew = part.soft[rows], part.skew[rows]
        self.level, self.room = part.level[rows], part.room[rows]

        def bent(forces: Array) -> Array:
            along = np.swapaxes(forces, -1, -2)
            moved = yielding(self.soft[:, None], self.skew[:, None], part.at, along)
            return np.swapaxes(moved, -1, -2)

        m = n.T @ bent(n)
        m[~np.isfinite(m).all(axis=(1, 2))] = 0.0
        values, vectors = np.linalg.eigh(0.5 * (m + np.swapaxes(m, 1, 2)))
        # A self-stress among rigid parts has no compliance: it is left as claimed.
        size = np.abs(values)
        kept = size > BOUND.singular * size.max(axis=1, initial=0.0)[:, None]
        stiff = np.where(kept, 1.0 / np.where(kept, values, 1.0), 0.0)[:, None]
        basis, free = n @ (vectors * kept[:, None]), n @ (vectors * ~kept[:, None])
        self.shared = np.where(np.abs(free).max(axis=2, initial=0.0) > BOUND.shared, np.inf, 0.0)
        by_gap = (basis * stiff) @ np.swapaxes(basis, 1, 2)
        by_load = p - by_gap @ bent(p)
        self.force_by = by_load, by_gap
        self.moved_by = p.T @ bent(by_load), p.T @ (bent(by_gap) - np.eye(len(p)))
        wrong = np.abs(np.swapaxes(vectors, 1, 2) @ m @ vectors * stiff - np.eye(n.shape[1]))
        wrong *= kept[:, None] & kept[:, :, None]
        self.defect = wrong.sum(axis=2).max(axis=1, initial=0.0)
        self._follow(part)
        self._sizes = tuple(np.abs(v) for v in (*self.force_by, *self.moved_by))

    def _follow(self, part: ActingGroup) -> None:
        """Let levels and rooms follow the torques over their splines."""
        twist, unit = part.twist, np.eye(len(part.twist))
        by = [twist @ v for v in self.force_by]
        sizes = [np.abs(twist) @ np.abs(v) for v in self.force_by]
        back = part.spread(self.level), part.spread(self.room)
        pushed = part.statics.directions.T @ back[0]
        around = unit + by[0] @ pushed - by[1] @ back[1]
        finite = np.isfinite(around).all(axis=(1, 2))
        inverse = np.linalg.pinv(np.where(finite[:, None, None], around, 0.0))
        wrong = np.abs(inverse @ around - unit).sum(axis=2).max(axis=1, initial=0.0)
        self.defect = np.maximum(self.defect, wrong)
        torque_by = inverse @ by[0], inverse @ by[1]

        def followed(ways: tuple[Array, Array]) -> tuple[Array, Array]:
            more = ways[1] @ back[1] - ways[0] @ pushed
            return ways[0] + more @ torque_by[0], ways[1] + more @ torque_by[1]

        elastic, self.moved_by = followed(self.force_by), followed(self.moved_by)
        self.force_by = (
            elastic[0] + back[0] @ torque_by[0],
            elastic[1] + back[0] @ torque_by[1],
        )
        # A sum that cancels over a spline is known only to the rounding of its terms.
        spread = EPS * len(part.columns) + np.minimum(self.defect, 1.0)[:, None, None]
        self._torques = tuple(
            np.abs(v) + spread * np.abs(inverse) @ size
            for v, size in zip(torque_by, sizes, strict=True)
        )

    def step(self, load: Array, gap: Array) -> tuple[Array, Array]:
        """Return forces and coordinates under S loads and gaps."""
        ways = self.force_by, self.moved_by
        force, moved = (_times(one, load) + _times(other, gap) for one, other in ways)
        return force, moved

    def reach(self, load: Array, gap: Array, rows: Numbers) -> tuple[Array, Array, Array]:
        """Return the largest forces, coordinates and spline torques for sizes of loads and gaps.

        Parameters
        ----------
        load, gap : ndarray, shape (S, n) and (S, k)
        rows : ndarray of int, shape (S,)
            Whose response each one has, if claims have their own.
        """
        pick = slice(None) if len(self.defect) == 1 else rows
        enough = np.where(self.defect < 0.5, 1.0 / (1.0 - self.defect), np.inf)[pick, None]
        f, g, x, y, t, u = (v[pick] for v in (*self._sizes, *self._torques))
        forces, moved, torques = (
            enough * (_times(one, load) + _times(other, gap))
            for one, other in ((f, g), (x, y), (t, u))
        )
        return forces, moved, torques


def _times(matrices: Array, vectors: Array) -> Array:
    """Return the products of vectors (S, n) with one matrix or one for each, (1 or S, k, n)."""
    if len(matrices) == 1:
        return np.asarray(vectors @ matrices[0].T)
    return np.asarray((matrices @ vectors[:, :, None])[:, :, 0])
