"""Forces and misfits of elements, and the load that they leave over."""

from __future__ import annotations

import numpy as np

from loadshare.by_reference import set_apart
from loadshare.certify.bound.acts import CLOSED, ENDLESS, OPEN
from loadshare.certify.bound.claim import EPS
from loadshare.certify.bound.kernel.laws import (
    law_of,
    nearest,
    put_laws,
    rate_of,
    rolling_at,
    sticks,
    stiffest,
)
from loadshare.certify.bound.kernel.options import inlined, within
from loadshare.certify.bound.kernel.rows import (
    fill,
    put_column,
    put_largest,
    put_most,
    put_multiple,
    put_rows,
    put_sizes,
    put_sum,
    row_of,
)
from loadshare.extremes import larger, smaller
from loadshare.settings import BOUND


@within
def put_contacts(of, here, claim, first, width, work, found, sets, new):  # type: ignore[no-untyped-def]
    """Write forces and misfits of contacts.

    Also writes their largest compression [m], infinite where one pulls; that of loaded flanks, or
    what remains of their approach at rest [m]; and their part in residuals: length [m], work [J],
    pull [N], and a sum that keeps every NaN.
    """
    set_apart()
    for row in (work.yielded, work.bent, work.misfit, work.energy, work.pulled, work.total):
        fill(row, 0.0)
    fill(work.weakest, np.inf)
    fill(work.turned_lines, 0.0)
    fill(work.bow, 0.0)
    for c in range(len(of.twin)):
        claimed, acts, push, carried = work.claimed[c], work.acts[c], work.push, 0.0
        for v in range(BOUND.side_by_side):
            push[v] = claimed[v] if acts[v] != OPEN else 0.0
        for v in range(BOUND.side_by_side):
            carried += acts[v] + abs(claimed[v])
        _put_columns(of, work, c)
        if carried == 0.0:
            # It acts in none of the claims.
            fill(work.apart[c], 0.0)
            continue
        if c < len(of.arm):
            alike = put_laws(of, here, claim, c, first, width, work)
            _put_bent(work, c)
        else:
            alike = _put_wall(of, here, c, first, width, work)
        _put_reach(of, work, c, work.reach, work.faint)
        _put_seen(work, c)
        _spread_contact(work, c, first, width, found, sets, new, alike)
    for v in range(BOUND.side_by_side):
        # A contact cannot pull: nothing is bounded then.
        work.yielded[v] = work.yielded[v] if work.weakest[v] >= 0.0 else np.inf


@inlined
def _put_columns(of, work, c):  # type: ignore[no-untyped-def]
    """Write the force of a contact to its column, of an arc to its two."""
    flanks, push = len(of.arm), work.push
    k = c - len(of.twin) + len(of.apart)
    if k < 0:
        force = work.force[c if c < flanks else of.first_stop + c - flanks]
        put_multiple(force, push, 1.0)
        return
    for a in range(2):
        force, line = work.force[of.first_arc + 2 * k + a], work.line[k, a]
        for v in range(BOUND.side_by_side):
            force[v] = -push[v] * line[v]


@inlined
def _put_bent(work, c):  # type: ignore[no-untyped-def]
    """Include the deflection of a flank, loaded or at rest."""
    bent, acts, compression = work.bent, work.acts[c], work.law[0]
    claimed, at_rest = work.claimed[c], work.at_rest[c]
    for v in range(BOUND.side_by_side):
        bent[v] = larger(bent[v], compression[v] if acts[v] != OPEN else 0.0)
    for v in range(BOUND.side_by_side):
        bent[v] = larger(bent[v], abs(at_rest[v]) if claimed[v] > work.band[v] else 0.0)


@inlined
def _put_wall(of, here, c, first, width, work):  # type: ignore[no-untyped-def]
    """Write the law of a stop or an arc; return whether compliances are the same for all claims."""
    k, push = c - len(of.twin) + len(of.apart), work.push
    compression, least, most, holds = work.law
    put_column(here.wall[:, of.drum[c - len(of.arm)]], first, width, least)
    for v in range(BOUND.side_by_side):
        compression[v] = least[v] * push[v]
    for v in range(BOUND.side_by_side):
        most[v], holds[v] = least[v], np.inf
    if k >= 0:
        for v in range(BOUND.side_by_side):
            turned = work.turn[k, v] if work.acts[c, v] != OPEN else 0.0
            work.turned_lines[v] = larger(work.turned_lines[v], turned)
        put_largest(work.bow, push, 1.0 / of.apart[k])
    return len(here.wall) == 1


