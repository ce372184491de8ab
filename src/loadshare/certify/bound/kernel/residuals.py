"""Residuals of a claim, as for single answers, and how far it is displaced."""

from __future__ import annotations

import numpy as np

from loadshare.by_reference import set_apart
from loadshare.certify.bound.kernel.options import inlined, within
from loadshare.certify.bound.kernel.rows import (
    fill,
    put_column,
    put_largest,
    put_most,
    put_multiple,
    put_sum,
    row_of,
)
from loadshare.extremes import larger
from loadshare.settings import BOUND, CERTIFY


@within
def put_worst(of, here, claim, first, width, work):  # type: ignore[no-untyped-def]
    """Write the largest scaled residuals of claims except balance: of laws, signs, and the rest.

    NaN where a claimed figure is NaN, and where two opposed contacts carry: these are left to
    `residuals`.
    """
    set_apart()
    force, length, total = work.pulled, work.misfit, work.total
    at = len(of.twin) + len(of.spring)
    _put_strayed(of, work)
    _put_free(of, here, first, width, work)
    for c in range(len(work.x)):
        put_sum(total, work.x[c], 1.0)
    for v in range(width):
        resolution = work.resolution[v]
        band = CERTIFY.band * work.deflection[v] + resolution
        for q in range(len(of.pull_gear)):
            pull = work.pull[q, 0, v], work.pull[q, 1, v], work.pull[q, 2, v]
            x, y = work.offset[q, 0, v], work.offset[q, 1, v]
            force[v] = max(force[v], _excess(work.graph[q], v, (x, y), pull, band))
            total[v] += pull[2] + work.apart[at + 2 * q, v] + work.apart[at + 2 * q + 1, v]
            if np.isinf(work.graph[q, 4, v]):
                length[v] = max(length[v], np.sqrt(x * x + y * y) - work.graph[q, 3, v])
        for d in of.squeezed:
            force[v] = max(force[v], _squeeze(of, here, claim, first + v, work, v, d, band))
    for v in range(BOUND.side_by_side):
        load, deflection = work.scale[v], work.deflection[v]
        beyond = larger(length[v] - work.resolution[v], 0.0)
        worst = larger(force[v] / load, beyond / deflection)
        work.worst[v] = larger(worst, work.energy[v] / (load * deflection)) + 0.0 * total[v]
    for v in range(BOUND.side_by_side):
        lawful = (work.lawful[v] > 0.0) & (not work.behind[v] > 0.0)
        work.given[v] = work.worst[v] if lawful else np.inf
    for v in range(BOUND.side_by_side):
        work.worst[v] = work.given[v]


@inlined
def _excess(graph, v, offset, pull, band):  # type: ignore[no-untyped-def]
    """Return the excess [N] of a radial element's pull over its graph (see `residuals`)."""
    x, y, lifting = offset[0], offset[1], abs(pull[2])
    radius, force = np.sqrt(x * x + y * y), np.sqrt(pull[0] * pull[0] + pull[1] * pull[1])
    low, high = _interval(graph, v, radius, band)
    along, sideways = force, 0.0
    if radius > band:
        along = (pull[0] * x + pull[1] * y) / radius
        sideways = abs(pull[0] * y - pull[1] * x) / radius - force * band / radius
    return max(max(low - along, along - high), max(sideways, lifting))


@inlined
def _interval(graph, v, radius, band):  # type: ignore[no-untyped-def]
    """Return least and largest force that a graph admits within the band about a radius."""
    first, stick, level, reach, last = (
        graph[0, v],
        graph[1, v],
        graph[2, v],
        graph[3, v],
        graph[4, v],
    )
    low, high = np.inf, 0.0
    inner, outer = radius - band, radius + band
    throughout = np.isinf(stick)
    level_end = max(reach, 0.0 if throughout else stick)
    if stick > 0.0 and inner <= stick:
        low, high = first * max(inner, 0.0), first * min(outer, stick)
    if level_end > stick and stick <= outer and inner <= level_end:
        low, high = min(low, level), max(high, level)
    if np.isfinite(last) and not throughout and outer >= level_end:
        low = min(low, level + last * max(inner - level_end, 0.0))
        high = max(high, level + last * max(outer - level_end, 0.0))
    if radius <= band:
        low = 0.0
    if np.isinf(last) and radius >= reach - band:
        low, high = min(low, level), np.inf
    return low, high


