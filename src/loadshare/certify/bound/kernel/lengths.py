"""Coordinates, lengths and gaps of claims."""

from __future__ import annotations

import numpy as np

from loadshare.certify.bound.kernel.laws import row_of
from loadshare.certify.bound.kernel.options import inlined


@inlined
def put_places(of, here, claim, s, work, v, found):  # type: ignore[no-untyped-def]
    """Coordinates, clockings and offsets of a claim [m], and where its gears are.

    Writes the sum of the largest sizes of both as its width, and the largest offset of a centre as
    its deflection.
    """
    x, varying, shift = work.x, work.varying, work.shift
    widest, offsets, furthest, moving = 0.0, 0.0, 0.0, claim.displacement
    for k in range(len(of.turn)):
        x[of.turn[k, 0], v] = of.turn_radius[k] * claim.rotation[s, of.turn[k, 1]]
    for k in range(len(of.place)):
        at, g = of.place[k, 0], of.place[k, 1]
        for a in range(2):
            moved = 0.0
            for i in range(3):
                moved += of.frame[g, a, i] * moving[s, g, i]
            x[at + a, v] = moved
    for c in range(len(x)):
        widest = max(widest, abs(x[c, v]))
    r, shafts = row_of(here.offset, s), here.clocking.shape[1]
    for k in range(shafts):
        varying[k, v] = here.clocking[row_of(here.clocking, s), k]
    for g in range(here.offset.shape[1]):
        square = 0.0
        for i in range(3):
            offset = here.offset[r, g, i]
            varying[shafts + 3 * g + i, v] = offset
            shift[3 * g + i, v] = moving[s, g, i] + offset
            offsets, square = max(offsets, abs(offset)), square + offset * offset
        furthest = max(furthest, square)
    for g in range(len(of.carrier)):
        if of.carrier[g] >= 0:
            for i in range(3):
                shift[3 * g + i, v] += shift[3 * of.carrier[g] + i, v]
    found.width[s], found.deflection[s] = widest + offsets, np.sqrt(furthest)


@inlined
def put_lengths(of, work, width):  # type: ignore[no-untyped-def]
    """Lengths A X [m] with clockings and offsets, what of them remains at rest, turns of lines."""
    x, varying, length, at_rest, across = (
        work.x,
        work.varying,
        work.length,
        work.at_rest,
        work.across,
    )
    for j in range(len(length)):
        for v in range(width):
            length[j, v] = 0.0
        for i in range(of.start[j], of.start[j + 1]):
            value, c = of.value[i], of.at[i]
            for v in range(width):
                length[j, v] += value * x[c, v]
        for i in range(of.rest_start[j], of.rest_start[j + 1]):
            value, c = of.rest_value[i], of.rest_at[i]
            for v in range(width):
                length[j, v] += value * varying[c, v]
    for e in range(len(at_rest)):
        for v in range(width):
            at_rest[e, v] = across[e, v] = 0.0
        for i in range(of.rest_shift[e], of.rest_start[e + 1]):
            value, c = of.rest_value[i], of.rest_at[i]
            for v in range(width):
                at_rest[e, v] += value * varying[c, v]
        for k in range(3):
            value, i, j = of.across[e, k], 3 * of.ends[e, 0] + k, 3 * of.ends[e, 1] + k
            for v in range(width):
                across[e, v] += value * (work.shift[i, v] - work.shift[j, v])


@inlined
def put_limits(of, here, s, work, v):  # type: ignore[no-untyped-def]
    """Take gaps and floats from the lengths [m]; returns the largest, and the largest approach."""
    limits, approach, length = 0.0, 0.0, work.length
    rg, rs = row_of(here.gap, s), row_of(here.stop, s)
    for e in range(len(of.arm)):
        gap = here.gap[rg, e]
        length[e, v] -= gap
        work.at_rest[e, v] -= gap
        limits, approach = max(limits, abs(gap)), max(approach, length[e, v])
    for d in range(len(of.drum_gear)):
        for side in range(2):
            limit = here.stop[rs, d, side]
            length[of.first_stop + 2 * d + side, v] -= limit
            limits = max(limits, abs(limit))
    return limits, approach


@inlined
def put_gaps(of, here, s, work, v):  # type: ignore[no-untyped-def]
    """Gaps of flanks, stops and arcs, and unit vectors of the latter.

    Returns the widest gap, and whether a gear stands beyond a neighbour on whose ring its own
    rolls.
    """
    flanks, drums, behind = len(of.arm), len(of.drum_gear), False
    for e in range(flanks):
        work.gap[e] = -work.length[e, v]
    for k in range(2 * drums):
        work.gap[flanks + k] = -work.length[of.first_stop + k, v]
    ra, rc = row_of(here.arc_shift, s), row_of(here.arc_clearance, s)
    for k in range(2 * drums):
        d, side = k // 2, k % 2
        apart, along, square = of.apart[k], 0.0, 0.0
        for a in range(2):
            moved = work.length[of.first_arc + 2 * k + a, v]
            for i in range(3):
                moved += of.frame[of.drum_gear[d], a, i] * here.arc_shift[ra, d, side, i]
            work.line[k, a] = moved
            along += of.nominal[k, a] * moved
            square += moved * moved
        behind |= not apart * apart + along > 0.0
        length = np.sqrt(apart * apart + 2.0 * along + square)
        longer = (2.0 * along + square) / (length + apart)
        work.turn[k] = 0.0
        for a in range(2):
            turned = (work.line[k, a] - longer * of.nominal[k, a] / apart) / length
            work.turn[k] = max(work.turn[k], abs(turned))
            work.line[k, a] = of.nominal[k, a] / apart + turned
        work.gap[flanks + 2 * drums + k] = longer + here.arc_clearance[rc, d, side]
    widest = 0.0
    for c in range(len(work.gap)):
        widest = max(widest, abs(work.gap[c]))
    return widest, behind
