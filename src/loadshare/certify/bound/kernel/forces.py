"""Forces and misfits of elements, and the load that they leave over."""

from __future__ import annotations

import numpy as np

from loadshare.certify.bound.claim import EPS
from loadshare.certify.bound.kernel.laws import (
    contact_force,
    flank_law,
    law_of,
    nearest,
    rate_of,
    row_of,
    sticks,
    stiffest,
)
from loadshare.certify.bound.kernel.options import inlined
from loadshare.certify.bound.laws import CLOSED, ENDLESS, OPEN
from loadshare.settings import BOUND, CERTIFY


@inlined
def put_contacts(of, here, claim, s, work, v, found, sets, resolution):  # type: ignore[no-untyped-def]
    """Forces and misfits of contacts.

    Returns their largest compression [m], that of loaded flanks or what remains of their approach
    at rest [m], and what is seen of residuals: length [m], work [J], pull [N] and sum of forces.
    """
    flanks, contacts, number = len(of.arm), len(of.twin), found.number[s]
    arcs, rw, band = contacts - len(of.apart), row_of(here.wall, s), CERTIFY.band * found.scale[s]
    yielded, bent, weakest, reach, turned, bow = 0.0, 0.0, np.inf, np.inf, 0.0, 0.0
    length, energy, pull, total = 0.0, 0.0, 0.0, 0.0
    for c in range(contacts):
        acts = found.acts[s, c] != OPEN
        claimed = contact_force(of, claim, s, c)
        force = claimed if acts else 0.0
        pull, total, misfit = max(pull, -claimed), total + claimed, 0.0
        if c < flanks:
            work.force[c, v] = force
            if claimed > band:
                bent = max(bent, abs(work.at_rest[c, v]))
        elif c < arcs:
            work.force[of.first_stop + c - flanks, v] = force
        else:
            k = c - arcs
            for a in range(2):
                work.force[of.first_arc + 2 * k + a, v] = -force * work.line[k, a]
        if acts:
            if c < flanks:
                law = flank_law(of, here, s, c, force, found.scale[s])
                compression, least, most, holds = law
                reach, bent = min(reach, holds), max(bent, compression)
            else:
                least = most = here.wall[rw, of.drum[c - flanks]]
                compression = least * force
                if c >= arcs:
                    turned = max(turned, work.turn[c - arcs])
                    bow = max(bow, abs(force) / of.apart[c - arcs])
            # What opens may move by any length; of two that touch, one takes what the other cannot.
            if of.twin[c] < 0 or work.gap[of.twin[c]] < np.inf:
                reach = min(reach, force if found.acts[s, c] == CLOSED else np.inf)
            # What yields without end carries no load.
            spread(sets, number, c, least, least if found.acts[s, c] == ENDLESS else most)
            weakest, yielded = min(weakest, force), max(yielded, abs(compression))
            misfit = -work.gap[c] - compression
            # With less force than the band it counts as open, as in `residuals`.
            length = max(length, abs(misfit) if force > band else misfit)
            energy, total = max(energy, -force * misfit - abs(force) * resolution), total + misfit
            if force == 0.0:
                misfit = max(misfit, 0.0)
        elif work.gap[c] < np.inf:
            length = max(length, -work.gap[c])
            energy = max(energy, claimed * work.gap[c] - abs(claimed) * resolution)
        elif claimed != 0.0:
            # Two opposed contacts carry.
            total = np.nan
        found.misfit[s, c] = misfit
    found.turned[s], found.bow[s], found.reach[s] = turned, bow, reach
    # A contact that pulls is none.
    return yielded if weakest >= 0.0 else np.inf, bent, (length, energy, pull, total)


@inlined
def put_springs(of, here, claim, s, work, v, found, sets):  # type: ignore[no-untyped-def]
    """Forces and misfits of elastic shafts and bearings; returns their largest deflection [m]."""
    yielded, first = 0.0, len(of.twin)
    for k in range(len(of.spring)):
        j, number, axis = of.spring[k, 0], of.spring[k, 1], of.spring[k, 2]
        if axis == 2:
            soft = of.spring_arm[k] ** 2 / here.torsion[row_of(here.torsion, s), number]
            force = claim.shaft_torque[s, number] / of.spring_arm[k]
        else:
            soft = 1.0 / here.support[row_of(here.support, s), number, axis]
            force = claim.support_force[s, number, axis]
        spread(sets, found.number[s], first + k, soft, soft)
        work.force[j, v] = force
        found.misfit[s, first + k] = work.length[j, v] - soft * force
        yielded = max(yielded, abs(soft * force))
    return yielded


