"""The certificate of one answer after another, compiled with Numba: the figures of `residuals`.

It follows `state` and `residuals` step by step, with numbers in place of arrays, from the same
mechanics of the train. `of` are the train's `Arguments`, `here` the situations, `claim` the
answers, of which number `s` is at hand, and `scratch` what is found on the way. The compiled code
is kept on disk, so that only the first use of a new version waits for it; it holds no lock of the
interpreter.

It shares nothing with the compiled solver, though both find the root of a law: what the solver gets
wrong must not be wrong here too.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from loadshare import compilation
from loadshare.settings import CERTIFY, LAWS

# Nothing is allocated in here, so Numba need not count who holds an array: counting would take
# twice as long as judging. A call would hand over every array of the tuples below, and cost more
# than what it does, so functions that take them are inlined.
_how: dict[str, Any] = {
    "nogil": True,
    "error_model": "numpy",
    "fastmath": {"reassoc", "contract", "nsz"},
    "_nrt": False,
}
compiled = compilation.jit(**_how)
inlined = compilation.within(forceinline=True, **_how)


@compiled
def judge_all(of, here, claim, scratch, residuals, loads, deflections):  # type: ignore[no-untyped-def]
    """Judge all answers; see `arguments.judged`."""
    for s in range(len(claim.rotation)):
        load = _load(of, here, claim, s)
        gap, sizes = _flanks(of, here, claim, s, scratch)
        deflection = _deflection(here, claim, s, scratch)
        more, larger, fault = _ring_contacts(of, here, claim, s, scratch)
        gap, sizes = gap + more, sizes + larger
        fault |= _pulls(of, here, claim, s, scratch)
        _moves(of, claim, s, scratch)
        _moments(of, here, claim, s, scratch)
        work = load * deflection
        figures = (
            _force_balance(of, claim, s, scratch) / load,
            _moment_balance(of, scratch) / load,
            _penetration(scratch) / deflection,
            _complementarity(claim, s, scratch) / work,
            _deformation_law(of, here, claim, s, scratch, CERTIFY.band * load) / deflection,
            _cone_membership(of, here, claim, s, scratch, CERTIFY.band * deflection) / load,
            _energy_gap(of, here, claim, s, scratch, gap, sizes) / work,
        )
        bad = fault or not _finite(claim, s)
        for figure in figures:
            bad |= figure != figure
        for k in range(7):
            residuals[s, k] = np.inf if bad else figures[k]
        loads[s], deflections[s] = load, deflection


@inlined
def _row(array, s):  # type: ignore[no-untyped-def]
    """Row of an answer, or the only one."""
    return s if len(array) > 1 else 0


@inlined
def _worse(worst, value):  # type: ignore[no-untyped-def]
    """The larger figure; not-a-number is worse than any.

    Where `max` stands instead, what it compares is known to be a number: claims by `_finite`,
    overlaps by `_penetration`.
    """
    return value if value > worst or value != value else worst


@inlined
def _load(of, here, claim, s):  # type: ignore[no-untyped-def]
    """Load of the case [N] (see `State`)."""
    torque, row = here.torque, _row(here.torque, s)
    load = 0.0
    for g in range(len(of.radius)):
        load = _worse(load, abs(torque[row, g]) / of.radius[g])
    for e in range(claim.flank_force.shape[1]):
        load = _worse(load, abs(claim.flank_force[s, e]))
    return 1.0 if load == 0.0 else load


@inlined
def _flanks(of, here, claim, s, scratch):  # type: ignore[no-untyped-def]
    """Overlaps, pushes and moments of flanks.

    Returns their part of the energy gap and of the sizes of its terms [J].
    """
    phi, moved, offset = claim.rotation, claim.displacement, here.offset
    r, rg, rj = _row(offset, s), _row(here.gap, s), _row(here.backlash, s)
    rb, rc, rt = _row(here.bending, s), _row(here.hertz, s), _row(here.table, s)
    scratch.push[:] = 0.0
    scratch.moment[:] = 0.0
    gap, sizes = 0.0, 0.0
    for e in range(len(of.driver)):
        i, j, m = of.driver[e], of.driven[e], of.mesh[e]
        at_rest = -here.gap[rg, m] if of.is_drive[e] else -here.backlash[rj, m]
        approach = of.turning[e, 0] * phi[s, i] + of.turning[e, 1] * phi[s, j]
        force = claim.flank_force[s, e]
        for k in range(3):
            n = of.pushing[e, k]
            at_rest += n * (offset[r, i, k] - offset[r, j, k])
            approach += n * (moved[s, i, k] - moved[s, j, k])
            scratch.push[i, k] -= n * force
            scratch.push[j, k] += n * force
        scratch.moment[i] += of.moment[e, 0] * force
        scratch.moment[j] += of.moment[e, 1] * force
        approach += at_rest
        compression = 0.0
        if force > 0.0 or approach > 0.0:
            if of.is_tabled[e]:
                found = _by_table(here.table[rt, m, 0], here.table[rt, m, 1], force, approach)
            else:
                found = _by_power(here.bending[rb, m], here.hertz[rc, m], force, approach)
            compression = found[0]
            gap += found[1]
            sizes += found[1]
        gap -= force * at_rest
        sizes += abs(force * at_rest)
        scratch.at_rest[e], scratch.compression[e] = at_rest, compression
        scratch.overlap[e] = approach - compression
    return gap, sizes


@inlined
def _by_power(b, c, force, approach):  # type: ignore[no-untyped-def]
    """Compression [m] and both energies [J] of a power law.

    Where the law holds, the strain energy at the approach is that at the compression and the work
    of the force from there on; elsewhere the force at the approach has to be found.
    """
    positive = max(force, 0.0)
    if c == 0.0:
        compression = b * positive
        strain = max(approach, 0.0) ** 2 / b if b > 0.0 else 0.0
        return compression, 0.5 * (compression * positive + strain)
    root = np.cbrt(positive)
    square = root * root
    fifth = square * square * root
    compression = b * positive + c * square
    dual = (0.5 * b * root + 0.6 * c) * fifth
    if approach <= 0.0:
        return compression, dual
    beyond, slope = approach - compression, (3.0 * b * root + 2.0 * c) * root
    if abs(beyond) <= 1e-8 * slope * root:
        return compression, dual + (0.5 * b * root + 0.4 * c) * fifth + positive * beyond
    root = _root(b, c, approach)
    return compression, dual + (0.5 * b * root + 0.4 * c) * root**5


@compiled
def _root(b, c, compression):  # type: ignore[no-untyped-def]
    """F^(1/3) of the law b F + c F^(2/3), c > 0, by Newton's method from above."""
    y = np.sqrt(compression / c)
    if b > 0.0:
        y = min(y, np.cbrt(compression / b))
    for _ in range(60):
        step = ((b * y + c) * y * y - compression) / ((3.0 * b * y + 2.0 * c) * y)
        y -= step
        if abs(step) <= 1e-15 * y:
            break
    return y


