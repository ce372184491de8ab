"""Laws of flanks and graphs of radial elements, at a claim."""

from __future__ import annotations

import numpy as np

from loadshare.certify.bound.kernel.options import compiled, inlined
from loadshare.certify.bound.kernel.rows import put_column, row_of
from loadshare.settings import BOUND, LAWS


@inlined
def _level(of, here, claim, s, q):  # type: ignore[no-untyped-def]
    """Return the force at which a spline slips [N]."""
    k = q - of.rounds
    r = row_of(here.spline, s)
    bound = here.spline[r, k, 3]
    if not np.isnan(bound):
        return bound
    torque = 0.0
    for e in range(len(of.arm)):
        torque += of.moment[k, e] * claim.flank_force[s, e]
    return here.spline[r, k, 4] * abs(torque)


@inlined
def law_of(of, here, claim, s, q, distance):  # type: ignore[no-untyped-def]
    """Return the graph of a radial element; NaN where it has no meaning.

    First stiffness, S1, level, S2, last stiffness, and the force at the end of the first piece. A
    wall with a power law is given by its tangent at the distance (see `graphs.wall`).
    """
    if q < of.rounds:
        reach = here.round_radius[row_of(here.round_radius, s), q]
        last = here.round_stiffness[row_of(here.round_stiffness, s), q]
        power = here.round_power[0, q]
        if power != 1.0:
            gap = max(distance - reach, (reach if reach > 0.0 else 1.0) * 2.0**-52)
            reach += gap * (1.0 - 1.0 / power)
            last *= power * gap ** (power - 1.0)
        return 0.0, 0.0, 0.0, reach, last, 0.0
    r, k = row_of(here.spline, s), q - of.rounds
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
def rolling_at(here, s, q, force, light):  # type: ignore[no-untyped-def]
    """Return the distance [m] at which a wall with a power law carries a force.

    Also returns the largest and the smallest compliance [m/N] next to it; for a light force,
    tangents are taken at a larger one.
    """
    reach = here.round_radius[row_of(here.round_radius, s), q]
    stiffness = here.round_stiffness[row_of(here.round_stiffness, s), q]
    power, at = here.round_power[0, q], max(force, light)
    least = (at / stiffness) ** (1.0 / power) / (power * at)
    far = reach + (force / stiffness) ** (1.0 / power)
    return far, max(least, far / at), least


@inlined
def stiffest(law):  # type: ignore[no-untyped-def]
    """Return a compliance below which that between two points of a graph never falls [m/N].

    A graph whose last piece is as stiff as its first, without a step of the force, is nowhere
    stiffer than that; a ring is as stiff as its wall.
    """
    _, _, level, _, last, end = law
    return 1.0 / last if end >= level else 0.0


@inlined
def flank_law(of, here, s, e, force, scale):  # type: ignore[no-untyped-def]
    """Return the law of a flank at a force.

    Compression [m], smallest and largest compliance [m/N] next to it, and the error of the force
    up to which they hold [N].
    """
    light = BOUND.light * scale
    if of.is_tabled[e]:
        r = row_of(here.table, s)
        return _by_table(here.table[r, e, 0], here.table[r, e, 1], force, light)
    bending, hertz = here.bending[row_of(here.bending, s), e], here.hertz[row_of(here.hertz, s), e]
    root = np.cbrt(max(force, 0.0))
    compression, least, most = _by_power(bending, hertz, force, root, light, np.cbrt(light))
    return compression, least, most, _holds(hertz, force, light)


@inlined
def _by_power(bending, hertz, force, root, light, root_of_light):  # type: ignore[no-untyped-def]
    """Return compression [m] by a power law, smallest and largest compliance [m/N] next to it.

    A light Hertz contact may lose its force: its largest compliance is the secant to zero force,
    infinite where it carries none.
    """
    compression = bending * force + hertz * root * root
    soft = bending + 2.0 / 3.0 * hertz / root
    secant = bending + hertz / root
    least = soft if force >= light else bending + 2.0 / 3.0 * hertz / root_of_light
    most = soft if force >= light else secant
    curved = hertz != 0.0
    return compression, least if curved else bending, most if curved else bending