@inlined
def put_pulls(of, here, claim, s, work, v, found, top, widest):  # type: ignore[no-untyped-def]
    """Forces and misfits of radial elements: the point of their graph next to what is claimed.

    Returns the largest of their lengths [m], whether their laws have a meaning, and whether they
    are covered by the bound.
    """
    contacts, at = len(of.twin), len(of.twin) + len(of.spring)
    longest, lawful, covered = 0.0, True, True
    for q in range(len(of.pull_gear)):
        g, j, rate = of.pull_gear[q], of.first_pull + 2 * q, 0.0
        x, y = work.length[j, v] - of.centre[q, 0], work.length[j + 1, v] - of.centre[q, 1]
        fx, fy, lifting = 0.0, 0.0, 0.0
        for i in range(3):
            fx -= of.frame[g, 0, i] * claim.radial_reaction[s, q, i]
            fy -= of.frame[g, 1, i] * claim.radial_reaction[s, q, i]
            lifting += of.axis[g, i] * claim.radial_reaction[s, q, i]
        claimed_x, claimed_y, away_x, away_y = fx, fy, x, y
        distance, force = np.sqrt(x * x + y * y), np.sqrt(fx * fx + fy * fy)
        law = law_of(of, here, claim, s, q, distance)
        stick, level, reach = law[1], law[2], law[3]
        lawful &= force < np.inf and distance < np.inf
        lawful &= stick >= 0.0 and level >= 0.0 and reach >= 0.0
        noise = BOUND.noise * top
        acts = level > 0.0 or force > noise or reach - distance <= BOUND.near * widest
        found.acts[s, contacts + q] = CLOSED if acts else OPEN
        soft, spare, misfit_x, misfit_y, slips, near = 0.0, np.inf, 0.0, 0.0, 0.0, 0.0
        if acts:
            near, along, soft, spare = nearest(law, force, distance, BOUND.corner)
            if near <= 0.0 or distance == 0.0:
                # On the first piece, or pinned: a spring about the centre.
                misfit_x, misfit_y = x - fx * soft, y - fy * soft
                longest = max(longest, distance + force * soft)
            else:
                misfit_x, misfit_y = x - near / distance * x, y - near / distance * y
                fx, fy = along * x / distance, along * y / distance
                longest = max(longest, distance + near)
                slips = 1.0 / distance if along == level else 0.0
            covered &= q >= of.rounds or here.round_power[0, q] == 1.0
            if q >= of.rounds:
                rate = rate_of(of, here, s, q)
                covered &= rate == 0.0 or found.aside[s] == 0.0
        else:
            fx, fy = 0.0, 0.0
            found.room[s] = min(found.room[s], reach - distance)
        longest = max(longest, abs(of.centre[q, 0]) + abs(of.centre[q, 1]) + distance)
        work.force[j, v], work.force[j + 1, v] = fx, fy
        work.excess[2 * q, v], work.excess[2 * q + 1, v] = claimed_x - fx, claimed_y - fy
        for k in range(len(law)):
            work.law[q, k] = law[k]
        work.offset[q, 0], work.offset[q, 1] = away_x, away_y
        work.pull[q, 0], work.pull[q, 1], work.pull[q, 2] = claimed_x, claimed_y, lifting
        work.stiffest[q] = stiffest(law)
        found.misfit[s, at + 2 * q], found.misfit[s, at + 2 * q + 1] = misfit_x, misfit_y
        found.held[s, q] = np.inf
        if rate > 0.0 and near <= 0.0 and sticks(law, force):
            # So it does until the torque is half of what it is.
            found.held[s, q], rate = 0.5 * level / rate, 0.0
        found.soft[s, q], found.spare[s, q], found.rate[s, q] = soft, spare, rate
        found.slip[s, q, 0], found.slip[s, q, 1] = slips * x, slips * y
    return longest, lawful, covered


@inlined
def spread(sets, number, at, least, most):  # type: ignore[no-untyped-def]
    """Let the compliances of a set hold some more [m/N]."""
    if number >= 0:
        sets.least[number, at] = min(sets.least[number, at], least)
        sets.most[number, at] = max(sets.most[number, at], most)


@inlined
def put_pushes(of, work, width):  # type: ignore[no-untyped-def]
    """What forces carry of the load at every coordinate [N], and the sizes of its terms."""
    left, sizes, force = work.left, work.sizes, work.force
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
def put_balance(of, here, s, work, v, found):  # type: ignore[no-untyped-def]
    """Load that is left over [N]: the largest, with its rounding; and over the load of the case."""
    left, sizes, largest, r = work.left, work.sizes, 0.0, row_of(here.torque, s)
    for k in range(len(of.load)):
        due, c = here.torque[r, of.load[k, 1]] / of.load_radius[k], of.load[k, 0]
        left[c, v] += due
        sizes[c, v] += abs(due)
    for j in range(len(work.force)):
        largest = max(largest, abs(work.force[j, v]))
    residual, rounding, total = 0.0, 0.0, 0.0
    for c in range(len(left)):
        found.left[s, c] = left[c, v]
        most = abs(left[c, v]) + EPS * sizes[c, v]
        residual, total = max(residual, most), total + most
        rounding = max(rounding, EPS * sizes[c, v])
    found.push[s], found.rounding[s] = largest, rounding + EPS * residual
    for j in range(2 * len(of.pull_gear)):
        # What is claimed leaves it over, not the point of the graph next to it.
        left[of.at[of.start[of.first_pull + j]], v] -= work.excess[j, v]
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
