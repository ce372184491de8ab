"""Words placed where they cover least: each takes the best of some places around its point.

What is further away is joined to its point by a thin line.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from loadshare.report.figures.marks import path_rows, rimmed
from loadshare.report.figures.paths import Point
from loadshare.report.palette import SOFT
from loadshare.report.vega_lite import Drawing, Row, channel, layer

SIZE = 10
"""Of the letters [px]."""
BROAD = 0.56
"""Mean width of a letter over its height."""
WAYS = 16
"""Directions that are tried around a point."""
FURTHER = (1.0, 2.5, 4.0)
"""Gaps that are tried, over the one wanted."""
RIM = 1.0
"""Room around a label that others leave free [px]."""
CLEAR = 2.0
"""Room above and below a label that lines leave free, for letters that reach further [px]."""
STEP = 3.0
"""Distance between the points by which a line is felt [px]."""
MOST = 400
"""Most points of one straight piece: a line may run far beyond the panel."""

CLEARLY = 1.5
"""How many times further a label is from what it does not name."""

Box = tuple[float, float, float, float]
Line = tuple[Point, Point]


class Labels:
    """Labels of one panel.

    Parameters
    ----------
    low, high : (float, float)
        Corners of the panel, in the units of its data.
    pixels : float
        Of one such unit, the same in both directions.

    Attributes
    ----------
    pixels : float
    rows : list of dict
        What was placed and not yet taken by `layers`: x, y of the middle, text.
    """

    def __init__(self, low: Point, high: Point, pixels: float) -> None:
        self._low, self._high, self.pixels = low, high, pixels
        self._felt = np.empty((0, 2))
        self._taken: list[Box] = []
        self._leaders: list[Row] = []
        self.rows: list[Row] = []

    def avoid(self, path: Sequence[Point]) -> None:
        """Keep labels off a path."""
        felt: list[Any] = [self._felt, *([path[:1]] if path else [])]
        for start, end in pairwise(path):
            count = max(1, min(MOST, round(math.dist(start, end) * self.pixels / STEP)))
            felt.append(np.linspace(start, end, count + 1)[1:])
        self._felt = np.vstack(felt)

    def place(
        self,
        text: str,
        anchors: Iterable[Point],
        towards: Point = (0.0, 0.0),
        gap: float = 5.0,
        others: Sequence[Point] = (),
    ) -> None:
        """Put a label next to the best of some points.

        Parameters
        ----------
        text : str
        anchors : iterable of (float, float)
            Points that it may name, the preferred first.
        towards : (float, float)
            Direction that is preferred; none by default.
        gap : float
            Between point and label [px].
        others : sequence of (float, float)
            Points that it shall not seem to name, by its place or by the line that leads to it.
        """
        best: tuple[float, Box, Line | None] | None = None
        for order, anchor in enumerate(anchors):
            for way, away, box in self._around(anchor, len(text), gap):
                leader = None if away == FURTHER[0] else (anchor, _nearest(box, anchor))
                unwanted = 1.5 * (1.0 - way[0] * towards[0] - way[1] * towards[1])
                cost = self._cost(box) + 30.0 * self._misread(box, anchor, leader, others, gap)
                cost += unwanted + 0.5 * order + away
                if best is None or cost < best[0]:
                    best = (cost, box, leader)
        if best is None:
            return
        _, (left, low, right, high), leader = best
        rim = RIM / self.pixels
        self._taken.append((left - rim, low - rim, right + rim, high + rim))
        if leader:
            self._leaders += path_rows(leader, label=len(self._taken))
            self.avoid(leader)
        self.rows.append({"x": (left + right) / 2, "y": (low + high) / 2, "text": text})

    def layers(self, x: Any, y: Any, colour: str = SOFT, **style: Any) -> list[Drawing]:
        """Return what was placed as layers, or none, and start again with the same obstacles."""
        rows, self.rows = self.rows, []
        leaders, self._leaders = self._leaders, []
        if not rows:
            return []
        where = {"x": x, "y": y}
        texts = rimmed(rows, where, colour, fontSize=SIZE, baseline="middle", **style)
        if not leaders:
            return texts
        where |= {"order": channel("order:Q"), "detail": channel("label:N")}
        return [layer("line", leaders, where, color=colour, strokeWidth=0.6), *texts]

    def _around(
        self, anchor: Point, letters: int, gap: float
    ) -> Iterator[tuple[Point, float, Box]]:
        """Places around a point: direction, how far in parts of the gap, and box."""
        width, height = BROAD * SIZE * letters / self.pixels, SIZE / self.pixels
        for away in FURTHER:
            for k in range(WAYS):
                angle = 2.0 * math.pi * k / WAYS
                way = (math.cos(angle), math.sin(angle))
                # The box begins in this direction, with its side or, obliquely, with its corner.
                x = anchor[0] + away * gap / self.pixels * way[0] + width / 2 * _cornered(way[0])
                y = anchor[1] + away * gap / self.pixels * way[1] + height / 2 * _cornered(way[1])
                yield way, away, (x - width / 2, y - height / 2, x + width / 2, y + height / 2)

    def _misread(
        self, box: Box, anchor: Point, leader: Line | None, others: Sequence[Point], gap: float
    ) -> int:
        """Count the other points and labels that a label could be taken to belong to."""
        if not leader:
            near = CLEARLY * math.dist(anchor, _nearest(box, anchor))
            return sum(math.dist(other, _nearest(box, other)) < near for other in others)
        passed = sum(_beside(other, leader) * self.pixels < gap for other in others)
        return passed + sum(_crosses(leader, taken) for taken in self._taken)

    def _cost(self, box: Box) -> float:
        left, low, right, high = box
        cost = 300.0 * sum(_overlap(box, other) for other in self._taken)
        x, y = self._felt.T
        above = CLEAR / self.pixels
        over = (left <= x) & (x <= right) & (low - above <= y) & (y <= high + above)
        cost += int(np.count_nonzero(over))
        beyond = (
            *(self._low[0] - left, self._low[1] - low),
            *(right - self._high[0], high - self._high[1]),
        )
        return cost + 300.0 * sum(out > 0.0 for out in beyond)


def _cornered(part: float) -> float:
    """Part of half a box by which it is set aside, from the cosine of the direction."""
    return min(max(1.5 * part, -1.0), 1.0)


def _nearest(box: Box, point: Point) -> Point:
    """Point of a box that is nearest to a point."""
    left, low, right, high = box
    return min(max(point[0], left), right), min(max(point[1], low), high)


def _beside(point: Point, line: Line) -> float:
    """Distance of a point from a straight line between two others."""
    start, end = line
    dx, dy = end[0] - start[0], end[1] - start[1]
    along = (point[0] - start[0]) * dx + (point[1] - start[1]) * dy
    part = min(max(along / ((dx * dx + dy * dy) or 1.0), 0.0), 1.0)
    return math.dist(point, (start[0] + part * dx, start[1] + part * dy))


def _crosses(line: Line, box: Box) -> bool:
    """Whether a short line runs into a box; seen at ten of its points."""
    points = [[a + k / 9 * (b - a) for a, b in zip(*line, strict=True)] for k in range(10)]
    return any(box[0] < x < box[2] and box[1] < y < box[3] for x, y in points)


def _overlap(one: Box, other: Box) -> bool:
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]
