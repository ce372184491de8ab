"""Points of tooth flanks with their normals and derivatives, and vector algebra for them."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from loadshare.tooth.geometry.body import Array


@dataclass(frozen=True, eq=False)
class Patch:
    """Points of a flank X(a, b), with first derivatives of position and normal.

    Parameters
    ----------
    components : array (6, 3, ...)
        `vectors` with the components on axis 1, so that one product rotates all six vectors.
    """

    components: Array

    @cached_property
    def vectors(self) -> Array:
        """Position, unit normal, and derivatives of both with respect to a and b (6, ..., 3)."""
        return np.moveaxis(self.components, 1, -1)

    @property
    def point(self) -> Array:
        """Positions (..., 3) [m]."""
        return np.asarray(self.vectors[0])

    @property
    def normal(self) -> Array:
        """Unit vectors (..., 3) out of the tooth."""
        return np.asarray(self.vectors[1])

    @property
    def rays(self) -> Array:
        """Derivatives (2, ..., 3) of the position with respect to both surface parameters."""
        return self.vectors[2:4]

    @property
    def bends(self) -> Array:
        """Derivatives (2, ..., 3) of the unit normal with respect to both surface parameters."""
        return self.vectors[4:6]

    def turned(self, rotation: Array, origin: Array | None = None) -> Patch:
        """Return the patch in another frame: x ↦ rotation x + origin."""
        shape = self.components.shape
        components = (rotation @ self.components.reshape(6, 3, -1)).reshape(shape)
        if origin is not None:
            components[0] += origin.reshape(3, *[1] * (len(shape) - 2))
        return Patch(components)

    def normal_change(self, direction: Array) -> Array:
        """Return the change of the unit normal per length along tangential directions.

        This is Weingarten's map. The curvature of the flank in a unit tangent t is
        t·(change along t), positive where the flank is convex.

        Parameters
        ----------
        direction : array (..., 3)
            Directions; the part along the normal is ignored.

        Returns
        -------
        array (..., 3)
            Derivative of the normal [1/m] times the length of `direction`.
        """
        a, b = self.rays
        (aa, ab), bb = dot(self.rays, a), dot(b, b)
        along = solve_2((aa, ab), (ab, bb), *dot(self.rays, direction))
        change = along[0][..., None] * self.bends[0] + along[1][..., None] * self.bends[1]
        return np.asarray(change)


def patch(fill: Callable[..., None], numbers: tuple[Any, ...], *at: Array | float) -> Patch:
    """Return points at surface parameters a, b and rotations [rad], broadcast together.

    Parameters
    ----------
    fill : callable
        Compiled function that fills points (6, 3, n) from a flank's numbers and parameters (n,).
    numbers : tuple
        Numbers of the flank.
    *at : array or float
        a, b and the rotations.
    """
    parameters = np.broadcast_arrays(*at)
    components = np.empty((6, 3, parameters[0].size))
    fill(numbers, *(np.array(part, float, order="C").ravel() for part in parameters), components)
    return Patch(components.reshape(6, 3, *parameters[0].shape))


def dot(first: Array, second: Array) -> Array:
    """Return scalar products along the last axis."""
    product: Array = np.einsum("...i,...i->...", first, second)
    return product


def solve_2(
    first: Iterable[Array], second: Iterable[Array], right_1: Array, right_2: Array
) -> tuple[Array, Array]:
    """Solve stacked systems of two equations, given by their rows."""
    (a, b), (c, d) = first, second
    area = a * d - b * c
    return (d * right_1 - b * right_2) / area, (a * right_2 - c * right_1) / area


def solve_3(first: Array, second: Array, third: Array, right: Array) -> tuple[Array, Array, Array]:
    """Solve stacked systems of three equations, given by their columns (..., 3).

    A singular system gives infinite or undefined numbers.
    """
    across = np.cross(first, second)
    with np.errstate(divide="ignore", invalid="ignore"):
        over = 1.0 / dot(across, third)
        beside = np.cross(right, third)
        return -dot(beside, second) * over, dot(beside, first) * over, dot(across, right) * over


def unit(vectors: Array) -> Array:
    """Normalise vectors."""
    return vectors / np.sqrt(dot(vectors, vectors))[..., None]


def relative_curvature(driver: Patch, driven: Patch, direction: Array) -> Array:
    """Return the curvature [1/m] of the gap between touching flanks in a unit tangent direction.

    Curvature is positive where a flank is convex, so the curvatures of two convex flanks add.
    """
    return dot(direction, driver.normal_change(direction) + driven.normal_change(direction))


def principal_directions(driver: Patch, driven: Patch) -> tuple[Array, Array]:
    """Return the directions of least and greatest relative curvature at points of contact.

    The first is the major axis of the contact ellipse.

    Returns
    -------
    major, minor : array (..., 3)
        Unit tangents of the driver's flank, major × minor = normal.
    """
    first = unit(driver.rays[0])
    second = np.cross(driver.normal, first)
    change_1 = driver.normal_change(first) + driven.normal_change(first)
    change_2 = driver.normal_change(second) + driven.normal_change(second)
    k11, k22 = dot(first, change_1), dot(second, change_2)
    k12 = 0.5 * (dot(first, change_2) + dot(second, change_1))
    greatest = 0.5 * np.arctan2(2.0 * k12, k11 - k22)
    minor = np.cos(greatest)[..., None] * first + np.sin(greatest)[..., None] * second
    return np.cross(minor, driver.normal), minor
