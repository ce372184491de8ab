"""The certificate of one claim after another, compiled with Numba: what `batch` asks for.

`of` is the train as columns, `here` the situations, `claim` the claims. First every claim is put
into figures, `found`, and numbered by what acts in it; then, with what `batch` makes of each such
`group`, they become bounds. The compiled code is kept on disk. Nothing of it is shared with the
certificate of single answers, nor with a solver: what they get wrong must not be wrong here too.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from loadshare import compilation
from loadshare.certify.bound.claim import EPS
from loadshare.certify.bound.laws import CLOSED, ENDLESS, LIGHT, OPEN
from loadshare.settings import BOUND, CERTIFY, LAWS

# Nothing is allocated in here, so Numba need not count who holds an array: counting would take
# twice as long as judging. A call would hand over every array of the tuples below, and cost more
# than what it does, so functions that take them are inlined.
_how: dict[str, Any] = {
    "nogil": True,
    "error_model": "numpy",
    "fastmath": {"reassoc", "contract", "nsz"},
    "_nrt": False,
}
FORCE, WAY, TORQUE, ARC, ARC_WAY = range(5)
"""Largest error of a force, way of an element, error of a torque; force and way of arcs."""
compiled = compilation.jit(**_how)
inlined = compilation.within(forceinline=True, **_how)


@compiled
def find_all(of, here, claim, sheet, found, sets):  # type: ignore[no-untyped-def]
    """Put all claims into figures; returns how many sets of elements act in them.

    Products with A and its transpose are those of some claims side by side; the rest goes claim by
    claim.
    """
    count, last, claims = 0, 0, len(claim.rotation)
    for first in range(0, claims, BOUND.abreast):
        width = min(BOUND.abreast, claims - first)
        for v in range(width):
            _places(of, here, claim, first + v, sheet, v, found)
        _lengths(of, sheet, width)
        for v in range(width):
            s = first + v
            top = _loads(of, here, claim, s, found)
            limits, approach = _limits(of, here, s, sheet, v)
            widest, behind = _gaps(of, here, s, sheet, v)
            _acts(of, here, claim, s, sheet, found, top, approach, widest)
            longest, lawful, covered = _pulls(of, here, claim, s, sheet, v, found, top, widest)
            count, last = _numbered(s, found.acts, sets, count, last)
            found.number[s] = last
            yielded, bent, seen = _contacts(of, here, claim, s, sheet, v, found, sets)
            further = _springs(of, here, claim, s, sheet, v, found, sets)
            for q in range(len(of.pull_gear)):
                at, soft = len(of.twin) + len(of.spring) + q, sheet.stiffest[q]
                _spread(sets, found.number[s], at, soft, soft)
            found.residual[s] = 0.0 if lawful and covered else np.inf
            found.width[s] = EPS * (found.width[s] + limits + longest + max(yielded, further))
            deflection = max(bent, found.deflection[s])
            deflection = deflection if deflection > 0.0 else CERTIFY.least_deflection
            worst = _worst(of, here, claim, s, sheet, v, found, deflection, seen)
            found.worst[s] = worst if lawful and not behind else np.inf
            found.deflection[s] = deflection
            found.displaced[s] = _displaced(of, claim, s, sheet, v, deflection)
        _pushes(of, sheet, width)
        for v in range(width):
            _balance(of, here, first + v, sheet, v, found)
    return count


@compiled
def bound_all(of, here, claim, found, group, errors):  # type: ignore[no-untyped-def]
    """Largest error of a torque [N·m] of every claim; infinite where it is not shown."""
    for s in range(len(errors)):
        errors[s], g = np.inf, found.number[s]
        if g < 0 or not group.known[g]:
            continue
        stray, taken, balanced = 0.0, 0.0, True
        for k in range(group.moves.shape[1]):
            along = 0.0
            for c in range(group.moves.shape[2]):
                along += group.moves[g, k, c] * found.left[s, c]
            stray = max(stray, abs(along))
        residual, scale = found.residual[s], found.scale[s]
        rest = found.rounding[s]
        if group.is_loose[g]:
            balanced = stray <= max(BOUND.balanced * scale, BOUND.rounded * found.push[s])
            residual += stray + EPS * scale
            rest += stray + EPS * scale
        for k in range(group.held.shape[1]):
            along = 0.0
            for c in range(group.held.shape[2]):
                along += group.held[g, k, c] * found.left[s, c]
            taken = max(taken, abs(along))
        if taken > 0.0:
            taken += EPS * scale
            residual += taken
            rest += taken
            arm = 0.0
            for c in range(len(of.arm)):
                if found.acts[s, c] == LIGHT or found.acts[s, c] == ENDLESS:
                    arm = max(arm, of.arm[c])
            # A mesh has two flanks.
            found.aside[s] += 2.0 * taken * arm
        if not balanced or not found.aside[s] < np.inf or not taken <= found.reach[s]:
            continue
        by_norm = group.by[g, TORQUE, 0] * residual, group.into[g] * residual
        errors[s] = _proved(of, found, group, g, s, residual, by_norm)
        if not errors[s] <= BOUND.enough * found.largest[s]:
            closely = _passed(of, here, claim, found, group, g, s, rest)
            errors[s] = min(errors[s], _proved(of, found, group, g, s, residual, closely))


@inlined
def _proved(of, found, group, g, s, residual, carried):  # type: ignore[no-untyped-def]
    """Error of a torque [N·m] if all holds that was assumed; else infinite."""
    largest, moved, torque = _answered(of, found, group, g, s, residual, carried)
    # Beyond their reach laws, above all of light Hertz contacts, are not what is said of them.
    if found.room[s] > moved + found.width[s] and largest <= found.reach[s] and torque < np.inf:
        return torque + found.aside[s]
    return np.inf


@inlined
def _row(array, s):  # type: ignore[no-untyped-def]
    """Row of a claim, or the only one."""
    return s if len(array) > 1 else 0


@inlined
def _contact_force(of, claim, s, c):  # type: ignore[no-untyped-def]
    """Claimed force of a flank, stop or arc [N]."""
    flanks = len(of.arm)
    return claim.flank_force[s, c] if c < flanks else claim.ring_force[s, c - flanks]


@inlined
def _loads(of, here, claim, s, found):  # type: ignore[no-untyped-def]
    """Load and largest torque of a claim; returns the largest force of a flank [N]."""
    r, load, torque, top = _row(here.torque, s), 0.0, 0.0, 0.0
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
def _level(of, here, claim, s, q):  # type: ignore[no-untyped-def]
    """Force at which a spline slips [N]."""
    k = q - of.rounds
    r = _row(here.spline, s)
    bound = here.spline[r, k, 3]
    if not np.isnan(bound):
        return bound
    torque = 0.0
    for e in range(len(of.arm)):
        torque += of.moment[k, e] * claim.flank_force[s, e]
    return here.spline[r, k, 4] * abs(torque)


@inlined
def _law(of, here, claim, s, q):  # type: ignore[no-untyped-def]
    """Graph of a radial element; not a number where it has no meaning.

    First stiffness, S1, level, S2, last stiffness, and the force at the end of the first piece.
    """
    if q < of.rounds:
        reach = here.round_radius[_row(here.round_radius, s), q]
        return 0.0, 0.0, 0.0, reach, here.round_stiffness[_row(here.round_stiffness, s), q], 0.0
    r, k = _row(here.spline, s), q - of.rounds
    level = _level(of, here, claim, s, q)
    stiffness, given, reach = here.spline[r, k, 0], here.spline[r, k, 1], here.spline[r, k, 2]
    stick, end = level / stiffness, level
    if np.isnan(given):
        if reach < stick:
            stick = end = np.inf
    elif stiffness * given > level * (1.0 + LAWS.written) or reach < min(given, stick):
        stick = np.nan
    elif given < stick:
        stick, end = given, stiffness * given
    return stiffness, stick, level, reach, stiffness, end


@inlined
def _stiffest(law):  # type: ignore[no-untyped-def]
    """Compliance of a graph that no two of its points undercut [m/N].

    A graph whose last piece is as stiff as its first, without a step of the force, is nowhere
    stiffer than that; a ring is as stiff as its wall.
    """
    _, _, level, _, last, end = law
    return 1.0 / last if end >= level else 0.0


@inlined
def _places(of, here, claim, s, sheet, v, found):  # type: ignore[no-untyped-def]
    """Coordinates, clockings and offsets of a claim [m], and where its gears are.

    Writes the sum of the largest sizes of both as its width, and the largest offset of a centre as
    its deflection.
    """
    x, varying, shift = sheet.x, sheet.varying, sheet.shift
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
    r, shafts = _row(here.offset, s), here.clocking.shape[1]
    for k in range(shafts):
        varying[k, v] = here.clocking[_row(here.clocking, s), k]
    for g in range(here.offset.shape[1]):
        square = 0.0
        for i in range(3):
            offset = here.offset[r, g, i]
            varying[shafts + 3 * g + i, v] = offset
            shift[3 * g + i, v] = moving[s, g, i] + offset
            offsets, square = max(offsets, abs(offset)), square + offset * offset
        furthest = max(furthest, square)
    found.width[s], found.deflection[s] = widest + offsets, np.sqrt(furthest)


@inlined
def _lengths(of, sheet, width):  # type: ignore[no-untyped-def]
    """Lengths A X [m] with clockings and offsets, what of them remains at rest, turns of lines."""
    x, varying, length, at_rest, across = (
        sheet.x,
        sheet.varying,
        sheet.length,
        sheet.at_rest,
        sheet.across,
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
                across[e, v] += value * (sheet.shift[i, v] - sheet.shift[j, v])


@inlined
def _limits(of, here, s, sheet, v):  # type: ignore[no-untyped-def]
    """Take gaps and floats from the lengths [m]; returns the largest, and the largest approach."""
    limits, approach, length = 0.0, 0.0, sheet.length
    rg, rj, rs = _row(here.gap, s), _row(here.backlash, s), _row(here.stop, s)
    for e in range(len(of.arm)):
        m = of.mesh[e]
        gap = here.gap[rg, m] if of.is_drive[e] else here.backlash[rj, m]
        length[e, v] -= gap
        sheet.at_rest[e, v] -= gap
        limits, approach = max(limits, abs(gap)), max(approach, length[e, v])
    for d in range(len(of.drum_gear)):
        for side in range(2):
            limit = here.stop[rs, d, side]
            length[of.first_stop + 2 * d + side, v] -= limit
            limits = max(limits, abs(limit))
    return limits, approach


@inlined
def _gaps(of, here, s, sheet, v):  # type: ignore[no-untyped-def]
    """Gaps of flanks, stops and arcs, and unit vectors of the latter.

    Returns the widest gap, and whether a gear stands beyond a neighbour on whose ring its own
    rolls.
    """
    flanks, drums, behind = len(of.arm), len(of.drum_gear), False
    for e in range(flanks):
        sheet.gap[e] = -sheet.length[e, v]
    for k in range(2 * drums):
        sheet.gap[flanks + k] = -sheet.length[of.first_stop + k, v]
    ra, rc = _row(here.arc_shift, s), _row(here.arc_clearance, s)
    for k in range(2 * drums):
        d, side = k // 2, k % 2
        apart, along, square = of.apart[k], 0.0, 0.0
        for a in range(2):
            moved = sheet.length[of.first_arc + 2 * k + a, v]
            for i in range(3):
                moved += of.frame[of.drum_gear[d], a, i] * here.arc_shift[ra, d, side, i]
            sheet.line[k, a] = moved
            along += of.nominal[k, a] * moved
            square += moved * moved
        behind |= not apart * apart + along > 0.0
        length = np.sqrt(apart * apart + 2.0 * along + square)
        longer = (2.0 * along + square) / (length + apart)
        sheet.turn[k] = 0.0
        for a in range(2):
            turned = (sheet.line[k, a] - longer * of.nominal[k, a] / apart) / length
            sheet.turn[k] = max(sheet.turn[k], abs(turned))
            sheet.line[k, a] = of.nominal[k, a] / apart + turned
        sheet.gap[flanks + 2 * drums + k] = longer + here.arc_clearance[rc, d, side]
    widest = 0.0
    for c in range(len(sheet.gap)):
        widest = max(widest, abs(sheet.gap[c]))
    return widest, behind


@inlined
def _acts(of, here, claim, s, sheet, found, top, deflection, widest):  # type: ignore[no-untyped-def]
    """Tell which contacts act, as `quick` does, and by how much the others are apart."""
    flanks, acts, gap = len(of.arm), found.acts, sheet.gap
    for c in range(len(of.twin)):
        force = abs(_contact_force(of, claim, s, c))
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
            second = _contact_force(of, claim, s, c) >= _contact_force(of, claim, s, other)
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


@inlined
def _spread(sets, number, at, least, most):  # type: ignore[no-untyped-def]
    """Let the compliances of a set hold some more [m/N]."""
    if number >= 0:
        sets.least[number, at] = min(sets.least[number, at], least)
        sets.most[number, at] = max(sets.most[number, at], most)


@inlined
def _flank(of, here, s, e, force, scale):  # type: ignore[no-untyped-def]
    """Law of a flank at a force.

    Compression [m], smallest and largest compliance [m/N] next to it, and the error of the force
    up to which they hold [N]. A Hertz contact that is light may lose its force: its largest is the
    secant to none, which has no end where there is none.
    """
    m, light = of.mesh[e], BOUND.light * scale
    if of.is_tabled[e]:
        r = _row(here.table, s)
        return _by_table(here.table[r, m, 0], here.table[r, m, 1], force, light)
    bending, hertz = here.bending[_row(here.bending, s), m], here.hertz[_row(here.hertz, s), m]
    if hertz == 0.0:
        return bending * force, bending, bending, np.inf
    root = np.cbrt(max(force, 0.0))
    compression = bending * force + hertz * root * root
    if force >= light:
        soft = bending + 2.0 / 3.0 * hertz / root
        return compression, soft, soft, 0.1 * force
    least = bending + 2.0 / 3.0 * hertz / np.cbrt(light)
    most = bending + hertz / root if root > 0.0 else np.inf
    return compression, least, most, 0.1 * light


@compiled
def _by_table(forces, compressions, force, near):  # type: ignore[no-untyped-def]
    """Law of a table at a force, as `_flank`; it is straight beyond the last point.

    Corners that are near do not end it: laws on both sides of them are among those it tells of.
    """
    last = len(forces) - 2
    while last > 0 and np.isnan(forces[last + 1]):
        last -= 1
    k = 0
    while k < last and forces[k + 1] <= force:
        k += 1
    slope = (compressions[k + 1] - compressions[k]) / (forces[k + 1] - forces[k])
    first, final = k, k
    while first > 0 and force - forces[first] <= near:
        first -= 1
    while final < last and forces[final + 1] - force <= near:
        final += 1
    least, most, reach = slope, slope, np.inf
    for i in range(first, final + 1):
        other = (compressions[i + 1] - compressions[i]) / (forces[i + 1] - forces[i])
        least, most = min(least, other), max(most, other)
    if first > 0:
        reach = min(reach, force - forces[first])
    if final < last:
        reach = min(reach, forces[final + 1] - force)
    return compressions[k] + slope * (force - forces[k]), least, most, reach


@inlined
def _contacts(of, here, claim, s, sheet, v, found, sets):  # type: ignore[no-untyped-def]
    """Forces and misfits of contacts.

    Returns their largest compression [m], that of loaded flanks or what remains of their approach
    at rest [m], and what is seen of residuals: length [m], work [J], pull [N] and sum of forces.
    """
    flanks, contacts, number = len(of.arm), len(of.twin), found.number[s]
    arcs, rw, band = contacts - len(of.apart), _row(here.wall, s), CERTIFY.band * found.scale[s]
    yielded, bent, weakest, reach, turned, bow = 0.0, 0.0, np.inf, np.inf, 0.0, 0.0
    length, work, pull, total = 0.0, 0.0, 0.0, 0.0
    for c in range(contacts):
        acts = found.acts[s, c] != OPEN
        claimed = _contact_force(of, claim, s, c)
        force = claimed if acts else 0.0
        pull, total, misfit = max(pull, -claimed), total + claimed, 0.0
        if c < flanks:
            sheet.force[c, v] = force
            if claimed > 0.0:
                bent = max(bent, abs(sheet.at_rest[c, v]))
        elif c < arcs:
            sheet.force[of.first_stop + c - flanks, v] = force
        else:
            k = c - arcs
            for a in range(2):
                sheet.force[of.first_arc + 2 * k + a, v] = -force * sheet.line[k, a]
        if acts:
            if c < flanks:
                law = _flank(of, here, s, c, force, found.scale[s])
                compression, least, most, holds = law
                reach, bent = min(reach, holds), max(bent, compression)
            else:
                least = most = here.wall[rw, of.drum[c - flanks]]
                compression = least * force
                if c >= arcs:
                    turned = max(turned, sheet.turn[c - arcs])
                    bow = max(bow, abs(force) / of.apart[c - arcs])
            # What opens may move by any length; of two that touch, one takes what the other cannot.
            if of.twin[c] < 0 or sheet.gap[of.twin[c]] < np.inf:
                reach = min(reach, force if found.acts[s, c] == CLOSED else np.inf)
            # What yields without end carries no load.
            _spread(sets, number, c, least, least if found.acts[s, c] == ENDLESS else most)
            weakest, yielded = min(weakest, force), max(yielded, abs(compression))
            misfit = -sheet.gap[c] - compression
            # With less force than the band it counts as open, as in `residuals`.
            length = max(length, abs(misfit) if force > band else misfit)
            work, total = max(work, -force * misfit), total + misfit
            if force == 0.0:
                misfit = max(misfit, 0.0)
        elif sheet.gap[c] < np.inf:
            length, work = max(length, -sheet.gap[c]), max(work, claimed * sheet.gap[c])
        elif claimed != 0.0:
            # Two opposed contacts carry.
            total = np.nan
        found.misfit[s, c] = misfit
    found.turned[s], found.bow[s], found.reach[s] = turned, bow, reach
    # A contact that pulls is none.
    return yielded if weakest >= 0.0 else np.inf, bent, (length, work, pull, total)


@inlined
def _springs(of, here, claim, s, sheet, v, found, sets):  # type: ignore[no-untyped-def]
    """Forces and misfits of elastic shafts and bearings; returns their largest deflection [m]."""
    yielded, first = 0.0, len(of.twin)
    for k in range(len(of.spring)):
        j, number, axis = of.spring[k, 0], of.spring[k, 1], of.spring[k, 2]
        if axis == 2:
            soft = of.spring_arm[k] ** 2 / here.torsion[_row(here.torsion, s), number]
            force = claim.shaft_torque[s, number] / of.spring_arm[k]
        else:
            soft = 1.0 / here.support[_row(here.support, s), number, axis]
            force = claim.support_force[s, number, axis]
        _spread(sets, found.number[s], first + k, soft, soft)
        sheet.force[j, v] = force
        found.misfit[s, first + k] = sheet.length[j, v] - soft * force
        yielded = max(yielded, abs(soft * force))
    return yielded


@inlined
def _pulls(of, here, claim, s, sheet, v, found, top, widest):  # type: ignore[no-untyped-def]
    """Forces and misfits of radial elements: the point of their graph next to what is claimed.

    Returns the largest of their lengths [m], whether their laws have a meaning, and whether they
    are covered by the bound.
    """
    contacts, at = len(of.twin), len(of.twin) + len(of.spring)
    longest, lawful, covered = 0.0, True, True
    for q in range(len(of.pull_gear)):
        g, j, rate = of.pull_gear[q], of.first_pull + 2 * q, 0.0
        law = _law(of, here, claim, s, q)
        stick, level, reach = law[1], law[2], law[3]
        x, y = sheet.length[j, v] - of.centre[q, 0], sheet.length[j + 1, v] - of.centre[q, 1]
        fx, fy, lifting = 0.0, 0.0, 0.0
        for i in range(3):
            fx -= of.frame[g, 0, i] * claim.radial_reaction[s, q, i]
            fy -= of.frame[g, 1, i] * claim.radial_reaction[s, q, i]
            lifting += of.axis[g, i] * claim.radial_reaction[s, q, i]
        claimed_x, claimed_y, away_x, away_y = fx, fy, x, y
        distance, force = np.sqrt(x * x + y * y), np.sqrt(fx * fx + fy * fy)
        lawful &= force < np.inf and distance < np.inf
        lawful &= stick >= 0.0 and level >= 0.0 and reach >= 0.0
        noise = BOUND.noise * top
        acts = level > 0.0 or force > noise or reach - distance <= BOUND.near * widest
        found.acts[s, contacts + q] = CLOSED if acts else OPEN
        soft, spare, misfit_x, misfit_y, slips, near = 0.0, np.inf, 0.0, 0.0, 0.0, 0.0
        if acts:
            near, along, soft, spare = _nearest(law, force, distance, BOUND.corner)
            if near <= 0.0 or distance == 0.0:
                # On the first piece, or pinned: a spring about the centre.
                misfit_x, misfit_y = x - fx * soft, y - fy * soft
                longest = max(longest, distance + force * soft)
            else:
                misfit_x, misfit_y = x - near / distance * x, y - near / distance * y
                fx, fy = along * x / distance, along * y / distance
                longest = max(longest, distance + near)
                slips = 1.0 / distance if along == level else 0.0
            if q >= of.rounds:
                rate = _rate(of, here, s, q)
                covered &= rate == 0.0 or found.aside[s] == 0.0
        else:
            fx, fy = 0.0, 0.0
            found.room[s] = min(found.room[s], reach - distance)
        longest = max(longest, abs(of.centre[q, 0]) + abs(of.centre[q, 1]) + distance)
        sheet.force[j, v], sheet.force[j + 1, v] = fx, fy
        sheet.excess[2 * q, v], sheet.excess[2 * q + 1, v] = claimed_x - fx, claimed_y - fy
        for k in range(len(law)):
            sheet.law[q, k] = law[k]
        sheet.offset[q, 0], sheet.offset[q, 1] = away_x, away_y
        sheet.pull[q, 0], sheet.pull[q, 1], sheet.pull[q, 2] = claimed_x, claimed_y, lifting
        sheet.stiffest[q] = _stiffest(law)
        found.misfit[s, at + 2 * q], found.misfit[s, at + 2 * q + 1] = misfit_x, misfit_y
        found.held[s, q] = np.inf
        if rate > 0.0 and near <= 0.0 and _sticks(law, force):
            # So it does until the torque is half of what it is.
            found.held[s, q], rate = 0.5 * level / rate, 0.0
        found.soft[s, q], found.spare[s, q], found.rate[s, q] = soft, spare, rate
        found.slip[s, q, 0], found.slip[s, q, 1] = slips * x, slips * y
    return longest, lawful, covered


@inlined
def _sticks(law, force):  # type: ignore[no-untyped-def]
    """Whether a spline would stick at half the level as well."""
    first, stick, level, reach, _, end = law
    if np.isinf(stick):
        return 0.5 * level >= first * reach
    return end >= level and force <= 0.5 * level


@inlined
def _rate(of, here, s, q):  # type: ignore[no-untyped-def]
    """Change of a spline's level with the torque over it [1/m]."""
    r, k = _row(here.spline, s), q - of.rounds
    return abs(here.spline[r, k, 4]) if np.isnan(here.spline[r, k, 3]) else 0.0


