"""Bounds of many claims: on every torque, force and displacement."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from loadshare.array_types import Array, Flags, Numbers
from loadshare.certify.bound.acts import Act, Acts, alike, first_acts
from loadshare.certify.bound.bound import Box, boxes
from loadshare.certify.bound.claim import EPS, Claim
from loadshare.certify.bound.columns import Columns
from loadshare.certify.bound.held import HeldSlips, with_held_slips
from loadshare.certify.bound.locked import locked, without
from loadshare.certify.bound.open_slips import OpenSlip, is_inside, open_slips, reaction_error
from loadshare.certify.bound.quick import quick_boxes
from loadshare.certify.bound.squeezed import squeezed
from loadshare.certify.bound.verge import on_the_verge
from loadshare.settings import BOUND, CERTIFY
from loadshare.train.equilibria import Equilibria
from loadshare.train.situations import Situations


@dataclass(frozen=True, eq=False)
class Bounds:
    """Bounds on the distance of S claims from the exact equilibria of their cases.

    Infinite where nothing could be proved, and for what an equilibrium does not determine.

    Attributes
    ----------
    columns : Columns
    relative : ndarray, shape (S,)
        Largest error of a mesh's torque, drive less coast, over the largest torque of a flank.
    torque : ndarray, shape (S, flanks), or None
        Errors of the torques of all flanks on their drivers [N·m]; None if Numba was enough.
    force : ndarray, shape (S, m), or None
        Errors of the forces of all columns [N]; likewise.
    coordinate : ndarray, shape (S, n), or None
        Errors of the coordinates [m]; likewise.
    """

    columns: Columns
    relative: Array
    torque: Array | None
    force: Array | None
    coordinate: Array | None


def _torques(columns: Columns, force: Array, claimed: Array) -> Array:
    """Return the errors of the torques of all flanks as reported, (…, flanks) [N·m].

    They follow from the errors of all columns' forces, and from the claimed forces of the flanks
    because a torque is itself rounded.
    """
    error = force[..., columns.flanks] * (1.0 + EPS) + EPS * np.abs(claimed)
    return np.asarray(error * columns.arms)


def _largest(columns: Columns, force: Array, claimed: Array) -> Array:
    """Return the largest error of a mesh's torque, drive less coast, (…) [N·m]; see `_torques`."""
    found = columns.over_meshes(_torques(columns, force, claimed))
    return np.asarray(found.max(axis=-1, initial=0.0))


def bounds(
    columns: Columns,
    situations: Situations,
    answers: Equilibria,
    rigorous: bool = False,
    enough: float = BOUND.enough,
) -> Bounds:
    """Bound the errors of S claimed equilibria, from the claims and the train alone.

    Parameters
    ----------
    columns : Columns
    situations : Situations
    answers : Equilibria
    rigorous : bool
        Find all residuals in twice the working precision; otherwise only where that is needed.
    enough : float
        Error of a torque, over the largest torque, that is good enough.
    """
    if not len(answers.rotation):
        return Bounds(columns, np.zeros(0), None, None, None)
    with np.errstate(all="ignore"):
        return _boxes(Claim(columns, situations, answers, fine=False), rigorous, enough)


def completed(
    columns: Columns,
    situations: Situations,
    answers: Equilibria,
    relative: Array,
    tolerance: float,
    wanted: Flags,
) -> Bounds:
    """Bound by every method the wanted claims that Numba has not bounded closely enough.

    A bound within the tolerance is close enough: a closer look costs as much as a thousand answers.

    Parameters
    ----------
    columns : Columns
    situations : Situations
    answers : Equilibria
    relative : ndarray, shape (S,)
        Largest error of a torque over the largest torque, as Numba has it; changed in place.
    tolerance : float
        Largest value of `relative` that is certified.
    wanted : ndarray of bool, shape (S,)
    """
    left = np.flatnonzero(~(relative <= tolerance) & wanted)
    if len(left):
        some = situations.take(left), answers.take(left)
        more = bounds(columns, *some, enough=tolerance).relative
        relative[left] = np.fmin(relative[left], more)
    return Bounds(columns, relative, None, None, None)


