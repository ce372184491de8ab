"""Quadratic interpolation on a sheet of a swept mesh."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from loadshare.tooth.geometry.body import Array


@dataclass(frozen=True, eq=False)
class Sheet:
    """Nodes of 8-node quadrilaterals in rows (levels) and columns (stations).

    Attributes
    ----------
    levels, stations : array (2r + 1,), (2c + 1,)
        Coordinates of the nodes, every second one a vertex, the others half-way.
    """

    levels: Array
    stations: Array

    @cached_property
    def present(self) -> NDArray[np.bool_]:
        """Which grid nodes the element has: all but the middles of the quadrilaterals."""
        i, j = np.indices((len(self.levels), len(self.stations)))
        return np.asarray((i % 2 == 0) | (j % 2 == 0))

    @property
    def places(self) -> Array:
        """Coordinates (nodes, 2) of the nodes present."""
        i, j = np.nonzero(self.present)
        return np.column_stack([self.levels[i], self.stations[j]])

    def weights(self, points: Array) -> Array:
        """Return weights (n, nodes) that interpolate values of the nodes present to points (n, 2).

        Points beyond the sheet take the value of its edge.
        """
        # Numbers of the grid nodes, meaningful only for those present.
        number = np.cumsum(self.present).reshape(self.present.shape) - 1
        a, x = _cell(self.levels, points[:, 0])
        b, y = _cell(self.stations, points[:, 1])
        rows = np.arange(len(points))
        weights = np.zeros((len(points), number[-1, -1] + 1))
        for i, j, value in _serendipity(x, y):
            weights[rows, number[a + i, b + j]] = value
        return weights


def _cell(grid: Array, at: Array) -> tuple[NDArray[np.int64], Array]:
    """Return the first node of each coordinate's cell, and the place in the cell, −1 to 1."""
    ends = grid[::2]
    at = np.clip(at, ends[0], ends[-1])
    cell = np.clip(np.searchsorted(ends, at, side="right") - 1, 0, len(ends) - 2)
    place = 2.0 * (at - ends[cell]) / (ends[cell + 1] - ends[cell]) - 1.0
    return 2 * cell, place


def _serendipity(x: Array, y: Array) -> list[tuple[int, int, Array]]:
    """Return the 8-node quadrilateral's shape functions: node (i, j) of its 3 × 3 grid, value."""
    shapes = []
    for i, xi in ((0, -1.0), (2, 1.0)):
        for j, eta in ((0, -1.0), (2, 1.0)):
            corner = 0.25 * (1.0 + xi * x) * (1.0 + eta * y) * (xi * x + eta * y - 1.0)
            shapes.append((i, j, corner))
        shapes.append((i, 1, 0.5 * (1.0 + xi * x) * (1.0 - y**2)))
        shapes.append((1, i, 0.5 * (1.0 - x**2) * (1.0 + xi * y)))
    return shapes
