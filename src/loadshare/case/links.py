"""Elements that join or hold gears: shafts, clearance splines, limit rings, bearings."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated, Literal

from pydantic import ConfigDict, Field, Strict, Tag

from loadshare.case.element import (
    LIMITS,
    LIST,
    TABLE,
    VALUE,
    Element,
    OneOrMore,
    Rule,
    T,
    shaped,
    values,
    without_default,
)
from loadshare.case.quantity import (
    ANGLE,
    BALL_STIFFNESS,
    FORCE,
    LENGTH,
    ROLLER_STIFFNESS,
    STIFFNESS,
    TORSIONAL_STIFFNESS,
    Angle,
    Distance,
    Length,
    Modulus,
    PositiveStiffness,
    Quantity,
    Radius,
)
from loadshare.case.rolling import BALL, ROLLER, bearing_coefficient
from loadshare.numbers import counted
from loadshare.settings import ALLOWED

PerSection = Annotated[OneOrMore[T], shaped("a length, or a list of them, one per section")]
"""A length of a shaft, or those of its sections."""

BEARING_LAWS = ("stiffness", "ball_stiffness", "roller_stiffness", "rolling")
"""Keys of the law of a bearing beyond its clearance."""
STEEPEST_CONTACT = Quantity("75 deg", math.radians(75.0))
RigidOr = Quantity | Literal["rigid"]
TORSION, WALL = (s.bounded(above=0).or_words("rigid") for s in (TORSIONAL_STIFFNESS, STIFFNESS))
Load = Annotated[Quantity, FORCE.bounded(at_least=0)]


class Shaft(Element):
    """A torsion shaft between two gears."""

    ends: tuple[str, str] = Field(default=("", ""), json_schema_extra=without_default)
    """The two gears that it joins; taken from the shaft's name when left out."""

    stiffness: Annotated[RigidOr, TORSION] | None = None
    """Torsional stiffness [torque/angle], or rigid; else it follows from diameter and length."""

    diameter: PerSection[Radius] | None = None
    """Outer diameter, of a stepped shaft those of its sections [length]."""

    length: PerSection[Radius] | None = None
    """Length between the gears, of a stepped shaft those of its sections [length]."""

    bore: PerSection[Distance] = Quantity("0 mm", 0.0)
    """Diameter of its bore, for all sections or each [length]."""

    shear_modulus: Modulus = Quantity("79.3 GPa", 79.3e9)
    """Shear modulus, that of steel when left out [force/area]."""

    ALTERNATIVES = ((("stiffness",), ("diameter", "length", "bore", "shear_modulus")),)

    clocking: Angle = Quantity("0 rad", 0.0)
    """Angle by which the second end lags the first when unloaded [angle]."""

    def rules(self) -> Iterator[Rule]:
        """Yield the broken rules on stiffness and dimensions."""
        sizes = [key for key in ("diameter", "length") if getattr(self, key) is not None]
        if self.stiffness is not None:
            for key in ("diameter", "length", "bore", "shear_modulus"):
                if key in self.model_fields_set:
                    yield Rule.exclusive(key, "stiffness")
            return
        if not sizes:
            hint = "Or give diameter and length."
            yield Rule("is missing", ("stiffness",), TORSION.allowed, hint)
            return
        for key in {"diameter", "length"} - set(sizes):
            yield Rule.required(key, sizes[0], LENGTH.allowed)
        if self.diameter is None or self.length is None:
            return
        outer, inner = values(self.diameter), values(self.bore)
        for key, given in (("length", values(self.length)), ("bore", inner)):
            if len(given) != len(outer) and not (key == "bore" and len(given) == 1):
                yield Rule(f"has {counted(len(given))}, but diameter has {len(outer)}", (key,))
                return
        if any(inner[k % len(inner)] >= d for k, d in enumerate(outer)):
            yield Rule("leaves no shaft: it is not below the diameter", ("bore",))

    @property
    def torsional_stiffness(self) -> float:
        """Torsional stiffness [N·m/rad], infinite where rigid.

        If not given, it is that of the sections in series, each G π (d⁴ − d_i⁴)/(32 l).
        """
        if self.stiffness is not None:
            return math.inf if isinstance(self.stiffness, str) else self.stiffness.si
        if self.diameter is None or self.length is None:
            raise ValueError("a shaft without stiffness")
        outer, lengths, inner = (values(v) for v in (self.diameter, self.length, self.bore))
        compliance = sum(
            32.0 * long / (math.pi * (d**4 - inner[k % len(inner)] ** 4))
            for k, (d, long) in enumerate(zip(outer, lengths, strict=True))
        )
        return self.shear_modulus.si / compliance