@inlined
def _nearest(law, force, distance, corner):  # type: ignore[no-untyped-def]
    """Point of a graph at a force that is nearest to a distance: distance [m], force [N].

    A distance below 0 stands for the first piece. Further the compliance [m/N] there (of a slip
    across it, wherever it ends), and by how much the force may change.
    """
    first, stick, level, reach, last, end = law
    if np.isinf(stick):
        return -1.0, force, 1.0 / first, np.inf
    slips = stick * (1.0 + BOUND.slack) < distance < reach * (1.0 - BOUND.slack)
    if abs(force - level) <= (BOUND.slack if slips else corner) * level:
        return min(max(distance, stick), reach), level, reach / level, BOUND.slip_turns * level
    if force > level:
        far = reach + (force - level) / last
        return far, force, max(1.0 / last, far / force), min(force - level, 0.05 * force)
    if force <= end and stick > 0.0:
        return -1.0, force, 1.0 / first, end - force
    spare = min(level - force, force - end if stick > 0.0 else np.inf)
    return stick, force, stick / force if stick > 0.0 else 0.0, spare


@inlined
def _pushes(of, sheet, width):  # type: ignore[no-untyped-def]
    """What forces carry of the load at every coordinate [N], and the sizes of its terms."""
    left, sizes, force = sheet.left, sheet.sizes, sheet.force
    for c in range(len(left)):
        for v in range(width):
            left[c, v] = sizes[c, v] = 0.0
    for j in range(len(force)):
        for i in range(of.start[j], of.start[j + 1]):
            value, c = of.value[i], of.at[i]
            for v in range(width):
                term = value * force[j, v]
                left[c, v] -= term
                sizes[c, v] += abs(term)


