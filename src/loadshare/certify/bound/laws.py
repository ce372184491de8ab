"""Every element at the claim: whether it acts, how it yields, and what its law leaves over.

Scalar columns yield by a compliance; arcs and radial elements as in `pairs`. Source: formulation,
sections 3, 5, 6 and 16.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from loadshare.array_types import Array, Flags, Numbers
from loadshare.certify.bound.acts import Act, Acts
from loadshare.certify.bound.claim import EPS, TINY, Claim
from loadshare.certify.bound.elements import Elements
from loadshare.certify.bound.pairs import put_pairs
from loadshare.certify.bound.twofold import exact, minus, plus, power_two_thirds, two_product
from loadshare.settings import BOUND


def elements(
    claim: Claim, act: Acts, scale: Array, verge: Flags | None, softest: float = BOUND.softest
) -> Elements:
    """Describe the elements at S claims.

    Parameters
    ----------
    claim : Claim
    act : ndarray of int8, shape (S, elements)
        How they are taken to act.
    scale : ndarray, shape (S,)
        Load of the claims [N].
    verge : ndarray of bool, shape (S, elements), or None
        Elements of which it is open how they act: contacts among them carry next to nothing. None
        where secants take the place of curvatures.
    softest : float
        Largest compliance of a turn, in those of the claim; what a softer one has less in
        stiffness goes to `stiff_error`.
    """
    columns, count = claim.columns, claim.count
    m, pairs = len(columns.names), columns.pairs
    shape = (count, m)
    active = np.zeros(shape, dtype=bool)
    soft, width, curve = np.zeros(shape), np.zeros(shape), np.zeros(shape)
    room = np.full(shape, np.inf)
    force = claim.forces.copy()
    # A flank that pulls has no law: the pull is put aside.
    force[:, columns.flanks] = np.maximum(force[:, columns.flanks], 0.0)
    rounding = np.zeros(shape)
    lengths, sizes = claim.lengths
    misfit = lengths.value
    flanks, stops = columns.flanks.stop, columns.stops.stop - columns.stops.start
    active[:, columns.flanks] = act[:, :flanks] != Act.OPEN
    active[:, columns.stops] = act[:, flanks : flanks + stops] != Act.OPEN
    pushed = force[:, columns.flanks]
    least = BOUND.light * scale[:, None]
    light = np.ones(pushed.shape, bool) if verge is None else verge[:, :flanks] | (pushed == 0.0)
    reached = pushed if verge is None else BOUND.reached * pushed
    at = np.where(light, np.maximum(reached, least), pushed)
    _flanks(claim, scale, at, soft, curve, room, misfit, width)
    light &= curve[:, columns.flanks] > 0.0
    curve[:, columns.flanks][light] = 0.0
    if verge is not None:
        room[:, columns.flanks][light] = (at - pushed)[light]
    _springs(claim, active, soft, misfit, width)
    scalar = slice(0, columns.first_pair)
    width[:, scalar] += EPS * np.abs(misfit[:, scalar]) + TINY * sizes[:, scalar]
    force[:, scalar] = np.where(active[:, scalar], force[:, scalar], 0.0)
    lines: list[Any] = [
        np.zeros((count, k)) for k in (*[pairs] * 6, len(claim.columns.claims.radials))
    ]
    lines.append(np.zeros((count, pairs), dtype=bool))
    found = Elements(
        act,
        active,
        force,
        rounding,
        soft,
        np.zeros((count, pairs)),
        misfit,
        width,
        curve,
        room,
        np.zeros((count, pairs, 2)),
        np.ones((count, pairs)),
        *lines,
    )
    if pairs:
        with np.errstate(divide="ignore", invalid="ignore"):
            open_ended = None if verge is None else verge[:, flanks + stops :]
            put_pairs(claim, act[:, flanks + stops :], found, least, open_ended, softest)
    if claim.slack is not None:
        found.width[:] += claim.slack
    return found


def _flanks(
    claim: Claim,
    scale: Array,
    at: Array,
    soft: Array,
    curve: Array,
    room: Array,
    misfit: Array,
    width: Array,
) -> None:
    """Compliance (at a force), curvature and misfit of flanks, in twice the precision."""
    columns, here = claim.columns, claim.situations
    b, c = here.bending, here.hertz
    force = np.maximum(claim.forces[:, columns.flanks], 0.0)
    part = slice(0, columns.flanks.stop)
    hertz = 2.0 / 3.0 * c / np.cbrt(at)
    soft[:, part] = b + hertz
    curve[:, part] = hertz / at
    length, sizes = claim.lengths
    length = type(length)(length.high[:, part], length.low[:, part])
    if not claim.fine:
        root = np.cbrt(force)
        yielded = exact(b * force + c * (root * root))
        width[:, part] += EPS * yielded.high
    else:
        yielded = two_product(np.broadcast_to(b, force.shape), force)
    if claim.fine and c.any():
        power = power_two_thirds(force)
        wide = np.broadcast_to(c, force.shape)
        yielded = plus(yielded, plus(two_product(wide, power.high), exact(wide * power.low)))
    tabled = columns.tabled
    if len(tabled):
        yielded = type(yielded)(yielded.high.copy(), yielded.low.copy())
        slope, value, jump, room[:, tabled] = _tables(claim, tabled, force[:, tabled], scale)
        soft[:, tabled], yielded.high[:, tabled], yielded.low[:, tabled] = slope, value, 0.0
        width[:, tabled] += EPS * value
        curve[:, tabled] = jump
    misfit[:, part] = minus(length, yielded).value
    width[:, part] += TINY * (yielded.high + sizes[:, part])


def _tables(
    claim: Claim, flanks: Numbers, force: Array, scale: Array
) -> tuple[Array, Array, Array, Array]:
    """Slopes and values of tabulated laws (S, k), curvatures that cover corners close by, and room.

    The last is the distance to the nearest corner that is not covered [N].
    """
    table = np.broadcast_to(
        claim.situations.table[:, flanks], (*force.shape, *claim.situations.table.shape[2:])
    )
    forces, values = table[:, :, 0], table[:, :, 1]
    last = (~np.isnan(forces)).sum(axis=2) - 2
    k = np.clip((forces <= force[:, :, None]).sum(axis=2) - 1, 0, last)
    slopes = np.diff(values, axis=2) / np.diff(forces, axis=2)

    def at(array: Array, place: Numbers) -> Array:
        return np.take_along_axis(array, place[:, :, None], axis=2)[:, :, 0]

    slope = at(slopes, k)
    value = at(values, k) + slope * (force - at(forces, k))
    near = BOUND.light * scale[:, None]
    jump = np.zeros(force.shape)
    corners = np.abs(forces[:, :, 1:-1] - force[:, :, None])
    ends = np.arange(1, forces.shape[2] - 1) > last[:, :, None]
    corners = np.where(ends | np.isnan(corners) | (corners <= near[:, :, None]), np.inf, corners)
    room = corners.min(axis=2, initial=np.inf)
    for j, corner in ((k - 1, at(forces, k)), (k + 1, at(forces, k + 1))):
        there = (j >= 0) & (j <= last) & (np.abs(force - corner) <= near)
        other = at(slopes, np.clip(j, 0, slopes.shape[2] - 1))
        with np.errstate(invalid="ignore"):
            # A bend of the law within reach counts as if it were spread over the reach.
            jump = np.maximum(jump, np.where(there, 3.0 * np.abs(other - slope), 0.0))
    return slope, value, -jump, room


def _springs(claim: Claim, active: Flags, soft: Array, misfit: Array, width: Array) -> None:
    """Shafts, bearings, stops and the shafts of splines with memory: linear columns."""
    columns, here = claim.columns, claim.situations
    support = here.support[:, columns.moving].reshape(len(here.support), -1)
    held = support > 0.0
    given = [
        columns.shaft_arms**2 / here.torsion[:, columns.elastic_shafts],
        np.where(held, 1.0 / np.where(held, support, 1.0), np.nan),
        np.repeat(here.wall, 2, axis=1),
    ]
    if columns.slips:
        given.append(np.repeat(1.0 / here.spline[:, :, 0], 2, axis=1))
    rows = max(map(len, given))
    compliance = np.concatenate([np.broadcast_to(v, (rows, v.shape[1])) for v in given], axis=1)
    linear, stops = slice(columns.shafts.start, columns.bends.stop), columns.stops
    held = ~np.isnan(compliance)
    compliance = np.where(held, compliance, 0.0)
    active[:, linear.start : stops.start] = held[:, : stops.start - linear.start]
    active[:, columns.bends] = held[:, stops.stop - linear.start :]
    soft[:, linear] = compliance
    yielded = compliance * claim.forces[:, linear]
    length = claim.lengths[0]
    misfit[:, linear] = (length.high[:, linear] - yielded) + length.low[:, linear]
    width[:, linear] += EPS * np.abs(yielded)
