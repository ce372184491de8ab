"""Splines and round rings whose direction turns: laws, tangents, and the tangents' misfit."""

from __future__ import annotations

import numpy as np

from loadshare.settings import HOT, LAWS, SIDE_BY_SIDE
from loadshare.solver.hot.contact_states import CORNER, SLIP, STOP, WALL
from loadshare.solver.hot.kernel import work as at
from loadshare.solver.hot.kernel.options import bare


@bare
def graph(s, i, j, torque, radius):  # type: ignore[no-untyped-def]
    """Return five numbers of a radial law, and whether it is valid; see `contact_states.graph`."""
    here = i if s.radial.shape[0] > 1 else 0
    first, given, reach = s.radial[here, j, 0], s.radial[here, j, 1], s.radial[here, j, 2]
    bound = s.radial[here, j, 3]
    if np.isnan(bound):
        bound = s.radial[here, j, 4] * abs(torque)
    continuous = bound / first if first > 0.0 else 0.0
    valid = True
    if np.isnan(given):
        stick = continuous if reach >= continuous else np.inf
    else:
        stick = min(given, continuous)
        valid = first * given <= bound * (1.0 + LAWS.written) and reach >= stick
    last, power = s.radial[here, j, 5], s.radial[here, j, 6]
    if power != 1.0:
        gap = max(radius - reach, (s.radial[here, j, 7] / last) ** (1.0 / power))
        reach += gap * (1.0 - 1.0 / power)
        last *= power * gap ** (power - 1.0)
    return first, stick, bound, reach, last, valid


@bare
def torque_of(follows, carried, force, width, torque):  # type: ignore[no-untyped-def]
    """Write the torque (width,) over force unit of a radial element, if friction follows it."""
    for m in range(width):
        torque[m] = 0.0
    if follows:
        for e in range(carried.shape[0]):
            arm = carried[e]
            if arm != 0.0:
                for m in range(width):
                    torque[m] += arm * force[e, m]


@bare
def renew_bound(s, work, t, width):  # type: ignore[no-untyped-def]
    """Renew the law of a turning radial element at its radius, with the friction of the forces."""
    j = s.turning_radials[t]
    torque_of(s.follows[j], s.carried[j], work.force, width, work.one)
    for m in range(width):
        u, v = work.radial[t, at.U, m], work.radial[t, at.V, m]
        radius = np.sqrt(u * u + v * v)
        _, stick, bound, reach, last, _ = graph(s, work.samples[m], j, work.one[m], radius)
        work.radial[t, at.FIRST_END, m], work.radial[t, at.BOUND, m] = stick, bound
        work.radial[t, at.REACH, m], work.radial[t, at.LAST, m] = reach, last


@bare
def turn_radials(s, work, width):  # type: ignore[no-untyped-def]
    """Renew directions and tangents of the radial elements; see `hot.radials.tangent`."""
    one, two = work.one, work.two
    for t in range(s.turning_radials.shape[0]):
        status = s.states[s.first_radial - s.first_column + s.turning_radials[t]]
        law = work.radial[t]
        p, q = work.force[2 * t], work.force[2 * t + 1]
        by_force = status in (CORNER, WALL)
        # If it yields by less than the play before it, a turn of the offset looks like a force.
        wall = status == STOP and s.radial[0, s.turning_radials[t], 0] == 0.0
        for m in range(width):
            a, b = (p[m], q[m]) if by_force else (law[at.U, m], law[at.V, m])
            other_a, other_b = (law[at.U, m], law[at.V, m]) if by_force else (p[m], q[m])
            square = a * a + b * b
            one[m] = np.sqrt(square)
            if wall:
                pull = np.sqrt(other_a * other_a + other_b * other_b)
                if 0.0 < pull < law[at.LAST, m] * law[at.REACH, m]:
                    a, b, square = other_a, other_b, pull * pull
                    # The negative sign marks this as a force.
                    one[m] = -pull
            a, b = (a, b) if square > 0.0 else (other_a, other_b)
            square = a * a + b * b
            inverse = 1.0 / np.sqrt(square) if square > 0.0 else 0.0
            a = a * inverse if square > 0.0 else 1.0
            law[at.DU, m] = a if work.go[m] > 0.0 else law[at.DU, m]
            law[at.DV, m] = b * inverse if work.go[m] > 0.0 else law[at.DV, m]
            two[m] = work.push[m] if work.push[m] > 1e-300 else 1e-300
        for m in range(width):
            size, push, reach, bound = one[m], two[m], law[at.REACH, m], law[at.BOUND, m]
            if by_force:
                begin = law[at.FIRST_END, m] if status == CORNER else reach
                # A wall that does not carry yet holds its float along its direction alone.
                unknown = HOT.softest if status == WALL else begin / push
                inner, outer = 0.0, begin / size if size > 0.0 else unknown
            elif status == SLIP:
                begin = 0.0
                outer = max(size, law[at.FIRST_END, m])
                outer = min(outer, reach) / max(bound, HOT.faint * push)
                inner = min(outer, SIDE_BY_SIDE.yields)
            else:
                inner, reached = 1.0 / law[at.LAST, m], max(size, reach)
                begin = reach - bound * inner
                pull = bound + law[at.LAST, m] * (reached - reach)
                if size < 0.0:
                    pull, reached = -size, reach - size * inner
                outer = reached / pull if pull > 0.0 else inner
            outer = min(outer, HOT.softest)
            going = work.go[m] > 0.0
            law[at.INNER, m] = inner if going else law[at.INNER, m]
            law[at.OUTER, m] = outer if going else law[at.OUTER, m]
            law[at.BEGIN, m] = begin if going else law[at.BEGIN, m]
            work.tangent[2 * t, m] = work.tangent[2 * t + 1, m] = law[at.OUTER, m]
        for c in range(s.redundant.shape[1]):
            here, there = s.redundant[2 * t, c], s.redundant[2 * t + 1, c]
            along = work.along[t, c]
            for m in range(width):
                along[m] = law[at.DU, m] * here + law[at.DV, m] * there