class Spline(Element):
    """A clearance spline on a gear: it sticks, then slips, then its clearance is used up."""

    bending_stiffness: PositiveStiffness
    """Bending stiffness of the spline shaft, K_w [force/length]."""

    clearance: Distance
    """Displacement at which the clearance is used up, S2 [length]."""

    stick_limit: Distance | None = None
    """Displacement up to which the spline sticks, S1 [length]; F_m / K_w when left out.

    It must not exceed the clearance. If it is left out, a clearance below F_m / K_w closes before
    friction is overcome: the spline then acts as a spring K_w throughout, which results call stick.
    """

    friction_force: Load | None = None
    """Friction bound given directly, F_m [force]."""

    friction: Annotated[float, Strict(), Field(ge=0, le=ALLOWED.friction)] | None = None
    """Coefficient of friction [-]; goes with `normal_force` or `radius`."""

    normal_force: Load | None = None
    """Normal force of the spline, F_N [force]; the friction bound is `friction` times this force.
    """

    radius: Radius | None = None
    """Radius at which the torque acts on the spline [length]: F_N = torque / radius."""

    ALTERNATIVES = ((("friction_force",), ("friction", "normal_force", "radius")),)

    def rules(self) -> Iterator[Rule]:
        """Yield the broken rules on how the friction is given."""
        allowed = "friction_force; friction and normal_force; or friction and radius"
        ways = [{"friction_force"}, {"friction", "normal_force"}, {"friction", "radius"}]
        given = self.given("friction_force", "friction", "normal_force", "radius")
        if not given:
            yield Rule("has no friction bound", allowed=allowed)
        elif set(given) not in ways:
            yield Rule(
                f"has an incomplete or ambiguous friction bound: {', '.join(given)}",
                allowed=allowed,
            )

    @property
    def fixed_bound(self) -> float | None:
        """Friction bound F_m [N], or None where it follows the torque."""
        if self.friction_force is not None:
            return self.friction_force.si
        if self.friction is not None and self.normal_force is not None:
            return self.friction * self.normal_force.si
        return None


class Range(Element):
    """A float range to either side."""

    up: Distance
    """Float up, to the left of the line from the first neighbour to the second [length]."""

    down: Distance
    """Float down, to the right of the line from the first neighbour to the second [length]."""


class Backlashes(Element):
    """A float range given by the backlashes that the float has to take up."""

    upward: Annotated[tuple[str, ...], Field(min_length=1)]
    """Meshes whose backlashes the float takes up on its way up."""

    downward: Annotated[tuple[str, ...], Field(min_length=1)]
    """Meshes whose backlashes the float takes up on its way down."""


class Ring(Element):
    """A limit ring on a gear: a drum between two neighbours, or a circle."""

    model_config = ConfigDict(validate_by_name=False, validate_by_alias=True)

    neighbours: tuple[str, str] | None = None
    """Drum: the two gears whose rings it rolls on; up is left of the line from first to second."""

    clearance: Annotated[
        Annotated[Distance, Tag(VALUE)] | Annotated[tuple[Distance, Distance], Tag(LIST)],
        shaped("a length, or a list of 2 lengths, one per neighbour"),
    ] = Quantity("0 um", 0.0)
    """Drum: gap between the rings [length], for both neighbours or each."""

    float_: (
        Annotated[
            Annotated[Distance, Tag(VALUE)]
            | Annotated[Range, Tag(TABLE)]
            | Annotated[Backlashes, Tag(LIMITS)],
            shaped(
                "a length, a table of up and down, or a table of upward and downward meshes",
                limits=("upward", "downward"),
            ),
        ]
        | None
    ) = Field(default=None, alias="float")
    """Drum: float across the line of the neighbours, the same up and down [length]; or each of the
    two, or the meshes whose backlashes set them."""

    radius: Distance | None = None
    """Circle: radius of the disc in which the centre may move [length]."""

    offset: tuple[Length, Length] = (Quantity("0 mm", 0.0), Quantity("0 mm", 0.0))
    """Circle: centre of the disc, relative to the gear's centre [length]."""

    stiffness: Annotated[RigidOr, WALL] = "rigid"
    """Stiffness of the ring [force/length], or rigid."""

    measured: Literal["assembled", "nominal"] = "assembled"
    """Whether the clearance is that of the gears with their errors, or without."""

    ALTERNATIVES = ((("neighbours", "float", "clearance"), ("radius", "offset")),)

    def rules(self) -> Iterator[Rule]:
        """Yield the broken rules on the two forms, drum and circle."""
        forms = "drum (neighbours, float, clearance) or circle (radius, offset)"
        names = ("neighbours", "float_", "clearance")
        drum = [name.rstrip("_") for name in names if name in self.model_fields_set]
        circle = [key for key in ("radius", "offset") if key in self.model_fields_set]
        if drum and circle:
            yield Rule(f"mixes two forms: {', '.join(drum)}; {', '.join(circle)}", allowed=forms)
        elif not drum and not circle:
            yield Rule("is neither a drum nor a circle", allowed=forms)
        elif drum and self.neighbours is None:
            yield Rule("is missing", ("neighbours",), "a list of 2 gears")
        elif drum and self.float_ is None:
            yield Rule("is missing", ("float",), LENGTH.allowed)
        elif circle and self.radius is None:
            yield Rule("is missing", ("radius",), LENGTH.allowed)


