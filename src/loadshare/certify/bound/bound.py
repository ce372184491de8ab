r"""A bound on the distance of a claimed equilibrium from the exact one.

Residuals that are small in force and length do not bound torques where stiff parts share through
soft ones. Here the error is bounded itself. With the residuals of a claim, in twice the working
precision,

.. math:: r_f = f - A^T F, \qquad r_o = A X - g - \delta(F),

the linearised error is :math:`\Delta F = P r_f + N z`, where :math:`A^T P = 1`, :math:`A^T N = 0`
and

.. math:: N^T D N\, z = N^T (r_o - D P r_f), \qquad \Delta X = P^T (D\,\Delta F - r_o),

D the compliances of what acts. Common shifts drop out with :math:`N^T A = 0`, whatever the ratio
of stiffnesses. What the linearisation leaves out (curvature of laws, turning directions, rounding
of all that is computed here) is bounded over a box around the claim, and the box is accepted only
if the exact error is thereby shown to lie in it (Krawczyk; Rump, Acta Numerica 19, 2010). Last,
every force and gap that decides which elements act must keep its sign all over the box: then what
acts was identified rightly, and the exact equilibrium of the case is the one in the box. Source:
formulation, section 16.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from loadshare.certify.bound.claim import EPS, Claim
from loadshare.certify.bound.columns import Columns
from loadshare.certify.bound.laws import Act, Codes, Elements, elements
from loadshare.settings import BOUND

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Box:
    """Where the exact equilibria of S claims lie; infinite where nothing was proved.

    Attributes
    ----------
    force : ndarray, shape (S, m)
        Largest error of the columns' forces [N].
    coordinate : ndarray, shape (S, n)
        Largest error of the coordinates [m]; infinite for those that nothing determines.
    doubtful : ndarray of bool, shape (S, elements)
        Elements of which it is not proved how they act.
    above : ndarray of bool, shape (S, elements)
        Whether a doubtful radial element may act as further out or under more force.
    unbalanced : ndarray of bool, shape (S,)
        Whether what acts cannot carry the load.
    """

    force: Array
    coordinate: Array
    doubtful: Flags
    above: Flags
    unbalanced: Flags

    def part(self, row: int) -> Box:
        """Return the box of one claim."""
        return Box(*(getattr(self, f.name)[row : row + 1] for f in fields(self)))

    def put(self, rows: NDArray[np.intp], other: Box) -> None:
        """Write the boxes of some claims."""
        for f in fields(self):
            getattr(self, f.name)[rows] = getattr(other, f.name)

    @classmethod
    def unproved(cls, claim: Claim, act: Codes) -> Box:
        """Return boxes without end."""
        columns = claim.columns
        return cls(
            np.full((claim.count, len(columns.names)), np.inf),
            np.full((claim.count, len(columns.coordinates)), np.inf),
            np.zeros(act.shape, dtype=bool),
            np.zeros(act.shape, dtype=bool),
            np.zeros(claim.count, dtype=bool),
        )


def boxes(claim: Claim, act: Codes, scale: Array, verge: Flags | None = None) -> Box:
    """Bound the errors of S claims, taking their elements to act as given.

    Parameters
    ----------
    claim : Claim
    act : ndarray of int8, shape (S, elements)
    scale : ndarray, shape (S,)
        Load of the claims [N].
    """
    verge = np.zeros(act.shape, dtype=bool) if verge is None else verge
    box = _boxes(claim, act, scale, verge, BOUND.soft)
    rows = np.flatnonzero(np.isinf(box.force).any(axis=1))
    if claim.columns.pairs and len(rows):
        # What holds a coordinate may be no more than the turning of a light force.
        other = _boxes(claim.take(rows), act[rows], scale[rows], verge[rows], BOUND.softest)
        unbounded = [np.isinf(b.force[:, claim.columns.flanks]).sum(axis=1) for b in (box, other)]
        better = np.flatnonzero(unbounded[1] <= unbounded[0][rows])
        box.put(rows[better], Box(*(getattr(other, f.name)[better] for f in fields(Box))))
    return box


def _boxes(claim: Claim, act: Codes, scale: Array, verge: Flags, softest: float) -> Box:
    """Bound errors with turns of light forces as soft as `softest` times the softest element."""
    found = elements(claim, act, scale, verge, softest)
    left, rounding = claim.balance(found.force)
    rounding = rounding + found.rounding @ np.abs(claim.columns.matrix.high)
    box = Box.unproved(claim, act)
    _, first, group = np.unique(
        np.packbits(found.active, axis=1), axis=0, return_index=True, return_inverse=True
    )
    for number, sample in enumerate(first):
        rows = np.flatnonzero(group.reshape(-1) == number)
        part = _Part(claim, found, rows, np.flatnonzero(found.active[sample]), left, rounding)
        force, coordinate = part.solve(scale[rows])
        # What goes along a free move may end at a contact that does not act.
        box.force[rows] = aside(claim, found, rows) + part.stray[:, None]
        box.force[np.ix_(rows, part.columns)] += force + part.shared
        box.coordinate[rows] = coordinate + np.where(part.statics.loose, np.inf, 0.0)
        box.doubtful[rows], box.above[rows] = part.doubts(found, force, coordinate)
        box.unbalanced[rows] = part.stray > rounding_of(found.force[rows], scale[rows])
    return box


def rounding_of(force: Array, scale: Array) -> Array:
    """Load along a move that nothing resists that counts as rounding, (S,) [N].

    Parameters
    ----------
    force : ndarray, shape (S, m)
        Of the columns [N].
    scale : ndarray, shape (S,)
        Load of the claims [N].
    """
    largest = np.abs(force).max(axis=1, initial=0.0)
    return np.asarray(np.maximum(BOUND.balanced * scale, BOUND.rounded * largest))


def _yielding(soft: Array, skew: Array, at: NDArray[np.intp], force: Array) -> Array:
    """D F: compliances, and those off the diagonal of the pairs that begin at some columns."""
    moved = soft * force
    moved[..., at] += skew * force[..., at + 1]
    moved[..., at + 1] += skew * force[..., at]
    return np.asarray(moved)


def aside(claim: Claim, found: Elements, rows: NDArray[np.intp] | slice) -> Array:
    """What claimed forces are off by whatever acts: what it cannot carry, friction put aside.

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
    """Friction that is put aside, as it follows torques over the splines, (S, n) [N].

    Parameters
    ----------
    columns : Columns
    spare : ndarray, shape (S, radials)
        As in `Elements`.
    torques : ndarray, shape (S, splines)
        Sizes of their errors [N·m].
    """
    radials = slice(columns.pairs - spare.shape[1], None)
    pushed = np.repeat(spare * (torques @ columns.splined[radials].T), 2, axis=1)
    return np.asarray(pushed @ np.abs(columns.matrix.high[columns.radials]))


