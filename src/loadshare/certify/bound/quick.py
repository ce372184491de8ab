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
Claims that cannot be bounded in this way are left to `boxes`. Source: formulation, section 16.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from loadshare.array_types import Array, Flags, Numbers
from loadshare.certify.bound.acts import Act, Acts, alike
from loadshare.certify.bound.bound import Box, aside, put_aside, rounding_of
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
    found = elements(claim, act, scale, None)
    if found.shrinks.any() or (claim.columns.train.slip is not None and found.follows.any()):
        # With memory, the room of a stop follows the torque: a length, not a force.
        return box
    left, rounding = claim.balance(found.force)
    arms = np.abs(claim.columns.moments).sum(axis=1)
    rounding = rounding + put_aside(claim.columns, found.spare, BOUND.noise * scale[:, None] * arms)
    for rows in _groups(claim, act):
        for _ in range(BOUND.references):
            load = np.abs(left) + rounding
            group = _Group(claim, found, rows, doubled, scale[rows], load, rounded)
            if not group.is_covered:
                break
            pick = slice(None) if len(rows) == len(act) else rows
            box.force[pick], box.coordinate[pick] = group.errors(
                left[pick], rounding[pick], scale[pick]
            )
            # Claims whose lines point elsewhere are tried with the line of another claim.
            rows = rows[group.turned]
            if not len(rows):
                break
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