class RollingElements(Element):
    """The balls or rollers of a bearing, which determine its law after Palmgren."""

    balls: Annotated[int, Strict(), Field(ge=3)] | None = None
    """Number of balls [-]."""

    rollers: Annotated[int, Strict(), Field(ge=3)] | None = None
    """Number of rollers in all rows [-]."""

    diameter: Radius | None = None
    """Diameter of a ball [length]."""

    length: Radius | None = None
    """Effective length of a roller [length]."""

    contact_angle: Annotated[Quantity, ANGLE.bounded(at_least=0, at_most=STEEPEST_CONTACT)] = (
        Quantity("0 deg", 0.0)
    )
    """Angle between the line of contact and the radial plane [angle]."""

    def rules(self) -> Iterator[Rule]:
        """Yield the broken rules on the elements."""
        kinds = self.given("balls", "rollers")
        if len(kinds) != 1:
            allowed = "balls and diameter, or rollers and length"
            yield Rule("needs either balls or rollers", allowed=allowed)
            return
        needed, idle = ("diameter", "length") if kinds == ["balls"] else ("length", "diameter")
        if getattr(self, needed) is None:
            yield Rule.required(needed, kinds[0], LENGTH.allowed)
        if getattr(self, idle) is not None:
            yield Rule(f"does not apply to {kinds[0]}", (idle,))

    @property
    def law(self) -> tuple[float, float]:
        """K [N/m^power] and the power of F = K δ^power."""
        count = self.balls or self.rollers or 0
        size = self.diameter or self.length
        if size is None:
            raise ValueError("rolling elements without a size")
        kind: Literal["ball", "roller"] = "ball" if self.balls else "roller"
        coefficient = bearing_coefficient(kind, count, size.si, size.si, self.contact_angle.si)
        return coefficient, BALL if self.balls else ROLLER


class Bearing(Element):
    """A bearing with radial clearance: it holds its gear where the clearance ends."""

    clearance: Distance
    """Radial clearance [length]: how far the centre moves before the bearing holds it."""

    stiffness: Annotated[RigidOr, WALL] | None = None
    """Stiffness beyond the clearance [force/length], or rigid."""

    ball_stiffness: Annotated[Quantity, BALL_STIFFNESS.bounded(above=0)] | None = None
    """K of a ball bearing, F = K δ^(3/2) beyond the clearance [force/length^(3/2)]."""

    roller_stiffness: Annotated[Quantity, ROLLER_STIFFNESS.bounded(above=0)] | None = None
    """K of a roller bearing, F = K δ^(10/9) beyond the clearance [force/length^(10/9)]."""

    rolling: RollingElements | None = None
    """Balls or rollers whose number and size determine the law."""

    offset: tuple[Length, Length] = (Quantity("0 mm", 0.0), Quantity("0 mm", 0.0))
    """Centre of the bearing, relative to the gear's centre [length]."""

    diameter: Radius | None = None
    """Mean diameter, with which its clearance changes as shaft and housing expand [length]."""

    ALTERNATIVES = (tuple((law,) for law in BEARING_LAWS),)

    def rules(self) -> Iterator[Rule]:
        """Yield the broken rules on the laws."""
        given = self.given(*BEARING_LAWS)
        if not given:
            yield Rule("is missing", ("stiffness",), f"one of {', '.join(BEARING_LAWS)}")
        elif len(given) > 1:
            yield Rule.exclusive(given[1], given[0])

    @property
    def wall(self) -> tuple[float, float]:
        """K [N/m^power] beyond the clearance, infinite for a rigid bearing, and the power."""
        if self.rolling is not None:
            return self.rolling.law
        if self.ball_stiffness is not None:
            return self.ball_stiffness.si, BALL
        if self.roller_stiffness is not None:
            return self.roller_stiffness.si, ROLLER
        return self.stiffness.si if isinstance(self.stiffness, Quantity) else math.inf, 1.0