class _Response:
    """How forces and coordinates answer a load [N] and a gap [m], with one claim's compliances.

    Friction that follows a torque T is part of the answer: with levels B per torque, rooms C per
    torque and T = M F of the response without them, the torque that comes is
    (1 + M P Aᵀ B − M G C)⁻¹ T, G the forces by gaps.

    Parameters
    ----------
    part : _Part
    row : int
        The claim.
    """

    def __init__(self, part: _Part, row: int) -> None:
        known = part.statics
        p, n = known.particular, known.redundant
        self.soft, self.skew = part.soft[row], part.skew[row]
        self.level, self.room = part.level[row], part.room[row]

        def bent(forces: Array) -> Array:
            return _yielding(self.soft, self.skew, part.at, forces.T).T

        m = n.T @ bent(n)
        if not np.isfinite(m).all():
            m = np.zeros_like(m)
        values, vectors = np.linalg.eigh(0.5 * (m + m.T))
        # A self-stress among rigid parts has no compliance: it is left as it is claimed.
        kept = np.abs(values) > BOUND.singular * np.abs(values).max(initial=0.0)
        basis = n @ vectors[:, kept]
        free = n @ vectors[:, ~kept]
        self.shared = np.where(np.abs(free).max(axis=1, initial=0.0) > BOUND.shared, np.inf, 0.0)
        by_gap = basis / values[kept] @ basis.T
        by_load = p - by_gap @ bent(p)
        self.force_by = by_load, by_gap
        self.moved_by = p.T @ bent(by_load), p.T @ (bent(by_gap) - np.eye(len(p)))
        exact = vectors[:, kept].T @ m @ vectors[:, kept] / values[kept]
        self.defect = float(np.abs(exact - np.eye(int(kept.sum()))).sum(axis=1).max(initial=0.0))
        self._follow(part)
        self._sizes = tuple(np.abs(v) for v in (*self.force_by, *self.moved_by))

    def _follow(self, part: _Part) -> None:
        """Let levels and rooms follow the torques over their splines."""
        twist, unit = part.twist, np.eye(len(part.twist))
        by = [twist @ v for v in self.force_by]
        sizes = [np.abs(twist) @ np.abs(v) for v in self.force_by]
        back = part.spread(self.level), part.spread(self.room)
        pushed = part.statics.directions.T @ back[0]
        around = unit + by[0] @ pushed - by[1] @ back[1]
        inverse = np.linalg.pinv(around) if np.isfinite(around).all() else np.zeros_like(unit)
        wrong = np.abs(inverse @ around - unit).sum(axis=1).max(initial=0.0)
        self.defect = float(np.maximum(self.defect, wrong))
        torque_by = inverse @ by[0], inverse @ by[1]

        def followed(ways: tuple[Array, Array]) -> tuple[Array, Array]:
            more = ways[1] @ back[1] - ways[0] @ pushed
            return ways[0] + more @ torque_by[0], ways[1] + more @ torque_by[1]

        elastic, self.moved_by = followed(self.force_by), followed(self.moved_by)
        self.force_by = (
            elastic[0] + back[0] @ torque_by[0],
            elastic[1] + back[0] @ torque_by[1],
        )
        # What cancels over a spline is known to the rounding of its parts.
        spread = EPS * len(part.columns) + min(self.defect, 1.0)
        self._torques = tuple(
            np.abs(v) + spread * np.abs(inverse) @ size
            for v, size in zip(torque_by, sizes, strict=True)
        )

    def step(self, load: Array, gap: Array) -> tuple[Array, Array]:
        """Forces and coordinates, of S loads and gaps."""
        forces, moved = self.force_by, self.moved_by
        return load @ forces[0].T + gap @ forces[1].T, load @ moved[0].T + gap @ moved[1].T

    def reach(self, load: Array, gap: Array) -> tuple[Array, Array, Array]:
        """Largest forces, coordinates and torques over splines under loads and gaps of sizes."""
        f, g, x, y = self._sizes
        t, u = self._torques
        enough = 1.0 / (1.0 - self.defect) if self.defect < 0.5 else np.inf
        return (
            enough * (load @ f.T + gap @ g.T),
            enough * (load @ x.T + gap @ y.T),
            enough * (load @ t.T + gap @ u.T),
        )


