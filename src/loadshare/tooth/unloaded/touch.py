"""Points at which unloaded flanks touch, and the contact ellipses there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from loadshare.settings import TEETH
from loadshare.tooth.geometry.body import Array
from loadshare.tooth.geometry.flank import principal_directions, relative_curvature, unit
from loadshare.tooth.geometry.gap import least_gap
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
    """First contact of every pair of teeth at one phase, each pair taken alone.

    The contact equations, equal points and opposite normals in five unknowns (two parameters on
    either flank and the driver's angle), are solved by Newton's method from the place of the least
    gap on the pair's line. Steps along a line contact, where the equations are singular, are
    left out. Where the flanks touch at an edge, no inner point of contact exists and the edge is
    named.

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
    error, lines, _ = touching(pair, [phase])
    gap, station, _ = least_gap(lines)
    trace = lines.trace(station[:, None])
    pairs, driver, driven = (x[:, None] for x in (lines.pairs, lines.driver, lines.driven))
    at_end = np.minimum(np.abs(station - lines.start), np.abs(station - lines.end)) < TEETH.at_end
    at_edge = at_end & (np.abs(trace.slope[:, 0]) > TEETH.level)

    unknowns = np.stack([*trace.driver_at, *trace.driven_at, np.zeros_like(trace.gap)], axis=-1)
    unknowns[..., 4] = gap[:, None] / pair.arm
    inner = ~at_edge
    if inner.any():
        turned = (rotation[inner] for rotation in (driver, driven))
        refined = _newton(pair, pairs[inner], unknowns[inner], *turned)
        # Next to a line contact the equations are nearly singular and can lead off the line; the
        # place of the least gap then stands.
        lead = refined[..., 4] - unknowns[inner][..., 4]
        near = np.abs(lead) * pair.arm < TEETH.near
        unknowns[inner] = np.where(near[..., None], refined, unknowns[inner])
    a, b, c, d, lead = np.moveaxis(unknowns, -1, 0)
    own = pair.driver_patch(pairs, (a, b), driver + lead)
    other = pair.driven_patch(pairs, (c, d), driven)
    major, minor = principal_directions(own, other)
    least = relative_curvature(own, other, major)
    greatest = relative_curvature(own, other, minor)
    margins = {name: margin[:, 0] for name, margin in pair.margins((a, b), (c, d)).items()}

    edges = []
    for i in range(len(lines.pairs)):
        nearest = min(float(margin[i]) for margin in margins.values())
        edge = next(
            name for name, margin in margins.items() if margin[i] <= nearest + TEETH.same_edge
        )
        edges.append(edge if at_edge[i] else "")
    vectors = (part[:, 0] for part in (own.point, own.normal, major, minor))
    numbers = [part[:, 0].tolist() for part in (error[0] + lead, least, greatest)]
    rows = zip(lines.pairs.tolist(), numbers[0], *vectors, *numbers[1:], edges, strict=True)
    return tuple(ContactPoint(int(number), *parts) for number, *parts in rows)


def _newton(pair: GearPair, pairs: Array, unknowns: Array, driver: Array, driven: Array) -> Array:
    """Solve the contact equations; unknowns (m, 1, 5) with the driver's further turn as last."""
    for _ in range(20):
        a, b, c, d, turn = np.moveaxis(unknowns, -1, 0)
        own = pair.driver_patch(pairs, (a, b), driver + turn)
        other = pair.driven_patch(pairs, (c, d), driven)
        first = unit(own.rays[0])
        # In metres too, so that the rows weigh alike.
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
    return unknowns


def _about_z(vectors: Array) -> Array:
    return np.cross(np.array([0.0, 0.0, 1.0]), vectors)