@inlined
def _holds(hertz, force, light):  # type: ignore[no-untyped-def]
    """Return the error of a force up to which compliances next to it hold [N]."""
    return np.inf if hertz == 0.0 else 0.1 * max(force, light)


@inlined
def put_laws(of, here, claim, e, first, width, work):  # type: ignore[no-untyped-def]
    """Write the laws of a flank at the forces of claims to four rows, as in `flank_law`.

    Return whether compliances are the same for all claims.
    """
    force, (compression, least, most, holds) = work.push, work.law
    if of.is_tabled[e]:
        for v in range(width):
            law = flank_law(of, here, first + v, e, force[v], work.scale[v])
            compression[v], least[v], most[v], holds[v] = law
        return False
    hertz, curved = work.given, 0.0
    put_column(here.bending[:, e], first, width, least)
    put_column(here.hertz[:, e], first, width, hertz)
    for v in range(BOUND.side_by_side):
        curved += hertz[v]
    if curved == 0.0:
        for v in range(BOUND.side_by_side):
            most[v], holds[v] = least[v], np.inf
        for v in range(BOUND.side_by_side):
            compression[v] = least[v] * force[v]
        return len(here.bending) == 1 and len(here.hertz) == 1
    root, light, root_of_light = work.root, work.light, work.root_of_light
    put_column(claim.flank_root[:, e], first, width, root)
    for v in range(BOUND.side_by_side):
        root[v] = root[v] if force[v] != 0.0 else 0.0
    for v in range(BOUND.side_by_side):
        holds[v] = _holds(hertz[v], force[v], light[v])
    for v in range(BOUND.side_by_side):
        law = _by_power(least[v], hertz[v], force[v], root[v], light[v], root_of_light[v])
        compression[v], least[v], most[v] = law
    return False


@compiled
def _by_table(forces, compressions, force, near):  # type: ignore[no-untyped-def]
    """Return the law of a table at a force, as in `flank_law`; linear beyond the last point.

    Corners nearby do not limit it: the compliances include those on both sides of them.
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
def nearest(law, force, distance, light):  # type: ignore[no-untyped-def]
    """Return the point of a graph at a force nearest to a distance: distance [m], force [N].

    A distance below 0 stands for the first piece. Also returns the compliance [m/N] there (for a
    slip, across it, wherever it ends), and by how much the force may change. A light element slips
    where its place says so.
    """
    first, stick, level, reach, last, end = law
    if np.isinf(stick):
        return -1.0, force, 1.0 / first, np.inf
    slips = stick * (1.0 + BOUND.slack) < distance < reach * (1.0 - BOUND.slack)
    near = abs(force - level) <= (BOUND.slack if slips else BOUND.corner) * level
    if near or (slips and light):
        return min(max(distance, stick), reach), level, reach / level, BOUND.slip_turns * level
    if force > level:
        far = reach + (force - level) / last
        return far, force, max(1.0 / last, far / force), min(force - level, 0.05 * force)
    if force <= end and stick > 0.0:
        return -1.0, force, 1.0 / first, end - force
    spare = min(level - force, force - end if stick > 0.0 else np.inf)
    return stick, force, stick / force if stick > 0.0 else 0.0, spare


@inlined
def sticks(law, force):  # type: ignore[no-untyped-def]
    """Return whether a spline would stick at half the level as well."""
    first, stick, level, reach, _, end = law
    if np.isinf(stick):
        return 0.5 * level >= first * reach
    return end >= level and force <= 0.5 * level


@inlined
def rate_of(of, here, s, q):  # type: ignore[no-untyped-def]
    """Return the change of a spline's level with the torque over it [1/m]."""
    r, k = row_of(here.spline, s), q - of.rounds
    return abs(here.spline[r, k, 4]) if np.isnan(here.spline[r, k, 3]) else 0.0
