r"""Every element at the claim: whether it acts, how it yields, and what its law leaves over.

Scalar columns yield by a compliance. Arcs and radial elements push along the line from their centre
and yield as

.. math:: \Delta o = \left(c_n\, u u^T \pm \frac{|d|}{F}\,(1 - u u^T)\right)\Delta F,

u the direction and |d| the distance from the centre: a turn of the direction is a compliance too.
Where a slip only begins, |d| = 0, u is the direction of the friction F. Whatever slips from there
follows it, so that its direction is off by no more than 2 |ΔF|/F: it is held across u.
Source: formulation, sections 3, 5, 6 and 16.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from loadshare.array_types import Array, Flags
from loadshare.certify.bound.claim import EPS, TINY, Claim
from loadshare.certify.bound.twofold import exact, minus, plus, power_two_thirds, two_product
from loadshare.settings import BOUND

Acts = NDArray[np.int8]


class Act:
    """How an element acts.

    Plain numbers: arrays are compared with members of an enumeration in ten times the time.
    """

    OPEN = 0
    """Not at all."""
    STICK = 1
    """As a spring about its centre."""
    PINNED = 2
    """Rigidly."""
    STEP = 3
    """Rigidly along its line, at the radius S1 where the force steps up to the level."""
    SLIP = 4
    """With a given force along its line."""
    STOP = 5
    """Along its line: a closed flank, stop or arc, a ring, a spline at its clearance."""
    WAYS = 6
    """How many there are."""


OPEN, CLOSED, LIGHT, ENDLESS = range(4)
"""How an element acts in large batches.