@compiled
def _by_table(forces, compressions, force, approach):  # type: ignore[no-untyped-def]
    """Compression [m] and both energies [J] of a table."""
    positive = max(force, 0.0)
    energy = _area(forces, compressions, positive)
    if approach > 0.0:
        true = _interpolated(compressions, forces, approach)
        energy += true * approach - _area(forces, compressions, true)
    return _interpolated(forces, compressions, positive), energy


@compiled
def _interpolated(axis, values, at):  # type: ignore[no-untyped-def]
    """Value of a table at `at`, straight beyond the last point."""
    k = 0
    while k + 2 < len(axis) and axis[k + 1] <= at and not np.isnan(axis[k + 2]):
        k += 1
    return values[k] + (values[k + 1] - values[k]) / (axis[k + 1] - axis[k]) * (at - axis[k])


@compiled
def _area(forces, compressions, force):  # type: ignore[no-untyped-def]
    """∫δ dF of a table up to `force`."""
    area = 0.0
    for k in range(len(forces) - 1):
        if np.isnan(forces[k + 1]) or not force > forces[k]:
            break
        is_last = k + 2 == len(forces) or np.isnan(forces[k + 2])
        width = (force if is_last else min(force, forces[k + 1])) - forces[k]
        rise = compressions[k + 1] - compressions[k]
        slope = rise / (forces[k + 1] - forces[k])
        area += width * (compressions[k] + 0.5 * slope * width)
    return area