class _Part:
    """Claims of which the same columns act."""

    def __init__(
        self,
        claim: Claim,
        found: Elements,
        rows: NDArray[np.intp],
        columns: NDArray[np.intp],
        left: Array,
        rounding: Array,
    ) -> None:
        self.claim, self.found, self.rows, self.columns = claim, found, rows, columns
        self.statics = claim.columns.statics(columns)
        pick = np.ix_(rows, columns)
        self.soft, self.misfit, self.width = found.soft[pick], found.misfit[pick], found.width[pick]
        self.left, self.rounding = left[rows], rounding[rows]
        moves = self.statics.moves
        # Balance along moves that nothing resists is the case's own; only rounding may be left.
        self.stray = np.abs(self.left @ moves).max(axis=1, initial=0.0)
        if moves.size:
            self.stray += EPS * np.abs(found.force[rows]).max(axis=1, initial=0.0)
        self.left = self.left - self.left @ moves @ moves.T
        first = claim.columns.first_pair
        at = np.searchsorted(columns, np.arange(first, found.active.shape[1], 2))
        self.pairs = np.flatnonzero(found.active[rows[0], first::2])
        self.at = at[self.pairs]
        self.skew = found.skew[np.ix_(rows, self.pairs)]
        self._set_following()
        self.shared = np.zeros(len(columns))

    def _set_following(self) -> None:
        """Find the torques over splines [N·m], and what follows them.

        Along the line of each pair a level [1/m] and a room [1/N] per torque, (rows, pairs, 2);
        where next to no torque decides the sense nothing is said to follow. Where nothing follows,
        no torques are looked at.
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
        """Put vectors of the pairs, (pairs, 2), in their columns, by spline: (columns, splines)."""
        spread = np.zeros((len(self.columns), len(self.twist)))
        for k in (0, 1):
            spread[self.at + k] = pairs[:, k, None] * self.splined
        return spread

    def _per_torque(self, vectors: Array, torque: Array) -> Array:
        """Vectors of the pairs per torque, (S, pairs, 2), under torques, in their columns."""
        total = np.zeros((len(torque), len(self.columns)))
        for k in (0, 1):
            total[:, self.at + k] = vectors[:, :, k] * (torque @ self.splined.T)
        return total

    def solve(self, scale: Array) -> tuple[Array, Array]:
        """Largest errors of the forces of these columns and of the coordinates.

        Claims that yield alike share the linear operators of one of them; what they differ by is
        bounded with the rest.
        """
        force = np.full(self.soft.shape, np.inf)
        coordinate = np.full((len(self.rows), len(self.statics.directions.T)), np.inf)
        allowed = rounding_of(self.found.force[self.rows], scale)
        left = np.flatnonzero(self.stray <= allowed)
        for _ in range(BOUND.references):
            if not len(left):
                break
            middle = int(left[len(left) // 2])
            response = _Response(self, middle)
            force[left], coordinate[left] = self._errors(response, left)
            self.shared = np.maximum(self.shared, response.shared)
            left = left[(left != middle) & np.isinf(force[left]).any(axis=1)]
        return force, coordinate

    def _errors(self, response: _Response, rows: NDArray[np.intp]) -> tuple[Array, Array]:
        """Errors of some claims; infinite where they are not proved."""
        known, size = self.statics, len(self.columns)
        soft, skew, misfit = self.soft[rows], self.skew[rows], self.misfit[rows]
        force, moved = response.step(self.left[rows], misfit)
        # What the step leaves of the linear equations, and the rounding of this very figure.
        torque = force @ self.twist.T
        followed = self._per_torque(self.level[rows], torque)
        yielded = _yielding(soft, skew, self.at, force - followed)
        misfit = misfit + self._per_torque(self.room[rows], torque)
        over = np.abs(self.left[rows] - force @ known.directions) + self.rounding[rows]
        over += EPS * size * (np.abs(force) @ np.abs(known.directions))
        # What goes along a free move may end at any contact, and push what that joins.
        over += self.stray[rows][:, None]
        apart = np.abs(misfit + moved @ known.directions.T - yielded) + self.width[rows]
        apart += EPS * size * (np.abs(moved) @ np.abs(known.directions).T + np.abs(misfit))
        sizes = np.abs(force) + np.abs(followed)
        apart += EPS * size * _yielding(np.abs(soft), np.abs(skew), self.at, sizes)
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
        reached = response.reach(over, apart)
        boxes = tuple(np.zeros_like(v) for v in reached)
        left = np.arange(len(rows))
        for _ in range(BOUND.passes):
            boxes = tuple(
                np.maximum(b, BOUND.wider * v) for b, v in zip(boxes, reached, strict=True)
            )
            ends = tuple(b + s[left] for b, s in zip(boxes, steps, strict=True))
            push, gap = self._left_out(rows[left], *ends)
            elastic = boxes[0] + self._per_torque(levels[left], boxes[2])
            gap += _yielding(unlike[0][left], unlike[1][left], self.at, elastic)
            push += self._per_torque(unlike[2][left], boxes[2])
            gap += self._per_torque(unlike[3][left], boxes[2])
            load = over[left] + push @ np.abs(known.directions)
            if len(self.twist):
                load += put_aside(
                    self.claim.columns, self.found.spare[self.rows[rows[left]]], ends[2]
                )
            forces, places, torques = response.reach(load, apart[left] + gap)
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
        self, rows: NDArray[np.intp], reach: Array, ways: Array, torques: Array
    ) -> tuple[Array, Array]:
        """What the linearisation leaves out of forces [N] and of lengths [m] in a box."""
        found, columns = self.found, self.columns
        lengths = ways @ np.abs(self.statics.directions).T
        gap = np.zeros_like(reach)
        pick = np.ix_(self.rows[rows], columns)
        curve, force = found.curve[pick], np.abs(found.force[pick])
        light = force <= 2.0 * reach
        # Over half to twice the force the tangent of a Hertz contact changes by its curvature.
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
            near = np.where(distance > 2.0 * moved, distance, np.nan)
            bow = np.where(lined, moved**2 / near, 0.0)
            turn = np.where(
                lined,
                2.0 * pushed * moved / near
                + 2.0 * size * (moved / near) ** 2
                + found.stiff_error[where] * moved,
                0.0,
            )
            # A torque that passes through zero turns what follows it around.
            claimed = self.torque[rows]
            turned = np.where(claimed > 0.0, 2.0 * np.maximum(torques - claimed, 0.0), torques)
            turned, torques = turned @ self.splined.T, torques @ self.splined.T
            turn += found.follows[where] * turned
            bow += found.shrinks[where] * (turned + torques * np.where(lined, moved / near, 0.0))
            for k in (0, 1):
                gap[:, self.at + k] += bow
                extra[:, self.at + k] += turn
        return extra, gap

    def doubts(self, found: Elements, force: Array, coordinate: Array) -> tuple[Flags, Flags]:
        """Elements of which the errors do not show how they act."""
        columns = self.claim.columns
        errors = np.zeros((len(self.rows), len(columns.names)))
        errors[:, self.columns] = force
        moved = coordinate @ np.abs(columns.matrix.high).T
        doubtful, above = doubts(self.claim, found, self.rows, errors, moved)
        # Errors without a bound tell nothing of the elements.
        bounded = np.asarray(np.isfinite(coordinate).all(axis=1))[:, None]
        return doubtful & bounded, above & bounded


def doubts(
    claim: Claim, found: Elements, rows: NDArray[np.intp], errors: Array, moved: Array
) -> tuple[Flags, Flags]:
    """Elements whose force or gap may change its sign within errors, shape (rows, elements).

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