Not at all; by its law; by that of a light Hertz contact, which is soft; without force, where it
yields without end.
"""


@dataclass(frozen=True, eq=False)
class Elements:
    """Elements at S claims.

    Attributes
    ----------
    act : ndarray of int8, shape (S, elements)
        Flanks, stops, arcs, radial elements.
    active : ndarray of bool, shape (S, m)
        Columns that act.
    force : ndarray, shape (S, m)
        F of the columns [N]: what is claimed, along the line of the element where it has one.
    rounding : ndarray, shape (S, m)
        Of that [N].
    soft, skew : ndarray, shape (S, m) and (S, pairs)
        Compliance: diagonal, and the one off it of elements with two columns [m/N].
    misfit, width : ndarray, shape (S, m)
        A X − g − δ(F) [m], and its rounding.
    curve : ndarray, shape (S, m)
        Curvature of the law, as the part of the compliance that goes with F^(−1/3), over F.
    room : ndarray, shape (S, m)
        Error of the force [N] up to which the law is described: beyond, a light contact is stiffer,
        and a table has another corner.
    line, distance, size : ndarray, shape (S, pairs, 2), (S, pairs), (S, pairs)
        u, |d| [m] and the force along it [N].
    along : ndarray, shape (S, pairs)
        Compliance along the line [m/N].
    bent : ndarray, shape (S, pairs)
        Largest change of the compliance along the line per force [m/N²], from half to twice it.
    stiff_error : ndarray, shape (S, pairs)
        Lateral stiffness that `soft` and `skew` leave out or add [N/m].
    follows, shrinks : ndarray, shape (S, pairs)
        Change of the level [1/m], and of the room up to a stop [1/N], per torque over the spline;
        0 where it does not enter.
    spare : ndarray, shape (S, radials)
        Change with the torque of friction that is put aside [1/m].
    begins : ndarray of bool, shape (S, pairs)
        Slips that are zero so far: u is the direction of the friction.
    """

    act: Acts
    active: Flags
    force: Array
    rounding: Array
    soft: Array
    skew: Array
    misfit: Array
    width: Array
    curve: Array
    room: Array
    line: Array
    distance: Array
    size: Array
    along: Array
    bent: Array
    stiff_error: Array
    follows: Array
    shrinks: Array
    spare: Array
    begins: Flags


def first_acts(claim: Claim, noise: float = BOUND.noise) -> Acts:
    """How the elements act by the claim's own forces, shape (S, elements).

    Parameters
    ----------
    claim : Claim
    noise : float
        Friction, over the largest force, that is put aside.
    """
    columns = claim.columns
    force = claim.forces
    contacts = np.concatenate(
        [force[:, columns.flanks], force[:, columns.stops], force[:, columns.arcs][:, ::2]], axis=1
    )
    length = claim.lengths[0].value
    gap = np.concatenate(
        [-length[:, columns.flanks], -length[:, columns.stops], claim.arcs[1]], axis=1
    )
    largest = np.abs(force[:, columns.flanks]).max(axis=1, initial=0.0)[:, None]
    deflection = length[:, columns.flanks].max(axis=1, initial=0.0)[:, None]
    faint = (np.abs(contacts) <= BOUND.noise * largest) & (gap > BOUND.apart * deflection)
    closed = (contacts != 0.0) & ~faint
    scalar = np.where(closed, Act.STOP, Act.OPEN).astype(np.int8)
    radials = np.zeros((claim.count, 0), np.int8)
    if claim.radial_gears:
        radials = _radial_acts(claim, noise * largest)
    return np.concatenate([scalar, radials], axis=1)


def _unmoved(claim: Claim, distance: Array) -> Flags:
    """Splines with memory, among the radial elements, whose slip has changed by rounding only."""
    train, columns = claim.columns.train, claim.columns
    found = np.zeros(distance.shape, dtype=bool)
    for k, gear in enumerate(train.splines if train.slip is not None else ()):
        before = np.linalg.norm((train.slip or {})[gear])
        place = np.abs(claim.answers.displacement[:, columns.order[gear]]).max(axis=1)
        at = len(train.rounds) + k
        found[:, at] = distance[:, at] <= EPS * (before + place)
    return found


def _radial_acts(claim: Claim, noise: Array) -> Acts:
    columns = claim.columns
    pair = claim.forces[:, columns.radials].reshape(claim.count, -1, 2)
    where = claim.lengths[0].value[:, columns.radials].reshape(claim.count, -1, 2)
    size, distance = (np.sqrt((v**2).sum(axis=2)) for v in (pair, where))
    distance = np.where(_unmoved(claim, distance), 0.0, distance)
    first, stick, level, reach, last = claim.graphs.transpose(2, 0, 1)
    with np.errstate(invalid="ignore"):
        end = np.where(stick > 0.0, first * stick, 0.0)
    held = np.where(np.isinf(last), Act.PINNED, Act.STICK)
    below = size < level * (1.0 - BOUND.corner)
    steps = end < level * (1.0 - BOUND.corner)
    ways = (
        (np.isinf(stick), Act.STICK),
        ((level <= noise) & (size <= noise) & (distance < reach), Act.OPEN),
        ((level == 0.0) & (stick == 0.0) & (reach == 0.0), held),
        ((level == 0.0) & (size == 0.0), Act.OPEN),
        (steps & below & (stick == 0.0), Act.PINNED),
        (steps & below & (size > end), Act.STEP),
        ((distance < stick) & (stick > 0.0), Act.STICK),
        ((size <= end) & steps & (stick > 0.0), Act.STICK),
        ((distance < reach) & (distance > 0.0) & (level > 0.0), Act.SLIP),
        ((distance == 0.0) & (level > 0.0) & (stick == 0.0), Act.PINNED),
    )
    found = np.full(size.shape, Act.STOP)
    # The first that holds counts.
    for there, way in reversed(ways):
        found = np.where(there, way, found)
    return found.astype(np.int8)


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
    lines: list[Any] = [np.zeros((count, k)) for k in (*[pairs] * 6, len(claim.radial_gears))]
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
            _pairs(claim, act[:, flanks + stops :], found, least, open_ended, softest)
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
    claim: Claim, flanks: NDArray[np.intp], force: Array, scale: Array
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

    def at(array: Array, place: NDArray[np.intp]) -> Array:
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


def _pairs(
    claim: Claim, act: Acts, found: Elements, least: Array, verge: Flags | None, softest: float
) -> None:
    """Arcs and radial elements."""
    columns, here = claim.columns, claim.situations
    first, count = columns.first_pair, claim.count
    where = claim.lengths[0].value[:, first:].reshape(count, -1, 2)
    arcs = (columns.arcs.stop - columns.arcs.start) // 2
    claimed = claim.forces[:, first:].reshape(count, -1, 2)
    ways, margins, sizes = claim.arcs
    walls = np.repeat(np.broadcast_to(here.wall, (count, here.wall.shape[1])), 2, axis=1)
    radials = np.zeros((count, where.shape[1] - arcs))
    vector = np.concatenate([ways, where[:, arcs:]], axis=1)
    normal, reach, yields = (np.concatenate([v, radials], axis=1) for v in (margins, sizes, walls))
    distance = np.sqrt((vector**2).sum(axis=2))
    line = vector / np.where(distance > 0.0, distance, 1.0)[:, :, None]
    size = np.sqrt((claimed**2).sum(axis=2))
    begins = (act == Act.SLIP) & (size > 0.0)
    begins[:, arcs:] &= _unmoved(claim, distance[:, arcs:])
    # What begins to slip does so along its friction, across which it is held.
    line = np.where(begins[:, :, None], claimed / np.where(size > 0.0, size, 1.0)[:, :, None], line)
    # An arc pushes outwards: its force does work against the distance.
    sign = np.ones(where.shape[1])
    sign[:arcs] = -1.0
    size[:, :arcs] = claimed[:, :arcs, 0]
    _, stick, level, radius, last = claim.graphs.transpose(2, 0, 1)
    acts = act[:, arcs:]
    size[:, arcs:] = np.where(acts == Act.SLIP, level, size[:, arcs:])
    part = slice(arcs, None)
    stopped, stepped = acts == Act.STOP, acts == Act.STEP
    yields[:, part] = np.where(stopped & np.isfinite(last), 1.0 / last, 0.0)
    begin = np.where(stopped, radius, np.where(stepped, stick, 0.0))
    preload = np.where(stopped, level, 0.0)
    normal[:, part] = distance[:, part] - begin
    reach[:, part] = distance[:, part] + np.where(np.isfinite(begin), begin, 0.0)
    preload = np.concatenate([np.zeros((count, arcs)), preload], axis=1)
    on = act != Act.OPEN
    lined = (act == Act.STOP) | (act == Act.STEP) | (act == Act.SLIP)
    off = normal - sign * yields * (size - preload)
    off = np.where(act == Act.SLIP, 0.0, off)
    light = np.zeros(here.round_power.shape, dtype=bool)
    if claim.rolls and verge is not None:
        light = _light_walls(claim, found, act, verge, least, (size, distance), (yields, off))
    spread = EPS * (reach + yields * np.abs(size)) + np.where(begins, distance, 0.0)
    most = np.maximum(found.soft.max(axis=1, initial=0.0), np.finfo(float).tiny)
    across = np.where(size > 0.0, distance / np.where(size > 0.0, size, 1.0), np.inf)
    across = np.where(begins, 0.0, across)
    lateral = sign * np.minimum(across, softest * most[:, None])
    free = np.maximum(BOUND.yielding * most[:, None], 100.0 * np.abs(lateral))
    along = np.where(act == Act.SLIP, free, yields)
    spring = _first_pieces(claim, act)
    along, lateral = (np.where(lined, v, spring) for v in (along, lateral))
    x, y = line[:, :, 0], line[:, :, 1]
    diagonal = np.stack([along * x * x + lateral * y * y, along * y * y + lateral * x * x], axis=2)
    found.soft[:, first:] = diagonal.reshape(count, -1)
    found.skew[:] = np.where(lined, (along - lateral) * x * y, 0.0)
    misfit = np.where(
        lined[:, :, None], off[:, :, None] * line, where - spring[:, :, None] * claimed
    )
    found.misfit[:, first:] = misfit.reshape(count, -1)
    wide = np.where(lined, spread, EPS * (np.abs(where).sum(axis=2) + spring * np.abs(size)))
    found.width[:, first:] = np.repeat(wide, 2, axis=1)
    force = np.where(lined[:, :, None], (sign * size)[:, :, None] * line, claimed)
    force = np.where(on[:, :, None], force, 0.0)
    found.force[:, first:] = force.reshape(count, -1)
    found.rounding[:, first:] = np.repeat(np.where(lined & on, 2.0 * EPS * np.abs(size), 0.0), 2, 1)
    aside, found.spare[:] = _put_aside(claim, acts)
    found.rounding[:, columns.radials] += np.repeat(aside, 2, axis=1)
    found.active[:, first:] = np.repeat(on, 2, axis=1)
    found.line[:], found.distance[:], found.size[:] = line, distance, size
    found.begins[:], found.along[:] = begins, yields
    if claim.rolls:
        _bends(claim, acts, found, arcs, light)
    true = np.where(size > 0.0, sign / across, 0.0)
    wrong = np.where(begins, 0.0, np.abs(true - 1.0 / lateral) * (1.0 + EPS))
    wrong += np.where(act == Act.SLIP, 1.0 / along, 0.0)
    found.stiff_error[:] = np.where(lined, np.maximum(wrong, np.finfo(float).tiny), 0.0)
    _follow(claim, acts, yields[:, part], found.follows[:, part], found.shrinks[:, part])
    if found.follows.any() or found.shrinks.any():
        _lose_torque(claim, found)


def _first_pieces(claim: Claim, act: Acts) -> Array:
    """Compliance of pairs on the first piece of their graph [m/N], (S, pairs); 0 of others."""
    first, stick, _, _, last = claim.graphs.transpose(2, 0, 1)
    spring, radials = np.zeros(act.shape), slice(act.shape[1] - stick.shape[1], None)
    stiffness = np.where(np.isinf(stick) | (stick > 0.0), first, last)
    spring[:, radials] = np.where(act[:, radials] == Act.STICK, 1.0 / stiffness, 0.0)
    return spring


def _lose_torque(claim: Claim, found: Elements) -> None:
    """Add the rounding of torques over splines: differences of forces that may be far larger."""
    columns, first = claim.columns, claim.columns.first_pair
    torque = EPS * np.abs(claim.answers.flank_force) @ np.abs(columns.moments).T
    lost = torque @ columns.splined.T
    found.rounding[:, first:] += np.repeat(found.follows * lost, 2, axis=1)
    found.width[:, first:] += np.repeat(found.shrinks * lost, 2, axis=1)


def _light_walls(
    claim: Claim,
    found: Elements,
    act: Acts,
    verge: Flags,
    least: Array,
    where: tuple[Array, Array],
    laws: tuple[Array, Array],
) -> Flags:
    """Put in walls that are powers on the verge, and return which these are, (S, rounds).

    As of a light Hertz contact, their tangent is taken at more than their force. Up to there the
    wall is softer: it answers by something between that tangent and none.

    Parameters
    ----------
    claim : Claim
    found : Elements
        Whose `room` is filled in.
    act : ndarray of int8, shape (S, pairs)
    verge : ndarray of bool, shape (S, pairs)
    least : ndarray, shape (S, 1)
        Smallest force at which a tangent is taken [N].
    where : (ndarray, ndarray)
        Sizes of the forces [N] and distances [m] of the pairs.
    laws : (ndarray, ndarray)
        Their compliances [m/N] and misfits [m] along their lines, filled in.
    """
    here, columns = claim.situations, claim.columns
    radius, stiffness, power = here.round_radius, here.round_stiffness, here.round_power
    first = (columns.arcs.stop - columns.arcs.start) // 2
    rounds = slice(first, first + power.shape[1])
    size, distance = (v[:, rounds] for v in where)
    light = (power != 1.0) & (act[:, rounds] == Act.STOP) & (verge[:, rounds] | (size == 0.0))
    at = np.maximum(BOUND.reached * size, least)
    soft = (at / stiffness) ** (1.0 / power) / (power * at)
    off = distance - radius - (size / stiffness) ** (1.0 / power)
    for target, value in zip(laws, (soft, off), strict=True):
        target[:, rounds] = np.where(light, value, target[:, rounds])
    # A force stays below that all along its line while its two components change by less than this.
    room = np.where(light, np.sqrt(0.5) * (at - size), np.inf)
    start = columns.radials.start
    found.room[:, start : start + 2 * power.shape[1]] = np.repeat(room, 2, axis=1)
    return np.asarray(light)


def _bends(claim: Claim, acts: Acts, found: Elements, arcs: int, light: Flags) -> None:
    """Curvature of the walls that are powers, and what their tangents leave at the claim."""
    power = claim.situations.round_power
    rounds = slice(arcs, arcs + power.shape[1])
    acting = (power != 1.0) & (acts[:, : power.shape[1]] != Act.OPEN) & ~light
    size = np.abs(found.size[:, rounds])
    compliance = found.along[:, rounds]
    with np.errstate(divide="ignore", invalid="ignore"):
        # The compliance goes with F^(1/power − 1); at half the force it bends four times more.
        bent = np.where(acting, 4.0 * (1.0 - 1.0 / power) * compliance / size, 0.0)
    found.bent[:, rounds] = np.where(np.isnan(bent), np.inf, bent)
    first = claim.columns.radials.start
    begin = claim.graphs[:, : power.shape[1], 3]
    touched = (found.distance[:, rounds] - begin) / np.where(acting, compliance, 1.0)
    left = np.where(acting, found.bent[:, rounds] * (size - touched) ** 2, 0.0)
    found.width[:, first : first + 2 * power.shape[1]] += np.repeat(left, 2, axis=1)


def _put_aside(claim: Claim, acts: Acts) -> tuple[Array, Array]:
    """Friction of splines that are taken as open, (S, radials): its level [N], and per torque."""
    is_open = acts == Act.OPEN
    spare = np.zeros(acts.shape)
    for k in range(len(claim.columns.train.splines)):
        q = len(claim.columns.train.rounds) + k
        fixed, rate = (claim.situations.spline[:, k, j] for j in (3, 4))
        spare[:, q] = np.where(np.isnan(fixed) & is_open[:, q], np.abs(rate), 0.0)
    return np.where(is_open, claim.graphs[:, :, 2], 0.0), spare


def _follow(claim: Claim, acts: Acts, yields: Array, follows: Array, shrinks: Array) -> None:
    """Change of a spline's level and of its room with its torque, where they enter."""
    train, here = claim.columns.train, claim.situations
    rounds, splines = len(train.rounds), len(train.splines)
    for q in range(rounds, acts.shape[1]):
        k = (q - rounds) % splines
        stiffness, fixed, rate = (here.spline[:, k, j] for j in (0, 3, 4))
        rate = np.where(np.isnan(fixed), np.abs(rate), 0.0)
        stopped = acts[:, q] == Act.STOP
        if q >= rounds + splines:
            # With memory the room of a rigid stop shrinks by F_m/K_w.
            shrinks[:, q] = np.where(stopped, rate / stiffness, 0.0)
        else:
            enters = (acts[:, q] == Act.SLIP) | (stopped & (yields[:, q] > 0.0))
            follows[:, q] = np.where(enters, rate, 0.0)