def torque_bounds(
    columns: Columns, situations: Situations, answers: Equilibria, relative: Array
) -> Array:
    """Bound the torques of all meshes, (S, meshes) [N·m], of claims that are bounded already.

    Parameters
    ----------
    columns : Columns
    situations : Situations
    answers : Equilibria
    relative : ndarray, shape (S,)
        Largest error of a mesh's torque over the largest torque; it bounds every mesh for which the
        quick bound is no better.
    """
    with np.errstate(all="ignore"):
        claim = Claim(columns, situations, answers, fine=False)
        scale, largest = _scales(claim)
        box = quick_boxes(claim, first_acts(claim), scale)
        found = columns.over_meshes(_torques(columns, box.force, np.abs(answers.flank_force)))
        return np.asarray(np.fmin(found, (relative * largest)[:, None]))


def _scales(claim: Claim) -> tuple[Array, Array]:
    """Return load [N] and largest torque of a flank or from outside [N·m] of claims, (S,)."""
    columns, torque, answers = claim.columns, claim.situations.torque, claim.answers
    radius = np.array([g.base_radius for g in columns.train.gears.values()])
    flanks = np.abs(answers.flank_force)
    pushed = (np.abs(torque) / radius).max(axis=1, initial=0.0)
    pushed = np.maximum(pushed, np.abs(claim.situations.push).max(axis=(1, 2), initial=0.0))
    scale = np.maximum(flanks.max(axis=1, initial=0.0), pushed)
    largest = (flanks * columns.arms).max(axis=1, initial=0.0)
    largest = np.maximum(largest, np.abs(torque).max(axis=1, initial=0.0))
    return np.where(scale > 0.0, scale, 1.0), np.where(largest > 0.0, largest, 1.0)


def _boxes(claim: Claim, rigorous: bool, enough: float) -> Bounds:
    """Bound all forces and coordinates."""
    columns, flanks = claim.columns, np.abs(claim.answers.flank_force)
    scale, largest = _scales(claim)
    first, *others = BOUND.still if columns.train.slip is not None else BOUND.still[:1]
    held = with_held_slips(claim, scale, first)
    box, relative = _proved(held, scale, largest, rigorous, enough)
    for still in others:
        rows = np.flatnonzero(~(relative <= enough))
        if len(rows):
            held = with_held_slips(claim.take(rows), scale[rows], still)
            other, found = _proved(held, scale[rows], largest[rows], rigorous, enough)
            _improve(box, relative, rows, (other.force, other.coordinate, found))
    torques = _torques(columns, box.force, flanks)
    box.force[squeezed(claim)] = np.inf
    return Bounds(columns, relative, torques, box.force, box.coordinate)


def _improve(box: Box, relative: Array, rows: Numbers, other: tuple[Array, Array, Array]) -> None:
    """Take other errors of forces, coordinates and torques where those of torques are less."""
    better = other[2] < relative[rows]
    for target, errors in zip((box.force, box.coordinate, relative), other, strict=True):
        target[rows[better]] = errors[better]


def _proved(
    held: HeldSlips, scale: Array, largest: Array, rigorous: bool, enough: float
) -> tuple[Box, Array]:
    """Return the errors of S claims, and the largest of a torque over the largest torque, (S,)."""
    claim, columns, answers = held.claim, held.claim.columns, held.claim.answers
    flanks = np.abs(answers.flank_force)
    act = first_acts(claim)
    box = Box.unproved(claim, act)
    finite = np.logical_and.reduce(
        [np.isfinite(a).reshape(claim.count, -1).all(axis=1) for a in answers.arrays]
    )
    finite &= np.isfinite(claim.lengths[0].high).all(axis=1)
    finite &= ~np.isnan(claim.graphs).any(axis=(1, 2))
    if not rigorous and finite.all():
        box = quick_boxes(claim, act, scale)

    relative = _largest(columns, box.force, flanks) / largest
    left = np.flatnonzero(~(relative <= enough) & finite)
    for at in range(0, len(left), BOUND.together):
        rows = left[at : at + BOUND.together]
        fine = replace(claim.take(rows), fine=True)
        force, coordinate = _fine(fine, act[rows], scale[rows])
        found = _largest(columns, force, flanks[rows]) / largest[rows]
        _improve(box, relative, rows, (force, coordinate, found))
    of_pairs = (_with_walls_at_centre, _with_locked, _with_light_friction, _with_open_slips)
    ways = of_pairs if columns.pairs else ()
    left = np.flatnonzero(~(relative <= CERTIFY.largest) & finite)
    together = [left[at : at + BOUND.together] for at in range(0, len(left), BOUND.together)]
    # Together, claims are bounded less closely than alone.
    for rows in (*together, *(left[:, None] if len(left) > 1 else ())):
        for way in (*ways, _without_rounding):
            rest = rows[~(relative[rows] <= CERTIFY.largest)]
            if len(rest):
                some = replace(claim.take(rest), fine=True)
                box.force[rest], box.coordinate[rest] = way(some, scale[rest])
                relative[rest] = _largest(columns, box.force[rest], flanks[rest]) / largest[rest]
    # Where torques are not bounded closely enough for any certificate, other bounds hold only if
    # the right elements act, and secants may differ from tangents by more than was allowed for.
    unproved = ~(relative <= CERTIFY.largest) | held.denied(box.force)
    box.force[unproved], box.coordinate[unproved], relative[unproved] = np.inf, np.inf, np.inf
    box.force[:, held.shared] = np.inf
    return box, relative