@inlined
def _balance(of, here, s, sheet, v, found):  # type: ignore[no-untyped-def]
    """Load that is left over [N]: the largest, with its rounding; and over the load of the case."""
    left, sizes, largest, r = sheet.left, sheet.sizes, 0.0, _row(here.torque, s)
    for k in range(len(of.load)):
        due, c = here.torque[r, of.load[k, 1]] / of.load_radius[k], of.load[k, 0]
        left[c, v] += due
        sizes[c, v] += abs(due)
    for j in range(len(sheet.force)):
        largest = max(largest, abs(sheet.force[j, v]))
    residual, rounding, total = 0.0, 0.0, 0.0
    for c in range(len(left)):
        found.left[s, c] = left[c, v]
        most = abs(left[c, v]) + EPS * sizes[c, v]
        residual, total = max(residual, most), total + most
        rounding = max(rounding, EPS * sizes[c, v])
    found.push[s], found.rounding[s] = largest, rounding + EPS * residual
    for j in range(2 * len(of.pull_gear)):
        # What is claimed leaves it over, not the point of the graph next to it.
        left[of.at[of.start[of.first_pull + j]], v] -= sheet.excess[j, v]
    unbalanced = 0.0
    for c in range(len(left)):
        unbalanced, total = max(unbalanced, abs(left[c, v])), total + abs(left[c, v])
    # The largest may have passed over what is not a number.
    known = total < np.inf
    found.residual[s] = max(found.residual[s], residual if known else np.inf)
    if not known:
        found.worst[s] = np.nan if found.worst[s] < np.inf else found.worst[s]
    elif found.worst[s] < unbalanced / found.scale[s]:
        found.worst[s] = unbalanced / found.scale[s]


