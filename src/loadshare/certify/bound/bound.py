r"""A bound on the distance of a claimed equilibrium from the exact one.

Residuals that are small in force and length do not bound torques where stiff parts share a load
through soft ones. Here the error itself is bounded. With the residuals of a claim, in twice the
working precision,

.. math:: r_f = f - A^T F, \qquad r_o = A X - g - \delta(F),

the linearised error is :math:`\Delta F = P r_f + N z`, where :math:`A^T P = 1`, :math:`A^T N = 0`
and

.. math:: N^T D N\, z = N^T (r_o - D P r_f), \qquad \Delta X = P^T (D\,\Delta F - r_o),

with D the compliances of the elements that act. Common shifts drop out because :math:`N^T A = 0`,
whatever the ratio of stiffnesses. What the linearisation leaves out (curvature of laws, turning
directions, rounding of all that is computed here) is bounded over a box around the claim, and the
box is accepted only if this proves that the exact error lies in it (Krawczyk; Rump, Acta Numerica
19, 2010). Finally, every force and gap that decides which elements act must keep its sign
throughout the box: then the acting elements were identified correctly, and the exact equilibrium of
the case is the one in the box. Source: formulation, section 16.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from loadshare.array_types import Array, Flags, Numbers
from loadshare.certify.bound.acts import Acts, alike
from loadshare.certify.bound.claim import EPS, Claim
from loadshare.certify.bound.columns import Columns
from loadshare.certify.bound.elements import Elements
from loadshare.certify.bound.laws import elements
from loadshare.certify.bound.response import ActingGroup, Response, yielding
from loadshare.certify.bound.signs import doubts
from loadshare.settings import BOUND


@dataclass(frozen=True, eq=False)
class Box:
    """Boxes in which the exact equilibria of S claims lie; infinite where nothing was proved.

    Attributes
    ----------
    force : ndarray, shape (S, m)
        Largest error of the columns' forces [N].
    coordinate : ndarray, shape (S, n)
        Largest error of the coordinates [m]; infinite for those that nothing determines.
    doubtful : ndarray of bool, shape (S, elements)
        Elements for which it is not proved how they act.
    above : ndarray of bool, shape (S, elements)
        Whether a doubtful radial element may act as it does further out or under more force.
    unbalanced : ndarray of bool, shape (S,)
        Whether the acting elements cannot carry the load.
    """

    force: Array
    coordinate: Array
    doubtful: Flags
    above: Flags
    unbalanced: Flags

    def take(self, rows: Numbers) -> Box:
        """Return the boxes of some claims."""
        return Box(*(getattr(self, f.name)[rows] for f in fields(self)))

    def put(self, rows: Numbers, other: Box) -> None:
        """Write the boxes of some claims."""
        for f in fields(self):
            getattr(self, f.name)[rows] = getattr(other, f.name)

    @classmethod
    def unproved(cls, claim: Claim, act: Acts) -> Box:
        """Return infinite boxes."""
        columns = claim.columns
        return cls(
            np.full((claim.count, len(columns.names)), np.inf),
            np.full((claim.count, len(columns.coordinates)), np.inf),
            np.zeros(act.shape, dtype=bool),
            np.zeros(act.shape, dtype=bool),
            np.zeros(claim.count, dtype=bool),
        )


def boxes(claim: Claim, act: Acts, scale: Array, verge: Flags | None = None) -> Box:
    """Bound the errors of S claims, assuming that their elements act as given.

    Parameters
    ----------
    claim : Claim
    act : ndarray of int8, shape (S, elements)
    scale : ndarray, shape (S,)
        Load of the claims [N].
    verge : ndarray of bool, shape (S, elements), optional
        Elements that may be on either side of their limit; none by default.
    """
    verge = np.zeros(act.shape, dtype=bool) if verge is None else verge
    box = _boxes(claim, act, scale, verge, BOUND.soft)
    rows = np.flatnonzero(np.isinf(box.force).any(axis=1))
    if claim.columns.pairs and len(rows):
        # A coordinate may be held by nothing but the turning of a light force.
        other = _boxes(claim.take(rows), act[rows], scale[rows], verge[rows], BOUND.softest)
        unbounded = [np.isinf(b.force[:, claim.columns.flanks]).sum(axis=1) for b in (box, other)]
        better = np.flatnonzero(unbounded[1] <= unbounded[0][rows])
        box.put(rows[better], other.take(better))
    return box


def _boxes(claim: Claim, act: Acts, scale: Array, verge: Flags, softest: float) -> Box:
    """Bound errors with turns of light forces as soft as `softest` times the softest element."""
    found = elements(claim, act, scale, verge, softest)
    left, rounding = claim.balance(found.force)
    rounding = rounding + found.rounding @ np.abs(claim.columns.matrix.high)
    box = Box.unproved(claim, act)
    for rows in alike(found.active):
        acting = np.flatnonzero(found.active[rows[0]])
        part = _Enclosure(claim, found, rows, acting, left, rounding)
        force, coordinate = part.solve(scale[rows])
        box.force[rows] = aside(claim, found, rows) + part.ended[:, None]
        box.force[np.ix_(rows, part.columns)] += force + part.shared
        box.coordinate[rows] = coordinate + np.where(part.statics.loose, np.inf, 0.0)
        box.doubtful[rows], box.above[rows] = part.doubts(found, force, coordinate)
        box.unbalanced[rows] = part.stray > rounding_of(found.force[rows], scale[rows])
    return box


def rounding_of(force: Array, scale: Array) -> Array:
    """Return the load along a move that nothing resists that counts as rounding, (S,) [N].

    Parameters
    ----------
    force : ndarray, shape (S, m)
        Forces of the columns [N].
    scale : ndarray, shape (S,)
        Load of the claims [N].
    """
    largest = np.abs(force).max(axis=1, initial=0.0)
    return np.asarray(np.maximum(BOUND.balanced * scale, BOUND.rounded * largest))


def aside(claim: Claim, found: Elements, rows: Numbers | slice) -> Array:
    """Return errors of claimed forces apart from the box: parts not carried, friction put aside.

    Shape (rows, m) [N].
    """
    claimed, force = claim.forces[rows], found.force[rows]
    apart = np.abs(claimed - force)
    arcs, radials = claim.columns.arcs, claim.columns.radials
    apart[:, radials] += found.rounding[rows][:, radials]
    if arcs.start < arcs.stop:
        size = np.abs(claimed[:, arcs][:, ::2])
        left = np.where(found.active[rows][:, arcs][:, ::2], 0.0, size)
        apart[:, arcs] = np.repeat(left, 2, axis=1)
    return np.asarray(apart)


def put_aside(columns: Columns, spare: Array, torques: Array) -> Array:
    """Return the load by friction that is put aside, as it follows torque errors, (S, n) [N].

    Parameters
    ----------
    columns : Columns
    spare : ndarray, shape (S, radials)
        As in `Elements`.
    torques : ndarray, shape (S, splines)
        Sizes of the errors of torques over the splines [N·m].
    """
    radials = slice(columns.pairs - spare.shape[1], None)
    pushed = np.repeat(spare * (torques @ columns.splined[radials].T), 2, axis=1)
    return np.asarray(pushed @ np.abs(columns.matrix.high[columns.radials]))


class _Enclosure(ActingGroup):
    """Claims in which the same columns act, and the boxes that enclose their errors."""

    def solve(self, scale: Array) -> tuple[Array, Array]:
        """Bound the errors of the forces of these columns and of the coordinates.

        Claims that yield alike share the linear operators of one of them; their differences are
        bounded with the rest. Those that this does not prove have operators of their own.
        """
        force = np.full(self.soft.shape, np.inf)
        coordinate = np.full((len(self.rows), len(self.statics.directions.T)), np.inf)
        allowed = rounding_of(self.found.force[self.rows], scale)
        left = np.flatnonzero(self.stray <= allowed)

        def bound(rows: Numbers, whose: Numbers) -> None:
            response = Response(self, whose)
            force[rows], coordinate[rows] = self._errors(response, rows)
            self.shared[rows] = np.maximum(self.shared[rows], response.shared)

        if len(left):
            middle = left[len(left) // 2]
            bound(left, middle[None])
            left = left[(left != middle) & np.isinf(force[left]).any(axis=1)]
        size = len(self.columns) * sum(self.statics.directions.shape)
        together = max(BOUND.operators // max(size, 1), 1)
        for at in range(0, len(left), together):
            rows = left[at : at + together]
            bound(rows, rows)
        return force, coordinate

    def _errors(self, response: Response, rows: Numbers) -> tuple[Array, Array]:
        """Return the errors of some claims; infinite where they are not proved."""
        known, size = self.statics, len(self.columns)
        soft, skew, misfit = self.soft[rows], self.skew[rows], self.misfit[rows]
        force, moved = response.step(self.left[rows], misfit)
        # Residual of the step in the linear equations, and the rounding of this residual itself.
        torque = force @ self.twist.T
        followed = self.per_torque(self.level[rows], torque)
        yielded = yielding(soft, skew, self.at, force - followed)
        misfit = misfit + self.per_torque(self.room[rows], torque)
        over = np.abs(self.left[rows] - force @ known.directions) + self.rounding[rows]
        over += EPS * size * (np.abs(force) @ np.abs(known.directions))
        over += self.ended[rows][:, None]
        apart = np.abs(misfit + moved @ known.directions.T - yielded) + self.width[rows]
        apart += EPS * size * (np.abs(moved) @ np.abs(known.directions).T + np.abs(misfit))
        sizes = np.abs(force) + np.abs(followed)
        apart += EPS * size * yielding(np.abs(soft), np.abs(skew), self.at, sizes)
        unlike = tuple(
            np.abs(one - other)
            for one, other in (
                (soft, response.soft),
                (skew, response.skew),
                (self.level[rows], response.level),
                (self.room[rows], response.room),
            )
        )
        levels = np.abs(self.level[rows])
        found = np.full(force.shape, np.inf), np.full(moved.shape, np.inf)
        steps = np.abs(force), np.abs(moved), np.abs(torque)
        left = np.arange(len(rows))
        reached = response.reach(over, apart, left)
        boxes = tuple(np.zeros_like(v) for v in reached)
        for _ in range(BOUND.passes):
            boxes = tuple(
                np.maximum(b, BOUND.wider * v) for b, v in zip(boxes, reached, strict=True)
            )
            ends = tuple(b + s[left] for b, s in zip(boxes, steps, strict=True))
            push, gap = self._left_out(rows[left], *ends)
            elastic = boxes[0] + self.per_torque(levels[left], boxes[2])
            gap += yielding(unlike[0][left], unlike[1][left], self.at, elastic)
            push += self.per_torque(unlike[2][left], boxes[2])
            gap += self.per_torque(unlike[3][left], boxes[2])
            load = over[left] + push @ np.abs(known.directions)
            if len(self.twist):
                load += put_aside(
                    self.claim.columns, self.found.spare[self.rows[rows[left]]], ends[2]
                )
            forces, places, torques = response.reach(load, apart[left] + gap, left)
            reached = forces + push, places, torques
            proved = np.logical_and.reduce(
                [(v <= b).all(axis=1) for v, b in zip(reached, boxes, strict=True)]
            )
            done = left[proved]
            for target, v, step in zip(found, reached, steps, strict=False):
                target[done] = v[proved] + step[done]
            more = ~proved & np.isfinite(reached[0]).all(axis=1)
            left = left[more]
            boxes, reached = (tuple(v[more] for v in part) for part in (boxes, reached))
            if not len(left):
                break
        return found

    def _left_out(
        self, rows: Numbers, reach: Array, ways: Array, torques: Array
    ) -> tuple[Array, Array]:
        """Return what the linearisation leaves out of forces [N] and lengths [m] in a box."""
        found, columns = self.found, self.columns
        lengths = ways @ np.abs(self.statics.directions).T
        gap = np.zeros_like(reach)
        pick = np.ix_(self.rows[rows], columns)
        curve, force = found.curve[pick], np.abs(found.force[pick])
        light = force <= 2.0 * reach
        # From half to twice the force, the tangent of a Hertz contact changes by its curvature.
        gap += np.where(curve > 0.0, 0.5 * curve * reach**2, 0.0)
        gap += np.where(curve < 0.0, -curve * reach, 0.0)
        gap = np.where((curve > 0.0) & light | (reach > found.room[pick]), np.inf, gap)
        extra = np.zeros_like(reach)
        if len(self.at):
            where = np.ix_(self.rows[rows], self.pairs)
            size, distance = np.abs(found.size[where]), found.distance[where]
            moved = np.hypot(lengths[:, self.at], lengths[:, self.at + 1])
            pushed = np.hypot(reach[:, self.at], reach[:, self.at + 1])
            lined = found.stiff_error[where] != 0.0
            begins = found.begins[where]
            near = np.where(distance > 2.0 * moved, distance, np.nan)
            near = np.where(begins, np.inf, near)
            bow = np.where(lined, moved**2 / near, 0.0)
            turn = np.where(
                lined,
                2.0 * pushed * moved / near
                + 2.0 * size * (moved / near) ** 2
                + found.stiff_error[where] * moved,
                0.0,
            )
            # A slip that begins follows its friction, whose direction is known up to its error.
            begun = np.where(2.0 * pushed < size, pushed / np.where(begins, size, 1.0), np.inf)
            bow = np.where(begins, 2.0 * begun * moved, bow)
            turn = np.where(begins, begun * pushed + found.stiff_error[where] * moved, turn)
            # A torque that passes through zero reverses what follows it.
            claimed = self.torque[rows]
            turned = np.where(claimed > 0.0, 2.0 * np.maximum(torques - claimed, 0.0), torques)
            turned, torques = turned @ self.splined.T, torques @ self.splined.T
            turn += found.follows[where] * turned
            bent = found.bent[where]
            spread = np.where(2.0 * pushed < size, 0.5 * bent * pushed**2, np.inf)
            bow += np.where(bent > 0.0, spread, 0.0)
            bow += found.shrinks[where] * (turned + torques * np.where(lined, moved / near, 0.0))
            for k in (0, 1):
                gap[:, self.at + k] += bow
                extra[:, self.at + k] += turn
        return extra, gap

    def doubts(self, found: Elements, force: Array, coordinate: Array) -> tuple[Flags, Flags]:
        """Return the elements for which the errors do not show how they act."""
        columns = self.claim.columns
        errors = np.zeros((len(self.rows), len(columns.names)))
        errors[:, self.columns] = force
        moved = coordinate @ np.abs(columns.matrix.high).T
        doubtful, above = doubts(self.claim, found, self.rows, errors, moved)
        # Errors without a bound say nothing about the elements.
        bounded = np.asarray(np.isfinite(coordinate).all(axis=1))[:, None]
        return doubtful & bounded, above & bounded
