"""Words placed where they cover least: each takes the best of some places around its point."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from loadshare.report.figures.marks import Drawing, Point, Row, chart, rimmed
from loadshare.report.palette import SOFT

SIZE = 10
"""Of the letters [px]."""
BROAD = 0.56
"""Mean width of a letter over its height."""
WAYS = 16
"""Directions that are tried around a point."""
FURTHER = (1.0, 2.5, 4.0)
"""Gaps that are tried, over the one wanted."""
STEP = 3.0
"""Distance between the points by which a line is felt [px]."""
MOST = 400
"""Most points of one straight piece: a line may run far beyond the panel."""

Box = tuple[float, float, float, float]


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
    rows : list of dict
        What was placed and not yet taken by `layers`: x, y of the middle, text.
    """

    def __init__(self, low: Point, high: Point, pixels: float) -> None:
        self._low, self._high, self._pixels = low, high, pixels
        self._felt = np.empty((0, 2))
        self._taken: list[Box] = []
        self.rows: list[Row] = []

    def avoid(self, path: Sequence[Point]) -> None:
        """Keep labels off a path."""
        points = [*path[:1]]
        for start, end in pairwise(path):
            count = max(1, min(MOST, round(math.dist(start, end) * self._pixels / STEP)))
            points += [
                (
                    start[0] + k / count * (end[0] - start[0]),
                    start[1] + k / count * (end[1] - start[1]),
                )
                for k in range(1, count + 1)
            ]
        if points:
            self._felt = np.vstack([self._felt, points])

    def place(
        self, text: str, anchors: Iterable[Point], towards: Point = (0.0, 0.0), gap: float = 5.0
    ) -> None:
        """Put a label beside the best of some points.

        Parameters
        ----------
        text : str
        anchors : iterable of (float, float)
            Points that it may name, the preferred first.
        towards : (float, float)
            Direction that is preferred; none by default.
        gap : float
            Between point and label [px].
        """
        width = BROAD * SIZE * len(text) / self._pixels
        height = SIZE / self._pixels
        best: tuple[float, Point] | None = None
        for order, anchor in enumerate(anchors):
            for k in range(WAYS * len(FURTHER)):
                angle = 2.0 * math.pi * k / WAYS
                way = (math.cos(angle), math.sin(angle))
                away = FURTHER[k // WAYS]
                # Far enough that the box just clears the point in this direction.
                reach = away * gap / self._pixels + min(
                    width / 2 / max(abs(way[0]), 1e-9), height / 2 / max(abs(way[1]), 1e-9)
                )
                centre = (anchor[0] + reach * way[0], anchor[1] + reach * way[1])
                unwanted = 1.5 * (1.0 - way[0] * towards[0] - way[1] * towards[1])
                cost = self._cost(centre, width, height) + unwanted + 0.5 * order + away
                if best is None or cost < best[0]:
                    best = (cost, centre)
        if best is None:
            return
        x, y = best[1]
        self._taken.append(_box(best[1], width, height))
        self.rows.append({"x": x, "y": y, "text": text})

    def layers(self, x: Any, y: Any, colour: str = SOFT, **style: Any) -> list[Drawing]:
        """Return what was placed as layers, or none, and begin anew with the same obstacles."""
        rows, self.rows = self.rows, []
        if not rows:
            return []
        words = chart(rows).encode(x=x, y=y, text="text:N")
        return rimmed(words, colour, fontSize=SIZE, baseline="middle", **style)

    def _cost(self, centre: Point, width: float, height: float) -> float:
        left, low, right, high = box = _box(centre, width, height)
        cost = 30.0 * sum(_overlap(box, other) for other in self._taken)
        x, y = self._felt.T
        cost += int(np.count_nonzero((left <= x) & (x <= right) & (low <= y) & (y <= high)))
        beyond = (
            *(self._low[0] - left, self._low[1] - low),
            *(right - self._high[0], high - self._high[1]),
        )
        return cost + 100.0 * sum(out > 0.0 for out in beyond)


def _box(centre: Point, width: float, height: float) -> Box:
    x, y = centre
    return (x - width / 2, y - height / 2, x + width / 2, y + height / 2)


def _overlap(one: Box, other: Box) -> bool:
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]