@inlined
def _worst(of, here, claim, s, sheet, v, found, deflection, seen):  # type: ignore[no-untyped-def]
    """Largest scaled residual of a claim but of balance: of laws, signs, and what is no column.

    Not a number where something claimed is none, and where two opposed contacts carry: these are
    for `residuals`.
    """
    load, (length, work, pull, total) = found.scale[s], seen
    for k in range(found.misfit.shape[1]):
        total += found.misfit[s, k]
    for k in range(len(of.twin), len(of.twin) + len(of.spring)):
        length = max(length, abs(found.misfit[s, k]))
    strayed, free = _strayed(of, here, claim, s), _free(of, here, claim, s)
    length, force, band = max(length, strayed), max(pull, free), CERTIFY.band * deflection
    for q in range(len(of.pull_gear)):
        force = max(force, _excess(sheet.law[q], sheet.offset[q], sheet.pull[q], band))
        total += sheet.pull[q, 2]
        if np.isinf(sheet.law[q, 4]):
            x, y = sheet.offset[q, 0], sheet.offset[q, 1]
            length = max(length, np.sqrt(x * x + y * y) - sheet.law[q, 3])
    for d in of.squeezed:
        force = max(force, _squeeze(of, here, claim, s, sheet, d, band))
    worst = max(max(force / load, length / deflection), work / (load * deflection))
    for c in range(len(sheet.x)):
        total += sheet.x[c, v]
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
    length, r = np.sqrt(square), _row(here.clocking, s)
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
    turned = claim.rotation[s, of.output]
    # The largest may have passed over what is not a number.
    return max(length, abs(turned) * of.radius[of.output]) + 0.0 * (total + turned)


