"""Claimed equilibria as coordinates, forces and lengths of the columns."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from loadshare.array_types import Array, Flags, Numbers
from loadshare.certify.bound.columns import Columns
from loadshare.certify.bound.twofold import Twofold, exact, minus, plus, product, quotient
from loadshare.certify.graphs import spline_graphs, wall
from loadshare.train.equilibria import Equilibria
from loadshare.train.situations import Situations


@dataclass(frozen=True, eq=False)
class Claim:
    """S claims at their situations.

    Attributes
    ----------
    columns : Columns
    situations : Situations
    answers : Equilibria
    fine : bool
        Whether residuals are found in twice the working precision.
    slack : ndarray, shape (S, m), or None
        By how much the lengths of the columns are left open [m].
    limits : ndarray, shape (S, radials, 2), or None
        Levels [N] and reaches [m] of the radial elements that replace those of their laws.
    """

    columns: Columns
    situations: Situations
    answers: Equilibria
    fine: bool = True
    slack: Array | None = None
    limits: Array | None = None

    @property
    def count(self) -> int:
        """S."""
        return len(self.answers.rotation)

    def take(self, rows: Numbers) -> Claim:
        """Return some of the claims."""
        answers = self.answers.take(rows)
        here = self.situations
        here = here.take(rows) if here.count > 1 else here
        slack, limits = (None if v is None else v[rows] for v in (self.slack, self.limits))
        return Claim(self.columns, here, answers, self.fine, slack, limits)

    @cached_property
    def coordinates(self) -> Array:
        """X, shape (S, n) [m]."""
        columns, train = self.columns, self.columns.train
        x = np.zeros((self.count, len(columns.coordinates)))
        for gear, turn in columns.turns.items():
            if turn.coordinate is not None and not turn.shafts:
                x[:, turn.coordinate] = turn.radius * self.answers.rotation[:, columns.order[gear]]
        for gear, at in columns.places.items():
            moved = self.answers.displacement[:, columns.order[gear]]
            x[:, at : at + 2] = moved @ train.gears[gear].frame.T
        reaction, claims = self.answers.radial_reaction, columns.claims
        friction, stop = reaction[:, claims.splines], reaction[:, claims.spline_stops]
        for k, (gear, at) in enumerate(columns.slips.items()):
            # The spline's shaft bends under the friction and the stop that act on its slip.
            force = friction[:, k] + stop[:, k]
            bent = -force @ train.gears[gear].frame.T / self.situations.spline[:, k, :1]
            place = columns.places[gear]
            x[:, at : at + 2] = x[:, place : place + 2] - bent
        return x

    @cached_property
    def forces(self) -> Array:
        """F as claimed, shape (S, m) [N]; for arcs, the size is in the first of two columns."""
        columns, train, answers = self.columns, self.columns.train, self.answers
        found = np.zeros((self.count, len(columns.names)))
        found[:, columns.flanks] = answers.flank_force
        torques = answers.shaft_torque[:, columns.elastic_shafts]
        found[:, columns.shafts] = torques / columns.shaft_arms
        found[:, columns.bearings] = answers.support_force[:, columns.moving].reshape(
            self.count, -1
        )
        claims = columns.claims
        found[:, columns.stops] = answers.ring_force[:, claims.stops]
        found[:, columns.arcs.start : columns.arcs.stop : 2] = answers.ring_force[:, claims.arcs]
        for q, (_, gear) in enumerate(claims.radials):
            frame = train.gears[gear].frame
            found[:, columns.both(q)] = -answers.radial_reaction[:, q] @ frame.T
        if columns.slips:
            friction, stop = map(columns.all_of, (claims.splines, claims.spline_stops))
            found[:, columns.bends] = found[:, friction] + found[:, stop]
        return found

    @cached_property
    def rest(self) -> tuple[Twofold, Array]:
        """Lengths at X = 0, shape (S, m) [m], and the sum of the sizes of their terms."""
        here, on = self.situations, self.columns.constants
        offset = here.offset.reshape(len(here.offset), -1)
        rows = max(len(offset), len(here.clocking))
        varying = np.concatenate(
            [np.broadcast_to(a, (rows, a.shape[1])) for a in (here.clocking, offset)], axis=1
        )
        gaps = self._gaps()
        if not self.fine:
            return exact(varying @ on - gaps), np.abs(gaps)
        total, sizes = product(varying, on)
        return minus(total, exact(gaps)), sizes + np.abs(gaps)

    def _gaps(self) -> Array:
        """Return gaps, limits and centres, shape (S or 1, m) [m]."""
        columns, train, here = self.columns, self.columns.train, self.situations
        rows = max(map(len, (here.gap, here.stop, here.offset, here.round_offset)))
        gaps = np.zeros((rows, len(columns.names)))
        gaps[:, columns.flanks] = here.gap
        gaps[:, columns.stops] = here.stop.reshape(len(here.stop), -1)
        for q, ring in enumerate(train.rounds):
            gaps[:, columns.both(q)] = here.round_offset[:, q] @ train.gears[ring.gear].frame.T
        if train.slip is not None:
            for q, gear in enumerate(train.splines, columns.claims.splines.start):
                gaps[:, columns.both(q)] = train.gears[gear].frame @ train.slip[gear]
        return gaps

    @cached_property
    def lengths(self) -> tuple[Twofold, Array]:
        """A X − g in twice the precision, shape (S, m) [m], and the sum of the sizes of its terms.

        For arcs, the relative displacement of their centres.
        """
        matrix, x = self.columns.matrix, self.coordinates
        if not self.fine:
            rest = self.rest[0].high
            plain = x @ matrix.high.T
            plain += rest
            widest = np.abs(x).max(axis=1, initial=0.0) + np.abs(rest).max(axis=1, initial=0.0)
            spread = EPS / TINY * (widest + self.widest_offset)[:, None]
            return exact(plain), np.broadcast_to(spread, plain.shape)
        moved, sizes = product(x, matrix.high.T)
        still, more = self.rest
        total = plus(plus(moved, exact(x @ matrix.low.T)), still)
        return total, sizes + more

    @cached_property
    def arcs(self) -> tuple[Array, Array, Array]:
        """Vectors from the neighbours' centres, margins, and the sizes of the margins' terms.

        Shapes (S, arcs, 2), (S, arcs), (S, arcs) [m]. The margin is that of the train's own arcs,
        free of cancellation.
        """
        columns, train, here = self.columns, self.columns.train, self.situations
        first = columns.arcs.start
        ways, margins, sizes = [], [], []
        for drum, ring in enumerate(train.drums):
            gear = train.gears[ring.gear]
            for side, neighbour in enumerate(ring.neighbours):
                at = first + 2 * (2 * drum + side)
                nominal = gear.frame @ (gear.centre - train.gears[neighbour].centre)
                moved = self.lengths[0].value[:, at : at + 2]
                moved = moved + here.arc_shift[:, drum, side] @ gear.frame.T
                way = nominal + moved
                grown = 2.0 * moved @ nominal + (moved**2).sum(axis=1)
                both = np.sqrt((way**2).sum(axis=1)) + np.sqrt(nominal @ nominal)
                clearance = here.arc_clearance[:, drum, side]
                ways.append(way)
                margins.append(grown / both + clearance)
                sizes.append(np.sqrt((moved**2).sum(axis=1)) + np.abs(clearance))
        if not ways:
            none = np.zeros((self.count, 0))
            return np.zeros((self.count, 0, 2)), none, none
        return np.stack(ways, axis=1), np.stack(margins, axis=1), np.stack(sizes, axis=1)

    @cached_property
    def pushes(self) -> Array:
        """Claimed forces of contacts: flanks, stops, arcs, shape (S, contacts) [N]."""
        columns, force = self.columns, self.forces
        return np.concatenate([force[:, columns.contacts], force[:, columns.arcs][:, ::2]], axis=1)

    @cached_property
    def gaps(self) -> Array:
        """By how much these contacts are open, shape (S, contacts) [m]."""
        return np.concatenate([-self.lengths[0].value[:, self.columns.contacts], self.arcs[1]], 1)

    @cached_property
    def load(self) -> tuple[Twofold, Array]:
        """f, shape (S, n) [N], and the sum of the sizes of its terms."""
        columns, torque = self.columns, self.situations.torque
        total = exact(np.zeros((len(torque), len(columns.coordinates))))
        for gear, turn in columns.turns.items():
            pushed = torque[:, columns.order[gear]]
            if turn.coordinate is None or not pushed.any():
                continue
            part = quotient(pushed, np.full_like(pushed, turn.radius))
            at = turn.coordinate
            here = Twofold(total.high[:, at], total.low[:, at])
            total.high[:, at], total.low[:, at] = plus(here, part)
        if self.situations.push.any():
            push = self.situations.push.reshape(len(self.situations.push), -1)
            from_push, sizes = product(push, self.columns.pushed)
            # Arms over radii are rounded, which sums in twice the precision do not account for.
            return plus(total, from_push), np.abs(total.high) + sizes * (EPS / TINY)
        return total, np.abs(total.high)

    @cached_property
    def widest_offset(self) -> Array:
        """Largest centre offset, shape (S or 1,) [m]."""
        return np.asarray(np.abs(self.situations.offset).max(axis=(1, 2), initial=0.0))

    def balance(self, forces: Array) -> tuple[Array, Array]:
        """Return f − Aᵀ F, shape (S, n) [N], and its rounding, at given forces."""
        matrix = self.columns.matrix
        if not self.fine:
            due = self.load[0].value
            sizes = np.abs(forces) @ self.columns.sizes + np.abs(due)
            return due - forces @ matrix.high, self.columns.roundings * sizes
        pushed, sizes = product(forces, matrix.high)
        load, more = self.load
        left = minus(minus(load, pushed), exact(forces @ matrix.low)).value
        return left, EPS * np.abs(left) + TINY * (sizes + more)

    @cached_property
    def torque_on_splines(self) -> Array:
        """Torque that each spline transmits to its gear, shape (S, splines) [N·m]."""
        return np.asarray(self.answers.flank_force @ self.columns.moments.T)

    @cached_property
    def rolling(self) -> Flags:
        """Which arcs and radial elements are bearings with a power law, shape (pairs,)."""
        columns = self.columns
        found = np.zeros(columns.pairs, dtype=bool)
        first = columns.pairs - len(columns.claims.radials)
        powers = self.situations.round_power
        found[first : first + powers.shape[1]] = (powers != 1.0).any(axis=0)
        return found

    @cached_property
    def rolls(self) -> bool:
        """Whether there is such a bearing."""
        return bool(self.rolling.any())

    @cached_property
    def graphs(self) -> Array:
        """Graphs of the radial elements, shape (S, radials, 5).

        First stiffness, stick radius S1 (infinite without slip), level F_m, reach S2, last
        stiffness (infinite for a rigid stop); NaN where a law has no meaning. A wall with a power
        law is given by its tangent at the claim.
        """
        train, here, claims = self.columns.train, self.situations, self.columns.claims
        found = np.zeros((self.count, len(claims.radials), 5))
        rounds = found[:, claims.rounds]
        rounds[:, :, 3], rounds[:, :, 4] = here.round_radius, here.round_stiffness
        if self.rolls:
            where = self.lengths[0].value[:, self.columns.all_of(claims.rounds)]
            radius = np.sqrt((where.reshape(self.count, -1, 2) ** 2).sum(axis=2))
            law = here.round_radius, here.round_stiffness, here.round_power
            rounds[:, :, 3], rounds[:, :, 4] = wall(*law, radius)
        if train.splines:
            numbers, memory = np.moveaxis(here.spline, 2, 0), train.slip is not None
            graphs, faulty = spline_graphs(numbers, self.torque_on_splines, memory=memory)
            for part, graph in zip((claims.splines, claims.spline_stops), graphs, strict=False):
                for k, figure in enumerate(graph):
                    found[:, part, k] = np.where(faulty, np.nan, figure)
        if self.limits is not None:
            found[:, :, 2:4] = np.where(np.isnan(found[:, :, 2:4]), np.nan, self.limits)
        return found


EPS = 4.0 * np.finfo(float).eps
"""Rounding of a handful of operations, relative to their result."""
TINY = 2.0**-98
"""Rounding of sums in twice the precision, relative to the sizes of their terms."""
