"""Bounds on the torques of claims, from their own figures and those that their set shares."""

from __future__ import annotations

import numpy as np

from loadshare.by_reference import by_reference, set_apart
from loadshare.certify.bound.acts import CLOSED, ENDLESS, LIGHT
from loadshare.certify.bound.claim import EPS
from loadshare.certify.bound.kernel.laws import flank_law
from loadshare.certify.bound.kernel.options import compiled, within
from loadshare.settings import BOUND

FORCE, WAY, TORQUE, ARC, ARC_WAY, FAINT = range(6)
"""Largest error of a force, movement of an element, error of a torque; force and movement of arcs;
error of a light force."""


@compiled
def bound_all(of, here, claim, found, group, errors):  # type: ignore[no-untyped-def]
    """Write the largest error of a torque [N·m] of every claim; infinite where it is not shown."""
    _bound_all(
        by_reference(of),
        by_reference(here),
        by_reference(claim),
        by_reference(found),
        by_reference(group),
        errors,
    )


@within
def _bound_all(of, here, claim, found, group, errors):  # type: ignore[no-untyped-def]
    set_apart()
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
        if group.ended[g] > 0.0:
            balanced = stray <= max(BOUND.balanced * scale, BOUND.rounded * found.push[s])
            stray = group.ended[g] * (stray + EPS * scale)
            residual += stray
            rest += stray
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
        reach = min(found.reach[s], found.faint[s])
        if not balanced or not found.aside[s] < np.inf or not taken <= reach:
            continue
        # Light elements are off by what they hold as well.
        found.faint[s] -= taken
        by_norm = group.by[g, TORQUE, 0] * residual, group.into[g] * residual
        errors[s] = _proved(of, found, group, g, s, residual, by_norm)
        if not errors[s] <= BOUND.enough * found.largest[s]:
            closely = _passed(of, here, claim, found, group, g, s, rest)
            errors[s] = min(errors[s], _proved(of, found, group, g, s, residual, closely))


@within
def _proved(of, found, group, g, s, residual, carried):  # type: ignore[no-untyped-def]
    """Return the error of a torque [N·m] if all that was assumed holds; else infinity."""
    largest, faint, moved, torque = _answered(of, found, group, g, s, residual, carried)
    # Beyond their reach laws, above all of light Hertz contacts, no longer hold as assumed.
    holds = largest <= found.reach[s] and faint <= found.faint[s]
    if holds and found.room[s] > moved + found.width[s] and torque < np.inf:
        return torque + found.aside[s]
    return np.inf


@within
def _passed(of, here, claim, found, group, g, s, rest):  # type: ignore[no-untyped-def]
    """Return largest torque [N·m] and energy [√J] of the forces that carry the load left over.

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
                _, _, most, _ = flank_law(of, here, s, k, claim.flank_force[s, k], found.scale[s])
                soft = most / BOUND.secant
        energy += soft * group.size[g, k] * force
    return torque, energy


@within
def _answered(of, found, group, g, s, residual, carried):  # type: ignore[no-untyped-def]
    """Return largest errors of a force, of a light one [N] and of a torque, and a movement [m].

    Parameters
    ----------
    residual : float
        Load that is left over [N].
    carried : tuple of float
        Torque [N·m] and energy [√J] of the forces that carry it.
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
        # The load that a slip should carry along its line comes back as load.
        again = residual * (back / (1.0 - back)) if back < BOUND.gain else np.inf
        own, spent, residual = own + by_load * again, spent + into * again, residual + again
    gap, push, tilt = deepest + found.width[s], 0.0, 0.0
    due = bent + spent, into, found.width[s]
    load, energy = _followed(of, found, group, g, s, residual, push, tilt, due)
    proved = True
    if group.bows[g] > 0.0:
        # Errors act along lines that are nominal here; what that leaves out is bounded over a box
        # several times as wide, which must contain the result.
        proved = False
        pushed = _by(group, g, ARC, load, push, energy, gap)
        moved = _by(group, g, ARC_WAY, load, push, energy, gap) + blind
        moved += _pulled_way(found, group, g, s, load, push, energy)
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
    faint = _by(group, g, FAINT, load, push, energy, gap)
    moved = _by(group, g, WAY, load, push, energy, gap + tilt) + blind
    moved += _pulled_way(found, group, g, s, load, push, energy)
    torque = own + _by(group, g, TORQUE, load - residual, push, energy, gap)
    return largest, faint, moved, torque if proved else np.inf


@within
def _by(group, g, what, load, push, energy, gap):  # type: ignore[no-untyped-def]
    """Return a largest figure under load [N], push on arcs [N], energy [√J] and gap [m]."""
    by = group.by[g, what]
    return by[0] * load + by[1] * push + by[2] * energy + by[3] * gap


@within
def _pulled(group, g, q, load, push, energy):  # type: ignore[no-untyped-def]
    """Return the force error of a radial element that takes part in carrying [N]; of others 0."""
    by = group.pull_by[g, q]
    return by[0] * load + by[1] * push + by[2] * energy if by[0] > 0.0 else 0.0


@within
def _pulled_way(found, group, g, s, load, push, energy):  # type: ignore[no-untyped-def]
    """Return the movement of an element as radial elements that take part in carrying yield [m]."""
    moved = 0.0
    if group.carries[g]:
        for q in range(found.soft.shape[1]):
            off = _pulled(group, g, q, load, push, energy)
            moved += 2.0 * group.pull_by[g, q, 3] * found.soft[s, q] * off
    return moved


@within
def _carried(of, found, group, g, s):  # type: ignore[no-untyped-def]
    """Return what is added where radial elements carry a load.

    Energy per load; the part of a load that comes back, because a slip carries none along its line;
    and the movement [m] that the force of a slip does not determine.
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


@within
def _followed(of, found, group, g, s, residual, push, tilt, due):  # type: ignore[no-untyped-def]
    """Return load left over and energy, with what friction that follows the torque adds."""
    spent, into, width = due
    energy = spent + group.into_by_push[g] * push
    energy += group.spread[g] * width + group.spread_of_arcs[g] * tilt
    most, back, rates = 0.0, 0.0, 0.0
    for k in range(len(of.moment)):
        rates += found.rate[s, of.rounds + k]
    if rates == 0.0:
        return residual, energy
    for k in range(len(of.moment)):
        if found.rate[s, of.rounds + k] == 0.0:
            continue
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
