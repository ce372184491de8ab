"""Radial elements of many samples: tangents at their offsets, and the states they should have."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from loadshare.array_library import lengths, library_of
from loadshare.array_types import Array, Flags, States
from loadshare.settings import HOT
from loadshare.solver.hot import contact_states as at

_BOTH = np.eye(2)


@dataclass(slots=True)
class RadialTangent:
    """Tangent of a radial element of the set: compression = offset + compliance · force.

    On the level piece the force along `along` is `bound`, and the compression along it is free.
    """

    columns: slice
    compliance: Array
    offset: Array
    along: Array
    bound: Array | None


def until(offset: Array, velocity: Array, reach: Array, slow: Array) -> Array:
    """Return t (k,) at which |offset + t velocity| = reach; infinite for what does not move."""
    xp = library_of(offset)
    square = xp.sum(velocity * velocity, axis=1)
    along = xp.sum(offset * velocity, axis=1)
    inside = xp.maximum(reach * reach - xp.sum(offset * offset, axis=1), 0.0)
    far = (xp.sqrt(along * along + square * inside) - along) / square
    found: Array = xp.where(square > slow * slow, xp.maximum(far, 0.0), math.inf)
    return found


def beyond(law: at.Graph) -> States:
    """Return the state of a radial element past its level piece."""
    xp = library_of(law.reach)
    rigid = xp.where(law.reach > 0.0, _states(law, at.WALL), at.PINNED)
    found: States = xp.where(xp.isinf(law.last), rigid, at.STOP)
    return found


def _states(law: at.Graph, state: int) -> States:
    """Return one state for all samples (k,)."""
    xp = library_of(law.reach)
    found: States = xp.full_like(law.reach, state, dtype=xp.int8)
    return found


def direction(first: Array, second: Array) -> Array:
    """Return unit vectors along `first`, along `second` where that is zero, or else along x."""
    xp = library_of(first)
    vector = xp.where(xp.any(first != 0.0, axis=1)[:, None], first, second)
    size = lengths(vector)[:, None]
    x = xp.asarray(_BOTH[0], device=first.device)
    found: Array = xp.where(size == 0.0, x, vector / xp.where(size > 0.0, size, 1.0))
    return found


def tangent(
    columns: slice, status: int, law: at.Graph, offset: Array, force: Array, push: Array
) -> RadialTangent:
    """Return the tangent of a radial element at its current offset and force."""
    xp = library_of(offset)
    radius, size = lengths(offset), lengths(force)
    nothing = xp.zeros_like(radius)
    if status in (at.CORNER, at.WALL):
        along = direction(force, offset)
        limit = law.stick if status == at.CORNER else law.reach
        # A wall that does not carry yet holds its float along its direction alone.
        unknown = HOT.softest if status == at.WALL else limit / push
        inner, outer = nothing, xp.where(size > 0.0, limit / size, unknown)
        start = limit
    else:
        along = direction(offset, force)
        if status == at.STICK:
            inner = outer = 1.0 / law.first
            start = nothing
        elif status == at.PINNED:
            inner = outer = start = nothing
        elif status == at.SLIP:
            # Beyond the piece the true tangent is too soft to find the way back.
            inner = start = nothing
            inside = xp.minimum(xp.maximum(radius, law.stick), law.reach)
            outer = inside / xp.maximum(law.bound, HOT.faint * push)
        else:
            # If a wall yields by less than the play before it, a turn of the offset looks like a
            # large force.
            stiff = (law.first == 0.0) & (size > 0.0) & (size < law.last * law.reach)
            along = xp.where(stiff[:, None], direction(force, offset), along)
            reached = xp.where(stiff, law.reach + size / law.last, xp.maximum(radius, law.reach))
            pull = xp.where(stiff, size, law.bound + law.last * (reached - law.reach))
            inner = 1.0 / law.last
            outer = xp.where(pull > 0.0, reached / xp.where(pull > 0.0, pull, 1.0), inner)
            start = law.reach - law.bound / law.last
    # Across the offset the force vanishes in the end, whatever the compliance there: one made
    # immense by a small force would only swamp all others.
    outer = xp.minimum(outer, HOT.softest)
    dyad = along[:, :, None] * along[:, None, :]
    both = xp.asarray(_BOTH, device=dyad.device)
    compliance = inner[:, None, None] * dyad + outer[:, None, None] * (both - dyad)
    bound = law.bound if status == at.SLIP else None
    return RadialTangent(columns, compliance, start[:, None] * along, along, bound)


def right_state(
    status: int,
    law: at.Graph,
    offset: Array,
    force: Array,
    force_band: Array,
    length_band: Array,
    faint: Array,
) -> tuple[Flags, States]:
    """Return whether a radial element has left its piece, and the state it should have instead.

    A friction bound up to `faint` counts as none.
    """
    xp = library_of(offset)
    radius, size = lengths(offset), lengths(force)
    jump = law.bound > law.first * law.stick * (1.0 + HOT.rounded)
    past, stays = beyond(law), _states(law, status)
    sticks, slips, opens = (_states(law, state) for state in (at.STICK, at.SLIP, at.OPEN))
    rubs = law.bound > faint
    level = xp.where(law.reach > law.stick, xp.where(rubs, slips, at.OPEN), past)
    back = xp.where(law.stick > 0.0, xp.where(jump, at.CORNER, sticks), at.PINNED)
    back = xp.where((law.bound == 0.0) & (law.reach > 0.0), at.OPEN, back)
    inward = xp.sum(offset * force, axis=1) < 0.0
    up = down = xp.zeros_like(inward)
    after = before = stays
    if status == at.OPEN:
        up, down = radius > law.reach + length_band, rubs & (radius > length_band)
        after, before = past, xp.where(radius < law.stick, at.STICK, level)
    elif status == at.STICK:
        up = size > law.first * law.stick + force_band
        gone = xp.where(radius > law.reach + length_band, past, level)
        after = xp.where(jump, at.CORNER, gone)
    elif status == at.CORNER:
        down = inward | (size < law.first * law.stick - force_band)
        up = (size > law.bound + force_band) & ~inward
        after, before = level, sticks
    elif status == at.PINNED:
        yields = (law.bound > 0.0) | (law.reach > 0.0) | xp.isfinite(law.last)
        up, after = (size > law.bound + force_band) & yields, level
    elif status == at.SLIP:
        up = (radius > law.reach + length_band) & rubs & ~inward
        down = (radius < law.stick - length_band) | inward | ~rubs
        after, before = past, xp.where(rubs, back, level)
    elif status == at.STOP:
        down = ((radius < law.reach - length_band) | inward) & (law.reach > 0.0)
        # A stop that carries almost nothing sticks: it does not use up its friction.
        slipping = (law.reach > law.stick) & (radius >= law.stick) & (size > HOT.gross * law.bound)
        before = xp.where(slipping, level, back)
    else:
        # A wall may hold a float with almost no force.
        down, before = inward | (size <= faint), opens
    return up | down, xp.where(up, after, before)
