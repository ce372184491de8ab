"""A point of a tooth flank with all that contact needs to know of it."""

from __future__ import annotations

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

    def turned(self, rotation: Array, origin: Array) -> Patch:
        """The patch carried to another frame: x ↦ rotation x + origin."""
        if not np.array_equal(rotation, np.eye(3)):
            vectors = (getattr(self, name) @ rotation.T for name in self.__dataclass_fields__)
            moved = Patch(*vectors)
        else:
            moved = self
        return Patch(
            moved.point + origin,
            moved.normal,
            moved.point_a,
            moved.point_b,
            moved.normal_a,
            moved.normal_b,
        )

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


def solve_2(
    first: tuple[Array, Array], second: tuple[Array, Array], right_1: Array, right_2: Array
) -> tuple[Array, Array]:
    """Solve stacked systems of two equations, given by their rows."""
    (a, b), (c, d) = first, second
    area = a * d - b * c
    return (d * right_1 - b * right_2) / area, (a * right_2 - c * right_1) / area


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
    second = np.cross(driver.normal, first)
    change_1 = driver.normal_change(first) + driven.normal_change(first)
    change_2 = driver.normal_change(second) + driven.normal_change(second)
    k11, k22 = dot(first, change_1), dot(second, change_2)
    k12 = 0.5 * (dot(first, change_2) + dot(second, change_1))
    greatest = 0.5 * np.arctan2(2.0 * k12, k11 - k22)
    minor = np.cos(greatest)[..., None] * first + np.sin(greatest)[..., None] * second
    return np.cross(minor, driver.normal), minor