@inlined
def _free(of, here, claim, s):  # type: ignore[no-untyped-def]
    """Largest force [N] claimed of bearings that bear nothing."""
    r, square, total = _row(here.support, s), 0.0, 0.0
    for k in range(len(of.place)):
        g, free = of.place[k, 1], 0.0
        for a in range(2):
            if not here.support[r, g, a] > 0.0:
                free += claim.support_force[s, g, a] ** 2
        square, total = max(square, free), total + free
    return np.sqrt(square) + 0.0 * total


@inlined
def _squeeze(of, here, claim, s, sheet, d, band):  # type: ignore[no-untyped-def]
    """What the squeeze of a drum's opposed arcs leaves open [N] (see `residuals`)."""
    first = 2 * len(of.drum_gear) + 2 * d
    squeeze = min(claim.ring_force[s, first], claim.ring_force[s, first + 1])
    if squeeze <= 0.0:
        return 0.0
    r, g = _row(here.arc_shift, s), of.drum_gear[d]
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
        known = max(abs(sheet.gap[gap]), abs(sheet.gap[gap + 1]))
        known += np.finfo(np.float64).eps * np.sqrt(moved)
    across = 2.0 * known / distance
    return squeeze * across / (np.sqrt(wedge) + np.sqrt(wedge + across))