def _with_walls_at_centre(claim: Claim, scale: Array) -> tuple[Array, Array]:
    """Bound S claims with rolling bearings without clearance that carry nothing at their centre."""
    act, here = first_acts(claim), claim.situations
    first = act.shape[1] - len(claim.columns.claims.radials)
    bearings = act[:, first : first + here.round_power.shape[1]]
    there = (bearings == Act.OPEN) & (here.round_power != 1.0) & (here.round_radius == 0.0)
    if not there.any():
        return _unproved(claim)
    bearings[there] = Act.STICK
    box = quick_boxes(claim, act, scale)
    return box.force, box.coordinate


def _with_locked(claim: Claim, scale: Array) -> tuple[Array, Array]:
    """Bound the rest of S claims with gears held that cannot move."""
    plays = locked(claim)
    held = np.isfinite(np.reshape([*plays.values()], (-1, claim.count))).T
    force, coordinate = _unproved(claim)
    for rows in alike(held):
        gears = {g: plays[g][rows, None] for g, h in zip(plays, held[rows[0]], strict=True) if h}
        if gears:
            force[rows], coordinate[rows] = _without(claim.take(rows), gears, scale[rows])
    return force, coordinate


def _with_open_slips(claim: Claim, scale: Array) -> tuple[Array, Array]:
    """Bound S claims with gears held in place whose splines have used up their friction."""
    force, coordinate = _unproved(claim)
    for row in range(claim.count):
        one = np.array([row])
        found = _with_these(claim.take(one), open_slips(claim.take(one)), scale[one])
        if found is not None:
            force[row], coordinate[row] = found
    return force, coordinate


def _with_these(
    claim: Claim, slips: Sequence[OpenSlip], scale: Array
) -> tuple[Array, Array] | None:
    """Bound a single claim with the gears of some slips held in place; None without a proof."""
    if not slips:
        return None
    columns = claim.columns
    every, places = _without(claim, {slip.gear: slip.play[None] for slip in slips}, scale)
    force = every[0]
    flanks = force[columns.flanks]
    if not all(is_inside(claim, slip, flanks) for slip in slips):
        return None
    for slip in slips:
        force[columns.both(columns.claims.splines.start + slip.number)] = reaction_error(
            claim, slip, flanks
        )
        bearing = columns.bearings.start + 2 * list(columns.places).index(slip.gear)
        force[bearing : bearing + 2] = np.abs(claim.forces[0, bearing : bearing + 2])
    return force, places[0]


def _without(claim: Claim, gears: Mapping[str, Array], scale: Array) -> tuple[Array, Array]:
    """Bound the rest of S claims with some gears held in place, except for a play."""
    whole = claim.columns
    force, coordinate = _unproved(claim)
    held, origin = without(claim, gears)
    names = [whole.coordinates.index(n) for n in held.columns.coordinates]
    force[:, origin], coordinate[:, names] = _fine(held, first_acts(held), scale)
    for gear, play in gears.items():
        at = whole.places[gear]
        coordinate[:, at : at + 2] = play
    return force, coordinate


