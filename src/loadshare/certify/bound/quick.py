r"""The bound of many claims at once, from the convexity of the complementary energy.

Every law is monotone along the way from a claim to the exact equilibrium, so that with compliances
D below which no element falls

.. math:: \Delta F^T D\,\Delta F \le \lvert \Delta F^T \epsilon \rvert, \qquad
    \Delta F = P r_f + N z,

with ε the misfits of the laws. With :math:`L L^T = N (N^T D N)^{-1} N^T` this gives

.. math:: \lvert \Delta F_e \rvert \le \lvert P r_f \rvert_e
    + \lVert L_e \rVert\, \bigl(\lVert L^T \epsilon \rVert
    + \textstyle\sum_k \lVert L_k \rVert\, \bar D_k \lvert P r_f \rvert_k \bigr),

where no element exceeds the compliances :math:`\bar D`. D is taken as the smallest compliances
among claims in which the same elements act, so that L is the same for all of them: a claim costs
two small products. The last term holds for elements that stay closed: a contact that opens may move
by any length. So a load is assigned to elements whose force exceeds its error, or that cannot open.
Claims that cannot be bounded in this way, and those in which a round ring or a spline pushes along
a line of its own, are left to `boxes`. Source: formulation, section 16.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from loadshare.array_types import Array, Flags, Numbers
from loadshare.certify.bound.acts import Act, Acts, alike
from loadshare.certify.bound.bound import Box, aside, rounding_of
from loadshare.certify.bound.claim import EPS, Claim
from loadshare.certify.bound.elements import Elements
from loadshare.certify.bound.laws import elements
from loadshare.certify.bound.signs import doubts
from loadshare.certify.bound.statics import Statics, free_moves, held_moves
from loadshare.settings import BOUND


def quick_boxes(claim: Claim, act: Acts, scale: Array, rounded: bool = False) -> Box:
    """Bound the errors of S claims; infinite where nothing is shown.

    Parameters
    ----------
    claim : Claim
    act : ndarray of int8, shape (S, elements)
    scale : ndarray, shape (S,)
        Load of the claims [N].
    rounded : bool
        Take parts of moves for zero that are no more than the rounding of the moves.
    """
    box = Box.unproved(claim, act)
    act, doubled = _with_near(claim, act)
    radials = act[:, act.shape[1] - len(claim.columns.claims.radials) :]
    lined = (Act.STEP, Act.SLIP, Act.STOP)
    groups = [rows for rows in alike(act) if not np.isin(radials[rows[0]], lined).any()]
    if not groups:
        return box
    found = elements(claim, act, scale, None)
    left, rounding = claim.balance(found.force)
    load = np.abs(left) + rounding
    for rows in groups:
        # Friction that is put aside follows errors of torques, which are not known here.
        if found.spare[rows].any():
            continue
        group = _Group(claim, found, rows, doubled, scale[rows], load, rounded)
        if group.is_covered:
            pick = group.pick
            box.force[pick], box.coordinate[pick] = group.errors(
                left[pick], rounding[pick], scale[pick]
            )
    return box


def _with_near(claim: Claim, act: Acts) -> tuple[Acts, Flags]:
    """Return ways of acting with nearly touching contacts closed, and which a twin replaces.

    Two opposed contacts of a ring, without clearance between them, are one contact that holds both
    ways; arcs only if none of the neighbours can be displaced.
    """
    columns = claim.columns
    flanks, contacts = columns.flanks.stop, len(columns.contacts)
    gaps, force = claim.gaps, claim.pushes
    widest = np.abs(gaps).max(axis=1, initial=0.0)
    act = act.copy()
    part = act[:, : gaps.shape[1]]
    part[(part == Act.OPEN) & (gaps <= BOUND.near * widest[:, None])] = Act.STOP
    doubled = np.zeros(act.shape, dtype=bool)
    ways = claim.arcs[0]
    for start in (*range(flanks, contacts, 2), *range(contacts, gaps.shape[1], 2)):
        both = (part[:, start] == Act.STOP) & (part[:, start + 1] == Act.STOP)
        if start >= contacts:
            one, other = ways[:, start - contacts], ways[:, start - contacts + 1]
            sizes = np.sqrt((one**2).sum(axis=1) * (other**2).sum(axis=1))
            both &= (one * other).sum(axis=1) < -BOUND.opposed * sizes
            both &= columns.between_fixed[(start - contacts) // 2]
        for k in (0, 1):
            weaker = force[:, start + k] < force[:, start + 1 - k] + k * np.finfo(float).tiny
            doubled[both & weaker, start + k] = True
    act[doubled] = Act.OPEN
    if claim.columns.claims.radials:
        length = claim.lengths[0].value[:, columns.radials].reshape(claim.count, -1, 2)
        left = claim.graphs[:, :, 3] - np.sqrt((length**2).sum(axis=2))
        radials = act[:, gaps.shape[1] :]
        radials[(radials == Act.OPEN) & (left <= BOUND.near * widest[:, None])] = Act.STOP
    return act, doubled


def _over_tangents(claim: Claim, found: Elements, rows: Numbers | slice, scale: Array) -> Array:
    """Return the largest compliance of flanks between two forces, over the tangent's.

    Shape (rows, flanks).

    The tangent of a light Hertz contact is taken at more than its force.
    """
    flanks = claim.columns.flanks
    force, least = found.force[rows][:, flanks], BOUND.light * scale[:, None]
    with np.errstate(divide="ignore"):
        light = np.minimum(1.5 * np.cbrt(least / force), BOUND.endless)
    hertz = np.broadcast_to(claim.situations.hertz, (claim.count, claim.situations.hertz.shape[1]))
    some = hertz[rows] > 0.0
    return np.where(some & (force < least), light, 1.0 / BOUND.secant)


class _Group:
    """Claims whose elements act alike.

    An arc is one column here, along its line in one of the claims.
    """

    def __init__(
        self,
        claim: Claim,
        found: Elements,
        rows: Numbers,
        doubled: Flags,
        scale: Array,
        load: Array,
        rounded: bool,
    ) -> None:
        self.claim, self.found, self.rows, self.doubled = claim, found, rows, doubled
        self.load, self.rounded = load[rows], rounded
        columns = claim.columns
        self.pick = slice(None) if len(rows) == len(found.act) else rows
        active = found.active[rows[0]].copy()
        self.lined = np.flatnonzero(active[columns.arcs][::2])
        active[columns.arcs] = False
        self.scalar = np.flatnonzero(active)
        matrix = columns.matrix.high
        self.at = columns.arcs.start + 2 * self.lined
        self.reference = found.line[rows[len(rows) // 2]][self.lined]
        along = np.einsum("ja,jan->jn", self.reference, matrix[self.at[:, None] + (0, 1)])
        self.directions = np.concatenate([matrix[self.scalar], along])
        self.arcs = slice(len(self.scalar), None)
        self.statics = Statics.of(self.directions)
        self.is_covered = True
        self.over = np.full((len(rows), len(self.directions)), 1.0 / BOUND.secant)
        over = _over_tangents(claim, found, self.pick, scale)
        flanks = np.flatnonzero(self.scalar < columns.flanks.stop)
        self.over[:, flanks] = over[:, self.scalar[flanks]]
        self.is_endless = (self.over > 1.0 / BOUND.secant).any(axis=0)
        self.may_open = (self._ends(self._pushed()) < BOUND.light * scale[:, None]).any(axis=0)
        self._set_particular()
        self._set_stiffness()

    def _columns(self, scalar: Array, lined: Array) -> Array:
        """Return figures of all columns of the claims and of the lines, side by side."""
        return np.concatenate([scalar[self.pick][:, self.scalar], lined], axis=1)

    def _ends(self, figures: Array) -> Array:
        """Return figures of all columns (rows, m) in the order of `directions`."""
        return np.concatenate([figures[:, self.scalar], figures[:, self.at]], axis=1)

    def _pushed(self) -> Array:
        """Return forces of contacts, which may open, shape (rows, m); infinite for all others."""
        found, pick, columns = self.found, self.pick, self.claim.columns
        pushed = np.full(found.force[pick].shape, np.inf)
        pushed[:, columns.contacts] = found.force[pick][:, columns.contacts]
        arcs = self.claim.arcs[1].shape[1]
        pushed[:, columns.arcs] = np.repeat(found.size[pick][:, :arcs], 2, axis=1)
        # Of two contacts without clearance between them, one takes what the other cannot.
        for rows, _, twin in self._twins():
            pushed[rows, twin] = np.inf
        return pushed

    def _twins(self) -> Iterator[tuple[Flags, int, int]]:
        """Yield contacts that their twin replaces: in which claims, and a column of each."""
        columns = self.claim.columns
        contacts, first = len(columns.contacts), columns.flanks.stop
        at = [*columns.contacts.tolist(), *range(columns.arcs.start, columns.arcs.stop, 2)]
        doubled = self.doubled[self.pick][:, : len(at)]
        for e in np.flatnonzero(doubled.any(axis=0)).tolist():
            twin = first + ((e - first) ^ 1)
            for k in (0,) if e < contacts else (0, 1):
                yield doubled[:, e], at[e] + k, at[twin] + k

    def _set_particular(self) -> None:
        """Find how elements that yield in proportion carry a load."""
        self.particular = self.statics.particular
        self.held = self.statics.moves[:, :0]
        # Elements that may open, or yield without limit, carry loads only if nothing else does.
        light = self.is_endless
        for left in (light | self.may_open, light, np.zeros_like(light)):
            self.is_left = left
            known = Statics.of(self.directions[~left]) if left.any() else self.statics
            opening = self.directions[self.may_open & left]
            self.is_covered = self._is_idle(free_moves(known.moves, opening))
            if len(opening):
                # Elements that may open carry what nothing else does, if balance determines it.
                self.held, is_determined = held_moves(
                    known.moves, self.directions[left], self.claim.columns.force_at_end
                )
                self.is_covered &= is_determined or self._bears_none(self.held)
            if self.is_covered:
                self.particular = np.zeros(self.particular.shape)
                self.particular[~left] = known.particular
                break

    def _is_idle(self, moves: Array) -> bool:
        """Return whether no load is left along moves, beyond those that nothing at all resists.

        Gears that carry nothing have none, to the last digit.
        """
        moves = moves - self.statics.moves @ (self.statics.moves.T @ moves)
        along = (self.load @ np.abs(moves)).max(axis=1, initial=0.0)
        return bool((along <= EPS * len(moves) * self.load.max(axis=1, initial=0.0)).all())

    def _bears_none(self, moves: Array) -> bool:
        """Return whether the elements that hold moves carry nothing."""
        ways = np.abs(moves)
        if self.rounded:
            ways[ways <= BOUND.rounded * ways.max(axis=0, initial=0.0)] = 0.0
        return not (self.load @ ways).any()

    def _set_stiffness(self) -> None:
        """Find L from the smallest compliances."""
        found, pick = self.found, self.pick
        self.soft = self._columns(found.soft, found.along[pick][:, self.lined])
        least = BOUND.secant * self.soft.min(axis=0)
        n = self.statics.redundant
        stiff = n.T @ (least[:, None] * n)
        if not np.isfinite(stiff).all():
            self.is_covered, stiff = False, np.eye(len(stiff))
        values, vectors = np.linalg.eigh(stiff)
        # A self-stress of rigid parts alone has no compliance, and moves nothing else.
        kept = values > BOUND.singular * values.max(initial=0.0)
        self.rigid = n @ vectors[:, ~kept]
        self.root = n @ (vectors[:, kept] / np.sqrt(values[kept]))
        self.sizes = np.sqrt((self.root**2).sum(axis=1))
        self.passes = np.abs(self.particular)
        self.soft *= self.over
        self.into_energy = self.passes.T @ (self.soft.max(axis=0) * self.sizes)

    def errors(self, left: Array, rounding: Array, scale: Array) -> tuple[Array, Array]:
        """Return the errors of all forces and coordinates of the claims."""
        claim, found, pick, at = self.claim, self.found, self.pick, self.at
        columns, matrix = claim.columns, self.claim.columns.sizes
        line, size, distance = (
            v[pick][:, self.lined] for v in (found.line, found.size, found.distance)
        )
        off = (found.misfit[pick][:, at[:, None] + (0, 1)] * line).sum(axis=2)
        misfit = self._columns(found.misfit, off)
        # A contact without force misses its law only where it overlaps.
        contacts = columns.is_contact[self.scalar]
        idle = contacts & (found.force[pick][:, self.scalar] == 0.0)
        misfit[:, : len(self.scalar)] = np.where(
            idle, np.maximum(misfit[:, : len(self.scalar)], 0.0), misfit[:, : len(self.scalar)]
        )
        misfit[:, self.arcs] = np.where(size == 0.0, np.minimum(off, 0.0), off)
        width = self._columns(found.width, found.width[pick][:, at])
        stray = np.zeros(len(left))
        if self.statics.moves.size:
            stray = np.abs(left @ self.statics.moves).max(axis=1) + EPS * scale
        taken = (self.load @ np.abs(self.held)).max(axis=1, initial=0.0)
        # A load along a free move may end at any contact, and push what that joins.
        ended = stray * columns.force_at_end(self.statics.moves)
        rounding = rounding + found.rounding[pick] @ matrix + (ended + taken)[:, None]
        base, energy = self._under(left, misfit)
        base = base + taken[:, None] * self.is_left
        # Where rigid parts contradict one another, one of them is open by that much.
        width = width + np.abs(misfit @ self.rigid) @ np.abs(self.rigid).T
        base, energy = self._with(base, energy, rounding, width)
        errors = base + energy[:, None] * self.sizes
        angle = np.abs(line - self.reference).sum(axis=2)
        linear, box = errors, 2.0 * errors
        near = np.ones(len(errors), dtype=bool)
        # The box is that of the first pass, widened by what the first pass leaves out.
        for _ in (1, 2):
            places = (self.soft * box + np.abs(misfit) + width) @ self.passes
            moved = places @ matrix.T
            way = moved[:, at] + moved[:, at + 1]
            if not len(at):
                break
            push = angle * box[:, self.arcs] + 2.0 * np.abs(size) / distance * way
            load = push @ (matrix[at] + matrix[at + 1])
            gap = np.zeros_like(errors)
            gap[:, self.arcs] = angle * way + way**2 / distance
            more, extra = self._with(np.zeros_like(errors), np.zeros(len(errors)), load, gap)
            errors = linear + more + extra[:, None] * self.sizes
            near = (way <= 0.05 * distance).all(axis=1) & (errors <= box).all(axis=1)
            box = np.where(near[:, None], box, 2.0 * errors)
        whole = aside(claim, found, pick)
        whole[:, self.scalar] += errors[:, : len(self.scalar)]
        for k in (0, 1):
            # The line itself may turn.
            whole[:, at + k] += errors[:, self.arcs] + np.abs(size) / distance * way
        allowed = rounding_of(found.force[pick], scale) + EPS * scale
        whole += np.where(stray <= allowed, ended, np.inf)[:, None]
        proved = self._is_proved(whole, places, moved, scale) & near
        self._cover_twins(whole)
        shared = np.abs(self.rigid).max(axis=1, initial=0.0) > BOUND.shared
        whole[:, self.scalar[shared[: len(self.scalar)]]] = np.inf
        for k in (0, 1):
            whole[:, at[shared[self.arcs]] + k] = np.inf
        whole[~proved], places[~proved] = np.inf, np.inf
        places[:, self.statics.loose] = np.inf
        return whole, places

    def _cover_twins(self, errors: Array) -> None:
        """Give contacts that their twin replaces the twin's errors: they may be those that act."""
        for rows, one, twin in self._twins():
            error = np.maximum(errors[:, one], errors[:, twin])
            errors[:, one] = np.where(rows, error, errors[:, one])

    def _under(self, load: Array, misfit: Array) -> tuple[Array, Array]:
        """Return sizes of the forces that carry a load, and of the misfit left to self-stress."""
        force = np.abs(load @ self.particular.T)
        bent = np.sqrt(((misfit @ self.root) ** 2).sum(axis=1))
        return force, bent + (self.soft * force) @ self.sizes

    def _with(self, base: Array, energy: Array, load: Array, gap: Array) -> tuple[Array, Array]:
        """Add the largest effects of loads and gaps of given sizes."""
        return base + load @ self.passes.T, energy + gap @ self.sizes + load @ self.into_energy

    def _is_proved(self, errors: Array, places: Array, moved: Array, scale: Array) -> Flags:
        """Return whether all that was assumed holds within the errors.

        A closed contact may as well be open in the exact equilibrium: the laws are monotone there
        too. Then the coordinates may differ by more than the forces show.
        """
        claim, found, pick = self.claim, self.found, self.pick
        columns = claim.columns
        force = np.abs(found.force[pick])
        proved = np.isfinite(errors).all(axis=1) & np.isfinite(places).all(axis=1)
        light = np.maximum(force, BOUND.light * scale[:, None])[:, columns.flanks]
        proved &= (errors[:, columns.flanks] <= 0.1 * light).all(axis=1)
        # The curvature of a table is that of a corner within reach.
        proved &= (found.curve[pick] >= 0.0).all(axis=1)
        proved &= (errors <= found.room[pick]).all(axis=1)
        doubtful, _ = doubts(claim, found, self.rows, errors, moved)
        sizes = [
            found.force[pick][:, columns.contacts],
            found.size[pick][:, : claim.arcs[1].shape[1]],
        ]
        pushed = np.concatenate(sizes, axis=1)
        closed = found.act[pick][:, : pushed.shape[1]] != Act.OPEN
        part = doubtful[:, : pushed.shape[1]]
        part[closed] = pushed[closed] < 0.0
        proved &= ~(doubtful & ~self.doubled[pick]).any(axis=1)
        error = self._ends(errors)
        opening = (self._ends(self._pushed()) <= error) & (error > 0.0)
        proved &= ~(opening & self.particular.any(axis=1)).any(axis=1)
        one_sided = columns.is_contact.copy()
        one_sided[columns.arcs] = True
        open_ended = found.active[pick] & one_sided & (force <= errors)
        places[open_ended.any(axis=1)] = np.inf
        return np.asarray(proved)
