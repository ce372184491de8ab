"""Where a gear stands in the fixed frame."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from loadshare.tooth.geometry.body import Array


@dataclass(frozen=True, eq=False)
class Placement:
    """Position of a gear's frame, before the gear turns, in the fixed frame.

    Parameters
    ----------
    origin : array (3,)
        The gear frame's origin [m].
    axes : array (3, 3)
        The gear frame's axes as columns.
    """

    origin: Array
    axes: Array

    def to_body(self, points: Array, rotation: Array | float) -> Array:
        """Carry points (..., 3) from the fixed frame to the gear turned by `rotation` [rad]."""
        placed: Array = (points - self.origin) @ self.axes
        return turned(placed, -np.asarray(rotation))

    def to_space(self, points: Array, rotation: Array | float) -> Array:
        """Carry points (..., 3) from the gear turned by `rotation` [rad] to the fixed frame."""
        placed: Array = turned(points, rotation) @ self.axes.T + self.origin
        return placed


def fixed() -> Placement:
    """The fixed frame itself, in which every driver stands."""
    return Placement(np.zeros(3), np.eye(3))


def turned(points: Array, angle: Array | float) -> Array:
    """Points (..., 3) turned about z by angles (...) [rad]."""
    x, y, z = np.moveaxis(points, -1, 0)
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * x - s * y, s * x + c * y, z], axis=-1)


def about_y(angle: float) -> Array:
    """Rotation matrix about y."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def about_x(angle: float) -> Array:
    """Rotation matrix about x."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
