"""Places of the components of a REXS model, along their shafts and in the unit."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from loadshare.case.place import Vector, dot, minus
from loadshare.exchange.rexs.model import GEARS, Component, Model

FIRST = ("1", "1.0", "1.0.0")
"""Versions that give the beginning of a gear along its shaft, not its middle."""


@dataclass(frozen=True)
class Places:
    """Places and directions in a model.

    Attributes
    ----------
    model : Model
    """

    model: Model

    def of(self, body: Component) -> Vector | None:
        """Return the place of a component [m]; those of the components it refers to are added."""
        found: list[Vector] = []
        for part in self.chain(body):
            place = part.vector("support_vector")
            if place is None:
                break
            found.append(place)
        if not found:
            return None
        x, y, z = (sum(parts) for parts in zip(*reversed(found), strict=True))
        return (x, y, z)

    def chain(self, body: Component) -> list[Component]:
        """Return a component and those to which its position refers, one after the other.

        The unit is not among them. The last one is a repetition if they refer in a circle.
        """
        found, passed = [body], {body.id}
        while (other := self._reference(found[-1])) is not None:
            found.append(other)
            if other.id in passed:
                break
            passed.add(other.id)
        return found

    def is_referred(self, body: Component) -> bool:
        """Return whether a component's position is relative to a component other than the unit."""
        return self._reference(body) is not None

    def reference_id(self, body: Component) -> str:
        """Return the id of the component to which a position refers; empty if it gives none."""
        reference = body.attributes.get("reference_component_for_position", "")
        number = isinstance(reference, float) and reference.is_integer()
        return f"{reference:.0f}" if number else str(reference)

    def _reference(self, body: Component) -> Component | None:
        other = self.model.components.get(self.reference_id(body))
        return None if other is None or other is body or other.type == "gear_unit" else other

    def along(self, part: Component, shaft: Component, side: str = "") -> float | None:
        """Return the place of a part's middle along a shaft [m], from the start of the shaft.

        Parameters
        ----------
        part : Component
            A gear, a load, a bearing or a coupling.
        shaft : Component
        side : str
            Side of a bearing or coupling on which the shaft is: "inner" or "outer".

        Returns
        -------
        float or None
            From the places of both in the unit, which mean the same in all versions, if both are
            given, unless one is relative to another component and there is a coordinate along the
            shaft; else from that coordinate. None without either.
        """
        here, start = self.of(part), self.of(shaft)
        name = f"u_coordinate_on_shaft_{side}_side" if side else "u_coordinate_on_shaft"
        coordinate = part.number(name)
        referred = self.is_referred(part) or self.is_referred(shaft)
        if here is not None and start is not None and (coordinate is None or not referred):
            return dot(minus(here, start), self.axis(shaft))
        if coordinate is not None and part.type in GEARS and self.model.version in FIRST:
            return coordinate + 0.5 * (part.number("face_width") or 0.0)
        return coordinate

    def off_axis(self, part: Component, shaft: Component) -> float:
        """Return the distance of a part from the axis of a shaft [m]; 0 if a place is not given."""
        here, start = self.of(part), self.of(shaft)
        if here is None or start is None:
            return 0.0
        apart, axis = minus(here, start), self.axis(shaft)
        return math.dist(apart, tuple(dot(apart, axis) * a for a in axis))

    def on_axis(self, shaft: Component, along: float) -> Vector | None:
        """Return a place along a shaft, in the unit [m]; None if the shaft's place is not given."""
        start = self.of(shaft)
        if start is None:
            return None
        x, y, z = (p + along * a for p, a in zip(start, self.axis(shaft), strict=True))
        return (x, y, z)

    def axis(self, *bodies: Component | None) -> Vector:
        """Return the unit direction u of the first component that gives one; x if none does."""
        for body in bodies:
            axis = body.vector("u_axis_vector") if body is not None else None
            if axis is not None:
                # The unit of measurement of a direction means nothing.
                size = math.hypot(*axis)
                return (axis[0] / size, axis[1] / size, axis[2] / size)
        return (1.0, 0.0, 0.0)

    def are_parallel(self, one: Component, other: Component) -> bool:
        """Return whether two components have parallel axes; also True if one gives none."""
        return abs(dot(self.axis(one, other), self.axis(other, one))) > 1.0 - 1e-9

    def across(self, *bodies: Component) -> tuple[np.ndarray, np.ndarray]:
        """Return the directions v and w, of length 1 and square to u, of the first that gives w.

        Without any, w is z, or x where u is nearer to z.
        """
        u = np.array(self.axis(*bodies))
        given = [w for body in bodies if (w := body.vector("w_axis_vector")) is not None]
        for w in (*given, (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)):
            square = np.array(w) - np.dot(w, u) * u
            size = float(np.linalg.norm(square))
            if size > 0.5 * math.hypot(*w) > 0.0:
                return np.cross(square / size, u), square / size
        raise AssertionError("one of two directions square to each other is square enough to u")


def ahead(there: Vector, here: Vector, axis: Vector) -> float:
    """Return how far a place lies ahead of another along an axis [m]."""
    return dot(minus(there, here), axis)