@inlined
def _displaced(of, claim, s, sheet, v, deflection):  # type: ignore[no-untyped-def]
    """How far displacements go to a warning (see `Measuring.worst`).

    Not a number where an approach is neglected that only gears without force may take up.
    """
    worst, most, furthest = 0.0, 0.0, 0.0
    for e in range(len(of.arm)):
        approach, across = sheet.length[e, v], sheet.across[e, v]
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


@inlined
def _passed(of, here, claim, found, group, g, s, rest):  # type: ignore[no-untyped-def]
    """Largest torque [N·m] and energy [√J] of what carries the load that is left over.

    Row by row, with the compliances of the claim itself.

    Parameters
    ----------
    rest : float
        Load that may be anywhere [N].
    """
    torque, both, energy = 0.0, 0.0, 0.0
    for k in range(group.particular.shape[1]):
        force, soft = 0.0, group.softest[g, k]
        for c in range(group.particular.shape[2]):
            force += group.particular[g, k, c] * found.left[s, c]
        force = abs(force) + group.passed[g, k] * rest
        if k < len(of.arm):
            if k == 0 or of.mesh[k] != of.mesh[k - 1]:
                both = 0.0
            both += force * of.arm[k] * (1.0 + EPS)
            torque = max(torque, both)
            if found.acts[s, k] == CLOSED or found.acts[s, k] == LIGHT:
                _, _, most, _ = _flank(of, here, s, k, claim.flank_force[s, k], found.scale[s])
                soft = most / BOUND.secant
        energy += soft * group.size[g, k] * force
    return torque, energy