def _groups(claim: Claim, act: Acts) -> list[Numbers]:
    """Return rows with the same codes; of few claims that lean on a ring or spline, each alone.

    Alone, the turn of its line is one more compliance. Many claims share the line of one of them,
    and those whose lines point elsewhere are left to twice the precision.
    """
    groups = alike(act)
    first = act.shape[1] - len(claim.columns.claims.radials)
    if claim.count > BOUND.few or not np.isin(act[:, first:], (Act.STOP, Act.STEP)).any():
        return groups
    return [row for rows in groups for row in np.split(rows, len(rows))]


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

    Elements that push along a line are one column here, along the line of one of the claims.
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
        acts = found.act[rows[0], len(columns.contacts) :]
        first = columns.first_pair
        self.lined = np.flatnonzero((acts == Act.STOP) | (acts == Act.STEP))
        self.slips = np.flatnonzero(acts == Act.SLIP)
        active = found.active[rows[0]].copy()
        for k in (0, 1):
            active[first + 2 * self.lined + k] = False
        self.scalar = np.flatnonzero(active)
        matrix = columns.matrix.high
        self.reference = found.line[rows[len(rows) // 2]][self.lined]
        along = [
            u @ matrix[first + 2 * j : first + 2 * j + 2]
            for u, j in zip(self.reference, self.lined, strict=True)
        ]
        # For a single claim, the turn of a ring's line is one more compliance; arcs turn away.
        self.turning = np.zeros(len(self.lined), dtype=bool)
        if len(rows) == 1:
            self.turning = self.lined >= claim.arcs[1].shape[1]
        across = [
            np.array([-u[1], u[0]]) @ matrix[first + 2 * j : first + 2 * j + 2]
            for u, j in zip(self.reference[self.turning], self.lined[self.turning], strict=True)
        ]
        self.line = slice(len(self.scalar), len(self.scalar) + len(self.lined))
        self.directions = np.concatenate(
            [matrix[self.scalar], np.reshape([*along, *across], (-1, matrix.shape[1]))]
        )
        self.statics = Statics.of(self.directions)
        self.is_sliding = np.zeros(len(self.directions), dtype=bool)
        for k in (0, 1):
            self.is_sliding[np.searchsorted(self.scalar, first + 2 * self.slips + k)] = True
        self.is_left = self.is_sliding.copy()
        self.is_left[self.line.stop :] = True
        self.is_covered = True
        self.over = np.full((len(rows), len(self.directions)), 1.0 / BOUND.secant)
        over = _over_tangents(claim, found, self.pick, scale)
        flanks = np.flatnonzero(self.scalar < columns.flanks.stop)
        self.over[:, flanks] = over[:, self.scalar[flanks]]
        light = found.size[self.pick][:, self.lined] < BOUND.light * scale[:, None]
        self.over[:, self.line][light & claim.rolling[self.lined]] = BOUND.endless
        at = np.flatnonzero(self.scalar >= first)
        centred = np.repeat(found.centred[self.pick], 2, axis=1)[:, self.scalar[at] - first]
        soft = found.soft[self.pick][:, self.scalar[at]]
        self.over[:, at] = np.where(centred > 0.0, centred / soft, self.over[:, at])
        self.is_endless = (self.over > 1.0 / BOUND.secant).any(axis=0)
        self.may_open = (self._at_ends(self._pushed()) < BOUND.light * scale[:, None]).any(axis=0)
        self._set_particular()
        self._set_stiffness()

    def _columns(self, scalar: Array, lined: Array) -> Array:
        """Return figures of all columns of the claims and of the lines, side by side."""
        rest = np.zeros((len(lined), int(self.turning.sum())))
        return np.concatenate([scalar[self.pick][:, self.scalar], lined, rest], axis=1)

    def _pushed(self) -> Array:
        """Return forces of elements that may open, shape (rows, m); infinite for all others."""
        claim, found, pick = self.claim, self.found, self.pick
        columns, arcs = claim.columns, claim.arcs[1].shape[1]
        pushed = np.full(found.force[pick].shape, np.inf)
        pushed[:, columns.contacts] = found.force[pick][:, columns.contacts]
        size = found.size[pick].copy()
        size[:, arcs:][claim.graphs[pick][:, :, 2] > 0.0] = np.inf
        first = columns.first_pair
        # A spring about a centre cannot open.
        size[found.act[pick][:, len(columns.contacts) :] == Act.STICK] = np.inf
        pushed[:, first::2] = pushed[:, first + 1 :: 2] = size
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

    def _at_ends(self, figures: Array) -> Array:
        """Return figures of all columns (rows, m) in the order of `directions`; turns infinite."""
        at = self.claim.columns.first_pair + 2 * self.lined
        turns = np.full((len(figures), int(self.turning.sum())), np.inf)
        return np.concatenate([figures[:, self.scalar], figures[:, at], turns], axis=1)

    def _set_particular(self) -> None:
        """Find how elements that yield in proportion carry a load."""
        self.particular = self.statics.particular
        self.held = self.statics.moves[:, :0]
        light = self.is_left | self.is_endless
        for left in (light | self.may_open, light, self.is_left, self.is_sliding):
            # Elements that may open, or yield without limit, carry loads only if nothing else does.
            self.is_left = left
            known = Statics.of(self.directions[~left]) if left.any() else self.statics
            opening = self.directions[self.may_open & left]
            self.is_covered = self._is_idle(free_moves(known.moves, opening))
            if len(opening):
                # Elements that may open carry what nothing else does, if balance determines it.
                self.held, shared = held_moves(
                    known.moves, self.directions[left], self.claim.columns.force_at_end
                )
                self.is_covered &= self._bears_none(shared)
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
        self.soft[:, self.is_sliding] = 0.0
        least = BOUND.secant * self.soft.min(axis=0)
        if len(self.slips):
            size, distance = (v[pick][:, self.slips] for v in (found.size, found.distance))
            least[self.is_sliding] = np.repeat(BOUND.secant * (distance / size).min(axis=0), 2)
        turning = self.lined[self.turning]
        size, distance = (v[pick][:, turning] for v in (found.size, found.distance))
        most = BOUND.softest * self.soft.max(initial=0.0)
        lateral = np.where(size > 0.0, distance / np.where(size > 0.0, size, 1.0), np.inf)
        lateral = np.minimum(lateral, most)
        least[self.line.stop :] = BOUND.secant * lateral.min(axis=0, initial=np.inf)
        if self.is_left is self.is_sliding:
            self.soft[:, self.line.stop :] = lateral
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
        claim, found, pick, lined = self.claim, self.found, self.pick, self.lined
        columns = claim.columns
        first, matrix = columns.first_pair, np.abs(columns.matrix.high)
        line, size, distance = (v[pick][:, lined] for v in (found.line, found.size, found.distance))
        at = first + 2 * lined
        off = (
            found.misfit[pick][:, at] * line[:, :, 0]
            + found.misfit[pick][:, at + 1] * line[:, :, 1]
        )
        misfit = self._columns(found.misfit, off)
        # A contact without force misses its law only where it overlaps.
        contacts = columns.is_contact[self.scalar]
        idle = contacts & (found.force[pick][:, self.scalar] == 0.0)
        misfit[:, : len(self.scalar)] = np.where(
            idle, np.maximum(misfit[:, : len(self.scalar)], 0.0), misfit[:, : len(self.scalar)]
        )
        over = np.where(at < columns.arcs.stop, np.minimum(off, 0.0), np.maximum(off, 0.0))
        misfit[:, self.line] = np.where(size == 0.0, over, off)
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
        if found.follows[pick].any():
            errors = errors + self._followed(errors)
        angle = np.abs(line - self.reference).sum(axis=2)
        self.turned = (angle > BOUND.angle).any(axis=1)
        linear, box = errors, 2.0 * errors
        near = np.ones(len(errors), dtype=bool)
        # The box is that of the first pass, widened by what the first pass leaves out.
        for _ in (1, 2):
            places = (self.soft * box + np.abs(misfit) + width) @ self.passes
            moved = places @ matrix.T
            if not len(lined):
                break
            way = moved[:, at] + moved[:, at + 1]
            bow = np.where(self.turning, way / distance, 1.0) * np.abs(size) / distance
            push = angle * box[:, self.line] + 2.0 * bow * way
            load = push @ (matrix[at] + matrix[at + 1])
            gap = np.zeros_like(errors)
            gap[:, self.line] = angle * way + way**2 / distance
            more, extra = self._with(np.zeros_like(errors), np.zeros(len(errors)), load, gap)
            errors = linear + more + extra[:, None] * self.sizes
            near = (way <= 0.05 * distance).all(axis=1) & (errors <= box).all(axis=1)
            box = np.where(near[:, None], box, 2.0 * errors)
        whole = aside(claim, found, pick)
        whole[:, self.scalar] += errors[:, : len(self.scalar)]
        for k in (0, 1):
            # The line itself may turn.
            whole[:, at + k] += errors[:, self.line]
            whole[:, at[self.turning] + k] += errors[:, self.line.stop :]
            if len(lined):
                whole[:, at + k] += np.abs(size) / distance * way
        allowed = rounding_of(found.force[pick], scale) + EPS * scale
        whole += np.where(stray <= allowed, ended, np.inf)[:, None]
        proved = self._is_proved(whole, places, moved, scale) & near
        self._cover_twins(whole)
        shared = np.abs(self.rigid).max(axis=1, initial=0.0) > BOUND.shared
        whole[:, self.scalar[shared[: len(self.scalar)]]] = np.inf
        for k in (0, 1):
            whole[:, at[shared[self.line]] + k] = np.inf
        whole[~proved], places[~proved] = np.inf, np.inf
        places[:, self.statics.loose] = np.inf
        return whole, places

    def _cover_twins(self, errors: Array) -> None:
        """Give contacts that their twin replaces the twin's errors: they may be those that act."""
        for rows, one, twin in self._twins():
            error = np.maximum(errors[:, one], errors[:, twin])
            errors[:, one] = np.where(rows, error, errors[:, one])

    def _under(self, load: Array, misfit: Array | float) -> tuple[Array, Array]:
        """Return sizes of the forces that carry a load, and of the misfit left to self-stress."""
        force = np.abs(load @ self.particular.T)
        bent = np.sqrt(((misfit @ self.root) ** 2).sum(axis=1))
        return force, bent + (self.soft * force) @ self.sizes

    def _with(self, base: Array, energy: Array, load: Array, gap: Array) -> tuple[Array, Array]:
        """Add the largest effects of loads and gaps of given sizes."""
        return base + load @ self.passes.T, energy + gap @ self.sizes + load @ self.into_energy

    def _followed(self, errors: Array) -> Array:
        """Return the errors due to friction that follows the torque."""
        claim, found, pick = self.claim, self.found, self.pick
        columns = claim.columns
        rates, arms = found.follows[pick], np.abs(columns.moments)
        at = self.scalar[self.scalar < columns.flanks.stop]
        arcs = claim.arcs[1].shape[1]
        total, most = np.zeros_like(errors), np.zeros(len(errors))
        followed = set()
        for pair in np.flatnonzero(rates.any(axis=0)).tolist():
            first = columns.first_pair + 2 * pair
            push = found.line[pick][:, pair] @ columns.matrix.high[first : first + 2]
            force, bent = self._under(push, np.zeros(self.over.shape))
            total += (force + bent[:, None] * self.sizes) * rates[:, pair, None]
            k = (pair - arcs - len(columns.train.rounds)) % len(arms)
            most = np.maximum(most, errors[:, : len(at)] @ arms[k, at])
            followed.add(k)
        back = (total[:, : len(at)] @ arms[np.ix_(sorted(followed), at)].T).max(axis=1)
        enough = np.where(back < BOUND.gain, most / (1.0 - np.minimum(back, BOUND.gain)), np.inf)
        return np.asarray(enough[:, None] * total)

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
        # Friction that is put aside was allowed for up to errors of this size only.
        slight = (errors[:, columns.flanks] <= BOUND.noise * scale[:, None]).all(axis=1)
        proved &= slight | (found.spare[pick] == 0.0).all(axis=1)
        # The curvature of a table is that of a corner within reach.
        proved &= (found.curve[pick] >= 0.0).all(axis=1)
        proved &= (errors <= found.room[pick]).all(axis=1)
        doubtful, _ = doubts(claim, found, self.rows, errors, moved)
        sizes = [
            found.force[pick][:, columns.contacts],
            found.size[pick][:, : claim.arcs[1].shape[1]],
        ]
        carried = np.concatenate(sizes, axis=1)
        closed = found.act[pick][:, : carried.shape[1]] != Act.OPEN
        part = doubtful[:, : carried.shape[1]]
        part[closed] = carried[closed] < 0.0
        # A ring, or a spline without friction, that is touched may as well be open too.
        loose = claim.graphs[pick][:, :, 2] == 0.0
        radials = found.act[pick][:, carried.shape[1] :]
        doubtful[:, carried.shape[1] :] &= ~(loose & (radials == Act.STOP))
        proved &= ~(doubtful & ~self.doubled[pick]).any(axis=1)
        error = self._at_ends(errors)
        pushed = self._at_ends(self._pushed())
        opening = (pushed < np.inf) & (pushed <= error) & (error > 0.0)
        proved &= ~(opening & self.particular.any(axis=1)).any(axis=1)
        one_sided = columns.is_contact.copy()
        one_sided[columns.arcs] = True
        one_sided[columns.radials] = loose.any()
        open_ended = found.active[pick] & one_sided & (force <= errors)
        places[open_ended.any(axis=1)] = np.inf
        return np.asarray(proved)