@inlined
def _put_reach(of, work, c, reach, faint):  # type: ignore[no-untyped-def]
    """Include the force error up to which a contact stays as it is, its compression, any pull."""
    acts, push, compression, holds = work.acts[c], work.push, work.law[0], work.law[3]
    yielded, weakest = work.yielded, work.weakest
    for v in range(BOUND.side_by_side):
        reach[v] = smaller(reach[v], holds[v] if acts[v] == CLOSED else np.inf)
    for v in range(BOUND.side_by_side):
        faint[v] = smaller(faint[v], holds[v] if acts[v] > CLOSED else np.inf)
    # A contact that opens may move by any length; of two that touch, one takes what the other
    # cannot.
    if of.twin[c] < 0:
        for v in range(BOUND.side_by_side):
            reach[v] = smaller(reach[v], push[v] if acts[v] == CLOSED else np.inf)
    else:
        other = work.gap[of.twin[c]]
        for v in range(BOUND.side_by_side):
            alone = (acts[v] == CLOSED) & (other[v] < np.inf)
            reach[v] = smaller(reach[v], push[v] if alone else np.inf)
    for v in range(BOUND.side_by_side):
        yielded[v] = larger(yielded[v], abs(compression[v]) if acts[v] != OPEN else 0.0)
    for v in range(BOUND.side_by_side):
        weakest[v] = smaller(weakest[v], push[v])


@inlined
def _put_seen(work, c):  # type: ignore[no-untyped-def]
    """Write the misfit of a contact [m], and include its part in residuals."""
    claimed, acts, gap, compression = work.claimed[c], work.acts[c], work.gap[c], work.law[0]
    apart, longest, energy, total = work.apart[c], work.misfit, work.energy, work.total
    for v in range(BOUND.side_by_side):
        apart[v] = -gap[v] - (compression[v] if acts[v] != OPEN else 0.0)
    # With less force than the band it counts as open, as in `residuals`.
    for v in range(BOUND.side_by_side):
        carries = (acts[v] != OPEN) & (claimed[v] > work.band[v])
        longest[v] = larger(longest[v], abs(apart[v]) if carries else apart[v])
    for v in range(BOUND.side_by_side):
        spent = -claimed[v] * apart[v] - abs(claimed[v]) * work.resolution[v]
        energy[v] = larger(energy[v], spent)
    put_most(work.pulled, claimed, -1.0)
    for v in range(BOUND.side_by_side):
        # Idle beside an opposed contact; claims in which both carry are left to NumPy.
        seen = apart[v] if apart[v] > -np.inf or claimed[v] != 0.0 else 0.0
        total[v] += claimed[v] + (0.0 * seen)
    for v in range(BOUND.side_by_side):
        misfit = apart[v] if acts[v] != OPEN else 0.0
        work.given[v] = larger(misfit, 0.0) if claimed[v] == 0.0 else misfit
    put_multiple(apart, work.given, 1.0)


@inlined
def _spread_contact(work, c, first, width, found, sets, new, alike):  # type: ignore[no-untyped-def]
    """Extend the compliance ranges of sets by those of a contact that acts in them."""
    _, least, most, _ = work.law
    if alike:
        for number in range(*new):
            spread(sets, number, c, least[0], least[0])
        return
    for v in range(width):
        acts = work.acts[c, v]
        if acts != OPEN:
            # A contact that yields without limit carries no load.
            upper = least[v] if acts == ENDLESS else most[v]
            spread(sets, found.number[first + v], c, least[v], upper)


