"""Residuals of a claim, as single answers have them, and how far it is displaced."""

from __future__ import annotations

import numpy as np

from loadshare.certify.bound.kernel.laws import row_of
from loadshare.certify.bound.kernel.options import inlined
from loadshare.settings import CERTIFY


@inlined
def worst_residual(of, here, claim, s, work, v, found, scale, seen):  # type: ignore[no-untyped-def]
    """Largest scaled residual of a claim but of balance: of laws, signs, and what is no column.

    Not a number where something claimed is none, and where two opposed contacts carry: these are
    for `residuals`.
    """
    (load, deflection, resolution), (length, energy, pull, total) = scale, seen
    for k in range(found.misfit.shape[1]):
        total += found.misfit[s, k]
    for k in range(len(of.twin), len(of.twin) + len(of.spring)):
        length = max(length, abs(found.misfit[s, k]))
    strayed, free = _strayed(of, here, claim, s), _free(of, here, claim, s)
    length, force = max(length, strayed), max(pull, free)
    band = CERTIFY.band * deflection + resolution
    for q in range(len(of.pull_gear)):
        force = max(force, _excess(work.law[q], work.offset[q], work.pull[q], band))
        total += work.pull[q, 2]
        if np.isinf(work.law[q, 4]):
            x, y = work.offset[q, 0], work.offset[q, 1]
            length = max(length, np.sqrt(x * x + y * y) - work.law[q, 3])
    for d in of.squeezed:
        force = max(force, _squeeze(of, here, claim, s, work, d, band))
    length = max(length - resolution, 0.0)
    worst = max(max(force / load, length / deflection), energy / (load * deflection))
    for c in range(len(work.x)):
        total += work.x[c, v]
    return worst + 0.0 * (total + strayed + free)


@inlined
def _excess(law, offset, pull, band):  # type: ignore[no-untyped-def]
    """Excess [N] of a radial element's pull over what its graph admits (see `residuals`)."""
    x, y, lifting = offset[0], offset[1], abs(pull[2])
    radius, force = np.sqrt(x * x + y * y), np.sqrt(pull[0] * pull[0] + pull[1] * pull[1])
    low, high = _interval(law, radius, band)
    along, sideways = force, 0.0
    if radius > band:
        along = (pull[0] * x + pull[1] * y) / radius
        sideways = abs(pull[0] * y - pull[1] * x) / radius - force * band / radius
    return max(max(low - along, along - high), max(sideways, lifting))


@inlined
def _interval(law, radius, band):  # type: ignore[no-untyped-def]
    """Forces that a graph admits within the band about a radius."""
    first, stick, level, reach, last = law[0], law[1], law[2], law[3], law[4]
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
def _strayed(of, here, claim, s):  # type: ignore[no-untyped-def]
    """Largest length [m] by which gears are where no coordinate leads them."""
    moved, square, total = claim.displacement, 0.0, 0.0
    for g in of.still:
        x, y, z = moved[s, g, 0], moved[s, g, 1], moved[s, g, 2]
        square, total = max(square, x * x + y * y + z * z), total + x + y + z
        total += claim.support_force[s, g, 0] + claim.support_force[s, g, 1]
    length, r = np.sqrt(square), row_of(here.clocking, s)
    for k in range(len(of.place)):
        g, lifted = of.place[k, 1], 0.0
        for i in range(3):
            lifted += of.axis[g, i] * moved[s, g, i]
        length, total = max(length, abs(lifted)), total + lifted
    for w in of.rigid_shaft:
        g = of.shaft[w, 0]
        wound = claim.rotation[s, g] - claim.rotation[s, of.shaft[w, 1]] - here.clocking[r, w]
        length = max(length, abs(wound) * of.radius[g])
        total += wound + claim.shaft_torque[s, w]
    for g in of.held:
        turned = claim.rotation[s, g]
        length, total = max(length, abs(turned) * of.radius[g]), total + turned
    # The largest may have passed over what is not a number.
    return length + 0.0 * total


@inlined
def _free(of, here, claim, s):  # type: ignore[no-untyped-def]
    """Largest force [N] claimed of bearings that bear nothing."""
    r, square, total = row_of(here.support, s), 0.0, 0.0
    for k in range(len(of.place)):
        g, free = of.place[k, 1], 0.0
        for a in range(2):
            if not here.support[r, g, a] > 0.0:
                free += claim.support_force[s, g, a] ** 2
        square, total = max(square, free), total + free
    return np.sqrt(square) + 0.0 * total


@inlined
def _squeeze(of, here, claim, s, work, d, band):  # type: ignore[no-untyped-def]
    """What the squeeze of a drum's opposed arcs leaves open [N] (see `residuals`)."""
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
    for i in range(3):
        moved += claim.displacement[s, g, i] ** 2
    wedge, distance = units[0] ** 2 + units[1] ** 2, min(of.apart[2 * d], of.apart[2 * d + 1])
    known = band
    if wedge * distance > 8.0 * band:
        gap = len(of.arm) + first
        known = max(abs(work.gap[gap]), abs(work.gap[gap + 1]))
        known += np.finfo(np.float64).eps * np.sqrt(moved)
    across = 2.0 * known / distance
    return squeeze * across / (np.sqrt(wedge) + np.sqrt(wedge + across))


@inlined
def displaced(of, claim, s, work, v, deflection):  # type: ignore[no-untyped-def]
    """How far displacements go to a warning (see `Measuring.worst`).

    Not a number where an approach is neglected that only gears without force may take up.
    """
    worst, most, furthest = 0.0, 0.0, 0.0
    for e in range(len(of.arm)):
        approach, across = work.length[e, v], work.across[e, v]
        most = max(most, 0.5 * of.line[e] * across * across - max(-approach, 0.0))
        worst, furthest = max(worst, approach * of.yields[e]), max(furthest, abs(across))
    worst = max(max(worst, furthest / of.turnable), most / (deflection * CERTIFY.neglected))
    if most > deflection * CERTIFY.neglected:
        worst = np.nan
    for k in range(len(of.apart)):
        square, g = 0.0, of.drum_gear[k // 2]
        for i in range(3):
            way = claim.displacement[s, g, i] - claim.displacement[s, of.neighbour[k], i]
            square += way * way
        worst = max(worst, np.sqrt(square) / (of.apart[k] * CERTIFY.turned))
    return worst
