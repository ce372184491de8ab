"""The middle surface of a tooth, and where the normals of a flank meet it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from loadshare.settings import TEETH
from loadshare.tooth.geometry.body import Array, ToothBody
from loadshare.tooth.geometry.flank import dot, solve_2

STEP = 1e-5
"""Step in u and w of the differences that give normals and slopes."""
LAST_MOVE = 1e-7
"""Step in u and w at which Newton's method ends: the error left is about its square."""


@dataclass(frozen=True, slots=True, eq=False)
class Foot:
    """Feet of flank normals on the middle surface.

    Attributes
    ----------
    zw : array (n, 2)
        Place on the middle surface: z = u for points between the flanks, and z below
        `MiddleSurface.waist` (down to −1) for points under the tooth; w as on the flank.
    depth : array (n,)
        Distance from the flank along the normal [m].
    flank : array (n, 3)
        Point of the flank [m], gear frame of tooth 0.
    inward : array (n, 3)
        Unit vector into the tooth there.
    """

    zw: Array
    depth: Array
    flank: Array
    inward: Array


class MiddleSurface:
    """The surface half-way between the two flanks of tooth 0, continued straight into the rim.

    Parameters
    ----------
    body : ToothBody
    waist : float
        The u on the fillet above which straight lines between the two sides make up the tooth.
    """

    def __init__(self, body: ToothBody, waist: float | None = None) -> None:
        self.body = body
        self.waist = waist_of(body) if waist is None else waist

    def between(self, u: Array, w: Array) -> Array:
        """Return points (n, 3) half-way between the two sides [m]."""
        return 0.5 * np.add(*both_sides(self.body, u, w))

    def points(self, zw: Array) -> Array:
        """Return points (n, 3) [m] of the middle surface at places (n, 2)."""
        z, w = zw[:, 0], zw[:, 1]
        top = self.between(np.maximum(z, self.waist), w)
        below = np.clip((self.waist - z) / (1.0 + self.waist), 0.0, None)
        return top + below[:, None] * (under(self.body, top) - top)

    def surface(self, zw: Array) -> tuple[Array, Array, Array]:
        """Return points (n, 3) [m] of the middle surface, and their derivatives over z and w."""
        over_z, over_w = (
            (self.points(zw + shift) - self.points(zw - shift)) / (2.0 * STEP)
            for shift in STEP * np.eye(2)
        )
        return self.points(zw), over_z, over_w

    def facing(self, uw: Array, side: int) -> tuple[Array, Array]:
        """Return points (n, 3) of the flank `side` [m], and unit normals there into the tooth."""
        u, w = uw[:, 0], uw[:, 1]
        # One-sided at foot and tip, where the outline may have a kink.
        low, high = np.maximum(u - STEP, self.body.foot), np.minimum(u + STEP, 1.0)
        before, after = np.maximum(w - STEP, 0.0), np.minimum(w + STEP, 1.0)
        outline = self.body.outline
        along = outline(high, w, side) - outline(low, w, side)
        across = outline(u, after, side) - outline(u, before, side)
        normal = np.cross(along, across)
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        flank = outline(u, w, side)
        inside = np.sign(np.sum(normal * (self.between(u, w) - flank), axis=1))
        return flank, np.asarray(inside[:, None] * normal)

    def feet(self, uw: Array, side: int) -> Foot:
        """Find where the normals of flank points (n, 2) meet the middle surface.

        A normal that leaves the tooth through its face end before it meets the middle surface has
        its foot on the end.
        """
        flank, inward = self.facing(uw, side)
        zw = uw.copy()
        for _ in range(TEETH.meets):
            here, *slopes = self.surface(zw)
            miss = flank - here
            # The foot moves in the surface until the remaining distance lies along the normal.
            a, b = (s - dot(s, inward)[:, None] * inward for s in slopes)
            ab = dot(a, b)
            move = solve_2((dot(a, a), ab), (ab, dot(b, b)), dot(a, miss), dot(b, miss))
            new = zw + np.clip(np.column_stack(move), -0.3, 0.3)
            new = np.column_stack([np.clip(new[:, 0], -1.0, 1.0), np.clip(new[:, 1], 0.0, 1.0)])
            done = float(np.abs(new - zw).max()) < LAST_MOVE
            zw = new
            if done:
                break
        return Foot(zw, dot(self.points(zw) - flank, inward), flank, inward)


def both_sides(body: ToothBody, u: Array, w: Array) -> tuple[Array, Array]:
    """Return points (..., 3) of the outline on side +1 and on side −1 [m]."""
    first = body.outline(u, w, 1)
    if body.gear.shape == "face":  # its tooth is its own mirror image
        return first, first * np.array([1.0, -1.0, 1.0])
    return first, body.outline(u, w, -1)


def under(body: ToothBody, points: Array) -> Array:
    """Return the points (..., 3) of the rim's free side that lie under `points` [m]."""
    if body.gear.shape == "face":
        moved = points.copy()
        moved[..., 2] = _floor_of(body) - body.rim
        return moved
    radius = np.hypot(points[..., 0], points[..., 1])
    scale = np.ones_like(points)
    scale[..., :2] = (body.rim / radius)[..., None]
    return points * scale


@lru_cache(maxsize=64)
def _floor_of(body: ToothBody) -> float:
    """Return the z of the deepest root of a face gear [m]."""
    return float(np.min(body.outline(np.zeros(3), np.array([0.0, 0.5, 1.0]), 1)[..., 2]))


def waist_of(body: ToothBody, angle: float = 50.0) -> float:
    """Return the u on the fillet where the outline is at `angle` [degrees] to the tooth's chord."""
    u = np.linspace(0.0, body.foot, 61)
    sides = both_sides(body, u, np.array(0.5))
    chord = sides[0] - sides[1]
    chord /= np.linalg.norm(chord, axis=1)[:, None]
    tangent = -np.gradient(sides[0], u, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    cosine = np.sum(chord * tangent, axis=1)
    steep = np.flatnonzero(cosine[1:-1] < np.cos(np.radians(angle))) + 1
    found = u[steep[0]] if len(steep) else 0.5 * body.foot
    return float(np.clip(found, 0.2 * body.foot, 0.8 * body.foot))