@inlined
def _answered(of, found, group, g, s, residual, carried):  # type: ignore[no-untyped-def]
    """Largest error of a force [N], way of an element [m] and error of a torque [N·m].

    Parameters
    ----------
    residual : float
        Load that is left over [N].
    carried : tuple of float
        Torque [N·m] and energy [√J] of what carries it.
    """
    bent, deepest, into, back, blind = 0.0, 0.0, group.into[g], 0.0, 0.0
    for i in range(group.root.shape[1]):
        along = 0.0
        for k in range(group.root.shape[2]):
            along += group.root[g, i, k] * found.misfit[s, k]
        bent += along * along
    bent, (own, spent), by_load = np.sqrt(bent), carried, group.by[g, TORQUE, 0]
    for k in range(found.misfit.shape[1]):
        deepest = max(deepest, abs(found.misfit[s, k]))
    if group.carries[g]:
        more, back, blind = _carried(of, found, group, g, s)
        into += more
        spent += more * residual
        # What a slip should carry along its line comes back as load.
        again = residual * (back / (1.0 - back)) if back < BOUND.gain else np.inf
        own, spent, residual = own + by_load * again, spent + into * again, residual + again
    gap, push, tilt = deepest + found.width[s], 0.0, 0.0
    due = bent + spent, into, found.width[s]
    load, energy = _followed(of, found, group, g, s, residual, push, tilt, due)
    proved = True
    if group.bows[g] > 0.0:
        # Errors act along lines that are nominal here; what that leaves out is bounded over a box
        # some times as wide, which must hold the result.
        proved = False
        pushed = _by(group, g, ARC, load, push, energy, gap)
        moved = _by(group, g, ARC_WAY, load, push, energy, gap) + blind
        for wide in BOUND.wider_lines:
            if not proved:
                box, room = wide * pushed, wide * moved
                push = 2.0 * (found.turned[s] * box + found.bow[s] * room) / (1.0 - back)
                tilt = found.turned[s] * room + room * room * group.bows[g]
                load, energy = _followed(of, found, group, g, s, residual, push, tilt, due)
                proved = _by(group, g, ARC, load, push, energy, gap + tilt) <= box
                way = _by(group, g, ARC_WAY, load, push, energy, gap + tilt) + blind
                way += _pulled_way(found, group, g, s, load, push, energy)
                proved &= way <= room
    if group.carries[g]:
        for q in range(found.soft.shape[1]):
            proved &= _pulled(group, g, q, load, push, energy) <= found.spare[s, q]
    for k in range(len(of.moment)):
        by = group.moment_by[g, k]
        off = by[0] * load + by[1] * push + by[2] * energy
        proved &= off <= found.held[s, of.rounds + k]
    largest = _by(group, g, FORCE, load, push, energy, gap)
    moved = _by(group, g, WAY, load, push, energy, gap + tilt) + blind
    moved += _pulled_way(found, group, g, s, load, push, energy)
    torque = own + _by(group, g, TORQUE, load - residual, push, energy, gap)
    return largest, moved, torque if proved else np.inf


