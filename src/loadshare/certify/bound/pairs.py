r"""Arcs and radial elements at the claim: how they yield, and the misfits of their laws.

Arcs and radial elements push along the line from their centre and yield as

.. math:: \Delta o = \left(c_n\, u u^T \pm \frac{|d|}{F}\,(1 - u u^T)\right)\Delta F,

with u the direction and |d| the distance from the centre: a turn of the direction is a compliance
too. Where a slip only begins, |d| = 0, u is the direction of the friction F. The slip follows it,
so that the direction is off by no more than 2 |ΔF|/F: the element is held across u.

A wall F = K |d|^p without play that carries nothing at its centre has no direction. Up to a force
F' it is nowhere stiffer than its tangent there, and no change of its force by f > f' moves it by
more than 2 (f'/K)^(1/p) f/f', since 1/p < 1.
Source: formulation, sections 3, 5, 6 and 16.
"""

from __future__ import annotations

import numpy as np

from loadshare.array_types import Array, Flags
from loadshare.certify.bound.acts import Act, Acts, unmoved
from loadshare.certify.bound.claim import EPS, Claim
from loadshare.certify.bound.elements import Elements
from loadshare.settings import BOUND


def put_pairs(
    claim: Claim, act: Acts, found: Elements, least: Array, verge: Flags | None, softest: float
) -> None:
    """Write the figures of arcs and radial elements."""
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
    begins[:, arcs:] &= unmoved(claim, distance[:, arcs:])
    # An element that begins to slip does so along its friction, and is held across it.
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
    by_force = np.zeros(here.round_power.shape, dtype=bool)
    if claim.rolls:
        by_force = _by_force(claim, found, act, verge, least, (size, distance), (yields, off))
    spread = EPS * (reach + yields * np.abs(size)) + np.where(begins, distance, 0.0)
    most = np.maximum(found.soft.max(axis=1, initial=0.0), np.finfo(float).tiny)
    across = np.where(size > 0.0, distance / np.where(size > 0.0, size, 1.0), np.inf)
    across = np.where(begins, 0.0, across)
    lateral = sign * np.minimum(across, softest * most[:, None])
    free = np.maximum(BOUND.yielding * most[:, None], 100.0 * np.abs(lateral))
    along = np.where(act == Act.SLIP, free, yields)
    x, y = line[:, :, 0], line[:, :, 1]
    diagonal = np.stack([along * x * x + lateral * y * y, along * y * y + lateral * x * x], axis=2)
    # At its centre, an element on its first piece yields as well, though it has no line there.
    spring = _first_pieces(claim, act)
    diagonal = np.where(lined[:, :, None], diagonal, spring[:, :, None])
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
    found.line[:], found.distance[:], found.size[:] = line, distance, size
    found.begins[:], found.along[:] = begins, yields
    if claim.rolls:
        _bends(claim, acts, found, arcs, by_force)
        _put_centred(claim, acts, found, least)
    true = np.where(size > 0.0, sign / across, 0.0)
    wrong = np.where(begins, 0.0, np.abs(true - 1.0 / lateral) * (1.0 + EPS))
    wrong += np.where(act == Act.SLIP, 1.0 / along, 0.0)
    found.stiff_error[:] = np.where(lined, np.maximum(wrong, np.finfo(float).tiny), 0.0)
    _follow(claim, acts, yields[:, part], found.follows[:, part], found.shrinks[:, part])
    if found.follows.any() or found.shrinks.any():
        _lose_torque(claim, found)


def _first_pieces(claim: Claim, act: Acts) -> Array:
    """Return compliances of pairs on the first piece of a graph [m/N], (S, pairs); 0 of others."""
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


