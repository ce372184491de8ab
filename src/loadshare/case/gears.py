"""Gears, where they stand and what is wrong with where they stand."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal

from pydantic import Field, Strict, Tag

from loadshare.case.element import LIST, TABLE, VALUE, Element, Number, Rule, shaped
from loadshare.case.quantity import (
    LENGTH,
    STIFFNESS,
    Angle,
    Distance,
    Length,
    PositiveStiffness,
    Quantity,
    Radius,
)

Components = Annotated[tuple[Length, ...], Field(min_length=2, max_length=3), Tag(LIST)]


class Polar(Element):
    """A centre given by distance and angle from another gear."""

    about: str | None = None
    """Gear whose centre is the pole; the origin when left out."""

    distance: Distance
    """Distance from the pole in the x-y plane [length]."""

    angle: Angle
    """Direction from the pole, counter-clockwise from the x axis [angle]."""

    height: Length = Quantity("0 mm", 0.0)
    """Offset from the pole along z [length]."""


class Gear(Element):
    """A gear: a rigid body with a centre, an axis and a base circle."""

    type: Literal["external", "internal", "face"] = "external"
    """Kind of teeth: external, internal or face."""

    centre: Annotated[
        Components | Annotated[Polar, Tag(TABLE)],
        shaped("a list of 2 or 3 lengths, or a table of distance, angle, about, height"),
    ]
    """Centre: x, y and, where it matters, z [length]; or distance and angle from another gear."""

    axis: Annotated[
        Annotated[Literal["x", "y", "z"], Tag(VALUE)]
        | Annotated[tuple[Number, Number, Number], Tag(LIST)],
        shaped("x, y, z, or a list of 3 numbers"),
    ] = "z"
    """Direction of the axis: x, y, z, or three components [-]."""

    base_radius: Radius | None = None
    """Base radius; of a face gear the acting radius [length]."""

    inner_radius: Radius | None = None
    """Inner radius of a face gear's teeth [length]."""

    outer_radius: Radius | None = None
    """Outer radius of a face gear's teeth [length]."""

    teeth: Annotated[int, Strict(), Field(ge=5)] | None = None
    """Number of teeth [-]; sets how far gears turn in a cycle and what position they reach."""

    support: (
        Annotated[
            Annotated[
                Literal["rigid", "free"] | Quantity,
                STIFFNESS.bounded(above=0).or_words("rigid", "free"),
                Tag(VALUE),
            ]
            | Annotated[tuple[PositiveStiffness, PositiveStiffness], Tag(LIST)],
            shaped('"rigid", "free", a stiffness such as "5.5e8 N/m", or a list of 2 of them'),
        ]
        | None
    ) = None
    """Bearing: rigid, free, or a stiffness for both or each of two directions [force/length].

    Left out: free for a gear with a spline or a ring, rigid for any other.
    """

    def rules(self) -> Iterator[Rule]:
        """Yield what does not hold of the radii and the axis."""
        radii = self.given("inner_radius", "outer_radius")
        if radii and self.type != "face":
            yield Rule("is for face gears only", (radii[0],), hint="Give base_radius.")
        elif radii and self.base_radius is not None:
            yield Rule("stands beside base_radius: give one or the other", (radii[0],))
        elif len(radii) == 1:
            missing = "outer_radius" if radii == ["inner_radius"] else "inner_radius"
            yield Rule("is missing", (missing,), hint=f"It goes with {radii[0]}.")
        elif not radii and self.base_radius is None:
            both = "inner_radius and outer_radius"
            hint = f"Or give {both}." if self.type == "face" else ""
            yield Rule("is missing", ("base_radius",), LENGTH.allowed, hint)
        elif (
            self.inner_radius and self.outer_radius and self.inner_radius.si >= self.outer_radius.si
        ):
            yield Rule("is not below outer_radius", ("inner_radius",))
        if not isinstance(self.axis, str) and not any(self.axis):
            yield Rule("has no direction", ("axis",), "x, y, z, or a list of 3 numbers, not all 0")

    @property
    def acting_radius(self) -> float:
        """Lever arm of the tooth force [m]: the base radius, of a face gear also (L1 + L2)/2."""
        if self.base_radius is not None:
            return self.base_radius.si
        if self.inner_radius is None or self.outer_radius is None:
            raise ValueError("a gear without radii")
        return (self.inner_radius.si + self.outer_radius.si) / 2


class Offset(Element):
    """An installation error given by size and direction."""

    amount: Distance
    """Size of the offset [length]."""

    direction: Angle
    """Direction of the offset, counter-clockwise from the x axis against the axis [angle]."""


class Eccentricity(Element):
    """A manufacturing error: the offset of the base circle, which turns with the gear."""

    amount: Distance
    """Size of the offset [length]."""

    direction: Angle = Quantity("0 deg", 0.0)
    """Direction of the offset on the gear [angle]."""

    phase: Angle = Quantity("0 deg", 0.0)
    """Further angle of the eccentricity at the first position, beside its direction [angle]."""


class Errors(Element):
    """The errors of one gear; each moves its centre without costing energy."""

    installation: (
        Annotated[
            Components | Annotated[Offset, Tag(TABLE)],
            shaped("a list of 2 or 3 lengths, or a table of amount and direction"),
        ]
        | None
    ) = None
    """Fixed offset of the centre: components, or size and direction [length]."""

    eccentricity: Eccentricity | None = None
    """Offset that turns with the gear: amount [length], direction and phase [angle]."""