@inlined
def _deflection(here, claim, s, scratch):  # type: ignore[no-untyped-def]
    """Deflection of the case [m] (see `State`)."""
    lengths, shifts = 0.0, 0.0
    for e in range(claim.flank_force.shape[1]):
        if claim.flank_force[s, e] > 0.0:
            lengths = _worse(lengths, max(scratch.compression[e], abs(scratch.at_rest[e])))
    r = _row(here.offset, s)
    for g in range(here.offset.shape[1]):
        x, y, z = here.offset[r, g, 0], here.offset[r, g, 1], here.offset[r, g, 2]
        shifts = _worse(shifts, x * x + y * y + z * z)
    deflection = _worse(lengths, np.sqrt(shifts))
    return 1e-6 if deflection == 0.0 else deflection


@inlined
def _ring_contacts(of, here, claim, s, scratch):  # type: ignore[no-untyped-def]
    """Overlaps and pushes of stops, then arcs.

    Returns their part of the energy gap and of the sizes of its terms [J], and whether a gear
    stands beyond its neighbour.
    """
    moved, forces = claim.displacement, claim.ring_force
    drums = len(of.drum)
    rh, ra = _row(here.stop, s), _row(here.arc_shift, s)
    rc, rw = _row(here.arc_clearance, s), _row(here.wall, s)
    stored, worked, sizes, fault = 0.0, 0.0, 0.0, False
    for d in range(drums):
        g, wall = of.drum[d, 0], here.wall[rw, d]
        across = 0.0
        for k in range(3):
            across += moved[s, g, k] * of.across[d, k]
        for side in range(2):
            stop, arc = 2 * d + side, 2 * (drums + d) + side
            sign, limit = 1.0 - 2.0 * side, here.stop[rh, d, side]
            approach, force = sign * across - limit, forces[s, stop]
            scratch.ring_overlap[stop] = approach - wall * max(force, 0.0)
            stored += _wall_energy(wall, force, approach)
            worked -= force * limit
            sizes += abs(force * limit)

            neighbour = of.drum[d, 1 + side]
            grown, size, rolled, ahead = 0.0, 0.0, 0.0, 0.0
            for k in range(3):
                nominal = of.nominal[d, side, k]
                relative = moved[s, g, k] - moved[s, neighbour, k]
                apart = here.arc_shift[ra, d, side, k] + relative
                grown += (2.0 * nominal + apart) * apart
                size += (nominal + apart) * (nominal + apart)
                rolled += (nominal + apart) * relative
                ahead += (nominal + apart) * nominal
            fault |= not ahead > 0.0
            size = np.sqrt(size)
            force = forces[s, arc]
            margin = grown / (size + of.distance[d, side]) + here.arc_clearance[rc, d, side]
            scratch.ring_overlap[arc] = -margin - wall * max(force, 0.0)
            stored += _wall_energy(wall, force, -margin)
            work = force * (rolled / size - margin)
            worked += work
            sizes += abs(work)
            push = force / size
            for k in range(3):
                relative = moved[s, g, k] - moved[s, neighbour, k]
                way = of.nominal[d, side, k] + here.arc_shift[ra, d, side, k] + relative
                scratch.push[g, k] += push * way - sign * forces[s, stop] * of.across[d, k]
                scratch.push[neighbour, k] -= push * way
    return stored - worked, stored + sizes, fault


@inlined
def _wall_energy(wall, force, approach):  # type: ignore[no-untyped-def]
    """Both energies [J] of a drum's contact of compliance `wall`."""
    if not wall > 0.0:
        return 0.0
    return 0.5 * (max(approach, 0.0) ** 2 / wall + wall * max(force, 0.0) ** 2)


@inlined
def _pulls(of, here, claim, s, scratch):  # type: ignore[no-untyped-def]
    """Radial elements: offsets, laws, reactions; returns whether a law has no meaning."""
    rr, rk, rs = _row(here.round_radius, s), _row(here.round_stiffness, s), _row(here.spline, s)
    fault = False
    for q in range(len(of.pull_gear)):
        g = of.pull_gear[q]
        for k in range(3):
            scratch.pull_offset[q, k] = claim.displacement[s, g, k] - of.pull_centre[q, k]
            scratch.push[g, k] += claim.radial_reaction[s, q, k]
        law = scratch.pull_law[q]
        if q < of.rounds:
            law[0], law[1], law[2] = 0.0, 0.0, 0.0
            law[3], law[4] = here.round_radius[rr, q], here.round_stiffness[rk, q]
            continue
        numbers = here.spline[rs, q - of.rounds]
        stiffness, given, reach, bound = numbers[0], numbers[1], numbers[2], numbers[3]
        if np.isnan(bound):
            bound = numbers[4] * abs(scratch.moment[g])
        stick = bound / stiffness
        if np.isnan(given):
            stick = np.inf if reach < stick else stick
        else:
            stick = min(given, stick)
            fault |= stiffness * given > bound * (1.0 + LAWS.written) or reach < stick
        law[0], law[1], law[2], law[3], law[4] = stiffness, stick, bound, reach, stiffness
    return fault


