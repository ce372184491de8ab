"""Bounds of many claims: on every torque, force and displacement."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from loadshare.array_types import Array, Flags, Numbers
from loadshare.certify.bound.acts import Act, Acts, first_acts
from loadshare.certify.bound.bound import Box, boxes
from loadshare.certify.bound.claim import EPS, Claim
from loadshare.certify.bound.columns import Columns
from loadshare.certify.bound.held import HeldSlips, with_held_slips
from loadshare.certify.bound.locked import locked, without
from loadshare.certify.bound.open_slips import is_inside, open_slips, reaction_error
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
    for row in np.flatnonzero(~(relative <= CERTIFY.largest) & finite).tolist():
        one = replace(claim.take(np.array([row])), fine=True)
        ways = (_with_locked, _with_light_friction, _with_open_slips) if columns.pairs else ()
        for way in (*ways, _without_rounding):
            if not relative[row] <= CERTIFY.largest:
                box.force[row], box.coordinate[row] = way(one, scale[row : row + 1])
                relative[row] = _largest(columns, box.force[row], flanks[row]) / largest[row]
    # Where torques are not bounded closely enough for any certificate, other bounds hold only if
    # the right elements act, and secants may differ from tangents by more than was allowed for.
    unproved = ~(relative <= CERTIFY.largest) | held.denied(box.force)
    box.force[unproved], box.coordinate[unproved], relative[unproved] = np.inf, np.inf, np.inf
    box.force[:, held.shared] = np.inf
    return box, relative


def _with_locked(claim: Claim, scale: Array) -> tuple[Array, Array]:
    """Bound the rest of a single claim with gears held that cannot move."""
    found = _without(claim, locked(claim), scale)
    return found.force[0], found.coordinate[0]


def _with_open_slips(claim: Claim, scale: Array) -> tuple[Array, Array]:
    """Bound a single claim with gears held in place whose splines have used up their friction."""
    columns = claim.columns
    slips = open_slips(claim)
    found = _without(claim, {slip.gear: slip.play for slip in slips}, scale)
    flanks = found.force[0, columns.flanks]
    if not all(is_inside(claim, slip, flanks) for slip in slips):
        return np.full_like(found.force[0], np.inf), np.full_like(found.coordinate[0], np.inf)
    for slip in slips:
        both = columns.both(columns.claims.splines.start + slip.number)
        found.force[0, both] = reaction_error(claim, slip, flanks)
        bearing = columns.bearings.start + 2 * list(columns.places).index(slip.gear)
        found.force[0, bearing : bearing + 2] = np.abs(claim.forces[0, bearing : bearing + 2])
    return found.force[0], found.coordinate[0]


def _without(claim: Claim, gears: Mapping[str, float | Array], scale: Array) -> Box:
    """Bound the rest of a single claim with some gears held in place, except for a play."""
    whole = claim.columns
    found = Box.unproved(claim, first_acts(claim))
    if gears:
        held, origin = without(claim, gears)
        names = [whole.coordinates.index(n) for n in held.columns.coordinates]
        found.force[:, origin], found.coordinate[:, names] = _fine(held, first_acts(held), scale)
        for gear, play in gears.items():
            at = whole.places[gear]
            found.coordinate[0, at : at + 2] = play
    return found


def _without_rounding(claim: Claim, scale: Array) -> tuple[Array, Array]:
    """Bound a single claim as if elements that carry only rounding carried nothing.

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
    return (box.force + np.abs(claim.forces - none.forces))[0], box.coordinate[0]


def _with_light_friction(claim: Claim, scale: Array) -> tuple[Array, Array]:
    """Bound a single claim with friction put aside that is light compared with what is certified.

    With memory, the friction of splines pressed to the end of their clearance is put aside too:
    there a slip can only turn, which the stop hardly allows.
    """
    act = first_acts(claim, BOUND.light_friction)
    if claim.columns.train.slip is not None:
        stops = act.shape[1] - len(claim.columns.train.splines)
        slips = stops - len(claim.columns.train.splines)
        act[:, slips:stops][act[:, stops:] == Act.STOP] = Act.OPEN
    force, coordinate = _fine(claim, act, scale)
    return force[0], coordinate[0]


def _fine(claim: Claim, act: Acts, scale: Array) -> tuple[Array, Array]:
    """Return errors from residuals in twice the precision."""
    box = boxes(claim, act, scale)
    force, coordinate = box.force.copy(), box.coordinate.copy()

    def try_ways(rows: Flags, doubtful: Flags) -> None:
        for row in np.flatnonzero(rows & doubtful.any(axis=1)).tolist():
            one = np.array([row])
            part = replace(box.take(one), doubtful=doubtful[one])
            single = on_the_verge(claim.take(one), act[one], scale[one], part)
            force[row], coordinate[row] = single.force[0], single.coordinate[0]

    # An element that carries only rounding may as well be open, unless it holds a gear.
    light = _of_rounding(claim, scale) & (act != Act.OPEN)
    try_ways(np.ones(claim.count, dtype=bool), box.doubtful | light)
    again = ~_bounded(claim, force) & light.any(axis=1)
    force[again], coordinate[again] = box.force[again], box.coordinate[again]
    try_ways(again, box.doubtful)
    for row in np.flatnonzero(~_bounded(claim, force)).tolist():
        one = np.array([row])
        single = quick_boxes(claim.take(one), act[one], scale[one])
        force[row], coordinate[row] = single.force[0], single.coordinate[0]
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
