r"""Proof that a set holds on a stretch of the parameter.

Between two solved points the unknowns are enclosed around their chord. With A the inverse of the
Jacobian in the middle, a true branch z(s) lies within d of the chord z̃(s) if

.. math:: |V A\,G(\tilde z(s), s)| + |V A U^T|\,\rho(d)\,d \le d

for the quantities V z that the nonlinear laws depend on, whose forces enter through U and whose
slopes stay within ρ of those in the middle (Krawczyk's test, written for the few quantities that
are nonlinear). The residual of the chord vanishes at both ends, so a quarter of the range of its
derivative bounds it. Gauges are bounded alike: one is positive throughout if its chord clears zero
by more than the enclosure, or if it leaves zero at one end and its derivative keeps its sign.

Laws and directions are enclosed over whole ranges. What the parameter itself moves (errors, loads,
clearances, compliances) is sampled at five values of a stretch, and its derivative taken from the
range of their differences, that range added once more to either side. Round-off is bounded by the
size of the terms. Source: formulation, section 16; Neumaier, Interval Methods, chapter 5.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from loadshare.scene.scene import Array
from loadshare.solver.hot import places as at
from loadshare.study.follow.equations import Equations, Flags, Polar, free_moves, pressed, scaling
from loadshare.study.follow.line import Numbers

NODES = 5
"""Values of a stretch at which the parameter's effect is sampled."""
ROUNDS = 6
"""Attempts to find an enclosure."""
ROUND_OFF = 64.0 * np.finfo(float).eps
"""Round-off of a sum, relative to the size of its terms."""
VERGE = 1e-11
"""Gauge, in deflections or loads, that counts as zero: a hundredth of what is certified."""


