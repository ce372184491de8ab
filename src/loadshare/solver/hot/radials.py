"""Radial elements of many samples: tangents at their offsets, and the states they should have."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

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
    square = (velocity * velocity).sum(axis=1)
    along = (offset * velocity).sum(axis=1)
    inside = np.maximum(reach * reach - (offset * offset).sum(axis=1), 0.0)
    far = (np.sqrt(along * along + square * inside) - along) / square
    return np.where(square > slow * slow, np.maximum(far, 0.0), np.inf)


def beyond(law: at.Graph) -> States:
    """Return the state of a radial element past its level piece."""
    rigid = np.where(law.reach > 0.0, at.WALL, at.PINNED)
    return np.where(np.isinf(law.last), rigid, at.STOP).astype(np.int8)


def direction(first: Array, second: Array) -> Array:
    """Return unit vectors along `first`, along `second` where that is zero, or else along x."""
    vector = np.where((first != 0.0).any(axis=1)[:, None], first, second)
    size = np.sqrt((vector * vector).sum(axis=1))
    along = vector / np.where(size > 0.0, size, 1.0)[:, None]
    along[size == 0.0] = (1.0, 0.0)
    return along


def block(
    columns: slice, status: int, law: at.Graph, offset: Array, force: Array, push: Array
) -> RadialTangent:
    """Return the tangent of a radial element at its current offset and force."""
    count = len(offset)
    radius, size = (np.sqrt((v * v).sum(axis=1)) for v in (offset, force))
    if status in (at.CORNER, at.WALL):
        along = direction(force, offset)
        limit = law.stick if status == at.CORNER else law.reach
        # A wall that does not carry yet holds its float along its direction alone.
        unknown = HOT.softest if status == at.WALL else limit / push
        inner, outer = np.zeros(count), np.where(size > 0.0, limit / size, unknown)
        start = limit
    else:
        along = direction(offset, force)
        if status == at.STICK:
            inner = outer = 1.0 / law.first
            start = np.zeros(count)
        elif status == at.PINNED:
            inner = outer = start = np.zeros(count)
        elif status == at.SLIP:
            # Beyond the piece the true tangent is too soft to find the way back.
            inner, start = np.zeros(count), np.zeros(count)
            outer = np.clip(radius, law.stick, law.reach) / np.maximum(law.bound, HOT.faint * push)
        else:
            # If a wall yields by less than the play before it, a turn of the offset looks like a
            # large force.
            stiff = (law.first == 0.0) & (size > 0.0) & (size < law.last * law.reach)
            along = np.where(stiff[:, None], direction(force, offset), along)
            reached = np.where(stiff, law.reach + size / law.last, np.maximum(radius, law.reach))
            pull = np.where(stiff, size, law.bound + law.last * (reached - law.reach))
            inner = 1.0 / law.last
            outer = np.where(pull > 0.0, reached / np.where(pull > 0.0, pull, 1.0), inner)
            start = law.reach - law.bound / law.last
    # Across the offset the force vanishes in the end, whatever the compliance there: one made
    # immense by a small force would only swamp all others.
    outer = np.minimum(outer, HOT.softest)
    dyad = along[:, :, None] * along[:, None, :]
    compliance = inner[:, None, None] * dyad + outer[:, None, None] * (_BOTH - dyad)
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
    radius, size = (np.sqrt((v * v).sum(axis=1)) for v in (offset, force))
    jump = law.bound > law.first * law.stick * (1.0 + HOT.rounded)
    past = beyond(law)
    rubs = law.bound > faint
    level = np.where(law.reach > law.stick, np.where(rubs, at.SLIP, at.OPEN), past)
    back = np.where(law.stick > 0.0, np.where(jump, at.CORNER, at.STICK), at.PINNED)
    back = np.where((law.bound == 0.0) & (law.reach > 0.0), at.OPEN, back)
    inward = (offset * force).sum(axis=1) < 0.0
    stays = np.full(len(radius), status)
    if status == at.OPEN:
        up, down = radius > law.reach + length_band, rubs & (radius > length_band)
        after, before = past, np.where(radius < law.stick, at.STICK, level)
    elif status == at.STICK:
        up, down = size > law.first * law.stick + force_band, False
        gone = np.where(radius > law.reach + length_band, past, level)
        after, before = np.where(jump, at.CORNER, gone), stays
    elif status == at.CORNER:
        down = inward | (size < law.first * law.stick - force_band)
        up = (size > law.bound + force_band) & ~inward
        after, before = level, np.full(len(radius), at.STICK)
    elif status == at.PINNED:
        yields = (law.bound > 0.0) | (law.reach > 0.0) | np.isfinite(law.last)
        up = (size > law.bound + force_band) & yields
        down, after, before = False, level, stays
    elif status == at.SLIP:
        up = (radius > law.reach + length_band) & rubs & ~inward
        down = (radius < law.stick - length_band) | inward | ~rubs
        after, before = past, np.where(rubs, back, level)
    elif status == at.STOP:
        up, down = False, ((radius < law.reach - length_band) | inward) & (law.reach > 0.0)
        # A stop that carries almost nothing sticks: it does not use up its friction.
        slips = (law.reach > law.stick) & (radius >= law.stick) & (size > HOT.gross * law.bound)
        after, before = stays, np.where(slips, level, back)
    else:
        # A wall may hold a float with almost no force.
        up, down = False, inward | (size <= faint)
        after, before = stays, np.full(len(radius), at.OPEN)
    wrong = np.broadcast_to(up | down, radius.shape)
    return wrong, np.where(up, after, before).astype(np.int8)
