"""Every element at the claim: whether it acts, how it yields, and the misfit of its law.

Scalar columns yield by a compliance; arcs and radial elements as in `pairs`. Source: formulation,
sections 3, 5, 6 and 16.
"""

from __future__ import annotations

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
        Elements that may act in more than one way: contacts among them carry almost nothing. None
        where secants take the place of curvatures.
    softest : float
        Largest compliance of a turn, over the largest of the claim; the missing difference in
        stiffness of a softer one goes to `stiff_error`.
    """
    columns, count, pairs = claim.columns, claim.count, claim.columns.pairs
    shape = count, len(columns.names)
    force = claim.forces.copy()
    # A flank that pulls has no law: the pull is put aside.
    force[:, columns.flanks] = np.maximum(force[:, columns.flanks], 0.0)
    lengths, sizes = claim.lengths
    flat = ("rounding", "soft", "width", "curve")
    paired = ("skew", "size", "along", "bent", "stiff_error", "follows", "shrinks", "centred")
    found = Elements(
        act=act,
        active=acting(claim, act),
        force=force,
        misfit=lengths.value,
        room=np.full(shape, np.inf),
        line=np.zeros((count, pairs, 2)),
        distance=np.ones((count, pairs)),
        spare=np.zeros((count, len(columns.claims.radials))),
        begins=np.zeros((count, pairs), dtype=bool),
        **{name: np.zeros(shape) for name in flat},
        **{name: np.zeros((count, pairs)) for name in paired},
    )
    scalar, contacts = slice(0, columns.first_pair), len(columns.contacts)
    least = BOUND.light * scale[:, None]
    _flanks(claim, found, scale, least, verge)
    _springs(claim, found)
    found.width[:, scalar] += EPS * np.abs(found.misfit[:, scalar]) + TINY * sizes[:, scalar]
    force[:, scalar] = np.where(found.active[:, scalar], force[:, scalar], 0.0)
    if pairs:
        with np.errstate(divide="ignore", invalid="ignore"):
            open_ended = None if verge is None else verge[:, contacts:]
            put_pairs(claim, act[:, contacts:], found, least, open_ended, softest)
    if claim.slack is not None:
        found.width[:] += claim.slack
    return found


def acting(claim: Claim, act: Acts) -> Flags:
    """Return which columns act, shape (S, m); parameters as for `elements`."""
    columns, contacts = claim.columns, len(claim.columns.contacts)
    found = np.ones((len(act), len(columns.names)), dtype=bool)
    found[:, columns.contacts] = act[:, :contacts] != Act.OPEN
    support = claim.situations.support[:, columns.moving]
    found[:, columns.bearings] = support.reshape(len(support), -1) > 0.0
    found[:, columns.first_pair :] = np.repeat(act[:, contacts:] != Act.OPEN, 2, axis=1)
    return found


def _flanks(claim: Claim, found: Elements, scale: Array, least: Array, verge: Flags | None) -> None:
    """Write compliance, curvature and misfit of flanks, in twice the precision if `claim.fine`."""
    columns, here = claim.columns, claim.situations
    b, c = here.bending, here.hertz
    part = slice(0, columns.flanks.stop)
    soft, curve, room, width = (
        v[:, part] for v in (found.soft, found.curve, found.room, found.width)
    )
    force = found.force[:, part]
    light = np.ones(force.shape, bool) if verge is None else verge[:, part] | (force == 0.0)
    reached = force if verge is None else BOUND.reached * force
    at = np.where(light, np.maximum(reached, least), force)
    hertz = 2.0 / 3.0 * c / np.cbrt(at)
    soft[:] = b + hertz
    curve[:] = hertz / at
    length, sizes = claim.lengths
    length = type(length)(length.high[:, part], length.low[:, part])
    if not claim.fine:
        root = np.cbrt(force)
        yielded = exact(b * force + c * (root * root))
        width += EPS * yielded.high
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
    found.misfit[:, part] = minus(length, yielded).value
    width += TINY * (yielded.high + sizes[:, part])
    light &= curve > 0.0
    curve[light] = 0.0
    if verge is not None:
        room[light] = (at - force)[light]


def _tables(
    claim: Claim, flanks: Numbers, force: Array, scale: Array
) -> tuple[Array, Array, Array, Array]:
    """Return slopes and values of tabulated laws (S, k), curvatures for near corners, and room.

    The curvatures cover corners close by; room is the distance to the next corner beyond [N].
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
            # A corner of the law within reach counts as if it were spread over the reach.
            jump = np.maximum(jump, np.where(there, 3.0 * np.abs(other - slope), 0.0))
    return slope, value, -jump, room


def _springs(claim: Claim, found: Elements) -> None:
    """Write shafts, bearings, stops and the shafts of splines with memory: linear columns."""
    columns, here = claim.columns, claim.situations
    support = here.support[:, columns.moving].reshape(len(here.support), -1)
    held = support > 0.0
    given = [
        columns.shaft_arms**2 / here.torsion[:, columns.elastic_shafts],
        np.where(held, 1.0 / np.where(held, support, 1.0), 0.0),
        np.repeat(here.wall, 2, axis=1),
    ]
    if columns.slips:
        given.append(np.repeat(1.0 / here.spline[:, :, 0], 2, axis=1))
    rows = max(map(len, given))
    compliance = np.concatenate([np.broadcast_to(v, (rows, v.shape[1])) for v in given], axis=1)
    linear = slice(columns.shafts.start, columns.bends.stop)
    found.soft[:, linear] = compliance
    yielded = compliance * claim.forces[:, linear]
    length = claim.lengths[0]
    found.misfit[:, linear] = (length.high[:, linear] - yielded) + length.low[:, linear]
    found.width[:, linear] += EPS * np.abs(yielded)