@inlined
def _moves(of, claim, s, scratch):  # type: ignore[no-untyped-def]
    """Displacements in the frames of the gears that can be displaced."""
    for g in range(len(of.radius)):
        if of.is_moving[g]:
            for a in range(2):
                along = 0.0
                for k in range(3):
                    along += of.frame[g, a, k] * claim.displacement[s, g, k]
                scratch.moved[g, a] = along


@inlined
def _moments(of, here, claim, s, scratch):  # type: ignore[no-untyped-def]
    """Add the load and the torques of elastic shafts to the moments of flanks."""
    r = _row(here.torque, s)
    for g in range(len(of.radius)):
        scratch.moment[g] += here.torque[r, g]
    for w in range(len(of.shaft)):
        if of.is_elastic[w]:
            scratch.moment[of.shaft[w, 0]] -= claim.shaft_torque[s, w]
            scratch.moment[of.shaft[w, 1]] += claim.shaft_torque[s, w]


@inlined
def _force_balance(of, claim, s, scratch):  # type: ignore[no-untyped-def]
    worst = 0.0
    for g in range(len(of.radius)):
        if of.is_moving[g]:
            square = 0.0
            for a in range(2):
                balance = -claim.support_force[s, g, a]
                for k in range(3):
                    balance += of.frame[g, a, k] * scratch.push[g, k]
                square += balance * balance
            worst = _worse(worst, square)
    return np.sqrt(worst)


@inlined
def _wind_up(of, here, claim, s, w):  # type: ignore[no-untyped-def]
    """Wind-up [rad] of a shaft."""
    clocking = here.clocking[_row(here.clocking, s), w]
    return claim.rotation[s, of.shaft[w, 0]] - claim.rotation[s, of.shaft[w, 1]] - clocking


@inlined
def _moment_balance(of, scratch):  # type: ignore[no-untyped-def]
    total = scratch.group_moment
    total[:] = 0.0
    for g in range(len(of.radius)):
        total[of.group[g]] += scratch.moment[g]
    worst = 0.0
    for k in range(len(total)):
        worst = _worse(worst, abs(total[k]) / of.group_radius[k])
    return worst


@inlined
def _penetration(scratch):  # type: ignore[no-untyped-def]
    worst = 0.0
    for e in range(len(scratch.overlap)):
        worst = _worse(worst, scratch.overlap[e])
    for c in range(len(scratch.ring_overlap)):
        worst = _worse(worst, scratch.ring_overlap[c])
    for q in range(len(scratch.pull_law)):
        if np.isinf(scratch.pull_law[q, 4]):
            worst = _worse(worst, _size(scratch.pull_offset[q]) - scratch.pull_law[q, 3])
    return worst


@inlined
def _complementarity(claim, s, scratch):  # type: ignore[no-untyped-def]
    worst = 0.0
    for e in range(len(scratch.overlap)):
        worst = max(worst, -claim.flank_force[s, e] * scratch.overlap[e])
    for c in range(len(scratch.ring_overlap)):
        worst = max(worst, -claim.ring_force[s, c] * scratch.ring_overlap[c])
    return worst


@inlined
def _deformation_law(of, here, claim, s, scratch, band):  # type: ignore[no-untyped-def]
    worst = 0.0
    for e in range(len(scratch.overlap)):
        if claim.flank_force[s, e] > band:
            worst = max(worst, abs(scratch.overlap[e]))
    for c in range(len(scratch.ring_overlap)):
        if claim.ring_force[s, c] > band:
            worst = max(worst, abs(scratch.ring_overlap[c]))
    moved, rt, rk = claim.displacement, _row(here.torsion, s), _row(here.support, s)
    for w in range(len(of.shaft)):
        off = _wind_up(of, here, claim, s, w)
        if of.is_elastic[w]:
            off -= claim.shaft_torque[s, w] / here.torsion[rt, w]
        worst = _worse(worst, abs(off) * of.radius[of.shaft[w, 0]])
    square = 0.0
    for g in range(len(of.radius)):
        x, y, z = moved[s, g, 0], moved[s, g, 1], moved[s, g, 2]
        if not of.is_moving[g]:
            square = _worse(square, x * x + y * y + z * z)
            continue
        lag = 0.0
        for a in range(2):
            stiffness = here.support[rk, g, a]
            if stiffness > 0.0:
                off = scratch.moved[g, a] - claim.support_force[s, g, a] / stiffness
                lag += off * off
        lifted = of.axis[g, 0] * x + of.axis[g, 1] * y + of.axis[g, 2] * z
        square = _worse(_worse(square, lag), lifted * lifted)
    worst = _worse(worst, np.sqrt(square))
    return _worse(worst, abs(claim.rotation[s, of.output]) * of.radius[of.output])


