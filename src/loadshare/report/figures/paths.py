"""Paths in the plane, without the library that draws charts."""

from __future__ import annotations

import math

Point = tuple[float, float]


def arrow(tail: Point, tip: Point, head: float) -> list[Point]:
    """Path of an arrow with an open head of `head` length; nothing for one without length."""
    dx, dy = tip[0] - tail[0], tip[1] - tail[1]
    length = math.hypot(dx, dy)
    if length == 0.0:
        return []
    ux, uy = dx / length, dy / length
    half = 0.4 * head
    left = (tip[0] - head * ux - half * uy, tip[1] - head * uy + half * ux)
    right = (tip[0] - head * ux + half * uy, tip[1] - head * uy - half * ux)
    return [tail, tip, left, tip, right]


def circle(centre: Point, radius: float, count: int = 120) -> list[Point]:
    """Path of a circle, closed."""
    return arc(centre, radius, 0.0, 2.0 * math.pi, count)


def arc(centre: Point, radius: float, start: float, end: float, count: int = 60) -> list[Point]:
    """Path of an arc from angle `start` to `end` [rad]."""
    angles = [start + (end - start) * k / count for k in range(count + 1)]
    return [(centre[0] + radius * math.cos(a), centre[1] + radius * math.sin(a)) for a in angles]