def _unproved(claim: Claim) -> tuple[Array, Array]:
    """Return errors of forces (S, m) and coordinates (S, n) of which nothing is proved."""
    columns = claim.columns
    return (
        np.full((claim.count, len(columns.names)), np.inf),
        np.full((claim.count, len(columns.coordinates)), np.inf),
    )


def _without_rounding(claim: Claim, scale: Array) -> tuple[Array, Array]:
    """Bound S claims as if elements that carry only rounding carried nothing.

    The load left over along moves that only they hold is then zero, to the last digit.
    """
    train, answers, least = claim.columns.train, claim.answers, BOUND.noise * scale[:, None]
    arms = [train.gears[shaft.first].base_radius for shaft in train.shafts.values()]
    carried = {
        "flank_force": least,
        "ring_force": least,
        "shaft_torque": least * arms,
        "support_force": least[:, :, None],
    }
    if train.slip is None:  # With memory, slips depend on these forces.
        carried["radial_reaction"] = least[:, :, None]
    kept: dict[str, Any] = {}
    for name, rounding in carried.items():
        force = getattr(answers, name)
        kept[name] = np.where(np.abs(force) > rounding, force, 0.0)
    none = replace(claim, answers=replace(answers, **kept))
    box = quick_boxes(none, first_acts(none), scale, rounded=True)
    return box.force + np.abs(claim.forces - none.forces), box.coordinate


def _with_light_friction(claim: Claim, scale: Array) -> tuple[Array, Array]:
    """Bound S claims with friction put aside that is light compared with what is certified.

    With memory, the friction of splines pressed to the end of their clearance is put aside too:
    there a slip can only turn, which the stop hardly allows.
    """
    act = first_acts(claim, BOUND.light_friction)
    if claim.columns.train.slip is not None:
        stops = act.shape[1] - len(claim.columns.train.splines)
        slips = stops - len(claim.columns.train.splines)
        act[:, slips:stops][act[:, stops:] == Act.STOP] = Act.OPEN
    return _fine(claim, act, scale)


def _fine(claim: Claim, act: Acts, scale: Array) -> tuple[Array, Array]:
    """Return errors from residuals in twice the precision."""
    box = boxes(claim, act, scale)
    force, coordinate = box.force.copy(), box.coordinate.copy()

    def try_ways(those: Flags, doubtful: Flags) -> None:
        rows = np.flatnonzero(those & doubtful.any(axis=1))
        if len(rows):
            part = replace(box.take(rows), doubtful=doubtful[rows])
            found = on_the_verge(claim.take(rows), act[rows], scale[rows], part)
            force[rows], coordinate[rows] = found.force, found.coordinate

    # An element that carries only rounding may as well be open, unless it holds a gear.
    light = _of_rounding(claim, scale) & (act != Act.OPEN)
    try_ways(np.ones(claim.count, dtype=bool), box.doubtful | light)
    again = ~_bounded(claim, force) & light.any(axis=1)
    force[again], coordinate[again] = box.force[again], box.coordinate[again]
    try_ways(again, box.doubtful)
    rows = np.flatnonzero(~_bounded(claim, force))
    if len(rows):
        found = quick_boxes(claim.take(rows), act[rows], scale[rows])
        force[rows], coordinate[rows] = found.force, found.coordinate
    return force, coordinate


def _bounded(claim: Claim, force: Array) -> Flags:
    """Return whether the errors of all flanks' forces are bounded, (S,)."""
    return np.asarray(np.isfinite(force[:, claim.columns.flanks]).all(axis=1))


def _of_rounding(claim: Claim, scale: Array) -> Flags:
    """Return elements with so little force that they may as well be open, shape (S, elements).

    For splines this means that their friction is put aside.
    """
    columns, noise = claim.columns, BOUND.noise * scale[:, None]
    found = np.zeros((claim.count, len(columns.contacts) + columns.pairs), dtype=bool)
    pushes = np.abs(claim.pushes)
    found[:, : pushes.shape[1]] = (pushes > 0.0) & (pushes <= noise)
    if columns.claims.radials:
        pulls = claim.forces[:, columns.radials].reshape(claim.count, -1, 2)
        size = np.hypot(pulls[:, :, 0], pulls[:, :, 1])
        found[:, -size.shape[1] :] = (
            (claim.graphs[:, :, 2] <= noise) & (size <= noise) & (size > 0.0)
        )
    return found