def _level_errors(claim: Claim, errors: Array, rows: NDArray[np.intp] | slice) -> Array:
    """Errors of the levels of splines that follow the torque, shape (rows, radials) [N]."""
    columns, train = claim.columns, claim.columns.train
    found = np.zeros((len(errors), len(claim.radial_gears)))
    torque = errors[:, columns.flanks] @ np.abs(columns.moments).T
    for q in range(len(train.rounds), found.shape[1]):
        k = (q - len(train.rounds)) % len(train.splines)
        spline = claim.situations.spline[:, k]
        spline = spline[rows] if len(spline) > 1 else spline
        rate, follows = np.abs(spline[:, 4]), np.isnan(spline[:, 3])
        found[:, q] = np.where(follows, np.where(follows, rate, 0.0) * torque[:, k], 0.0)
    return found


def _room(
    claim: Claim,
    found: Elements,
    rows: NDArray[np.intp] | slice,
    act: Codes,
    error: Array,
    moved: Array,
    level_error: Array,
) -> tuple[Flags, Flags]:
    """Whether each arc and radial element stays above and below the ends of its piece."""
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
        Act.STICK: np.isinf(stick) | (reach == 0.0) | (size + error < end - level_error),
        Act.PINNED: (level == 0.0) | (size + error < level - level_error),
        Act.STEP: size + error < level - level_error,
        Act.SLIP: distance + moved < reach,
    }
    for kind, held in is_low.items():
        low[:, part] &= (acts != kind) | held
    for kind, held in is_high.items():
        high[:, part] &= (acts != kind) | held
    return low, high
