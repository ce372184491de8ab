"""Figures of claims: acting elements, misfits, load that is left over, residuals and scales."""

from __future__ import annotations

import numpy as np

from loadshare.by_reference import by_reference, set_apart
from loadshare.certify.bound.acts import CLOSED, ENDLESS, LIGHT, OPEN
from loadshare.certify.bound.claim import EPS
from loadshare.certify.bound.kernel.forces import (
    put_balance,
    put_contacts,
    put_pulls,
    put_pushes,
    put_springs,
    spread,
)
from loadshare.certify.bound.kernel.lengths import put_gaps, put_lengths, put_limits, put_places
from loadshare.certify.bound.kernel.options import compiled, inlined, within
from loadshare.certify.bound.kernel.residuals import put_displaced, put_worst
from loadshare.certify.bound.kernel.rows import (
    fill,
    put_column,
    put_largest,
    put_rows,
    take_row,
    take_rows,
)
from loadshare.extremes import larger, smaller
from loadshare.numbering import numbered
from loadshare.settings import BOUND, CERTIFY

# As floats like the others, which a processor compares side by side.
_OPEN, _CLOSED, _LIGHT, _ENDLESS = map(float, (OPEN, CLOSED, LIGHT, ENDLESS))


@compiled
def find_all(of, here, claim, work, found, sets):  # type: ignore[no-untyped-def]
    """Find the figures of all claims; return how many sets of elements act in them."""
    return _find_all(
        by_reference(of),
        by_reference(here),
        by_reference(claim),
        by_reference(work),
        by_reference(found),
        by_reference(sets),
    )


@within
def _find_all(of, here, claim, work, found, sets):  # type: ignore[no-untyped-def]
    """Process claims side by side, except for what is rare: radial elements, opposed contacts."""
    set_apart()
    count, last, claims = 0, 0, len(claim.rotation)
    for first in range(0, claims, BOUND.side_by_side):
        width = min(BOUND.side_by_side, claims - first)
        put_places(of, here, claim, first, width, work)
        put_lengths(of, work)
        _put_loads(of, here, claim, first, width, work)
        put_limits(of, here, first, width, work)
        put_gaps(of, here, first, width, work)
        _put_acts(of, work)
        take_rows(found.acts, first, width, work.acts)
        before = count
        for v in range(width):
            put_pulls(of, here, claim, first + v, work, v, found)
            count, last = numbered(first + v, found.acts, sets.first, sets.key, count, last)
            found.number[first + v] = last
            for q in range(len(of.pull_gear)):
                at, soft = len(of.twin) + len(of.spring) + q, work.stiffest[q, v]
                spread(sets, last, at, soft, soft)
        new = before, count
        put_contacts(of, here, claim, first, width, work, found, sets, new)
        put_springs(of, here, claim, first, width, work, found, sets, new)
        _put_scales(work)
        put_worst(of, here, claim, first, width, work)
        put_displaced(of, work)
        put_pushes(work.left, work.sizes, work.force, of.start, of.at, of.value)
        put_balance(of, here, first, width, work)
        _take(first, width, work, found)
    return count


@inlined
def _put_scales(work):  # type: ignore[no-untyped-def]
    """Write the rounding of lengths, and the deflection of cases [m]."""
    width, deflection = work.width, work.deflection
    for v in range(BOUND.side_by_side):
        width[v] = EPS * (width[v] + work.limits[v] + work.longest[v] + work.yielded[v])
    for v in range(BOUND.side_by_side):
        bent = larger(work.bent[v], deflection[v])
        deflection[v] = bent if bent > 0.0 else CERTIFY.least_deflection


@within
def _take(first, width, work, found):  # type: ignore[no-untyped-def]
    """Store the figures of the present claims."""
    set_apart()
    take_rows(found.misfit, first, width, work.apart)
    take_rows(found.left, first, width, work.left_over)
    take_row(found.scale, first, width, work.scale)
    take_row(found.largest, first, width, work.largest)
    take_row(found.push, first, width, work.largest_push)
    take_row(found.residual, first, width, work.residual)
    take_row(found.rounding, first, width, work.rounding)
    take_row(found.width, first, width, work.width)
    take_row(found.reach, first, width, work.reach)
    take_row(found.faint, first, width, work.faint)
    take_row(found.room, first, width, work.room)
    take_row(found.aside, first, width, work.aside)
    take_row(found.turned, first, width, work.turned_lines)
    take_row(found.bow, first, width, work.bow)
    take_row(found.worst, first, width, work.worst)
    take_row(found.deflection, first, width, work.deflection)
    take_row(found.displaced, first, width, work.displaced)