@inlined
def _cone_membership(of, here, claim, s, scratch, band):  # type: ignore[no-untyped-def]
    worst = 0.0
    for e in range(len(scratch.overlap)):
        worst = max(worst, -claim.flank_force[s, e])
    for c in range(len(scratch.ring_overlap)):
        worst = max(worst, -claim.ring_force[s, c])
    r = _row(here.support, s)
    square = 0.0
    for g in range(len(of.radius)):
        if of.is_moving[g]:
            free = 0.0
            for a in range(2):
                if not here.support[r, g, a] > 0.0:
                    free += claim.support_force[s, g, a] ** 2
            square = _worse(square, free)
    worst = _worse(worst, np.sqrt(square))
    for d in range(len(of.drum)):
        if of.is_squeezed[d]:
            worst = _worse(worst, _squeeze(of, here, claim, s, scratch, d, band))
    for q in range(len(scratch.pull_law)):
        excess = _excess(
            scratch.pull_law[q], scratch.pull_offset[q], claim.radial_reaction[s, q], band
        )
        worst = _worse(worst, excess)
    return worst


@inlined
def _squeeze(of, here, claim, s, scratch, d, band):  # type: ignore[no-untyped-def]
    """What the squeeze of a drum's opposed arcs leaves open [N] (see `residuals`)."""
    first = 2 * len(of.drum) + 2 * d
    squeeze = min(claim.ring_force[s, first], claim.ring_force[s, first + 1])
    if squeeze <= 0.0:
        return 0.0
    r = _row(here.arc_shift, s)
    start, nominal = here.arc_shift, of.nominal
    one, other, wedge = 0.0, 0.0, 0.0
    for k in range(3):
        one += (nominal[d, 0, k] + start[r, d, 0, k]) ** 2
        other += (nominal[d, 1, k] + start[r, d, 1, k]) ** 2
    for k in range(3):
        unit = (nominal[d, 0, k] + start[r, d, 0, k]) / np.sqrt(one)
        unit += (nominal[d, 1, k] + start[r, d, 1, k]) / np.sqrt(other)
        wedge += unit * unit
    distance = min(of.distance[d, 0], of.distance[d, 1])
    known = band
    if wedge * distance > 8.0 * band:
        overlap = scratch.ring_overlap
        known = max(abs(overlap[first]), abs(overlap[first + 1]))
        known += np.finfo(np.float64).eps * _size(claim.displacement[s, of.drum[d, 0]])
    across = 2.0 * known / distance
    return squeeze * across / (np.sqrt(wedge) + np.sqrt(wedge + across))


@inlined
def _excess(law, offset, reaction, band):  # type: ignore[no-untyped-def]
    """Excess [N] of a radial element's force over what its graph admits."""
    radius = _size(offset)
    low, high = _interval(law, radius, band)
    if radius <= band:
        along, sideways = _size(reaction), 0.0
    else:
        along, sideways = 0.0, 0.0
        for k in range(3):
            along -= reaction[k] * offset[k] / radius
        for k in range(3):
            sideways += (reaction[k] + along * offset[k] / radius) ** 2
        sideways = np.sqrt(sideways) - _size(reaction) * band / radius
    return max(low - along, along - high, sideways)


