"""Gauges: quantities that are positive as long as every element keeps its state."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from functools import partial
from typing import NamedTuple

import numpy as np

from loadshare.array_types import Array, Flags
from loadshare.settings import FOLLOW
from loadshare.solver.hot import contact_states as at
from loadshare.study.follow.forces import friction_bound, varying_slopes
from loadshare.study.follow.ranges import Enclosure, RangeAlong, sampled
from loadshare.study.follow.stretches import Stretches


class Gauge(NamedTuple):
    """A quantity that turns negative where an element leaves its state.

    Attributes
    ----------
    switch : int
        The element, by its number in an active set.
    to : int
        Code of the state to which it then changes.
    value : Enclosure
        In deflections (an approach, a radius) or loads (a force).
    instead : Enclosure or None
        A quantity that may be positive in its place.
    """

    switch: int
    to: int
    value: Enclosure
    instead: Enclosure | None = None

    @property
    def first(self) -> Array:
        """Value at the first end of every stretch, shape (B,)."""
        first = self.value.chord.nodes[:, 0]
        return first if self.instead is None else np.maximum(first, self.instead.chord.nodes[:, 0])

    def holds(self, verge: float) -> Flags:
        """Return whether it is positive between the ends."""
        clear = self.value.clear(verge)
        return clear if self.instead is None else clear | self.instead.clear(verge)


def gauges_at(s: Stretches, only: Collection[int] | None = None) -> list[Gauge]:
    """Return the gauges of elements, all by default, on the chords themselves."""
    nothing = np.zeros((s.count, s.width))
    return list(gauges(s, nothing, nothing, only))


def gauges(
    s: Stretches, dev: Array, bend: Array, only: Collection[int] | None = None
) -> Iterator[Gauge]:
    """Yield the gauges of elements.

    Parameters
    ----------
    s : Stretches
    dev, bend : ndarray, shape (B, width)
        Deviations from the chord of the quantities on which laws depend, and of their derivatives.
    only : collection of int, optional
        Numbers of the elements in an active set; all by default.
    """
    e = s.equations
    for k in range(e.radials.stop):
        if only is not None and k not in only:
            continue
        if k < e.arcs.start:
            yield from _contact_gauges(s, k, dev, bend)
        elif k in e.arcs:
            yield _arc_gauge(s, k, dev, bend)
        else:
            yield from _radial_gauges(s, k, dev, bend)


def _arc_gauge(s: Stretches, k: int, dev: Array, bend: Array) -> Gauge:
    where = s.equations.polar_at.get(k)
    if where is not None:
        return Gauge(k, at.OPEN, s.unknown(where, dev, bend))
    margin = _radius(s, k, dev, bend)
    closed = k in s.equations.polar_at
    return Gauge(k, at.OPEN if closed else at.CLOSED, -margin if closed else margin)


def _contact_gauges(s: Stretches, k: int, dev: Array, bend: Array) -> Iterator[Gauge]:
    e = s.equations
    column = e.structure.springs + k
    approach = Enclosure(s.approach[column], dev[:, column], bend[:, column])
    if e.states[k] != at.CLOSED:
        if np.isfinite(approach.chord.nodes).all():
            yield Gauge(k, at.CLOSED, -approach)
    elif column in e.rigid:
        where = int(e.rigid_at[np.flatnonzero(e.rigid == column)[0]])
        yield Gauge(k, at.OPEN, s.unknown(where, dev, bend))
    elif column not in e.tables:
        yield Gauge(k, at.OPEN, approach)
    else:
        # A table's piece, from its beginning to its end.
        piece = e.active.pieces[int(np.flatnonzero(e.tables == column)[0])]
        points = s.split(s.numbers.tables[:, e.tabulated[column], 1])
        yield Gauge(k, at.OPEN, approach - _known(points[:, :, piece]))
        if piece + 2 < points.shape[-1] and np.isfinite(points[:, :, piece + 2]).all():
            yield Gauge(k, at.CLOSED, _known(points[:, :, piece + 1]) - approach)


def _radial_gauges(s: Stretches, k: int, dev: Array, bend: Array) -> Iterator[Gauge]:
    """Yield gauges of a radial element towards the states before and after its own."""
    gauge = partial(Gauge, k)
    e, law, states = s.equations, s.state.laws[k], int(s.equations.states[k])
    where = e.polar_at.get(k)
    given = s.split(s.numbers.radial[:, k - e.radials.start])
    radius, bound = _radius(s, k, dev, bend), _bound(s, k, dev, bend)
    stick, reach = _stick(s, k, bound), _known(given[:, :, 2])
    ends = bool(np.isfinite(reach.chord.nodes).all())
    if states == at.OPEN:
        if ends:
            yield gauge(at.STOP, reach - radius)
        # Without friction a spline moves freely; any friction ends that. A ring has none.
        if given[:, :, 3:5].any():
            yield gauge(at.SLIP, -bound)
    elif states == at.STICK and np.isnan(given[:, 0, 1]).all():
        # The spline bends throughout as long as its clearance closes before it slips.
        yield gauge(at.SLIP, stick - radius, stick - reach)
    elif states == at.STICK:
        yield gauge(at.SLIP, stick - radius)
    elif states == at.SLIP:
        if bound.chord.nodes.any():
            yield gauge(at.STICK, radius - stick)
        if ends:
            yield gauge(at.STOP, reach - radius)
    elif states == at.STOP:
        yield gauge(at.SLIP, radius - reach)
        # An element without a shaft that bends first has no such piece, even without clearance.
        if given[:, :, 0].any():
            yield gauge(at.STICK, reach - stick)
    elif states == at.WALL and where is not None:
        yield gauge(at.OPEN, s.unknown(where, dev, bend))
    elif states == at.CORNER and where is not None:
        force = s.unknown(where, dev, bend)
        yield gauge(at.STICK, force - _known(s.split(law.first * law.stick)))
        yield gauge(at.SLIP, bound - force)
    elif np.isinf(law.last).all():
        # A rigid ring pins its gear only as long as it has no play at all.
        yield gauge(at.WALL, -reach)
    elif where is not None:
        yield gauge(at.STICK, -stick)
        yield gauge(at.SLIP, bound - _pull(s, where, dev, bend))


def _known(nodes: Array) -> Enclosure:
    """Enclose a quantity that depends on the parameter alone, known at the nodes (B, NODES)."""
    still = np.zeros(len(nodes))
    return Enclosure(sampled(nodes), still, still)


def _radius(s: Stretches, k: int, dev: Array, bend: Array) -> Enclosure:
    """Enclose the radius of an offset, or the margin of an arc."""
    offset = s.offsets[k]
    around = s.around(k, dev)
    if k in s.equations.arcs:
        nodes = s.split(s.state.margin[k])
        clearance = s.sampled(s.numbers.clearance[:, k - s.equations.arcs.start])
    else:
        nodes = s.split(s.state.polars[k].radius)
        clearance = sampled(np.zeros((s.count, FOLLOW.nodes)))
    straight, across = offset.rate[:, 0], np.sqrt((offset.rate[:, 1:] ** 2).sum(axis=1))
    varies = np.sqrt((offset.spread**2).sum(axis=1))
    spread = around.rise * np.abs(straight) + around.turn * across
    # The radius changes no faster than the offset itself, however its direction turns.
    moved = np.sqrt((offset.rate**2).sum(axis=1))
    spread = np.fmin(spread, np.abs(straight) + moved) + varies
    chord = RangeAlong(nodes, straight + clearance.rate, spread + clearance.spread)
    return Enclosure(chord, s.felt(k, dev, around.turn), s.felt(k, bend, around.turn))


def _bound(s: Stretches, k: int, dev: Array, bend: Array) -> Enclosure:
    """Enclose the friction bound of a radial element."""
    follows = np.isnan(s.numbers.radial[:, k - s.equations.radials.start, 3]).any()
    bound = friction_bound(s, k, varying_slopes(s, dev) if follows else {})
    return Enclosure(bound.value, (bound.felt * dev).sum(axis=1), (bound.felt * bend).sum(axis=1))


def _stick(s: Stretches, k: int, bound: Enclosure) -> Enclosure:
    """Enclose the radius S1 at which slip starts, as given or F_m/K_w."""
    given = s.split(s.numbers.radial[:, k - s.equations.radials.start, 1])
    known = ~np.isnan(given[:, 0])
    first, friction = s.sampled(s.state.laws[k].first), bound.chord
    stiff = np.where(first.middle > 0.0, first.middle, 1.0)
    nodes = friction.nodes / np.where(first.nodes > 0.0, first.nodes, 1.0)
    rate = friction.rate / stiff
    spread = friction.spread / np.maximum(first.low, 1e-300)
    moving = first.rate.any() or first.spread.max() > FOLLOW.constant * np.abs(first.middle).max()
    if moving and not known.all():
        own = sampled(nodes)
        rate, spread = own.rate, own.spread + spread
    fixed = sampled(np.minimum(given, nodes))
    chord = RangeAlong(
        np.where(known[:, None], fixed.nodes, nodes),
        np.where(known, fixed.rate, rate),
        np.where(known, fixed.spread, spread),
    )
    soft = np.where(~known & (first.low > 0.0), 1.0 / np.maximum(first.low, 1e-300), 0.0)
    return Enclosure(chord, soft * bound.off, soft * bound.bend)


def _pull(s: Stretches, where: int, dev: Array, bend: Array) -> Enclosure:
    """Enclose the size of the force of an element that is pinned at its centre."""
    p = s.chord[np.array([where, where + 1])]
    size = np.sqrt((p.nodes**2).sum(axis=2))
    speed = np.sqrt((p.rate**2).sum(axis=1)) + np.sqrt((p.spread**2).sum(axis=1))
    middle = size[:, FOLLOW.nodes // 2]
    along = p.middle / np.where(middle > 0.0, middle, 1.0)[:, None]
    turn = 2.0 * np.sqrt((p.off**2).sum(axis=1)) / np.where(middle > 0.0, middle, 1e-300)
    spread = np.minimum(speed * turn, 2.0 * speed)
    parts = slice(s.z_in + where, s.z_in + where + 2)
    off, bends = (np.sqrt((v[:, parts] ** 2).sum(axis=1)) for v in (dev, bend))
    return Enclosure(RangeAlong(size, (along * p.rate).sum(axis=1), spread), off, bends)