def _by_force(
    claim: Claim,
    found: Elements,
    act: Acts,
    verge: Flags | None,
    least: Array,
    where: tuple[Array, Array],
    laws: tuple[Array, Array],
) -> Flags:
    """Describe power-law walls by their forces, and return which these are, (S, rounds).

    They are those on the verge: as for a light Hertz contact, their tangent is taken at more than
    their force. Up to that force the wall is softer: its response lies between that tangent's and
    none. Where secants take the place of curvatures, they are all walls that act.

    Parameters
    ----------
    claim : Claim
    found : Elements
        Elements whose `room` is filled in.
    act : ndarray of int8, shape (S, pairs)
    verge : ndarray of bool, shape (S, pairs), or None
        As in `elements`.
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
    chosen = (power != 1.0) & (act[:, rounds] == Act.STOP)
    if verge is None:
        at = np.maximum(size, least)
        spare = BOUND.bent * at
    else:
        chosen &= verge[:, rounds] | (size == 0.0)
        at = np.maximum(BOUND.reached * size, least)
        spare = at - size
    soft = (at / stiffness) ** (1.0 / power) / (power * at)
    off = distance - radius - (size / stiffness) ** (1.0 / power)
    for target, value in zip(laws, (soft, off), strict=True):
        target[:, rounds] = np.where(chosen, value, target[:, rounds])
    # While both components change by less than this, the force changes by less than the spare.
    room = np.where(chosen, np.sqrt(0.5) * spare, np.inf)
    found.room[:, columns.all_of(columns.claims.rounds)] = np.repeat(room, 2, axis=1)
    return np.asarray(chosen)


def _bends(claim: Claim, acts: Acts, found: Elements, arcs: int, by_force: Flags) -> None:
    """Write the curvature of the other power-law walls, and the tangents' misfit at the claim."""
    power = claim.situations.round_power
    rounds = slice(arcs, arcs + power.shape[1])
    acting = (power != 1.0) & (acts[:, : power.shape[1]] == Act.STOP) & ~by_force
    size = np.abs(found.size[:, rounds])
    compliance = found.along[:, rounds]
    with np.errstate(divide="ignore", invalid="ignore"):
        # The compliance goes with F^(1/power − 1); at half the force it bends four times more.
        bent = np.where(acting, 4.0 * (1.0 - 1.0 / power) * compliance / size, 0.0)
    found.bent[:, rounds] = np.where(np.isnan(bent), np.inf, bent)
    columns = claim.columns
    begin = claim.graphs[:, : power.shape[1], 3]
    touched = (found.distance[:, rounds] - begin) / np.where(acting, compliance, 1.0)
    left = np.where(acting, found.bent[:, rounds] * (size - touched) ** 2, 0.0)
    found.width[:, columns.all_of(columns.claims.rounds)] += np.repeat(left, 2, axis=1)


def _put_centred(claim: Claim, acts: Acts, found: Elements, least: Array) -> None:
    """Write the figures of power-law walls that stick: in any direction, about their centres.

    Parameters
    ----------
    claim : Claim
    acts : ndarray of int8, shape (S, radials)
    found : Elements
    least : ndarray, shape (S, 1)
        Force up to which they are nowhere stiffer than assumed [N].
    """
    power, stiffness = claim.situations.round_power, claim.situations.round_stiffness
    rounds, at = claim.columns.claims.rounds, claim.columns.all_of(claim.columns.claims.rounds)
    there = (acts[:, rounds] == Act.STICK) & (power != 1.0)
    if not there.any():
        return
    first = found.size.shape[1] - acts.shape[1]
    pairs = slice(first + rounds.start, first + rounds.stop)
    size = found.size[:, pairs]

    def stretch(force: Array) -> Array:
        return np.asarray((force / stiffness) ** (1.0 / power))

    rounding = EPS * least / BOUND.light
    most = 2.0 * stretch(rounding) / rounding
    secant = stretch(size) / np.where(size > 0.0, size, 1.0)
    found.centred[:, pairs] = np.where(there, most, 0.0)
    length = claim.lengths[0].value[:, at]
    figures = (
        (found.soft, stretch(least) / (power * least)),
        (found.width, most * rounding + found.width[:, at][:, ::2]),
        (found.room, np.sqrt(0.5) * (least - size)),
    )
    for target, values in figures:
        target[:, at] = np.where(np.repeat(there, 2, 1), np.repeat(values, 2, 1), target[:, at])
    misfit = length - np.repeat(secant, 2, axis=1) * claim.forces[:, at]
    found.misfit[:, at] = np.where(np.repeat(there, 2, axis=1), misfit, found.misfit[:, at])


def _put_aside(claim: Claim, acts: Acts) -> tuple[Array, Array]:
    """Return friction of splines taken as open, (S, radials): its level [N], and per torque."""
    is_open = acts == Act.OPEN
    spare = np.zeros(acts.shape)
    splines, fixed, rate = (
        claim.columns.claims.splines,
        *claim.situations.spline.T[3:].swapaxes(1, 2),
    )
    spare[:, splines] = np.where(np.isnan(fixed) & is_open[:, splines], np.abs(rate), 0.0)
    return np.where(is_open, claim.graphs[:, :, 2], 0.0), spare


def _follow(claim: Claim, acts: Acts, yields: Array, follows: Array, shrinks: Array) -> None:
    """Write the change of a spline's level and of its room with its torque, where they enter."""
    columns, here = claim.columns, claim.situations
    for q, k in columns.claims.on_splines:
        stiffness, fixed, rate = (here.spline[:, k, j] for j in (0, 3, 4))
        rate = np.where(np.isnan(fixed), np.abs(rate), 0.0)
        stopped = acts[:, q] == Act.STOP
        if q >= columns.claims.spline_stops.start:
            # With memory the room of a rigid stop shrinks by F_m/K_w.
            shrinks[:, q] = np.where(stopped, rate / stiffness, 0.0)
        else:
            enters = (acts[:, q] == Act.SLIP) | (stopped & (yields[:, q] > 0.0))
            follows[:, q] = np.where(enters, rate, 0.0)
