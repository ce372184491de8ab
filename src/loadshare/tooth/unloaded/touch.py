"""Points at which unloaded flanks touch, and the contact ellipses there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from loadshare.settings import TEETH
from loadshare.tooth.geometry.body import Array
from loadshare.tooth.geometry.flank import principal_directions, relative_curvature, unit
from loadshare.tooth.geometry.gap import Extents, least_gap
from loadshare.tooth.unloaded.positions import GearPair, touching


@dataclass(frozen=True, eq=False)
class ContactPoint:
    """Where one pair of teeth would first touch if it were alone.

    Parameters
    ----------
    pair : int
        Index of the pair of teeth.
    lead : float
        Lead of the driver over the ideal pair when this pair touches [rad]; the least over all
        pairs is the transmission error.
    point, normal : array (3,)
        Point of contact [m] and unit vector from the driver into the driven tooth, fixed frame.
    major, minor : array (3,)
        Unit vectors along the axes of the contact ellipse.
    least_curvature, greatest_curvature : float
        Relative curvatures along the major and the minor axis [1/m].
    edge : str
        Empty for a contact within both active flanks, else the edge at which the flanks touch,
        such as "driven tip".
    """

    pair: int
    lead: float
    point: Array
    normal: Array
    major: Array
    minor: Array
    least_curvature: float
    greatest_curvature: float
    edge: str


def contact_points(pair: GearPair, phase: float) -> tuple[ContactPoint, ...]:
    """Find the first contact of every pair of teeth at one phase, each pair taken alone.

    The contact equations, equal points and opposite normals in five unknowns (two parameters on
    either flank and the driver's angle), are solved by Newton's method. It starts at the least gap
    on the pair's line, with the driver turned further until that line touches, and takes no steps
    along a line contact, where the equations are singular. Where the flanks touch at an edge, no
    inner point of contact exists and the edge is named.

    Parameters
    ----------
    pair : GearPair
        The two gears.
    phase : float
        0 ≤ phase < 1 of the mesh cycle.

    Returns
    -------
    tuple of ContactPoint
        By rising pair index.

    Raises
    ------
    NoContactError
        If no pair of teeth is within both active flanks.
    """
    error, found, _ = touching(pair, [phase])
    lines, station, turned = _alone(pair, found)
    trace = lines.trace(station[:, None])
    pairs, driver, driven = (x[:, None] for x in (lines.pairs, lines.driver, lines.driven))
    at_end = np.minimum(np.abs(station - lines.start), np.abs(station - lines.end)) < TEETH.at_end
    at_edge = at_end & (np.abs(trace.slope[:, 0]) > TEETH.level)

    unknowns = np.stack([*trace.driver_at, *trace.driven_at, np.zeros_like(trace.gap)], axis=-1)
    unknowns[..., 4] = trace.gap / pair.arm
    inner = ~at_edge
    if inner.any():
        part = pairs[inner], unknowns[inner]
        refined, met = _newton(pair, *part, driver[inner], driven[inner])
        unknowns[inner] = np.where(_valid_refinement(pair, met, part[1], refined), refined, part[1])
    a, b, c, d, lead = np.moveaxis(unknowns, -1, 0)
    own = pair.driver_patch(pairs, (a, b), driver + lead)
    other = pair.driven_patch(pairs, (c, d), driven)
    major, minor = principal_directions(own, other)
    least = relative_curvature(own, other, major)
    greatest = relative_curvature(own, other, minor)
    margins = {name: margin[:, 0] for name, margin in pair.margins((a, b), (c, d)).items()}
    every = np.stack(list(margins.values()))
    nearest = np.argmax(every <= every.min(axis=0) + TEETH.same_edge, axis=0)
    edges = np.where(at_edge, np.array(list(margins))[nearest], "").tolist()

    vectors = (part[:, 0] for part in (own.point, own.normal, major, minor))
    apart = pair.openings(lines.pairs) / pair.arm
    leads = error[0] + (turned + apart)[:, None] + lead
    numbers = [part[:, 0].tolist() for part in (leads, least, greatest)]
    rows = zip(lines.pairs.tolist(), numbers[0], *vectors, *numbers[1:], edges, strict=True)
    return tuple(ContactPoint(int(number), *parts) for number, *parts in rows)


def _alone(pair: GearPair, found: Extents) -> tuple[Extents, Array, Array]:
    """Return lines (m,) of pairs, each with the driver turned further until that pair touches.

    This takes several steps: a pair's line far from its contact is not that at contact, and a gap
    over the arm is only nearly the angle that closes it. A line that leaves the flanks on the way
    keeps its last place.

    Returns
    -------
    lines : Extents
    station : array (m,)
        Where the gap is least [m].
    turned : array (m,)
        How far the driver was turned [rad].
    """
    turned, moving = np.zeros(len(found.pairs)), np.ones(len(found.pairs), bool)
    lines = found
    gap, station, _ = least_gap(lines)
    for _ in range(TEETH.steps):
        moving &= np.abs(gap) >= TEETH.touching
        if not moving.any():
            break
        further = turned + np.where(moving, gap / pair.arm, 0.0)
        every = pair.extents(found.driver + further, found.driven)
        own = np.flatnonzero(every.pairs == found.pairs[every.position])
        if len(own) < len(found.pairs):
            moving[np.setdiff1d(np.arange(len(found.pairs)), every.position[own])] = False
            continue
        lines, turned = every.rows(own), further
        gap, station, _ = least_gap(lines)
    return lines, station, turned


def _valid_refinement(pair: GearPair, met: Array, line: Array, refined: Array) -> Array:
    """Return which results (m, 1, 1) of Newton's method count: on both flanks, not after the line.

    Next to a line contact the equations are nearly singular and can lead off the flanks; then the
    place of the least gap on the line is kept. The line neglects the slope of the profile across
    it, so a pair touches sooner than its line says, never later.
    """
    a, b, c, d, lead = np.moveaxis(refined, -1, 0)
    margins = pair.margins((a, b), (c, d)).values()
    on_both = np.min(np.stack([np.broadcast_to(m, a.shape) for m in margins]), axis=0) >= 0.0
    later = (lead - line[..., 4]) * pair.arm
    return np.asarray((met & on_both & (later < TEETH.near))[..., None])


def _newton(
    pair: GearPair, pairs: Array, unknowns: Array, driver: Array, driven: Array
) -> tuple[Array, Array]:
    """Solve the contact equations; the driver's further turn is the last of unknowns (m, 1, 5).

    Return them, and for which pairs (m, 1) they are solved.
    """
    for _ in range(TEETH.meets):
        a, b, c, d, turn = np.moveaxis(unknowns, -1, 0)
        own = pair.driver_patch(pairs, (a, b), driver + turn)
        other = pair.driven_patch(pairs, (c, d), driven)
        first = unit(own.rays[0])
        # These rows are in metres too, so that all have the same weight.
        across = pair.arm * np.stack([first, np.cross(own.normal, first)], axis=-1)

        def equations(apart: Array, opening: Array, across: Array = across) -> Array:
            return np.concatenate([apart, (opening[..., None, :] @ across)[..., 0, :]], axis=-1)

        moves = np.stack([*own.rays, *-other.rays, _about_z(own.point)])
        bends = np.stack([*own.bends, *other.bends, _about_z(own.normal)])
        matrix = np.moveaxis(equations(moves, bends), 0, -1)
        right = equations(other.point - own.point, -(own.normal + other.normal))
        scale = np.sqrt((matrix**2).sum(axis=-2))
        step = np.linalg.pinv(matrix / scale[..., None, :], rcond=1e-9) @ right[..., None]
        unknowns = unknowns + step[..., 0] / scale
        if np.abs(step).max() < TEETH.last_step:
            break
    return unknowns, np.abs(step[..., 0]).max(axis=-1) + np.abs(right).max(axis=-1) < TEETH.near


def _about_z(vectors: Array) -> Array:
    return np.cross(np.array([0.0, 0.0, 1.0]), vectors)
