"""A point of a tooth flank with all that contact needs to know of it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from loadshare.tooth.body import Array


@dataclass(frozen=True, eq=False)
class Patch:
    """Points of a flank X(a, b), with first derivatives of position and normal.

    Parameters
    ----------
    point : array (..., 3)
        Position [m].
    normal : array (..., 3)
        Unit vector out of the tooth.
    point_a, point_b : array (..., 3)
        Derivatives of the position with respect to the two surface parameters.
    normal_a, normal_b : array (..., 3)
        Derivatives of the unit normal.
    """

    point: Array
    normal: Array
    point_a: Array
    point_b: Array
    normal_a: Array
    normal_b: Array

    @classmethod
    def spun(cls, components: Sequence[Iterable[Array | float]], angle: Array) -> Patch:
        """A patch whose vectors have the components (x, y, z), turned about z by angles [rad]."""
        vectors = np.empty((6, 3, *angle.shape))
        cosine, sine = np.cos(angle), np.sin(angle)
        for vector, (x, y, z) in zip(vectors, components, strict=True):
            vector[0] = cosine * x - sine * y
            vector[1] = sine * x + cosine * y
            vector[2] = z
        return cls(*(_last(vector) for vector in vectors))

    def turned(self, rotation: Array, origin: Array) -> Patch:
        """The patch carried to another frame: x ↦ rotation x + origin."""
        names = list(self.__dataclass_fields__)
        vectors = [getattr(self, name) for name in names]
        if not np.array_equal(rotation, np.eye(3)):
            vectors = [vector @ rotation.T for vector in vectors]
        return Patch(vectors[0] + origin, *vectors[1:])

    def normal_change(self, direction: Array) -> Array:
        """Change of the unit normal per length along tangential directions.

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
        a, b = self.point_a, self.point_b
        ab = dot(a, b)
        along_a, along_b = solve_2(
            (dot(a, a), ab), (ab, dot(b, b)), dot(a, direction), dot(b, direction)
        )
        return along_a[..., None] * self.normal_a + along_b[..., None] * self.normal_b


def dot(first: Array, second: Array) -> Array:
    """Scalar products along the last axis."""
    product: Array = np.einsum("...i,...i->...", first, second)
    return product


def cross(first: Array, second: Array) -> Array:
    """Vector products along the last axis."""
    a, b, c = first[..., 0], first[..., 1], first[..., 2]
    d, e, f = second[..., 0], second[..., 1], second[..., 2]
    product = np.empty((3, *np.broadcast_shapes(a.shape, d.shape)))
    product[0] = b * f - c * e
    product[1] = c * d - a * f
    product[2] = a * e - b * d
    return _last(product)


def _last(vectors: Array) -> Array:
    """Components (3, ...) as the last axis."""
    return vectors.transpose(*range(1, vectors.ndim), 0)


def solve_2(
    first: tuple[Array, Array], second: tuple[Array, Array], right_1: Array, right_2: Array
) -> tuple[Array, Array]:
    """Solve stacked systems of two equations, given by their rows."""
    (a, b), (c, d) = first, second
    area = a * d - b * c
    return (d * right_1 - b * right_2) / area, (a * right_2 - c * right_1) / area


def solve_3(first: Array, second: Array, third: Array, right: Array) -> tuple[Array, Array, Array]:
    """Solve stacked systems of three equations, given by their columns (..., 3).

    A singular system gives infinite or undefined numbers.
    """
    across = cross(first, second)
    with np.errstate(divide="ignore", invalid="ignore"):
        over = 1.0 / dot(across, third)
        beside = cross(right, third)
        return -dot(beside, second) * over, dot(beside, first) * over, dot(across, right) * over


def unit(vectors: Array) -> Array:
    """Vectors of length one."""
    return vectors / np.sqrt(dot(vectors, vectors))[..., None]


def relative_curvature(driver: Patch, driven: Patch, direction: Array) -> Array:
    """Curvature of the gap between two touching flanks in a unit tangent direction [1/m].

    Both flanks count as positive where they are convex, so that two convex flanks add up.
    """
    return dot(direction, driver.normal_change(direction) + driven.normal_change(direction))


def principal_directions(driver: Patch, driven: Patch) -> tuple[Array, Array]:
    """Directions of least and of greatest relative curvature at points of contact.

    The first is the major axis of the contact ellipse.

    Returns
    -------
    major, minor : array (..., 3)
        Unit tangents of the driver's flank, major × minor = normal.
    """
    first = unit(driver.point_a)
    second = cross(driver.normal, first)
    change_1 = driver.normal_change(first) + driven.normal_change(first)
    change_2 = driver.normal_change(second) + driven.normal_change(second)
    k11, k22 = dot(first, change_1), dot(second, change_2)
    k12 = 0.5 * (dot(first, change_2) + dot(second, change_1))
    greatest = 0.5 * np.arctan2(2.0 * k12, k11 - k22)
    minor = np.cos(greatest)[..., None] * first + np.sin(greatest)[..., None] * second
    return cross(minor, driver.normal), minor