@inlined
def _by(group, g, what, load, push, energy, gap):  # type: ignore[no-untyped-def]
    """One of the largest figures by load [N], push on arcs [N], energy [√J] and gap [m]."""
    by = group.by[g, what]
    return by[0] * load + by[1] * push + by[2] * energy + by[3] * gap


@inlined
def _pulled(group, g, q, load, push, energy):  # type: ignore[no-untyped-def]
    """Error of the force of a radial element that takes part in carrying [N]; of others 0."""
    by = group.pull_by[g, q]
    return by[0] * load + by[1] * push + by[2] * energy if by[0] > 0.0 else 0.0


@inlined
def _pulled_way(found, group, g, s, load, push, energy):  # type: ignore[no-untyped-def]
    """Way of an element by what radial elements yield that take part in carrying [m]."""
    moved = 0.0
    if group.carries[g]:
        for q in range(found.soft.shape[1]):
            off = _pulled(group, g, q, load, push, energy)
            moved += 2.0 * group.pull_by[g, q, 3] * found.soft[s, q] * off
    return moved


@inlined
def _carried(of, found, group, g, s):  # type: ignore[no-untyped-def]
    """What carrying a load by radial elements adds.

    Energy per load; the load that comes back of each, because a slip carries none along its line;
    and the way [m] that is not told by the force of a slip.
    """
    more, back, blind = 0.0, 0.0, 0.0
    for q in range(found.soft.shape[1]):
        by, soft, along = group.pull_by[g, q], found.soft[s, q], 0.0
        if by[0] > 0.0:
            more += 2.0 * soft * by[0] * by[2]
            x, y = found.slip[s, q, 0], found.slip[s, q, 1]
            if x != 0.0 or y != 0.0:
                for c in range(group.part.shape[3]):
                    along += abs(x * group.part[g, q, 0, c] + y * group.part[g, q, 1, c])
                level = found.spare[s, q] / BOUND.slip_turns
                back += along + BOUND.slip_turns * by[0]
                blind += 2.0 * soft * level * along
    return more, back, blind * group.widest[g]


@inlined
def _followed(of, found, group, g, s, residual, push, tilt, due):  # type: ignore[no-untyped-def]
    """Load left over and energy, with what friction that follows the torque adds to them."""
    spent, into, width = due
    energy = spent + group.into_by_push[g] * push
    energy += group.spread[g] * width + group.spread_of_arcs[g] * tilt
    most, back, rates = 0.0, 0.0, 0.0
    for k in range(len(of.moment)):
        rates += found.rate[s, of.rounds + k]
    if rates == 0.0:
        return residual, energy
    for k in range(len(of.moment)):
        by, gain = group.moment_by[g, k], 0.0
        most = max(most, by[0] * residual + by[1] * push + by[2] * energy)
        for i in range(len(of.moment)):
            each = group.gain[g, k, i]
            if group.carries[g]:
                for q in range(found.soft.shape[1]):
                    soft = 2.0 * found.soft[s, q] * group.pull_by[g, q, 2]
                    each += by[2] * soft * group.pushed[g, q, i]
            gain += each * found.rate[s, of.rounds + i]
        back = max(back, gain)
    more = rates * most / (1.0 - back) if back < BOUND.gain else np.inf
    if group.carries[g]:
        more *= 2.0
    return residual + more, energy + into * more