@inlined
def _put_strayed(of, work):  # type: ignore[no-untyped-def]
    """Include lengths [m] by which gears are where no coordinate can take them."""
    length, total, moved, square = work.misfit, work.total, work.moved, work.push
    fill(square, 0.0)
    for g in of.still:
        x, y, z = moved[3 * g], moved[3 * g + 1], moved[3 * g + 2]
        for v in range(BOUND.side_by_side):
            square[v] = larger(square[v], x[v] * x[v] + y[v] * y[v] + z[v] * z[v])
        for i in range(3 * g, 3 * g + 3):
            put_sum(total, moved[i], 1.0)
        for i in range(2 * g, 2 * g + 2):
            put_sum(total, work.borne[i], 1.0)
    for v in range(BOUND.side_by_side):
        length[v] = larger(length[v], np.sqrt(square[v]))
    for k in range(len(of.place)):
        g, axis = of.place[k, 1], of.axis[of.place[k, 1]]
        lifted = work.given
        fill(lifted, 0.0)
        for i in range(3):
            put_sum(lifted, moved[3 * g + i], axis[i])
        put_largest(length, lifted, 1.0)
        put_sum(total, lifted, 1.0)
    for w in of.rigid_shaft:
        g, other, wound = of.shaft[w, 0], of.shaft[w, 1], work.given
        put_multiple(wound, work.turned[g], 1.0)
        put_sum(wound, work.turned[other], -1.0)
        put_sum(wound, work.varying[w], -1.0)
        put_largest(length, wound, of.radius[g])
        put_sum(total, wound, 1.0)
        put_sum(total, work.wound[w], 1.0)
    for g in of.held:
        put_largest(length, work.turned[g], of.radius[g])
        put_sum(total, work.turned[g], 1.0)


@inlined
def _put_free(of, here, first, width, work):  # type: ignore[no-untyped-def]
    """Include the forces [N] that are claimed of bearings without stiffness."""
    force, total, given, square = work.pulled, work.total, work.given, work.push
    for k in range(len(of.place)):
        g = of.place[k, 1]
        fill(square, 0.0)
        for a in range(2):
            put_column(here.support[:, g, a], first, width, given)
            for v in range(BOUND.side_by_side):
                push = 0.0 if given[v] > 0.0 else work.borne[2 * g + a, v]
                square[v] += push * push
        for v in range(BOUND.side_by_side):
            force[v] = larger(force[v], np.sqrt(square[v]))
        put_sum(total, square, 1.0)


@inlined
def _squeeze(of, here, claim, s, work, v, d, band):  # type: ignore[no-untyped-def]
    """Return the force [N] that a squeeze of opposed arcs leaves open (see `residuals`)."""
    first = 2 * len(of.drum_gear) + 2 * d
    squeeze = min(claim.ring_force[s, first], claim.ring_force[s, first + 1])
    if squeeze <= 0.0:
        return 0.0
    r, g = row_of(here.arc_shift, s), of.drum_gear[d]
    units, moved = (np.float64(0.0), np.float64(0.0)), 0.0
    for k in range(2 * d, 2 * d + 2):
        x, y = of.nominal[k, 0], of.nominal[k, 1]
        for i in range(3):
            x += of.frame[g, 0, i] * here.arc_shift[r, d, k % 2, i]
            y += of.frame[g, 1, i] * here.arc_shift[r, d, k % 2, i]
        size = np.sqrt(x * x + y * y)
        units = units[0] + x / size, units[1] + y / size
    for i in range(3 * g, 3 * g + 3):
        moved += claim.displacement[s, i] ** 2
    wedge, distance = units[0] ** 2 + units[1] ** 2, min(of.apart[2 * d], of.apart[2 * d + 1])
    known = band
    if wedge * distance > 8.0 * band:
        gap = len(of.arm) + first
        known = max(abs(work.gap[gap, v]), abs(work.gap[gap + 1, v]))
        known += np.finfo(np.float64).eps * np.sqrt(moved)
    across = 2.0 * known / distance
    return squeeze * across / (np.sqrt(wedge) + np.sqrt(wedge + across))


@within
def put_displaced(of, work):  # type: ignore[no-untyped-def]
    """Write how close displacements come to a warning (see `Measuring.worst`).

    NaN where an approach is neglected that only gears without force may take up.
    """
    set_apart()
    most, furthest, worst = work.given, work.push, work.displaced
    moved = work.moved
    fill(most, 0.0)
    fill(furthest, 0.0)
    fill(worst, 0.0)
    for e in range(len(of.arm)):
        approach, across = work.length[e], work.across[e]
        for v in range(BOUND.side_by_side):
            neglected = 0.5 * of.line[e] * across[v] * across[v] - max(-approach[v], 0.0)
            most[v] = larger(most[v], neglected)
        put_most(worst, approach, of.yields[e])
        put_largest(furthest, across, 1.0)
    for v in range(BOUND.side_by_side):
        most[v] /= work.deflection[v] * CERTIFY.neglected
    for v in range(BOUND.side_by_side):
        worst[v] = larger(larger(worst[v], furthest[v] / of.turnable), most[v])
    for k in range(len(of.apart)):
        g, other, allowed = of.drum_gear[k // 2], of.neighbour[k], of.apart[k] * CERTIFY.turned
        for v in range(BOUND.side_by_side):
            square = 0.0
            for i in range(3):
                way = moved[3 * g + i, v] - moved[3 * other + i, v]
                square += way * way
            worst[v] = larger(worst[v], np.sqrt(square) / allowed)
    for v in range(BOUND.side_by_side):
        worst[v] = np.nan if most[v] > 1.0 else worst[v]