@within
def put_springs(of, here, claim, first, width, work, found, sets, new):  # type: ignore[no-untyped-def]
    """Write forces and misfits of elastic shafts and bearings; update the largest deflection."""
    set_apart()
    soft, contacts = work.given, len(of.twin)
    put_rows(claim.shaft_torque, first, width, work.wound)
    put_rows(claim.support_force, first, width, work.borne)
    for k in range(len(of.spring)):
        j, number, axis = of.spring[k, 0], of.spring[k, 1], of.spring[k, 2]
        force, length, arm = work.force[j], work.length[j], of.spring_arm[k]
        apart = work.apart[contacts + k]
        if axis == 2:
            put_column(here.torsion[:, number], first, width, soft)
            alike, claimed = len(here.torsion) == 1, work.wound[number]
        else:
            put_column(here.support[:, number, axis], first, width, soft)
            alike, claimed = len(here.support) == 1, work.borne[2 * number + axis]
        for v in range(BOUND.side_by_side):
            force[v] = claimed[v] / arm
        for v in range(BOUND.side_by_side):
            soft[v] = arm * arm / soft[v]
        for v in range(BOUND.side_by_side):
            work.yielded[v] = larger(work.yielded[v], abs(soft[v] * force[v]))
        for v in range(BOUND.side_by_side):
            apart[v] = length[v] - soft[v] * force[v]
        put_largest(work.misfit, apart, 1.0)
        put_sum(work.total, apart, 1.0)
        if alike:
            for new_set in range(*new):
                spread(sets, new_set, contacts + k, soft[0], soft[0])
        else:
            for v in range(width):
                spread(sets, found.number[first + v], contacts + k, soft[v], soft[v])


@within
def put_pulls(of, here, claim, s, work, v, found):  # type: ignore[no-untyped-def]
    """Write forces and misfits of radial elements, at the point of the graph next to the claim.

    Also writes the largest of their lengths [m], whether their laws have a meaning (1 or 0), and
    whether the bound covers them as well.
    """
    set_apart()
    contacts, at = len(of.twin), len(of.twin) + len(of.spring)
    longest, lawful, covered = 0.0, True, True
    for q in range(len(of.pull_gear)):
        g, j, rate = of.pull_gear[q], of.first_pull + 2 * q, 0.0
        fx, fy, lifting = 0.0, 0.0, 0.0
        off_x, off_y = _centre(of, here, s, q, g)
        x, y = work.length[j, v] - off_x, work.length[j + 1, v] - off_y
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
        noise, next_to = BOUND.noise * work.top[v], BOUND.near * work.widest[v]
        acts = level > 0.0 or force > noise or reach - distance <= next_to
        # A light element carries no load.
        endless = max(force, level) < work.light[v]
        found.acts[s, contacts + q] = (ENDLESS if endless else CLOSED) if acts else OPEN
        soft, spare, misfit_x, misfit_y, slips, near = 0.0, np.inf, 0.0, 0.0, 0.0, 0.0
        least = stiffest(law)
        if acts:
            near, along, soft, spare = nearest(law, force, distance, endless)
            if q < of.rounds and here.round_power[0, q] != 1.0:
                near, soft, least = rolling_at(here, s, q, force, work.light[v])
                near = near if force > 0.0 else min(near, distance)
                # For either component of the force.
                holds = np.sqrt(0.5) * BOUND.bent * max(force, work.light[v])
                if endless:
                    work.faint[v], spare = min(work.faint[v], holds), 0.0
                else:
                    work.reach[v] = min(work.reach[v], holds)
                covered &= distance > 0.0 or force == 0.0
            if near <= 0.0 or distance == 0.0:
                # On the first piece, or pinned: a spring about the centre.
                soft = soft if near < 0.0 or force > 0.0 else 0.0
                misfit_x, misfit_y = x - fx * soft, y - fy * soft
                longest = max(longest, distance + force * soft)
            else:
                misfit_x, misfit_y = x - near / distance * x, y - near / distance * y
                fx, fy = along * x / distance, along * y / distance
                longest = max(longest, distance + near)
                slips = 1.0 / distance if along == level else 0.0
            if q >= of.rounds:
                rate = rate_of(of, here, s, q)
                covered &= rate == 0.0 or work.aside[v] == 0.0
        else:
            fx, fy = 0.0, 0.0
            work.room[v] = min(work.room[v], reach - distance)
        longest = max(longest, abs(off_x) + abs(off_y) + distance)
        work.force[j, v], work.force[j + 1, v] = fx, fy
        work.excess[2 * q, v], work.excess[2 * q + 1, v] = claimed_x - fx, claimed_y - fy
        for k in range(len(law)):
            work.graph[q, k, v] = law[k]
        work.offset[q, 0, v], work.offset[q, 1, v] = away_x, away_y
        work.pull[q, 0, v], work.pull[q, 1, v], work.pull[q, 2, v] = claimed_x, claimed_y, lifting
        work.stiffest[q, v] = least
        work.apart[at + 2 * q, v], work.apart[at + 2 * q + 1, v] = misfit_x, misfit_y
        found.held[s, q] = np.inf
        if rate > 0.0 and near <= 0.0 and not endless and sticks(law, force):
            # It sticks until the torque has fallen to half.
            found.held[s, q], rate = 0.5 * level / rate, 0.0
        found.soft[s, q] = soft if soft < np.inf else 0.0
        found.spare[s, q], found.rate[s, q] = spare, rate
        found.slip[s, q, 0], found.slip[s, q, 1] = slips * x, slips * y
    work.longest[v], work.lawful[v] = longest, 1.0 if lawful else 0.0
    work.covered[v] = 1.0 if lawful and covered else 0.0