@bare
def lengthen(radial, force, stretch, width):  # type: ignore[no-untyped-def]
    """Add the part along their direction to the stretch of turning radial elements."""
    for t in range(radial.shape[0]):
        law = radial[t]
        p, q = force[2 * t], force[2 * t + 1]
        for m in range(width):
            du, dv = law[at.DU, m], law[at.DV, m]
            size = law[at.BEGIN, m] + law[at.EXTRA, m]
            size += (law[at.INNER, m] - law[at.OUTER, m]) * (du * p[m] + dv * q[m])
            stretch[2 * t, m] += size * du
            stretch[2 * t + 1, m] += size * dv


@bare
def follow_radials(s, work, misfit, width):  # type: ignore[no-untyped-def]
    """Renew offsets and friction from the forces; include the tangents' misfit.

    As with power laws, the misfit of a tangent is of second order.
    """
    for t in range(s.turning_radials.shape[0]):
        j = s.turning_radials[t]
        status = s.states[s.first_radial - s.first_column + j]
        law = work.radial[t]
        p, q = work.force[2 * t], work.force[2 * t + 1]
        for m in range(width):
            law[at.U, m] = work.stretch[2 * t, m] - work.gap[2 * t, m]
            law[at.V, m] = work.stretch[2 * t + 1, m] - work.gap[2 * t + 1, m]
        if s.follows[j] or s.radial[0, j, 6] != 1.0:
            renew_bound(s, work, t, width)
        for m in range(width):
            u, v = law[at.U, m], law[at.V, m]
            radius, size = np.sqrt(u * u + v * v), np.sqrt(p[m] * p[m] + q[m] * q[m])
            scale = work.largest[m] if work.largest[m] > radius else radius
            scale = scale if scale > 0.0 else 1.0
            strongest = work.strongest[m] if work.strongest[m] > 0.0 else 1.0
            product, across = u * p[m] + v * q[m], abs(u * q[m] - v * p[m])
            over_radius = 1.0 / radius if radius > 0.0 else 0.0
            over_size = 1.0 / size if size > 0.0 else 0.0
            bound = law[at.BOUND, m]
            if status == SLIP:
                gone = abs(product * over_radius - bound) / strongest
                more = across / (bound if bound > HOT.faint * strongest else strongest) / scale
                left = radius > HOT.beyond * law[at.REACH, m] or bound <= HOT.sign * work.push[m]
                law[at.BEYONDS, m] = law[at.BEYONDS, m] + 1.0 if left else 0.0
            elif status == STOP:
                gone = law[at.REACH, m] + (product * over_radius - bound) / law[at.LAST, m] - radius
                gone = abs(gone) / scale
                more = across * over_radius * law[at.OUTER, m] / scale
            else:
                limit = law[at.FIRST_END, m] if status == CORNER else law[at.REACH, m]
                gone = abs(product * over_size - limit) / scale
                more = across * over_size / scale
            gone = (gone if gone > more else more) * (HOT.settled / HOT.law)
            misfit[m] = gone if gone > misfit[m] else misfit[m]