@dataclass(frozen=True, slots=True, eq=False)
class Range:
    """A quantity along stretches, in parts τ ∈ [0, 1] of each; shape (B, ...).

    Attributes
    ----------
    nodes : ndarray, shape (B, NODES, ...)
        Along the chord.
    rate, spread : ndarray
        Its derivative with respect to τ lies within `spread` of `rate`.
    """

    nodes: Array
    rate: Array
    spread: Array

    @property
    def low(self) -> Array:
        """Lower bound along the chord."""
        return np.asarray(self.nodes.min(axis=1) - self.spread / (2.0 * (NODES - 1)))

    @property
    def high(self) -> Array:
        """Upper bound along the chord."""
        return np.asarray(self.nodes.max(axis=1) + self.spread / (2.0 * (NODES - 1)))

    @property
    def middle(self) -> Array:
        """Value in the middle."""
        return np.asarray(self.nodes[:, NODES // 2])

    @property
    def off(self) -> Array:
        """Largest distance from the value in the middle."""
        return np.asarray(np.maximum(self.high - self.middle, self.middle - self.low))

    def __getitem__(self, key: object) -> Range:
        """Return a part of the quantity."""
        whole = key if isinstance(key, tuple) else (key,)
        at_nodes = (slice(None), slice(None), *whole)
        inner = (slice(None), *whole)
        return Range(self.nodes[at_nodes], self.rate[inner], self.spread[inner])


def sampled(nodes: Array) -> Range:
    """Enclose a smooth quantity known at the nodes (B, NODES, ...)."""
    slopes = (NODES - 1) * np.diff(nodes, axis=1)
    low, high = slopes.min(axis=1), slopes.max(axis=1)
    noise = 4.0 * NODES * np.finfo(float).eps * np.abs(nodes).max(axis=1)
    # Half the range is what the samples show; as much again is what may lie between them.
    return Range(nodes, 0.5 * (low + high), (high - low) + noise)


@dataclass(slots=True, eq=False)
class _Gauges:
    """Gauges under way: names, where they lead, and their enclosures."""

    known: list[list[tuple[Range, Array, Array]]] = field(default_factory=list)

    def add(self, owner: int, to: int, value: Range, dev: Array, bend: Array) -> None:
        """Add one: its range along the chord, its deviation, and that of its derivative."""
        self.known.append([(value, dev, bend)])

    def alternative(self, value: Range, dev: Array, bend: Array) -> None:
        """Say what may be positive in place of the gauge added last."""
        self.known[-1].append((value, dev, bend))

    @property
    def first(self) -> Array:
        """Values at the first ends, shape (B, gauges)."""
        largest = [np.max([v.nodes[:, 0] for v, *_ in every], axis=0) for every in self.known]
        return np.stack(largest, axis=1)


@dataclass(frozen=True, slots=True, eq=False)
class Proof:
    """What was proved on stretches.

    Attributes
    ----------
    holds : ndarray of bool, shape (B,)
    enclosed : ndarray of bool, shape (B,)
        Whether there is an enclosure at all.
    """

    holds: Flags
    enclosed: Flags


class Stretches:
    """Stretches of one set between solved points.

    Parameters
    ----------
    equations : Equations
    ends : ndarray, shape (B, 2, size)
        Unknowns at both ends.
    numbers : Numbers
        At NODES equidistant values of each stretch, one stretch after another.
    """

    def __init__(self, equations: Equations, ends: Array, numbers: Numbers) -> None:
        self.equations, self.numbers = equations, numbers
        self.count = len(ends)
        tau = np.linspace(0.0, 1.0, NODES)[:, None]
        chord = (1.0 - tau) * ends[:, :1] + tau * ends[:, 1:]
        self.flat = chord.reshape(-1, equations.size)
        self.chord = sampled(chord)
        self.state = equations.state(self.flat, numbers)
        self.middle = np.arange(self.count) * NODES + NODES // 2
        self.at_middle = numbers.take(self.middle)

    def _split(self, values: Array) -> Array:
        """Return values of all nodes (B·NODES or 1, ...) as (B, NODES, ...)."""
        shape = (self.count * NODES, *values.shape[1:])
        return np.broadcast_to(values, shape).reshape(self.count, NODES, *values.shape[1:])

    def _own(self, values: Array) -> Array:
        """Return values (B or 1, ...) of the middles for every stretch."""
        return np.broadcast_to(values, (self.count, *values.shape[1:]))

    def prove(self) -> Proof:
        """Try to prove that the set holds from end to end."""
        with np.errstate(all="ignore"):
            inverse, fixed = self._inverse()
            self._lay_out()
            enclosed, dev, bend = self._enclosed(inverse)
            enclosed &= fixed
            holds = enclosed & self._positive(dev, bend)
        return Proof(holds, enclosed)

    def standing(self) -> Array:
        """Gauges at the first ends, shape (B, gauges)."""
        self._lay_out()
        nothing = np.zeros((self.count, self.width))
        return self.gauges(nothing, nothing).first

    # --- The linear part ------------------------------------------------------------------------

    def _inverse(self) -> tuple[Array, Flags]:
        """Inverse of the Jacobian in the middle, moves that nothing resists held fixed."""
        e = self.equations
        z = self.flat[self.middle]
        jacobian = e.jacobian(z, self.at_middle)
        jacobian = np.where(np.isfinite(jacobian), jacobian, 0.0)
        factor = scaling(jacobian)
        scaled = jacobian * factor[:, :, None] * factor[:, None, :]
        right, null = free_moves(scaled)
        moves = np.where(null[:, :, None], right, 0.0)
        held = scaled + moves.transpose(0, 2, 1) @ moves
        inverse = np.linalg.inv(held + 0.0)
        inverse = factor[:, :, None] * inverse * factor[:, None, :]
        return inverse, self._unfelt(moves * factor[:, None, :], np.asarray(null.any(axis=1)))

    def _unfelt(self, moves: Array, loose: Flags) -> Flags:
        """Whether no acting element feels the moves (B, size, size) that are held fixed."""
        if not loose.any():
            return np.ones(self.count, dtype=bool)
        e = self.equations
        size = np.abs(moves).max(axis=(1, 2))
        felt = np.abs(moves[:, :, e.n :]).max(axis=(1, 2), initial=0.0)
        acting = [self._own(self.at_middle.vectors)[:, : e.scalars][:, e.acts]]
        acting += [self._own(self.at_middle.relative)[:, a] for a in e.arc_at]
        for j in e.radial_at:
            column = e.elements.radial_column(j)
            acting.append(self._own(self.at_middle.vectors)[:, column : column + 2])
        rows = np.concatenate(acting, axis=1)
        felt = np.maximum(
            felt, np.abs(moves[:, :, : e.n] @ rows.transpose(0, 2, 1)).max(axis=(1, 2), initial=0.0)
        )
        load = self._split(self.numbers.load)
        pushed = np.abs(moves[:, :, : e.n] @ load.transpose(0, 2, 1)).max(axis=(1, 2), initial=0.0)
        push = np.abs(load).max(axis=(1, 2), initial=0.0)
        return np.asarray(~loose | ((felt <= 1e-10 * size) & (pushed <= 1e-10 * size * push)))

    def _lay_out(self) -> None:
        """Number the quantities that laws depend on, and write how they follow from unknowns."""
        e, state = self.equations, self.state
        arcs, radials = len(e.arc_acts), len(e.places)
        self.arc_in = e.scalars + 3 * np.arange(arcs)
        self.radial_in = e.scalars + 3 * arcs + 2 * np.arange(radials)
        self.z_in = e.scalars + 3 * arcs + 2 * radials
        self.width = self.z_in + e.size
        self.inputs = np.zeros((self.count, self.width, e.size))
        here = self._own(self.at_middle.vectors)
        self.inputs[:, : e.scalars, : e.n] = here[:, : e.scalars]
        for a, at_ in enumerate(self.arc_in):
            self.inputs[:, at_ : at_ + 3, : e.n] = self._own(self.at_middle.relative)[:, a]
        for j, at_ in enumerate(self.radial_in):
            column = e.elements.radial_column(j)
            self.inputs[:, at_ : at_ + 2, : e.n] = here[:, column : column + 2]
        self.inputs[:, self.z_in :] = np.eye(e.size)
        self.approach = sampled(self._split(state.approach))
        self.offsets = {k: sampled(self._split(p.offset)) for k, p in self._polars().items()}
        self.radii = {k: self._split(p.radius)[:, NODES // 2] for k, p in self._polars().items()}
        self.along = {k: self._split(p.along)[:, NODES // 2] for k, p in self._polars().items()}

    def _polars(self) -> dict[tuple[str, int], Polar]:
        arcs = {("arc", a): p for a, p in self.state.arcs.items()}
        return {**arcs, **{("radial", j): p for j, p in self.state.radials.items()}}

    # --- The nonlinear part ---------------------------------------------------------------------

    def _enclosed(self, inverse: Array) -> tuple[Flags, Array, Array]:
        """Find deviations of the quantities, and of their derivatives."""
        e = self.equations
        residual = e.residual(self.flat, self.numbers, self.state)
        reach = self.inputs @ inverse
        linear, ends = self._linear(residual), self._split(residual)
        ends = np.abs(ends[:, [0, -1]] @ reach.transpose(0, 2, 1)).max(axis=1)
        noise = ROUND_OFF * (np.abs(reach) @ self._sizes()[:, :, None])[:, :, 0]
        straight = sampled(linear @ reach.transpose(0, 2, 1))
        drift = self._drift(reach)
        dev = 1e-15 * np.ones((self.count, self.width))
        done = np.zeros(self.count, dtype=bool)
        kept = bend = np.full((self.count, self.width), np.inf)
        for _ in range(ROUNDS):
            ports = self._ports(dev)
            through = reach @ ports.outputs.transpose(0, 2, 1)
            spread = straight.spread + (np.abs(through) @ ports.spread[:, :, None])[:, :, 0]
            matrix = np.abs(through) @ ports.slack + drift
            base = ends + noise + 0.5 * spread
            fresh = base + (matrix @ dev[:, :, None])[:, :, 0]
            fits = (fresh <= dev).all(axis=1) & np.isfinite(fresh).all(axis=1) & ~done
            if fits.any():
                rate = np.abs(straight.rate + (through @ ports.rate[:, :, None])[:, :, 0]) + spread
                kept = np.where(fits[:, None], fresh, kept)
                bend = np.where(fits[:, None], self._contracted(matrix, rate, fits), bend)
                done |= fits
            if done.all():
                break
            dev = np.where(done[:, None], dev, self._wider(matrix, base, fresh))
        return done & np.isfinite(bend).all(axis=1), kept, bend

    def _wider(self, matrix: Array, base: Array, fresh: Array) -> Array:
        """Deviations to try next: a little more than what the last slopes ask for."""
        usable = np.asarray(np.isfinite(matrix).all(axis=(1, 2)) & np.isfinite(base).all(axis=1))
        solved = _series(
            np.where(usable[:, None, None], matrix, 0.0), np.where(usable[:, None], base, 1.0)
        )
        good = usable & (solved >= 0.0).all(axis=1)
        wider = np.where(good[:, None], solved, fresh)
        return np.asarray(np.minimum(1.1 * np.nan_to_num(wider, nan=1e12) + 1e-300, 1e12))

    def _contracted(self, matrix: Array, base: Array, these: Flags) -> Array:
        """Solve d = base + M d for d, where M contracts."""
        found = np.full(base.shape, np.inf)
        rows = np.flatnonzero(these)
        solved = _series(matrix[rows], base[rows])
        # A nonnegative solution proves that it bounds the series; round-off is given a part more.
        good = (solved >= 0.0).all(axis=1)
        found[rows[good]] = (1.0 + 1e-9) * solved[good]
        return found

    def _linear(self, residual: Array) -> Array:
        """Residual at the nodes without the parts whose slopes vary: (B, NODES, size)."""
        e, state = self.equations, self.state
        found = residual.copy()
        vectors = self.numbers.vectors[:, : e.scalars]
        curved = state.force[:, e.curved]
        found[:, : e.n] -= (curved[:, None, :] @ vectors[:, e.curved])[:, 0]
        for key, where in self._acting():
            polar = self._polars()[key]
            push = (polar.size[:, None] * polar.along)[:, None, :] @ polar.matrix
            found[:, : e.n] -= push[:, 0]
            if where is not None:
                found[:, where] = 0.0
        return self._split(found)

    def _acting(self) -> list[tuple[tuple[str, int], int | None]]:
        """Polar elements that turn, and where their unknown force stands."""
        e = self.equations
        turning = (at.SLIP, at.STOP, at.WALL, at.CORNER)
        arcs = [(("arc", a), w) for a, w in e.arc_at.items()]
        radials = [
            (("radial", j), w) for j, w in e.radial_at.items() if int(e.places[j]) in turning
        ]
        return [*arcs, *radials]

    def _sizes(self) -> Array:
        """Sum of the sizes of the terms of every equation, (B, size)."""
        e, state = self.equations, self.state
        vectors = np.abs(self.numbers.vectors[:, : e.scalars])
        x = np.abs(self.flat[:, : e.n])
        gap = np.where(np.isfinite(self.numbers.gap), np.abs(self.numbers.gap), 0.0)
        reach = (vectors @ x[:, :, None])[:, :, 0] + gap[:, : e.scalars]
        pushes = np.abs(state.force) + state.slope * reach
        found = np.zeros(self.flat.shape)
        found[:, : e.n] = (pushes[:, None, :] @ vectors)[:, 0] + np.abs(self.numbers.load)
        found[:, e.rigid_at] = reach[:, e.rigid]
        for key, polar in self._polars().items():
            matrix = np.abs(polar.matrix)
            moved = (matrix @ x[:, :, None])[:, :, 0]
            push = (np.abs(polar.size) + polar.slope * moved.max(axis=1))[:, None]
            found[:, : e.n] += (np.broadcast_to(push, moved.shape)[:, None, :] @ matrix)[:, 0]
            where = e.arc_at.get(key[1]) if key[0] == "arc" else e.radial_at.get(key[1])
            if where is not None:
                found[:, where : where + 2] += moved.max(axis=1)[:, None]
        return np.asarray(self._split(found).max(axis=1))

    def _drift(self, reach: Array) -> Array:
        """What directions that vary add to the contraction, (B, width, width)."""
        e = self.equations
        found = np.zeros((self.count, self.width, self.width))
        if len(self.numbers.vectors) == 1:
            return found
        z = self.flat[self.middle]
        middle = e.jacobian(z, self.at_middle)
        most = np.zeros_like(middle)
        for k in range(NODES):
            there = self.numbers.take(self.middle - NODES // 2 + k)
            most = np.maximum(most, np.abs(e.jacobian(z, there) - middle))
        found[:, :, self.z_in :] = np.abs(reach) @ (2.0 * most)
        return found

    def _ports(self, dev: Array) -> _Ports:
        """Forces that vary: how they enter, their derivative along the chord, their slack."""
        e = self.equations
        ports = _Ports(self.count, self.width, e.size)
        vectors = self._own(self.at_middle.vectors)
        slopes = self._slopes(dev)
        for k in np.flatnonzero(e.acts).tolist():
            if k in slopes:
                slope = slopes[k]
                port = ports.add(vectors[:, k], e.n)
                ports.slack_of(port, k, slope.off)
                ports.along(port, slope.rate, slope.spread)
        for key, where in self._acting():
            self._polar_port(ports, key, where, dev, slopes)
        for j, place in enumerate(e.places.tolist()):
            stiff = sampled(self._split(self.state.laws[j].first))
            if place == at.STICK and stiff.off.any():
                column = e.elements.radial_column(j)
                for i in (0, 1):
                    port = ports.add(vectors[:, column + i], e.n)
                    ports.slack_of(port, self.radial_in[j] + i, stiff.off)
        return ports

    def _slopes(self, dev: Array) -> dict[int, _Slope]:
        """Contacts whose slope varies: by how much, and how their force changes on the chord."""
        e, found = self.equations, {}
        nothing = np.zeros(self.count)
        columns = e.curved
        if len(columns):
            every = self._curved(
                self.approach[columns],
                sampled(self._split(self.numbers.bending[:, columns])),
                sampled(self._split(self.numbers.hertz[:, columns])),
                dev[:, columns],
            )
            for i, k in enumerate(columns.tolist()):
                found[k] = _Slope(every.off[:, i], every.rate[:, i], every.spread[:, i])
        for k in self._stiffening:
            b = sampled(self._split(self.numbers.bending[:, k]))
            off = np.where(b.low > 0.0, 1.0 / b.low - 1.0 / b.high, np.inf)
            found[k] = _Slope(off, nothing, nothing)
        return found

    @cached_property
    def _stiffening(self) -> list[int]:
        """Linear contacts and springs whose compliance follows the parameter."""
        bending = self.numbers.bending
        varies = (bending != bending[:1]).any(axis=0)
        acting = [*range(self.equations.elements.springs), *self.equations.linear.tolist()]
        return sorted({k for k in acting if varies[k]})

    def _curved(self, approach: Range, b: Range, c: Range, dev: Array) -> _Slope:
        """Enclose slope and derivative of a force, δ = bF + cF^(2/3)."""
        low, high = approach.low - dev, approach.high + dev
        nearest = np.where(low * high <= 0.0, 0.0, np.minimum(np.abs(low), np.abs(high)))
        furthest = np.maximum(np.abs(low), np.abs(high))
        b_low, c_low = np.maximum(b.low, 0.0), np.maximum(c.low, 0.0)
        _, least = pressed(b.high, c.high, nearest)
        force, most = pressed(b_low, c_low, furthest)
        force_middle, middle = pressed(b.middle, c.middle, approach.middle)
        off = np.maximum(most - middle, middle - least)
        moved, spread = _times(middle, off, approach.rate, approach.spread)
        # What b and c themselves add: -F F' b' - F^(2/3) F' c', with the sign of F.
        least_force, _ = pressed(b.high, c.high, nearest)
        sign = np.sign(approach.middle)
        crosses = low * high < 0.0
        for part, power in ((b, 1.0), (c, 2.0 / 3.0)):
            upper = np.abs(force) ** power * most
            lower = np.where(crosses, -upper, np.abs(least_force) ** power * least)
            here = np.abs(force_middle) ** power * middle
            wide = np.maximum(upper - here, here - lower)
            own, own_spread = _times(here, wide, part.rate, part.spread)
            moved, spread = moved - sign * own, spread + own_spread
        return _Slope(off, moved, spread)

    def _bound(self, j: int, slopes: dict[int, _Slope]) -> tuple[Range, Array, Array]:
        """Friction bound of a radial element along the chord, and how it follows the contacts.

        Returns
        -------
        Range
        ndarray, shape (B, width)
            Slope with respect to the approaches, its largest size.
        ndarray, shape (B, width)
            By how much it varies.
        """
        e = self.equations
        nodes = self._split(self.state.laws[j].bound)
        given = self._split(self.numbers.radial[:, j])
        value = sampled(nodes)
        felt = np.zeros((self.count, self.width))
        per = np.where(np.isnan(given[:, 0, 3]), given[:, :, 4].max(axis=1), 0.0)
        varies = np.zeros((self.count, self.width))
        if not per.any():
            return value, felt, varies
        arms = np.abs(self._own(self.at_middle.carried)[:, j, : e.scalars])
        slope = np.abs(self._split(self.state.slope)).max(axis=1)
        rate, spread = np.zeros(self.count), np.zeros(self.count)
        sign = np.sign(self._split(self.state.transmitted[:, j])[:, NODES // 2])
        signed = self._own(self.at_middle.carried)[:, j]
        for k in np.flatnonzero(e.acts).tolist():
            if not arms[:, k].any():
                continue
            known = slopes.get(k)
            if known is not None and k in e.curved:
                felt[:, k] = per * arms[:, k] * (slope[:, k] + known.off)
                varies[:, k] = per * arms[:, k] * known.off
                rate += per * sign * signed[:, k] * known.rate
                spread += per * arms[:, k] * known.spread
            else:
                force = sampled(self._split(self.state.force[:, k]))
                felt[:, k] = per * arms[:, k] * slope[:, k]
                rate += per * sign * signed[:, k] * force.rate
                spread += per * arms[:, k] * force.spread
        changing = sampled(given[:, :, 4])
        spread += (np.abs(changing.rate) + changing.spread) * np.abs(
            self._split(self.state.transmitted[:, j])
        ).max(axis=1)
        spread = np.maximum(spread, np.abs(value.rate - rate) + value.spread)
        # Where the torque changes its sign the bound has a kink.
        torque = self._split(self.state.transmitted[:, j])
        kink = (torque.min(axis=1) <= 0.0) & (torque.max(axis=1) >= 0.0)
        varies = np.where(kink[:, None] & (felt > 0.0), np.inf, varies)
        return Range(nodes, rate, spread), felt, varies

    def _polar_port(
        self,
        ports: _Ports,
        key: tuple[str, int],
        where: int | None,
        dev: Array,
        slopes: dict[int, _Slope],
    ) -> None:
        """Add the force of an element that turns."""
        e = self.equations
        kind, number = key
        offset, polar = self.offsets[key], self._polars()[key]
        width = offset.middle.shape[1]
        first = self.arc_in[number] if kind == "arc" else self.radial_in[number]
        here = slice(first, first + width)
        around, radius, turn = self._around(key, dev)
        near = radius - around
        size, slope, follows = self._size(key, where, dev, slopes)
        largest = np.maximum(np.abs(size.low), np.abs(size.high)) + size.extra
        middle = np.abs(size.value.middle)
        across = largest / near
        off = size.value.off + size.extra
        across_off = off / near + middle * around / (near * radius)
        slack = slope.off + 2.0 * across_off + (slope.size + across) * 2.0 * turn
        along = self.along[key]
        stiff = self._split(polar.stiffness)[:, NODES // 2]
        rate = (stiff @ offset.rate[:, :, None])[:, :, 0] + size.rate[:, None] * along
        moved = np.abs(offset.rate).sum(axis=1) + offset.spread.sum(axis=1)
        spread = slack * moved + (slope.size + across) * offset.spread.sum(axis=1)
        spread += size.spread + (np.abs(size.rate) + size.spread) * turn
        matrix = self._own(self.at_middle.relative)[:, number] if kind == "arc" else None
        if matrix is None:
            column = e.elements.radial_column(number)
            matrix = self._own(self.at_middle.vectors)[:, column : column + 2]
        for i in range(width):
            port = ports.add(matrix[:, i], e.n)
            ports.slack_of(port, here, slack[:, None])
            ports.along(port, rate[:, i], spread)
            if where is not None:
                ports.slack_of(port, self.z_in + where, turn)
            elif follows is not None:
                ports.add_slack(port, follows[0] * turn[:, None] + follows[1])
        if where is not None:
            limit = self._limit(key)
            port = ports.add_row(where)
            ports.slack_of(port, here, turn[:, None])
            sign = -1.0 if kind == "arc" else 1.0
            straight = (along * offset.rate).sum(axis=1)
            ports.along(
                port,
                sign * straight - limit.rate,
                turn * moved + offset.spread.sum(axis=1) + limit.spread,
            )

    def _around(self, key: tuple[str, int], dev: Array) -> tuple[Array, Array, Array]:
        """Distance of an offset from its middle, its radius there, and how far its way turns."""
        kind, number = key
        first = self.arc_in[number] if kind == "arc" else self.radial_in[number]
        width = self.offsets[key].middle.shape[1]
        off = self.offsets[key].off + dev[:, first : first + width]
        around, radius = np.sqrt((off * off).sum(axis=1)), self.radii[key]
        around = np.where(around < radius, around, np.inf)
        return around, radius, 2.0 * around / radius

    def _limit(self, key: tuple[str, int]) -> Range:
        """Radius at which a step stands; for an arc, minus its clearance's effect on the margin."""
        kind, number = key
        if kind == "arc":
            # The row is −margin = a − c − |d|.
            clearance = self._split(self.numbers.clearance[:, number])
            nominal = self._split(self.numbers.nominal[:, number])
            return sampled(clearance - np.sqrt((nominal * nominal).sum(axis=-1)))
        law = self.state.laws[number]
        place = self.equations.places[number]
        return sampled(self._split(law.stick if place == at.CORNER else law.reach))

    def _size(
        self, key: tuple[str, int], where: int | None, dev: Array, slopes: dict[int, _Slope]
    ) -> tuple[_Size, _Radial, tuple[Array, Array] | None]:
        """Force of a polar element along its offset, and its slope with respect to the radius."""
        kind, number = key
        nothing = np.zeros(self.count)
        if where is not None:
            sign = -1.0 if kind == "arc" else 1.0
            p = self.chord[where]
            value = Range(sign * p.nodes, sign * p.rate, p.spread)
            flat = _Radial(nothing, nothing)
            extra = dev[:, self.z_in + where]
            return _Size(value, value.rate, value.spread, extra), flat, None
        around, radius, _ = self._around(key, dev)
        if kind == "arc":
            give = sampled(self._split(self.state.arcs[number].slope))
            slope = _Radial(np.abs(give.middle) + give.off, give.off)
            clearance = sampled(self._split(self.numbers.clearance[:, number]))
            margin = sampled(self._split(self.state.margin[:, number]))
            value = sampled(self._split(self.state.arcs[number].size))
            extra = slope.size * self._felt(key, dev)
            depth = np.abs(margin.middle) + margin.off
            rate = give.middle * clearance.rate + margin.middle * give.rate
            spread = give.off * np.abs(clearance.rate) + slope.size * clearance.spread
            spread += margin.off * np.abs(give.rate) + depth * give.spread
            # The chord's own sagitta is far below the band of the offset; it is bounded by it.
            extra = extra + slope.size * around**2 / radius
            return _Size(value, rate, spread, extra), slope, None
        law = self.state.laws[number]
        bound, felt, varies = self._bound(number, slopes)
        follows = (felt * dev).sum(axis=1)
        if self.equations.places[number] == at.SLIP:
            value = bound
            still = _Radial(nothing, nothing)
            return _Size(value, bound.rate, bound.spread, follows), still, (felt, varies)
        give = sampled(self._split(law.last))
        reach = sampled(self._split(law.reach))
        slope = _Radial(np.abs(give.middle) + give.off, give.off)
        value = sampled(self._split(self.state.radials[number].size))
        past = np.abs(radius - reach.middle) + around + reach.off
        rate = bound.rate + give.rate * (radius - reach.middle) - give.middle * reach.rate
        spread = bound.spread + give.spread * past + slope.size * reach.spread
        spread += np.abs(give.rate) * (around + reach.off) + give.off * np.abs(reach.rate)
        extra = follows + slope.size * (self._felt(key, dev) + around**2 / radius)
        return _Size(value, rate, spread, extra), slope, (felt, varies)

    def _felt(self, key: tuple[str, int], dev: Array) -> Array:
        """Length of the deviation of an offset."""
        kind, number = key
        first = self.arc_in[number] if kind == "arc" else self.radial_in[number]
        part = dev[:, first : first + self.offsets[key].middle.shape[1]]
        return np.asarray(np.sqrt((part * part).sum(axis=1)))

    # --- Gauges ---------------------------------------------------------------------------------

    def _positive(self, dev: Array, bend: Array) -> Flags:
        """Whether all gauges are positive between the ends."""
        holds = np.ones(self.count, dtype=bool)
        for every in self.gauges(dev, bend).known:
            holds &= np.any([_clear(*one) for one in every], axis=0)
        return holds

    def gauges(self, dev: Array, bend: Array) -> _Gauges:
        """Return the gauges of all elements."""
        e = self.equations
        found = _Gauges()
        rows = e.code[: e.elements.rows]
        pieces = dict(zip(e.tables.tolist(), e.held.pieces, strict=True))
        for k in range(e.scalars - e.elements.springs):
            column = e.elements.springs + k
            value, off, steer = self.approach[column], dev[:, column], bend[:, column]
            if rows[k] != at.CLOSED:
                if np.isfinite(value.nodes).all():
                    found.add(k, at.CLOSED, _minus(value), off, steer)
            elif column in e.rigid:
                where = e.rigid_at[np.flatnonzero(e.rigid == column)[0]]
                found.add(
                    k,
                    at.OPEN,
                    self.chord[where],
                    dev[:, self.z_in + where],
                    bend[:, self.z_in + where],
                )
            else:
                low, high = self._piece(column, pieces.get(column))
                found.add(k, at.OPEN, _shifted(value, low), off, steer)
                if high is not None:
                    found.add(k, at.CLOSED, _minus(_shifted(value, high)), off, steer)
        for a in range(len(e.arc_acts)):
            self._arc_gauge(found, a, dev, bend)
        for j in range(len(e.places)):
            self._radial_gauges(found, j, dev, bend)
        return found

    def _piece(self, column: int, piece: int | None) -> tuple[Range, Range | None]:
        """Compressions at which a table's piece begins and ends; zero without a table."""
        nothing = sampled(np.zeros((self.count, NODES)))
        if piece is None:
            return nothing, None
        table = self._split(self.numbers.tables[:, self.equations.tabulated[column]])
        low, high = sampled(table[:, :, 1, piece]), None
        if piece + 2 < table.shape[-1] and np.isfinite(table[:, :, 1, piece + 2]).all():
            high = sampled(table[:, :, 1, piece + 1])
        return low, high

    def _radius(self, key: tuple[str, int], dev: Array, bend: Array) -> tuple[Range, Array, Array]:
        """Radius of an offset (for an arc: its margin) along the chord, and its deviations."""
        kind, number = key
        offset = self.offsets[key]
        _, _, turn = self._around(key, dev)
        if kind == "arc":
            nodes = self._split(self.state.margin[:, number])
            clearance = sampled(self._split(self.numbers.clearance[:, number]))
        else:
            nodes = self._split(self.state.radials[number].radius)
            clearance = sampled(np.zeros((self.count, NODES)))
        moved = np.sqrt((offset.rate**2).sum(axis=1))
        straight = (self.along[key] * offset.rate).sum(axis=1)
        spread = moved * turn + np.sqrt((offset.spread**2).sum(axis=1))
        # The radius is no faster than the offset itself, however its way turns.
        spread = np.minimum(
            spread, np.abs(straight) + moved + np.sqrt((offset.spread**2).sum(axis=1))
        )
        spread = np.where(np.isfinite(spread), spread, np.abs(straight) + moved)
        value = Range(nodes, straight + clearance.rate, spread + clearance.spread)
        return value, self._felt(key, dev), self._felt(key, bend)

    def _arc_gauge(self, found: _Gauges, a: int, dev: Array, bend: Array) -> None:
        e = self.equations
        owner = e.scalars - e.elements.springs + a
        where = e.arc_at.get(a)
        if where is not None:
            inner = self.z_in + where
            found.add(owner, at.OPEN, self.chord[where], dev[:, inner], bend[:, inner])
            return
        value, off, steer = self._radius(("arc", a), dev, bend)
        if a in e.arc_at:
            found.add(owner, at.OPEN, _minus(value), off, steer)
        else:
            found.add(owner, at.CLOSED, value, off, steer)

    def _radial_gauges(self, found: _Gauges, j: int, dev: Array, bend: Array) -> None:
        """Gauges of a radial element towards the places before and after its own."""
        e, law = self.equations, self.state.laws[j]
        owner, place = e.elements.rows + j, int(e.places[j])
        where = e.radial_at.get(j)
        nothing = np.zeros(self.count)
        radius, off, steer = self._radius(("radial", j), dev, bend)
        follows_torque = np.isnan(self.numbers.radial[:, j, 3]).any()
        bound, felt, _ = self._bound(j, self._slopes(dev) if follows_torque else {})
        bound_off, bound_steer = (felt * dev).sum(axis=1), (felt * bend).sum(axis=1)
        first = sampled(self._split(law.first))
        given = self._split(self.numbers.radial[:, j, 1])
        follows = np.isnan(given[:, 0])
        stick = self._stick(bound, first, given)
        soft = np.where(follows & (first.low > 0.0), 1.0 / np.maximum(first.low, 1e-300), 0.0)
        stick_off, stick_steer = soft * bound_off, soft * bound_steer
        reach = sampled(self._split(self.numbers.radial[:, j, 2]))
        last = law.last

        def add(to: int, value: Range, more: Array = nothing, bends: Array = nothing) -> None:
            found.add(owner, to, value, off + more, steer + bends)

        def force(to: int, value: Range, more: Array, bends: Array) -> None:
            found.add(owner, to, value, more, bends)

        if place == at.OPEN:
            if np.isfinite(reach.nodes).all():
                add(at.STOP, _less(reach, radius))
            # Without friction it moves freely; any friction ends that.
            force(at.SLIP, _minus(bound), bound_off, bound_steer)
        elif place == at.STICK:
            add(at.SLIP, _less(stick, radius), stick_off, stick_steer)
            if follows.all():
                # It bends throughout as long as its clearance closes before it slips.
                found.alternative(_less(stick, reach), stick_off, stick_steer)
        elif place == at.SLIP:
            add(at.STICK, _less(radius, stick), stick_off, stick_steer)
            if np.isfinite(reach.nodes).all():
                add(at.STOP, _less(reach, radius))
        elif place == at.STOP:
            add(at.SLIP, _less(radius, reach))
            force(at.STICK, _less(reach, stick), stick_off, stick_steer)
        elif where is not None and place in (at.WALL, at.CORNER):
            inner = self.z_in + where
            p, p_off, p_steer = self.chord[where], dev[:, inner], bend[:, inner]
            if place == at.WALL:
                force(at.OPEN, p, p_off, p_steer)
            else:
                lower = sampled(self._split(law.first * law.stick))
                force(at.STICK, _less(p, lower), p_off, p_steer)
                force(at.SLIP, _less(bound, p), p_off + bound_off, p_steer + bound_steer)
        elif place == at.PINNED and np.isinf(last).all():
            # A rigid ring without any play pins its gear, but as soon as it has some.
            force(at.WALL, _minus(reach), nothing, nothing)
        elif where is not None and place == at.PINNED:
            force(at.STICK, _minus(stick), stick_off, stick_steer)
            pull = self._pull(where)
            parts = slice(self.z_in + where, self.z_in + where + 2)
            p_off = np.sqrt((dev[:, parts] ** 2).sum(axis=1))
            p_steer = np.sqrt((bend[:, parts] ** 2).sum(axis=1))
            force(at.SLIP, _less(bound, pull), p_off + bound_off, p_steer + bound_steer)

    def _stick(self, bound: Range, first: Range, given: Array) -> Range:
        """Radius S1 at which slip starts along the chord, as given or F_m/K_w."""
        known = ~np.isnan(given[:, 0])
        stiff = np.where(first.middle > 0.0, first.middle, 1.0)
        nodes = bound.nodes / np.where(first.nodes > 0.0, first.nodes, 1.0)
        rate = bound.rate / stiff
        spread = bound.spread / np.maximum(first.low, 1e-300)
        moving = first.rate.any() or first.spread.max() > 1e-12 * np.abs(first.middle).max()
        if moving and not known.all():
            own = sampled(nodes)
            rate, spread = own.rate, own.spread + spread
        fixed = sampled(np.minimum(given, nodes))
        shape = known[:, None]
        return Range(
            np.where(shape, fixed.nodes, nodes),
            np.where(known, fixed.rate, rate),
            np.where(known, fixed.spread, spread),
        )

    def _pull(self, where: int) -> Range:
        """Size of the force of an element that is pinned at its centre."""
        p = self.chord[np.array([where, where + 1])]
        size = np.sqrt((p.nodes**2).sum(axis=2))
        speed = np.sqrt((p.rate**2).sum(axis=1)) + np.sqrt((p.spread**2).sum(axis=1))
        middle = size[:, NODES // 2]
        along = p.middle / np.where(middle > 0.0, middle, 1.0)[:, None]
        rate = (along * p.rate).sum(axis=1)
        turn = 2.0 * np.sqrt((p.off**2).sum(axis=1)) / np.where(middle > 0.0, middle, 1e-300)
        return Range(size, rate, np.minimum(speed * turn, 2.0 * speed))


@dataclass(frozen=True, slots=True, eq=False)
class _Slope:
    """Contact whose slope varies: by how much, and its force's derivative along the chord."""

    off: Array
    rate: Array
    spread: Array


@dataclass(frozen=True, slots=True, eq=False)
class _Radial:
    """Slope of a polar element against its radius: largest size, and by how much it varies."""

    size: Array
    off: Array


@dataclass(frozen=True, slots=True, eq=False)
class _Size:
    """Force of a polar element along its offset.

    Attributes
    ----------
    value : Range
        Along the chord.
    rate, spread : ndarray, shape (B,)
        Its derivative along the chord at a fixed offset.
    extra : ndarray, shape (B,)
        What the deviation of the unknowns adds to its range.
    """

    value: Range
    rate: Array
    spread: Array
    extra: Array

    @property
    def low(self) -> Array:
        """Lower bound along the chord."""
        return self.value.low

    @property
    def high(self) -> Array:
        """Upper bound along the chord."""
        return self.value.high


class _Ports:
    """Forces that vary nonlinearly, stacked."""

    def __init__(self, count: int, width: int, size: int) -> None:
        self._shape = count, width, size
        self._outputs: list[Array] = []
        self._slack: list[Array] = []
        self._rate: list[Array] = []
        self._spread: list[Array] = []

    def add(self, vector: Array, n: int) -> int:
        """Add a force that enters the balance along a vector (B, n)."""
        count, _, size = self._shape
        row = np.zeros((count, size))
        row[:, :n] = vector
        return self._add(row)

    def add_row(self, where: int) -> int:
        """Add a condition that stands in row `where`."""
        count, _, size = self._shape
        row = np.zeros((count, size))
        row[:, where] = 1.0
        return self._add(row)

    def _add(self, row: Array) -> int:
        count, width, _ = self._shape
        self._outputs.append(row)
        self._slack.append(np.zeros((count, width)))
        self._rate.append(np.zeros(count))
        self._spread.append(np.zeros(count))
        return len(self._outputs) - 1

    def slack_of(self, port: int, inputs: object, slack: Array) -> None:
        """Say by how much the slope of a port with respect to some quantities varies."""
        self._slack[port][:, inputs] += slack  # type: ignore[index]

    def add_slack(self, port: int, slack: Array) -> None:
        """Add slacks (B, width) with respect to all quantities."""
        self._slack[port] += slack

    def along(self, port: int, rate: Array, spread: Array) -> None:
        """Give the derivative of a port along the chord."""
        self._rate[port] = rate
        self._spread[port] = np.asarray(spread)

    def _stacked(self, parts: list[Array], *inner: int) -> Array:
        count = self._shape[0]
        return np.stack(parts, axis=1) if parts else np.zeros((count, 0, *inner))

    @property
    def outputs(self) -> Array:
        """U, shape (B, ports, size)."""
        return self._stacked(self._outputs, self._shape[2])

    @property
    def slack(self) -> Array:
        """ρ, shape (B, ports, width)."""
        return self._stacked(self._slack, self._shape[1])

    @property
    def rate(self) -> Array:
        """Derivative along the chord, shape (B, ports)."""
        return self._stacked(self._rate)

    @property
    def spread(self) -> Array:
        """Its spread, shape (B, ports)."""
        return self._stacked(self._spread)


def _clear(value: Range, off: Array, steer: Array) -> Flags:
    """Whether a gauge is positive between the ends: off zero, or leaving it at one end."""
    rises = value.rate - value.spread - steer > 0.0
    falls = value.rate + value.spread + steer < 0.0
    first, last = value.nodes[:, 0] >= -VERGE, value.nodes[:, -1] >= -VERGE
    return np.asarray((value.low - off >= -VERGE) | (first & rises) | (last & falls))


def _times(one: Array, one_off: Array, other: Array, other_off: Array) -> tuple[Array, Array]:
    """Product of two ranges given by middle and half width."""
    off = np.abs(one) * other_off + one_off * (np.abs(other) + other_off)
    return np.asarray(one * other), np.asarray(off)


def _minus(value: Range) -> Range:
    return Range(-value.nodes, -value.rate, value.spread)


def _shifted(value: Range, by: Range) -> Range:
    return Range(value.nodes - by.nodes, value.rate - by.rate, value.spread + by.spread)


_less = _shifted


def _series(matrix: Array, base: Array) -> Array:
    """Solve d = base + M d for (B, k, k) and (B, k); NaN where there is no one solution."""
    try:
        return np.asarray(np.linalg.solve(np.eye(base.shape[1]) - matrix, base[:, :, None])[..., 0])
    except np.linalg.LinAlgError:
        if len(base) == 1:
            return np.full(base.shape, np.nan)
        return np.concatenate([_series(matrix[[k]], base[[k]]) for k in range(len(base))])
