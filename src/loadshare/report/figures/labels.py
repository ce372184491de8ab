"""Labels placed where they cover least: each takes the best of some places around its point.

A label that is further away is joined to its point by a thin line.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from loadshare.report.figures.marks import path_rows, rimmed
from loadshare.report.figures.paths import Point
from loadshare.report.palette import SOFT
from loadshare.report.vega_lite import Channel, Drawing, Row, channel, layer
from loadshare.train.gear import Vector

SIZE = 10
"""Size of the letters [px]."""
BROAD = 0.56
"""Mean width of a letter over its height."""
DIRECTIONS = np.array([(math.cos(k * math.pi / 8), math.sin(k * math.pi / 8)) for k in range(16)])
"""Directions that are tried around a point."""
FURTHER = np.array([1.0, 2.5, 4.0])
"""Gaps that are tried, over the one wanted; beyond the first, a line joins label and point."""
RIM = 1.0
"""Room around a label that others leave free [px]."""
CLEAR = 2.0
"""Room above and below a label that lines leave free, for letters that reach further [px]."""
STEP = 3.0
"""Distance between the points that represent a line [px]."""
MOST = 400
"""Most points of one straight piece: a line may run far beyond the panel."""
CLEARLY = 1.5
"""How many times further a label must be from points that it does not name."""
ALONG = np.linspace(0.0, 1.0, 10)
"""Places at which a line to a label is checked, as parts of its length."""


class Labels:
    """Labels of one panel.

    Parameters
    ----------
    low, high : (float, float)
        Corners of the panel, in the units of its data.
    pixels : float
        Pixels per unit of the data, the same in both directions.

    Attributes
    ----------
    pixels : float
    rows : list of dict
        Labels that were placed: x, y of the middle, text, colour.
    """

    def __init__(self, low: Point, high: Point, pixels: float) -> None:
        self._low, self._high, self.pixels = low, high, pixels
        self._felt = np.empty((0, 2))
        self._taken = np.empty((0, 2, 2))
        self._leaders: list[Row] = []
        self.rows: list[Row] = []

    def avoid(self, path: Sequence[Point]) -> None:
        """Keep labels off a path."""
        if not path:
            return
        points = np.array(path)
        pieces = np.diff(points, axis=0)
        lengths = np.hypot(*pieces.T) * self.pixels
        counts = np.clip(np.rint(lengths / STEP), 1, MOST).astype(int)
        piece = np.repeat(np.arange(len(counts)), counts)
        number = np.arange(len(piece)) - np.repeat(np.cumsum(counts) - counts, counts) + 1
        between = points[piece] + (number / counts[piece])[:, None] * pieces[piece]
        self._felt = np.vstack([self._felt, points[:1], between])

    def place(
        self,
        text: str,
        anchors: Iterable[Point],
        towards: Point = (0.0, 0.0),
        gap: float = 5.0,
        others: Sequence[Point] = (),
        colour: str = SOFT,
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
            Points that it must not seem to name, by its place or by the line that joins it.
        colour : str
            Of the letters.
        """
        half = np.array([BROAD * len(text), 1.0]) * SIZE / 2.0 / self.pixels
        best: tuple[float, Any, Any] | None = None
        for order, anchor in enumerate(map(np.array, anchors)):
            boxes = self._around(anchor, half, gap)
            nearest = np.clip(anchor, boxes[..., 0, :], boxes[..., 1, :])
            cost = self._cost(boxes)
            cost += 30.0 * self._misread(boxes, anchor, nearest, others, gap)
            cost += 1.5 * (1.0 - DIRECTIONS @ towards) + 0.5 * order + FURTHER[:, None]
            away, way = np.unravel_index(np.argmin(cost), cost.shape)
            if best is None or cost[away, way] < best[0]:
                leader = [tuple(map(float, p)) for p in (anchor, nearest[away, way])]
                best = (cost[away, way], boxes[away, way], leader if away else [])
        if best is None:
            return
        _, box, leader = best
        rim = RIM / self.pixels
        self._taken = np.concatenate([self._taken, [np.add(box, [[-rim], [rim]])]])
        self._leaders += path_rows(leader, label=len(self._taken), colour=colour)
        self.avoid(leader)
        x, y = box.mean(axis=0)
        self.rows.append({"x": float(x), "y": float(y), "text": text, "colour": colour})

    def layers(self, x: Channel, y: Channel, **style: Any) -> list[Drawing]:
        """Return what was placed as layers; none if nothing was."""
        where = {"x": x, "y": y}
        path = {"order": channel("order:Q"), "detail": channel("label:N")}
        path["stroke"] = channel("colour:N", scale=None)
        lines = [layer("line", self._leaders, where | path, strokeWidth=0.6)]
        spoken = where | {"description": channel("text:N")}
        texts = rimmed(self.rows, spoken, fontSize=SIZE, baseline="middle", **style)
        return [*(lines if self._leaders else []), *(texts if self.rows else [])]

    def _around(self, anchor: Vector, half: Vector, gap: float) -> Vector:
        """Return boxes around a point: corners (further, ways, 2, 2), with half the size `half`."""
        # The side of a box faces the point or, in oblique directions, its corner does.
        aside = half * np.clip(1.5 * DIRECTIONS, -1.0, 1.0)
        middle = anchor + FURTHER[:, None, None] * gap / self.pixels * DIRECTIONS + aside
        return np.stack([middle - half, middle + half], axis=-2)

    def _cost(self, boxes: Vector) -> Vector:
        """Return the cost of boxes, for what they cover and for leaving the panel."""
        low, high = boxes[..., 0, :], boxes[..., 1, :]
        above = np.array([0.0, CLEAR / self.pixels])
        ends = low - above, high + above
        near = _within(self._felt, ends[0].min(axis=(0, 1)), ends[1].max(axis=(0, 1)))
        felt = _within(self._felt[near], *ends).sum(axis=-1)
        begin, end = self._taken[:, 0], self._taken[:, 1]
        covered = ((low[..., None, :] < end) & (begin < high[..., None, :])).all(axis=-1)
        beyond = (low < self._low) | (high > self._high)
        return np.asarray(felt + 300.0 * (covered.sum(axis=-1) + beyond.sum(axis=-1)))

    def _misread(
        self, boxes: Vector, anchor: Vector, nearest: Vector, others: Sequence[Point], gap: float
    ) -> Vector:
        """Count the other points and labels that each box could be taken to belong to."""
        points = np.reshape(others, (-1, 2))
        beside = boxes[0][:, None]
        away = _length(np.clip(points, beside[..., 0, :], beside[..., 1, :]) - points)
        close = away < CLEARLY * _length(nearest[0] - anchor)[:, None]
        lines = (nearest[1:] - anchor)[..., None, :]
        part = np.clip(((points - anchor) * lines).sum(-1) / (lines**2).sum(-1), 0.0, 1.0)
        passed = _length(points - anchor - part[..., None] * lines) * self.pixels < gap
        looked = anchor + ALONG[:, None] * lines
        crossed = [_within(looked, low, high).any(axis=-1) for low, high in self._taken]
        return np.concatenate([close.sum(axis=-1)[None], passed.sum(axis=-1) + sum(crossed)])


def _within(points: Vector, low: Vector, high: Vector) -> Vector:
    """Return which of some points (…, n, 2) are in each of some boxes."""
    x, y = points[..., 0], points[..., 1]
    left, right, lower, upper = (
        v[..., None] for v in (low[..., 0], high[..., 0], low[..., 1], high[..., 1])
    )
    return np.asarray((left <= x) & (x <= right) & (lower <= y) & (y <= upper))


def _length(vectors: Vector) -> Vector:
    return np.hypot(vectors[..., 0], vectors[..., 1])
