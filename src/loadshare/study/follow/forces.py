"""Forces that vary nonlinearly along stretches: how they enter equations, how much they vary."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from loadshare.array_types import Array
from loadshare.settings import FOLLOW
from loadshare.solver.hot import contact_states as at
from loadshare.study.follow.equations import pressed
from loadshare.study.follow.ranges import RangeAlong, sampled
from loadshare.study.follow.stretches import OffsetBounds, Stretches


class Force(NamedTuple):
    """A force, or a condition, that depends nonlinearly on quantities V z.

    Attributes
    ----------
    into : ndarray, shape (B, size)
        A row of U: how it enters the equations.
    slack : ndarray, shape (B, width)
        A row of ρ: by how much its slopes with respect to the quantities vary.
    rate, spread : ndarray, shape (B,)
        Its derivative along the chord lies within `spread` of `rate`.
    """

    into: Array
    slack: Array
    rate: Array
    spread: Array


class ContactSlope(NamedTuple):
    """A contact's slope: by how much it varies, and its force's derivative along the chord."""

    off: Array
    rate: Array
    spread: Array


class Bound(NamedTuple):
    """A friction bound.

    Attributes
    ----------
    value : RangeAlong
    felt : ndarray, shape (B, width)
        Largest size of its slope with respect to the quantities.
    varies : ndarray, shape (B, width)
        By how much this slope varies.
    """

    value: RangeAlong
    felt: Array
    varies: Array


class Push(NamedTuple):
    """The force of an arc or radial element along its offset.

    Attributes
    ----------
    value : RangeAlong
        Along the chord.
    rate, spread : ndarray, shape (B,)
        Its derivative along the chord at a fixed offset.
    extra : ndarray, shape (B,)
        What the deviation of the unknowns adds to its range.
    steep, off : ndarray, shape (B,)
        Its slope with respect to the radius: largest size, and by how much it varies.
    """

    value: RangeAlong
    rate: Array
    spread: Array
    extra: Array
    steep: Array
    off: Array


def forces(s: Stretches, dev: Array) -> Iterator[Force]:
    """Yield the forces that vary where quantities deviate from the chord by `dev` (B, width)."""
    e = s.equations
    slopes = varying_slopes(s, dev)
    for k in np.flatnonzero(e.acts).tolist():
        if k in slopes:
            slope = slopes[k]
            yield Force(s.inputs[:, k], _slack(s, k, slope.off), *slope[1:])
    for k, where in s.turning():
        yield from _turning_force(s, k, where, dev, slopes)
    for k in e.radials:
        stiff = s.sampled(s.state.laws[k].first)
        if e.states[k] == at.STICK and stiff.off.any():
            still = np.zeros(s.count)
            for i in range(s.columns[k].start, s.columns[k].stop):
                yield Force(s.inputs[:, i], _slack(s, i, stiff.off), still, still)


def _slack(s: Stretches, columns: int | slice, slack: Array) -> Array:
    """Return a row of ρ, which is zero except for some of the quantities."""
    found = np.zeros((s.count, s.width))
    found[:, columns] = slack
    return found


# --- Contacts -----------------------------------------------------------------------------------


def varying_slopes(s: Stretches, dev: Array) -> dict[int, ContactSlope]:
    """Return contacts whose slope varies: by how much, and how their force changes on the chord."""
    e, found = s.equations, {}
    if len(e.curved):
        every = _curved(s, dev)
        for i, k in enumerate(e.curved.tolist()):
            found[k] = ContactSlope(*(part[:, i] for part in every))
    bending, still = s.numbers.bending, np.zeros(s.count)
    varies = (bending != bending[:1]).any(axis=0)
    acting = {*range(e.structure.springs), *e.linear.tolist()}
    for k in sorted(k for k in acting if varies[k]):
        b = s.sampled(bending[:, k])
        off = np.where(b.low > 0.0, 1.0 / b.low - 1.0 / b.high, np.inf)
        found[k] = ContactSlope(off, still, still)
    return found


def _curved(s: Stretches, dev: Array) -> ContactSlope:
    """Enclose slopes and derivatives of forces, δ = bF + cF^(2/3)."""
    columns = s.equations.curved
    approach, dev = s.approach[columns], dev[:, columns]
    b, c = (s.sampled(v[:, columns]) for v in (s.numbers.bending, s.numbers.hertz))
    low, high = approach.low - dev, approach.high + dev
    nearest = np.where(low * high <= 0.0, 0.0, np.minimum(np.abs(low), np.abs(high)))
    furthest = np.maximum(np.abs(low), np.abs(high))
    least_force, least = pressed(b.high, c.high, nearest)
    force, most = pressed(np.maximum(b.low, 0.0), np.maximum(c.low, 0.0), furthest)
    force_middle, middle = pressed(b.middle, c.middle, approach.middle)
    off = np.maximum(most - middle, middle - least)
    moved, spread = _times(middle, off, approach.rate, approach.spread)
    # Changes of b and c add -F F' b' - F^(2/3) F' c', with the sign of F.
    sign = np.sign(approach.middle)
    crosses = low * high < 0.0
    for part, power in ((b, 1.0), (c, 2.0 / 3.0)):
        upper = np.abs(force) ** power * most
        lower = np.where(crosses, -upper, np.abs(least_force) ** power * least)
        here = np.abs(force_middle) ** power * middle
        wide = np.maximum(upper - here, here - lower)
        own, own_spread = _times(here, wide, part.rate, part.spread)
        moved, spread = moved - sign * own, spread + own_spread
    return ContactSlope(off, moved, spread)


def _times(one: Array, one_off: Array, other: Array, other_off: Array) -> tuple[Array, Array]:
    """Return the product of two ranges, each given by its middle and half width."""
    off = np.abs(one) * other_off + one_off * (np.abs(other) + other_off)
    return np.asarray(one * other), np.asarray(off)


def _scaled(one: RangeAlong, other: RangeAlong) -> tuple[Array, Array]:
    """Return the product of a quantity and the derivative of another, middle and half width."""
    return _times(one.middle, one.off, other.rate, other.spread)


# --- Arcs and radial elements -------------------------------------------------------------------


def friction_bound(s: Stretches, k: int, slopes: dict[int, ContactSlope]) -> Bound:
    """Return a radial element's friction bound on the chord, and how it follows the contacts."""
    e, j = s.equations, k - s.equations.radials.start
    value = s.sampled(s.state.laws[k].bound)
    given = s.split(s.numbers.radial[:, j])
    felt, varies = np.zeros((s.count, s.width)), np.zeros((s.count, s.width))
    per = np.where(np.isnan(given[:, 0, 3]), given[:, :, 4].max(axis=1), 0.0)
    if not per.any():
        return Bound(value, felt, varies)
    arms = s.own(s.at_middle.carried)[:, j]
    slope = np.abs(s.split(s.state.slope)).max(axis=1)
    rate, spread = np.zeros(s.count), np.zeros(s.count)
    torque = s.split(s.state.transmitted[:, j])
    sign = np.sign(torque[:, FOLLOW.nodes // 2])
    for i in np.flatnonzero(e.acts).tolist():
        if not arms[:, i].any():
            continue
        arm, bends = per * np.abs(arms[:, i]), i in slopes and i in e.curved
        force = slopes[i] if bends else s.sampled(s.state.force[:, i])
        if bends:
            varies[:, i] = arm * force.off
            felt[:, i] = arm * (slope[:, i] + force.off)
        else:
            felt[:, i] = arm * slope[:, i]
        rate += per * sign * arms[:, i] * force.rate
        spread += arm * force.spread
    changing = s.sampled(s.numbers.radial[:, j, 4])
    spread += (np.abs(changing.rate) + changing.spread) * np.abs(torque).max(axis=1)
    spread = np.maximum(spread, np.abs(value.rate - rate) + value.spread)
    # Where the torque changes its sign the bound has a kink.
    kink = (torque.min(axis=1) <= 0.0) & (torque.max(axis=1) >= 0.0)
    varies = np.where(kink[:, None] & (felt > 0.0), np.inf, varies)
    return Bound(RangeAlong(value.nodes, rate, spread), felt, varies)


def _turning_force(
    s: Stretches, k: int, where: int | None, dev: Array, slopes: dict[int, ContactSlope]
) -> Iterator[Force]:
    """Yield the components of a force that turns, and the condition on an unknown one."""
    e, offset, here = s.equations, s.offsets[k], s.columns[k]
    bound = None
    if where is None and k in e.radials:
        bound = friction_bound(s, k, slopes)
    around = s.around(k, dev)
    push = _push(s, k, where, dev, bound)
    width = offset.rate.shape[1]
    # By how much the direction itself may differ from that in the middle, along and across it.
    turn = np.stack([around.rise, *[around.turn] * (width - 1)], axis=1)
    slack, stiff = _turned(s, k, around, push, width)
    moved = np.abs(offset.rate) + offset.spread
    rate = stiff * offset.rate
    rate[:, 0] += push.rate
    spread = (slack @ moved[:, :, None])[:, :, 0] + np.abs(stiff) * offset.spread
    spread += (np.abs(push.rate) + push.spread)[:, None] * turn
    spread[:, 0] += push.spread
    for i in range(width):
        every = _slack(s, here, slack[:, i])
        if where is not None:
            every[:, s.z_in + where] += turn[:, i]
        elif bound is not None:
            every += bound.felt * turn[:, i, None] + (bound.varies if i == 0 else 0.0)
        yield Force(s.inputs[:, here.start + i], every, rate[:, i], spread[:, i])
    if where is not None:
        limit = _limit(s, k)
        row = np.zeros((s.count, e.size))
        row[:, where] = 1.0
        straight = s.state.polars[k].sense * offset.rate[:, 0]
        turned = (turn * moved).sum(axis=1) + offset.spread[:, 0]
        yield Force(row, _slack(s, here, turn), straight - limit.rate, turned + limit.spread)


def _turned(
    s: Stretches, k: int, around: OffsetBounds, push: Push, width: int
) -> tuple[Array, Array]:
    """Return by how much a turning force's stiffness varies, (B, width, width), and its diagonal.

    Along the force's direction the stiffness is that of the push, across it force over radius.
    """
    largest = np.maximum(np.abs(push.value.low), np.abs(push.value.high)) + push.extra
    radius = s.radii[k]
    across = push.value.middle / radius
    across_off = (push.value.off + push.extra + np.abs(across) * around.off) / around.least
    # Turning mixes the stiffness along the direction with that across it.
    twist = push.steep + largest / around.least
    diagonal = np.stack([push.off, *[across_off] * (width - 1)], axis=1)
    slack = np.tile((twist * around.turn**2)[:, None, None], (1, width, width))
    slack[:, 0, 1:] = slack[:, 1:, 0] = (twist * around.turn)[:, None]
    slack += diagonal[:, :, None] * np.eye(width)
    stiff = np.stack(
        [s.split(s.state.polars[k].slope)[:, FOLLOW.nodes // 2], *[across] * (width - 1)], axis=1
    )
    return slack, stiff


def _limit(s: Stretches, k: int) -> RangeAlong:
    """Return the radius of a step; for an arc, the clearance less the nominal length."""
    e = s.equations
    if k in e.arcs:
        # The row is −margin = a − c − |d|.
        a = k - e.arcs.start
        nominal = s.split(s.numbers.nominal[:, a])
        apart = np.sqrt((nominal * nominal).sum(axis=-1))
        return sampled(s.split(s.numbers.clearance[:, a]) - apart)
    law = s.state.laws[k]
    return s.sampled(law.stick if e.states[k] == at.CORNER else law.reach)


def _push(s: Stretches, k: int, where: int | None, dev: Array, bound: Bound | None) -> Push:
    """Return the force of an arc or radial element along its offset."""
    e, still = s.equations, np.zeros(s.count)
    polar = s.state.polars[k]
    if where is not None:
        p = s.chord[where]
        value = RangeAlong(polar.sense * p.nodes, polar.sense * p.rate, p.spread)
        return Push(value, value.rate, value.spread, dev[:, s.z_in + where], still, still)
    around = s.around(k, dev)
    value, give = s.sampled(polar.size), s.sampled(polar.slope)
    # The chord's own sagitta is far smaller than the band of the offset, which bounds it.
    felt = s.felt(k, dev, around.turn) + around.sagitta
    if bound is None:
        clearance = s.sampled(s.numbers.clearance[:, k - e.arcs.start])
        margin = s.sampled(s.state.margin[k])
        rate, spread = np.add(_scaled(give, clearance), _scaled(margin, give))
        extra = give.most * felt
        return Push(value, rate, spread, extra, give.most, give.off)
    follows = (bound.felt * dev).sum(axis=1)
    if e.states[k] == at.SLIP:
        value = bound.value
        return Push(value, value.rate, value.spread, follows, still, still)
    power = s.numbers.radial[0, k - e.radials.start, 6]
    if power != 1.0:
        return _rolling_push(s, k, felt, value, give, float(power))
    reach = s.sampled(s.state.laws[k].reach)
    moved, moved_spread = _scaled(give, reach)
    past = _times(s.radii[k] - reach.middle, around.off + reach.off, give.rate, give.spread)
    rate = bound.value.rate + past[0] - moved
    spread = bound.value.spread + past[1] + moved_spread
    extra = follows + give.most * felt
    return Push(value, rate, spread, extra, give.most, give.off)


def _rolling_push(
    s: Stretches, k: int, felt: Array, value: RangeAlong, give: RangeAlong, power: float
) -> Push:
    """Return the force of a bearing's wall, K (R − clearance)^power, with R known to `felt`."""
    numbers = s.numbers.radial[:, k - s.equations.radials.start]
    reach, stiffness = s.sampled(numbers[:, 2]), s.sampled(numbers[:, 5])
    gap = s.sampled(s.state.polars[k].radius).low - felt - reach.high
    # Off the chord the slope varies as well: it grows as the gap to the power − 1.
    bends = np.where(gap > 0.0, (power - 1.0) * give.most / gap, np.inf) * felt
    off, most = give.off + bends, give.most + bends
    extra = most * felt
    stiffer = stiffness.rate / stiffness.middle
    rate = value.middle * stiffer - give.middle * reach.rate
    spread = (value.off + extra) * np.abs(stiffer) + off * np.abs(reach.rate) + most * reach.spread
    varies = stiffness.spread + np.abs(stiffer) * stiffness.off
    spread += (value.most + extra) * varies / np.abs(stiffness.middle - stiffness.off)
    return Push(value, rate, spread, extra, most, off)
