"""Coordinates, lengths and gaps of claims."""

from __future__ import annotations

import numpy as np

from loadshare.by_reference import set_apart
from loadshare.certify.bound.kernel.options import within
from loadshare.certify.bound.kernel.rows import (
    fill,
    put_column,
    put_largest,
    put_most,
    put_multiple,
    put_product,
    put_rows,
    put_sum,
)
from loadshare.extremes import larger
from loadshare.settings import BOUND


@within
def put_places(of, here, claim, first, width, work):  # type: ignore[no-untyped-def]
    """Write coordinates, clockings and offsets of claims [m], and where their gears are.

    Also writes the largest coordinate plus the largest offset as the width, and the largest offset
    of a centre as the deflection.
    """
    set_apart()
    x, varying, shift, moved, square = work.x, work.varying, work.shift, work.moved, work.given
    widest, furthest = work.width, work.deflection
    shafts = here.clocking.shape[1]
    put_rows(claim.rotation, first, width, work.turned)
    put_rows(claim.displacement, first, width, moved)
    put_rows(here.clocking, first, width, varying[:shafts])
    put_rows(here.offset, first, width, varying[shafts:])
    fill(widest, 0.0)
    fill(furthest, 0.0)
    fill(work.limits, 0.0)
    for k in range(len(of.turn)):
        put_multiple(x[of.turn[k, 0]], work.turned[of.turn[k, 1]], of.turn_radius[k])
    for k in range(len(of.place)):
        at, g = of.place[k, 0], of.place[k, 1]
        for a in range(2):
            row, frame = x[at + a], of.frame[g, a]
            put_multiple(row, moved[3 * g], frame[0])
            put_sum(row, moved[3 * g + 1], frame[1])
            put_sum(row, moved[3 * g + 2], frame[2])
    for c in range(len(x)):
        put_largest(widest, x[c], 1.0)
    for g in range(here.offset.shape[1] // 3):
        fill(square, 0.0)
        for i in range(3 * g, 3 * g + 3):
            offset, row, way = varying[shafts + i], shift[i], moved[i]
            for v in range(BOUND.side_by_side):
                row[v] = way[v] + offset[v]
            put_largest(work.limits, offset, 1.0)
            for v in range(BOUND.side_by_side):
                square[v] += offset[v] * offset[v]
        put_most(furthest, square, 1.0)
    for g in range(len(of.carrier)):
        if of.carrier[g] >= 0:
            for i in range(3):
                put_sum(shift[3 * g + i], shift[3 * of.carrier[g] + i], 1.0)
    put_sum(widest, work.limits, 1.0)
    for v in range(BOUND.side_by_side):
        furthest[v] = np.sqrt(furthest[v])


@within
def put_lengths(of, work):  # type: ignore[no-untyped-def]
    """Write lengths A X [m] with clockings and offsets, their parts at rest, and turns of lines."""
    set_apart()
    length, at_rest, across, shift = work.length, work.at_rest, work.across, work.shift
    length[:], at_rest[:] = 0.0, 0.0
    put_product(length, of.start, of.start[1:], of.at, of.value, work.x)
    rest = of.rest_at, of.rest_value, work.varying
    put_product(length, of.rest_start, of.rest_start[1:], *rest)
    put_product(at_rest, of.rest_shift, of.rest_start[1:], *rest)
    for e in range(len(across)):
        fill(across[e], 0.0)
        for k in range(3):
            put_sum(across[e], shift[3 * of.ends[e, 0] + k], of.across[e, k])
            put_sum(across[e], shift[3 * of.ends[e, 1] + k], -of.across[e, k])


@within
def put_limits(of, here, first, width, work):  # type: ignore[no-untyped-def]
    """Subtract gaps and floats from lengths [m]; write the largest of them and of approaches."""
    set_apart()
    limits, approach, given = work.limits, work.approach, work.given
    flanks = work.gap[: len(of.arm)]
    put_rows(here.gap, first, width, flanks)
    fill(limits, 0.0)
    fill(approach, 0.0)
    for e in range(len(of.arm)):
        length, at_rest, gap = work.length[e], work.at_rest[e], flanks[e]
        put_sum(length, gap, -1.0)
        put_sum(at_rest, gap, -1.0)
        put_largest(limits, gap, 1.0)
        put_most(approach, length, 1.0)
    for d in range(len(of.drum_gear)):
        for side in range(2):
            length = work.length[of.first_stop + 2 * d + side]
            put_column(here.stop[:, d, side], first, width, given)
            put_sum(length, given, -1.0)
            put_largest(limits, given, 1.0)


@within
def put_gaps(of, here, first, width, work):  # type: ignore[no-untyped-def]
    """Write gaps of flanks, stops and arcs, the widest of them, and unit vectors of arcs.

    Where a gear is beyond a neighbour on whose ring its own rolls, `behind` is 1.
    """
    set_apart()
    flanks, drums = len(of.arm), len(of.drum_gear)
    for c in range(flanks + 2 * drums):
        length = work.length[c if c < flanks else of.first_stop + c - flanks]
        put_multiple(work.gap[c], length, -1.0)
    fill(work.behind, 0.0)
    for k in range(2 * drums):
        d, side, gap = k // 2, k % 2, work.gap[flanks + 2 * drums + k]
        line, turn, apart = work.line[k], work.turn[k], of.apart[k]
        for a in range(2):
            moved, frame = line[a], of.frame[of.drum_gear[d], a]
            length = work.length[of.first_arc + 2 * k + a]
            put_multiple(moved, length, 1.0)
            for i in range(3):
                put_column(here.arc_shift[:, d, side, i], first, width, work.given)
                put_sum(moved, work.given, frame[i])
        put_column(here.arc_clearance[:, d, side], first, width, gap)
        for v in range(BOUND.side_by_side):
            x, y = line[0, v], line[1, v]
            along = of.nominal[k, 0] * x + of.nominal[k, 1] * y
            longer = 2.0 * along + (x * x + y * y)
            length_now = np.sqrt(apart * apart + longer)
            longer /= length_now + apart
            across = of.nominal[k, 0] / apart, of.nominal[k, 1] / apart
            x, y = (x - longer * across[0]) / length_now, (y - longer * across[1]) / length_now
            before = apart * apart + along > 0.0
            work.behind[v] = larger(work.behind[v], 0.0 if before else 1.0)
            gap[v] += longer
            turn[v] = larger(abs(x), abs(y))
            line[0, v], line[1, v] = across[0] + x, across[1] + y
    fill(work.widest, 0.0)
    for c in range(len(work.gap)):
        put_largest(work.widest, work.gap[c], 1.0)