@inlined
def _energy_gap(of, here, claim, s, scratch, gap, sizes):  # type: ignore[no-untyped-def]
    """The gap of the contacts with what loads, shafts, bearings and radial elements add [J].

    Less what is rounding of the terms.
    """
    rt, rk, rs = _row(here.torque, s), _row(here.torsion, s), _row(here.support, s)
    stored = 0.0
    for g in range(len(of.radius)):
        work = here.torque[rt, g] * claim.rotation[s, g]
        gap -= work
        sizes += abs(work)
        if of.is_moving[g]:
            for a in range(2):
                stiffness = here.support[rs, g, a]
                stored += 0.5 * stiffness * scratch.moved[g, a] ** 2
                if stiffness > 0.0:
                    stored += 0.5 * claim.support_force[s, g, a] ** 2 / stiffness
    for w in range(len(of.shaft)):
        torque = claim.shaft_torque[s, w]
        if of.is_elastic[w]:
            stiffness, wind = here.torsion[rk, w], _wind_up(of, here, claim, s, w)
            stored += 0.5 * stiffness * wind**2 + 0.5 * torque**2 / stiffness
        else:
            torque = 0.0
            for g in range(len(of.radius)):
                torque += of.beyond[w, g] * scratch.moment[g]
        work = torque * here.clocking[_row(here.clocking, s), w]
        gap += work
        sizes += abs(work)
    for q in range(len(scratch.pull_law)):
        reaction = claim.radial_reaction[s, q]
        stored += _energy(scratch.pull_law[q], _size(scratch.pull_offset[q]))
        stored += _complementary(scratch.pull_law[q], _size(reaction))
        work = 0.0
        for k in range(3):
            work += reaction[k] * of.pull_centre[q, k]
        gap -= work
        sizes += abs(work)
    left = abs(gap + stored) - CERTIFY.rounded * (sizes + stored)
    return left if not left < 0.0 else 0.0


@inlined
def _finite(claim, s):  # type: ignore[no-untyped-def]
    """Whether every claimed figure is a number."""
    total = 0.0
    for g in range(claim.rotation.shape[1]):
        total += claim.rotation[s, g]
        for k in range(3):
            total += claim.displacement[s, g, k]
        for a in range(2):
            total += claim.support_force[s, g, a]
    for e in range(claim.flank_force.shape[1]):
        total += claim.flank_force[s, e]
    for c in range(claim.ring_force.shape[1]):
        total += claim.ring_force[s, c]
    for q in range(claim.radial_reaction.shape[1]):
        for k in range(3):
            total += claim.radial_reaction[s, q, k]
    for w in range(claim.shaft_torque.shape[1]):
        total += claim.shaft_torque[s, w]
    return np.isfinite(total)


@inlined
def _size(vector):  # type: ignore[no-untyped-def]
    """Length of a vector (3,)."""
    return np.sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2])


@inlined
def _interval(law, radius, band):  # type: ignore[no-untyped-def]
    """Forces that a graph admits within the band about a radius."""
    first, stick, bound, reach, last = law[0], law[1], law[2], law[3], law[4]
    low, high = np.inf, 0.0
    inner, outer = radius - band, radius + band
    throughout = np.isinf(stick)
    level_end = max(reach, 0.0 if throughout else stick)
    if stick > 0.0 and inner <= stick:
        low, high = first * max(inner, 0.0), first * min(outer, stick)
    if level_end > stick and stick <= outer and inner <= level_end:
        low, high = min(low, bound), max(high, bound)
    if np.isfinite(last) and not throughout and outer >= level_end:
        low = min(low, bound + last * max(inner - level_end, 0.0))
        high = max(high, bound + last * max(outer - level_end, 0.0))
    if radius <= band:
        low = 0.0
    if np.isinf(last) and radius >= reach - band:
        low, high = min(low, bound), np.inf
    return low, high


@inlined
def _energy(law, radius):  # type: ignore[no-untyped-def]
    """Strain energy of a graph at a radius."""
    first, stick, bound, reach, last = law[0], law[1], law[2], law[3], law[4]
    energy = 0.5 * first * min(radius, stick) ** 2
    if np.isinf(stick):
        return energy
    energy += bound * max(min(radius, reach) - stick, 0.0)
    beyond = radius - reach
    if np.isfinite(last) and beyond > 0.0:
        energy += bound * beyond + 0.5 * last * beyond**2
    return energy


@inlined
def _complementary(law, force):  # type: ignore[no-untyped-def]
    """Conjugate energy of a graph at a force."""
    first, stick, bound, reach, last = law[0], law[1], law[2], law[3], law[4]
    if np.isinf(stick):
        return force**2 / (2.0 * first)
    end = first * stick
    energy = min(force, end) ** 2 / (2.0 * first) if first > 0.0 else 0.0
    if force > end:
        energy += (force - end) * stick
    over = force - bound
    if over > 0.0:
        energy += over * (reach - stick)
        if np.isfinite(last):
            energy += over**2 / (2.0 * last)
    return energy
