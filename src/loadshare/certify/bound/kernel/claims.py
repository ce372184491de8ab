"""Claims as figures: what acts, misfits, what is left over, residuals and scales."""

from __future__ import annotations

import numpy as np

from loadshare.by_reference import by_reference, set_apart
from loadshare.certify.bound.claim import EPS
from loadshare.certify.bound.kernel.forces import (
    put_balance,
    put_contacts,
    put_pulls,
    put_pushes,
    put_springs,
    spread,
)
from loadshare.certify.bound.kernel.laws import contact_force, row_of
from loadshare.certify.bound.kernel.lengths import put_gaps, put_lengths, put_limits, put_places
from loadshare.certify.bound.kernel.options import compiled, inlined, within
from loadshare.certify.bound.kernel.residuals import displaced, worst_residual
from loadshare.certify.bound.laws import CLOSED, ENDLESS, LIGHT, OPEN
from loadshare.settings import BOUND, CERTIFY


@compiled
def find_all(of, here, claim, work, found, sets):  # type: ignore[no-untyped-def]
    """Put all claims into figures; returns how many sets of elements act in them."""
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
    """Products with A and its transpose are those of some claims side by side.

    The rest goes claim by claim.
    """
    set_apart()
    count, last, claims = 0, 0, len(claim.rotation)
    for first in range(0, claims, BOUND.abreast):
        width = min(BOUND.abreast, claims - first)
        for v in range(width):
            put_places(of, here, claim, first + v, work, v, found)
        put_lengths(of, work, width)
        for v in range(width):
            s = first + v
            top = _loads(of, here, claim, s, found)
            limits, approach = put_limits(of, here, s, work, v)
            widest, behind = put_gaps(of, here, s, work, v)
            resolution = CERTIFY.resolution * (found.width[s] + limits)
            _acts(of, here, claim, s, work, found, top, approach, widest)
            longest, lawful, covered = put_pulls(of, here, claim, s, work, v, found, top, widest)
            count, last = _numbered(s, found.acts, sets, count, last)
            found.number[s] = last
            yielded, bent, seen = put_contacts(of, here, claim, s, work, v, found, sets, resolution)
            further = put_springs(of, here, claim, s, work, v, found, sets)
            for q in range(len(of.pull_gear)):
                at, soft = len(of.twin) + len(of.spring) + q, work.stiffest[q]
                spread(sets, found.number[s], at, soft, soft)
            found.residual[s] = 0.0 if lawful and covered else np.inf
            found.width[s] = EPS * (found.width[s] + limits + longest + max(yielded, further))
            deflection = max(bent, found.deflection[s])
            deflection = deflection if deflection > 0.0 else CERTIFY.least_deflection
            scale = found.scale[s], deflection, resolution
            worst = worst_residual(of, here, claim, s, work, v, found, scale, seen)
            found.worst[s] = worst if lawful and not behind else np.inf
            found.deflection[s] = deflection
            found.displaced[s] = displaced(of, claim, s, work, v, deflection)
        put_pushes(of, work, width)
        for v in range(width):
            put_balance(of, here, first + v, work, v, found)
    return count


@inlined
def _loads(of, here, claim, s, found):  # type: ignore[no-untyped-def]
    """Load and largest torque of a claim; returns the largest force of a flank [N]."""
    r, load, torque, top = row_of(here.torque, s), 0.0, 0.0, 0.0
    for g in range(len(of.radius)):
        due = abs(here.torque[r, g])
        load, torque = max(load, due / of.radius[g]), max(torque, due)
    for e in range(len(of.arm)):
        force = abs(claim.flank_force[s, e])
        top, torque = max(top, force), max(torque, force * of.arm[e])
    load = max(load, top)
    found.scale[s] = load if load > 0.0 else 1.0
    found.largest[s] = torque if torque > 0.0 else 1.0
    return top


@inlined
def _acts(of, here, claim, s, work, found, top, deflection, widest):  # type: ignore[no-untyped-def]
    """Tell which contacts act, as `quick` does, and by how much the others are apart."""
    flanks, acts, gap = len(of.arm), found.acts, work.gap
    for c in range(len(of.twin)):
        force = abs(contact_force(of, claim, s, c))
        faint = force <= BOUND.noise * top and gap[c] > BOUND.apart * deflection
        acts[s, c] = OPEN
        if not (force == 0.0 or faint) or gap[c] <= BOUND.touching * widest:
            acts[s, c] = CLOSED
            if force < BOUND.light * found.scale[s]:
                acts[s, c] = LIGHT if force >= EPS * found.scale[s] else ENDLESS
    for c in range(flanks, len(of.twin)):
        other = of.twin[c]
        if other > c and acts[s, c] != OPEN and acts[s, other] != OPEN:
            # Two opposed contacts of a ring are one that holds both ways.
            second = contact_force(of, claim, s, c) >= contact_force(of, claim, s, other)
            idle, held = (other, c) if second else (c, other)
            acts[s, idle], gap[idle], acts[s, held] = OPEN, np.inf, CLOSED
    room, aside, known = np.inf, 0.0, True
    for c in range(len(of.twin)):
        known &= gap[c] == gap[c]
        if acts[s, c] == OPEN:
            room = min(room, gap[c])
            if c < flanks:
                # A mesh has two flanks.
                aside = max(aside, 2.0 * abs(claim.flank_force[s, c]) * of.arm[c])
    found.room[s], found.aside[s] = room if known else -np.inf, aside


@inlined
def _numbered(s, acts, sets, count, last):  # type: ignore[no-untyped-def]
    """Number what acts; returns how many sets there are, and the number, −1 if there are more."""
    key = np.uint64(0)
    for c in range(acts.shape[1]):
        key = key * np.uint64(6364136223846793005) + np.uint64(1 + acts[s, c])
    if last >= 0 and count > 0 and sets.key[last] == key and _same(acts, s, sets.first[last]):
        return count, last
    for k in range(count):
        if sets.key[k] == key and _same(acts, s, sets.first[k]):
            return count, k
    if count == len(sets.first):
        return count, -1
    sets.first[count], sets.key[count] = s, key
    return count + 1, count


@inlined
def _same(acts, one, other):  # type: ignore[no-untyped-def]
    same = True
    for c in range(acts.shape[1]):
        same &= acts[one, c] == acts[other, c]
    return same