@within
def _put_loads(of, here, claim, first, width, work):  # type: ignore[no-untyped-def]
    """Write load and largest torque of claims, and the largest force of their flanks [N]."""
    set_apart()
    flanks, top = len(of.arm), work.top
    load, torque = work.scale, work.largest
    fill(load, 0.0)
    fill(torque, 0.0)
    fill(top, 0.0)
    put_rows(here.torque, first, width, work.torque)
    put_rows(claim.flank_force, first, width, work.claimed[:flanks])
    put_rows(claim.ring_force, first, width, work.claimed[flanks:])
    for g in range(len(of.radius)):
        due = work.torque[g]
        put_largest(torque, due, 1.0)
        put_largest(load, due, 1.0 / of.radius[g])
    for k in range(len(of.push_start) - 1):
        put_column(here.push[:, k], first, width, work.given)
        put_largest(load, work.given, 1.0)
    for e in range(flanks):
        claimed = work.claimed[e]
        put_largest(top, claimed, 1.0)
        put_largest(torque, claimed, of.arm[e])
    for v in range(BOUND.side_by_side):
        load[v] = larger(load[v], top[v])
        load[v] = load[v] if load[v] > 0.0 else 1.0
        torque[v] = torque[v] if torque[v] > 0.0 else 1.0
    for v in range(BOUND.side_by_side):
        work.band[v], work.light[v] = CERTIFY.band * load[v], BOUND.light * load[v]
    for v in range(BOUND.side_by_side):
        work.root_of_light[v] = np.cbrt(work.light[v])


@within
def _put_acts(of, work):  # type: ignore[no-untyped-def]
    """Find which contacts act, as `quick` does, and by how much the others are apart."""
    set_apart()
    flanks, contacts, top, approach = len(of.arm), len(of.twin), work.top, work.approach
    room, aside = work.room, work.aside
    for v in range(BOUND.side_by_side):
        work.resolution[v] = CERTIFY.resolution * (work.width[v] + work.limits[v])
    for c in range(contacts):
        acts, claimed, gap = work.acts[c], work.claimed[c], work.gap[c]
        # According to its force alone.
        for v in range(BOUND.side_by_side):
            force = abs(claimed[v])
            loaded = _ENDLESS if force < EPS * work.scale[v] else _LIGHT
            acts[v] = loaded if force < work.light[v] else _CLOSED
        for v in range(BOUND.side_by_side):
            force, next_to = abs(claimed[v]), BOUND.touching * work.widest[v]
            faint = (force <= BOUND.noise * top[v]) & (gap[v] > BOUND.apart * approach[v])
            idle = ((force == 0.0) | faint) & (not gap[v] <= next_to)
            acts[v] *= _OPEN if idle else 1.0
    for c in range(flanks, contacts):
        if of.twin[c] > c:
            _put_opposed(work, c, of.twin[c])
    fill(room, np.inf)
    fill(work.reach, np.inf)
    fill(work.faint, np.inf)
    fill(aside, 0.0)
    for c in range(contacts):
        acts, claimed, gap = work.acts[c], work.claimed[c], work.gap[c]
        for v in range(BOUND.side_by_side):
            apart = gap[v] if acts[v] == OPEN else np.inf
            room[v] = smaller(room[v], apart if gap[v] == gap[v] else -np.inf)
        if c < flanks:
            # A mesh has two flanks.
            for v in range(BOUND.side_by_side):
                beside = 2.0 * abs(claimed[v]) * of.arm[c]
                aside[v] = larger(aside[v], beside if acts[v] == OPEN else 0.0)


@inlined
def _put_opposed(work, c, other):  # type: ignore[no-untyped-def]
    """Replace two opposed contacts of a ring that act by one that holds both ways."""
    for v in range(BOUND.side_by_side):
        if work.acts[c, v] != OPEN and work.acts[other, v] != OPEN:
            _hold_both_ways(work, c, other, v)


@within
def _hold_both_ways(work, c, other, v):  # type: ignore[no-untyped-def]
    set_apart()
    second = work.claimed[c, v] >= work.claimed[other, v]
    idle, held = (other, c) if second else (c, other)
    work.acts[idle, v], work.gap[idle, v], work.acts[held, v] = OPEN, np.inf, CLOSED
