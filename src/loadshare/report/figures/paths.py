"""Paths in the plane, without the library that draws charts."""

from __future__ import annotations

import math
from itertools import pairwise

Point = tuple[float, float]

STRAIGHT = 1e-9
"""Area spanned by two steps of a path, over the square of its size, if it counts as straight."""


def arrow(tail: Point, tip: Point, head: float) -> list[Point]:
    """Return the path of an arrow with an open head of `head` length; empty without length."""
    dx, dy = tip[0] - tail[0], tip[1] - tail[1]
    length = math.hypot(dx, dy)
    if length == 0.0:
        return []
    ux, uy = dx / length, dy / length
    half = 0.4 * head
    left = (tip[0] - head * ux - half * uy, tip[1] - head * uy + half * ux)
    right = (tip[0] - head * ux + half * uy, tip[1] - head * uy - half * ux)
    return [tail, tip, left, tip, right]


def corners(path: list[Point]) -> list[Point]:
    """Return a path without points along straight pieces: a circle from the side keeps three."""
    flat = STRAIGHT * math.dist(path[0], path[len(path) // 2]) ** 2
    kept = path[:1]
    for (x, y), (after_x, after_y) in pairwise(path[1:]):
        ux, uy, vx, vy = x - kept[-1][0], y - kept[-1][1], after_x - x, after_y - y
        if abs(ux * vy - uy * vx) > flat or ux * vx + uy * vy < 0.0:
            kept.append((x, y))
    return [*kept, path[-1]]


def circle(centre: Point, radius: float, count: int = 120) -> list[Point]:
    """Return the path of a circle, closed."""
    return arc(centre, radius, 0.0, 2.0 * math.pi, count)


def arc(centre: Point, radius: float, start: float, end: float, count: int = 60) -> list[Point]:
    """Return the path of an arc from angle `start` to `end` [rad]."""
    angles = [start + (end - start) * k / count for k in range(count + 1)]
    return [(centre[0] + radius * math.cos(a), centre[1] + radius * math.sin(a)) for a in angles]