@inlined
def _centre(of, here, s, q, g):  # type: ignore[no-untyped-def]
    """Return the centre of a radial element in the plane of its gear [m]."""
    x, y = 0.0, 0.0
    if q < of.rounds:
        r = row_of(here.round_offset, s)
        for i in range(3):
            x += of.frame[g, 0, i] * here.round_offset[r, q, i]
            y += of.frame[g, 1, i] * here.round_offset[r, q, i]
    return x, y


@inlined
def spread(sets, number, at, least, most):  # type: ignore[no-untyped-def]
    """Extend the range of a compliance of a set [m/N]."""
    if number >= 0:
        sets.least[number, at] = min(sets.least[number, at], least)
        sets.most[number, at] = max(sets.most[number, at], most)


@within
def put_pushes(left, sizes, force, start, at, value):  # type: ignore[no-untyped-def]
    """Write −Aᵀ F at every coordinate [N], and the sum of the sizes of its terms."""
    set_apart()
    left[:], sizes[:] = 0.0, 0.0
    for j in range(len(force)):
        row = force[j]
        for i in range(start[j], start[j + 1]):
            factor, over, size = value[i], left[at[i]], sizes[at[i]]
            for v in range(BOUND.side_by_side):
                term = factor * row[v]
                over[v] -= term
                size[v] += abs(term)


@within
def put_balance(of, here, first, width, work):  # type: ignore[no-untyped-def]
    """Write the load left over [N], the largest with its rounding; include it in `worst`."""
    set_apart()
    left, sizes = work.left, work.sizes
    largest, residual, rounding, total = work.largest_push, work.residual, work.rounding, work.total
    for k in range(len(of.load)):
        c = of.load[k, 0]
        due = work.torque[of.load[k, 1]]
        # A quotient is rounded once, a multiple by the inverse twice.
        for v in range(BOUND.side_by_side):
            work.given[v] = due[v] / of.load_radius[k]
        put_sum(left[c], work.given, 1.0)
        put_sizes(sizes[c], work.given, 1.0)
    for k in range(len(of.push_start) - 1):
        put_column(here.push[:, k], first, width, work.given)
        for i in range(of.push_start[k], of.push_start[k + 1]):
            put_sum(left[of.push_at[i]], work.given, of.push_value[i])
            put_sizes(sizes[of.push_at[i]], work.given, of.push_value[i])
    fill(largest, 0.0)
    fill(rounding, 0.0)
    fill(residual, 0.0)
    fill(total, 0.0)
    for j in range(len(work.force)):
        put_largest(largest, work.force[j], 1.0)
    for c in range(len(left)):
        for v in range(BOUND.side_by_side):
            most = abs(left[c, v]) + EPS * sizes[c, v]
            residual[v] = larger(residual[v], most)
            total[v] += most
        put_most(rounding, sizes[c], EPS)
    put_sum(rounding, residual, EPS)
    for c in range(len(left)):
        put_multiple(work.left_over[c], left[c], 1.0)
    for j in range(2 * len(of.pull_gear)):
        # The residual is that of the claim, not of the point of the graph next to it.
        c = of.at[of.start[of.first_pull + j]]
        put_sum(left[c], work.excess[j], -1.0)
    unbalanced = work.given
    fill(unbalanced, 0.0)
    for c in range(len(left)):
        put_largest(unbalanced, left[c], 1.0)
        put_sizes(total, left[c], 1.0)
    for v in range(BOUND.side_by_side):
        # The largest may have passed over a NaN.
        known = total[v] < np.inf
        residual[v] = residual[v] if known and work.covered[v] > 0.0 else np.inf
        worst, over = work.worst[v], unbalanced[v] / work.scale[v]
        worst = over if worst < over else worst
        work.worst[v] = worst if known or worst == np.inf else np.nan
