"""Gears and carriers: teeth, bodies and positions."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, Strict, Tag

from loadshare.case.element import (
    LIST,
    NESTED,
    TABLE,
    VALUE,
    Element,
    NotNegative,
    Number,
    Positive,
    Rule,
    shaped,
)
from loadshare.case.quantity import (
    ANGLE,
    LENGTH,
    STIFFNESS,
    Angle,
    Density,
    Distance,
    Expansion,
    Length,
    Mass,
    PositiveStiffness,
    Quantity,
    Radius,
    Stiffness,
    Temperature,
    refusal,
)
from loadshare.involute import InvoluteTooth
from loadshare.settings import ALLOWED

OF_TEETH = (
    "pressure_angle",
    "helix_angle",
    "profile_shift",
    "face_width",
    "addendum",
    "dedendum",
    "tip_alteration",
    "thickness_allowance",
    "tolerance_class",
    "web",
    "rim",
    "bore",
    "density",
    "tip_radius",
    "outside_diameter",
    "ovalisation",
)
"""Keys of a gear that describe its teeth, besides their number and module."""
USUAL_TEETH = {
    "pressure_angle": math.radians(20.0),
    "helix_angle": 0.0,
    "profile_shift": 0.0,
    "addendum": 1.0,
    "dedendum": 1.25,
    "tip_alteration": 0.0,
    "thickness_allowance": 0.0,
}
"""Default shape of teeth, in SI units or modules."""
OF_A_GEAR = ("base_radius", "inner_radius", "outer_radius", "teeth", "module", *OF_TEETH)
"""Keys of a gear that a carrier does not have."""
STEEL_EXPANSION = 11.5e-6
"""Thermal expansion where none is given [1/K]."""
HARMONICS = 7
"""Largest number of harmonics of a rim: 2 to 8."""
YOUNG = 206e9
"""Young's modulus of steel [Pa]."""
COPIES = range(2, 33)
"""How many copies a gear may have."""
RADIUS_TOLERANCE = 1e-3
"""Largest relative difference between a given base radius and that of the teeth [-]."""
SYMMETRIC = 1e-9
"""Largest difference between the off-diagonal entries of a support, due to rounding in the file,
relative to the largest entry [-]."""
STEEPEST = Quantity("45 deg", math.radians(45))
STEEPEST_HELIX = math.radians(60)

Components = Annotated[tuple[Length, ...], Field(min_length=2, max_length=3), Tag(LIST)]


@dataclass(frozen=True, kw_only=True)
class Tooth(InvoluteTooth):
    """The teeth of a cylindrical gear, as `InvoluteTooth` has them."""

    module: float
    teeth: int
    pressure_angle: float
    helix_angle: float
    profile_shift: float
    addendum: float
    dedendum: float
    internal: bool
    thickness_allowance: float = 0.0


AXES = "x, y, z, or a list of 3 numbers"
AGAINST = {"-x": "[-1, 0, 0]", "-y": "[0, -1, 0]", "-z": "[0, 0, -1]"}
"""Axes for which there is no word, and how to give them."""


def _along(axis: Any) -> Any:
    """Return an axis as it was given; raise an error for the opposite of a word, such as -x."""
    if isinstance(axis, str) and axis in AGAINST:
        hint = f"The opposite of {axis[1]} is {AGAINST[axis]}."
        raise refusal("is not one of the allowed words", AXES, hint)
    return axis


def shortened(length: float) -> str:
    """Return a tip alteration [m] as text for a case file, rounded down to a micrometre."""
    return f'"{math.floor(1e6 * length) / 1e3:.7g} mm"'


class Polar(Element):
    """A centre given by distance and angle from another gear."""

    about: str | None = None
    """Gear whose centre is the pole; the origin when left out."""

    distance: Distance | None = None
    """Distance from the pole in the x-y plane [length].

    When left out, it is that at which the teeth mesh without backlash, with the pole or with a gear
    on its axis.
    """

    angle: Angle
    """Direction from the pole, counter-clockwise from the x axis [angle]."""

    height: Length = Quantity("0 mm", 0.0)
    """Offset from the pole along z [length]."""


class PinSupport(Element):
    """Stiffness of a planet's pin, relative to the carrier's axis."""

    radial: PositiveStiffness
    """Radial stiffness, outwards and inwards [force/length]."""

    tangential: PositiveStiffness
    """Tangential stiffness, about the carrier's axis [force/length]."""


class Gear(Element):
    """A gear: a rigid body with a centre, an axis and a base circle; or a carrier of planets."""

    type: Literal["external", "internal", "face", "carrier"] = "external"
    """Kind of teeth: external, internal or face; a carrier has none."""

    centre: Annotated[
        Components | Annotated[Polar, Tag(TABLE)],
        shaped("a list of 2 or 3 lengths, or a table of distance, angle, about, height"),
    ]
    """Centre: x, y and, where it matters, z [length]; or distance and angle from another gear."""

    axis: Annotated[
        Annotated[Literal["x", "y", "z"], BeforeValidator(_along), Tag(VALUE)]
        | Annotated[tuple[Number, Number, Number], Tag(LIST)],
        shaped(AXES),
    ] = "z"
    """Direction of the axis: x, y, z, or three components [-]."""

    copies: (
        Annotated[
            Annotated[int, Strict(), Field(ge=COPIES.start, lt=COPIES.stop), Tag(VALUE)]
            | Annotated[
                tuple[Angle, ...],
                Field(min_length=COPIES.start, max_length=COPIES.stop - 1),
                Tag(LIST),
            ],
            shaped("a number of copies, or a list of angles"),
        ]
        | None
    ) = None
    """Gears that this entry stands for: their number, or the angles of their rotation [angle].

    The gear p stands for p1, p2 and so on, at places rotated about its pole; directions, such as
    those of an axis, an offset or a support along x and y, are the same for all. A mesh s-p stands
    for s-p1, s-p2, and likewise shafts, splines, rings, bearings, errors and the meshes of stages.
    Keys given for single copies take precedence.
    """

    carrier: str | None = None
    """Carrier on whose pin a planet sits; the centre of any other gear is held by the housing.

    The planet's support, float and displacement are then relative to its pin.
    """

    held: Annotated[bool, Strict()] = False
    """Whether the housing keeps it from turning, like the ring gear of most planetary sets."""

    base_radius: Radius | None = None
    """Base radius; for a face gear, the acting radius [length]."""

    inner_radius: Radius | None = None
    """Inner radius of a face gear's teeth [length]."""

    outer_radius: Radius | None = None
    """Outer radius of a face gear's teeth [length]."""

    teeth: Annotated[int, Strict(), Field(ge=5, le=ALLOWED.teeth)] | None = None
    """Number of teeth [-]; determines how far gears turn in a cycle and at which position they are.
    """

    module: Radius | None = None
    """Normal module, which with `teeth` determines the base radius [length]."""

    pressure_angle: Annotated[Quantity, ANGLE.bounded(above=0, at_most=STEEPEST)] | None = None
    """Normal pressure angle of the rack; 20 deg when left out [angle]."""

    helix_angle: Angle | None = None
    """Helix angle at the reference circle, positive for a right-hand helix [angle]."""

    profile_shift: Number | None = None
    """Profile shift coefficient; positive for a thicker tooth, also for an internal gear [-]."""

    face_width: Radius | None = None
    """Face width of the teeth [length]."""

    addendum: Positive | None = None
    """Addendum of the rack in modules; 1 when left out [-]."""

    dedendum: Positive | None = None
    """Dedendum of the rack in modules; 1.25 when left out [-]."""

    tip_radius: NotNegative | None = None
    """Tip radius of the rack in modules, for `law = "ltca"`; 0.38 when left out [-]."""

    tip_alteration: Length | None = None
    """Change of the tooth height at the tip, negative if the tooth is shortened [length]."""

    thickness_allowance: (
        Annotated[Quantity, LENGTH.bounded(at_most=Quantity("0 um", 0.0))] | None
    ) = None
    """Allowance of the tooth thickness along the reference circle in the normal section, negative
    or 0, for `backlash = "teeth"` [length]."""

    tolerance_class: Annotated[int, Strict(), Field(ge=1, le=11)] | None = None
    """Flank tolerance class of ISO 1328-1:2013, 1 to 11, which determines the tolerances of pitch,
    profile, helix and runout [-]."""

    web: Radius | None = None
    """Web thickness of a gear with a thin web, for `law = "iso"` [length]."""

    rim: Radius | None = None
    """Thickness of the rim below the teeth [length]: for `law = "iso"`, that on a thin web; for
    `law = "ltca"`, that of the elastic body, by default 1.5 tooth heights or half the root radius.
    """

    ovalisation: (
        Annotated[
            Annotated[Literal["rim"], Tag(VALUE)]
            | Annotated[
                tuple[PositiveStiffness, ...], Field(min_length=1, max_length=HARMONICS), Tag(LIST)
            ],
            shaped('"rim", or a list of stiffnesses'),
        ]
        | None
    ) = None
    """Stiffness of an internal gear's rim against bending in the harmonics 2, 3, … [force/length];
    goes with `teeth` and `module`.

    rim: that of a thin steel ring with the `rim` and `face_width`, up to the eighth harmonic.
    """

    outside_diameter: Radius | None = None
    """Outside diameter of the body of an internal gear, which determines its rim [length]."""

    bore: Radius | None = None
    """Diameter of the bore of an external gear, which determines its rim [length]."""

    density: Density | None = None
    """Density of the body, which with the teeth determines its mass; 7850 kg/m^3 when left out
    [mass/length^3]."""

    mass: Mass | None = None
    """Mass of the body, in place of that which follows from teeth, face width and bore [mass]."""

    temperature: Temperature | None = None
    """Rise of the body's temperature above that at which it was made [temperature]."""

    expansion: Expansion | None = None
    """Thermal expansion of the body; 11.5e-6 /K, that of steel, when left out [1/temperature]."""

    support: (
        Annotated[
            Annotated[
                Literal["rigid", "free"] | Quantity,
                STIFFNESS.bounded(above=0).or_words("rigid", "free"),
                Tag(VALUE),
            ]
            | Annotated[tuple[PositiveStiffness, PositiveStiffness], Tag(LIST)]
            | Annotated[
                tuple[tuple[Stiffness, Stiffness], tuple[Stiffness, Stiffness]], Tag(NESTED)
            ]
            | Annotated[PinSupport, Tag(TABLE)],
            shaped(
                '"rigid", "free", a stiffness such as "5.5e8 N/m", a list of 2 of them, 2 lists, '
                "or of a planet a table of radial and tangential"
            ),
        ]
        | None
    ) = None
    """Bearing: rigid, free, or a stiffness for both or each of two directions [force/length].

    Two lists of 2 are a full matrix, for a bearing whose stiffest direction is neither x nor y. For
    a planet, radial and tangential stiffness relative to the carrier's axis may be given.

    When left out: free for a gear with a spline, a ring or a bearing with radial clearance, rigid
    for any other.
    """

    def rules(self) -> Iterator[Rule]:
        """Yield the broken rules on copies, support, rim, teeth, radii and axis."""
        if self.copies is not None:
            hint = "The copies are rotated about its pole, from its angle."
            yield Rule("needs a centre given by distance and angle", ("copies",), hint=hint)
        yield from self._support_rules()
        if self.type == "carrier":
            yield from self._carrier_rules()
            return
        yield from self._rim_rules()
        radii = self.given("inner_radius", "outer_radius")
        if self.module is not None or self.given(*OF_TEETH):
            yield from self._tooth_rules()
        if self.carrier is not None and self.type == "face":
            yield Rule("is for cylindrical planets only", ("carrier",))
        if radii and self.type != "face":
            yield Rule("is for face gears only", (radii[0],), hint="Give base_radius.")
        elif radii and self.base_radius is not None:
            yield Rule.exclusive(radii[0], "base_radius")
        elif len(radii) == 1:
            missing = "outer_radius" if radii == ["inner_radius"] else "inner_radius"
            yield Rule.required(missing, radii[0])
        elif not radii and self.base_radius is None and self.module is None:
            other = "inner_radius and outer_radius" if self.type == "face" else "module and teeth"
            hint = f"Or give {other}."
            yield Rule("is missing", ("base_radius",), LENGTH.allowed, hint)
        elif (
            self.inner_radius and self.outer_radius and self.inner_radius.si >= self.outer_radius.si
        ):
            yield Rule("is not below outer_radius", ("inner_radius",))
        yield from self._axis_rules()

    def _support_rules(self) -> Iterator[Rule]:
        if isinstance(self.support, PinSupport) and self.carrier is None:
            message, hint = "is for planets only", "Give the stiffnesses along x and y."
            yield Rule(message, ("support", "radial"), hint=hint)
        if not isinstance(self.support, tuple) or not isinstance(self.support[0], tuple):
            return
        (xx, xy), (yx, yy) = ((k.si for k in row) for row in self.support)
        if abs(xy - yx) > SYMMETRIC * max(map(abs, (xx, xy, yx, yy))):
            off = f"{xy:.10g} N/m and {yx:.10g} N/m are off its diagonal"
            yield Rule(f"is not symmetric: {off}", ("support",))
        elif xx <= 0.0 or xx * yy - (0.5 * (xy + yx)) ** 2 <= 0.0:
            yield Rule("is not positive in all directions", ("support",))

    def _rim_rules(self) -> Iterator[Rule]:
        if self.ovalisation is None:
            return
        if self.type != "internal":
            yield Rule("is for internal gears only", ("ovalisation",))
        elif isinstance(self.ovalisation, str):
            needed = {"rim": self.rim or self.outside_diameter, "face_width": self.face_width}
            for key in (key for key, value in needed.items() if value is None):
                yield Rule.required(key, "ovalisation", LENGTH.allowed)

    def _axis_rules(self) -> Iterator[Rule]:
        if not isinstance(self.axis, str) and not any(self.axis):
            yield Rule("has no direction", ("axis",), "x, y, z, or a list of 3 numbers, not all 0")

    def _carrier_rules(self) -> Iterator[Rule]:
        for key in self.given(*OF_A_GEAR):
            yield Rule("is for gears only: a carrier has no teeth", (key,))
        if self.carrier is not None:
            yield Rule("is for planets only: a carrier sits in the housing", ("carrier",))
        yield from self._axis_rules()

    def _tooth_rules(self) -> Iterator[Rule]:
        if self.type == "face":
            key = self.given("module", *OF_TEETH)[0]
            yield Rule("is for cylindrical gears only", (key,), hint="Give the gear's radii.")
            return
        for missing in ("module", "teeth"):
            if getattr(self, missing) is None:
                yield Rule.required(missing, self.given("module", *OF_TEETH)[0])
        if self.helix_angle is not None and abs(self.helix_angle.si) > STEEPEST_HELIX:
            yield Rule("is steeper than 60 deg", ("helix_angle",), ANGLE.allowed)
            return
        for key, kind in (("bore", "external"), ("outside_diameter", "internal")):
            if getattr(self, key) is not None and self.type != kind:
                yield Rule(f"is for {kind} gears only", (key,))
        if self.web is not None and self.rim is None:
            yield Rule.required("rim", "web", LENGTH.allowed)
        tooth = self.tooth
        if tooth is None:
            return
        if self.base_radius is not None:
            given, follows = self.base_radius.si, tooth.base_radius
            if abs(given - follows) > RADIUS_TOLERANCE * follows:
                teeth = f"that of the teeth is {1e3 * follows:.8g} mm"
                yield Rule(f"contradicts module and teeth: {teeth}", ("base_radius",))
        there = tooth.half_angle_at(tooth.transverse_angle) > 0.0
        if not there:
            key = next(iter(self.given("thickness_allowance", "profile_shift")), "module")
            yield Rule("leaves no tooth at the reference circle", (key,))
        if self.type == "external" and self.bore is not None and self.bore.si >= 2.0 * tooth.root:
            root = f"the root diameter is {2e3 * tooth.root:.6g} mm"
            yield Rule(f"leaves no body below the teeth: {root}", ("bore",))
        depth = self.rim_depth
        if self.type == "internal" and depth is not None and depth <= 0.0:
            root = f"the root diameter is {2e3 * tooth.root:.6g} mm"
            yield Rule(f"leaves no body beyond the teeth: {root}", ("outside_diameter",))
        if tooth.internal and self.rim and self.outside_diameter and not self.web:
            follows = 2.0 * (tooth.root + self.rim.si)
            if abs(self.outside_diameter.si - follows) > RADIUS_TOLERANCE * follows:
                rim = f"with it the diameter is {1e3 * follows:.8g} mm"
                yield Rule(f"contradicts the rim: {rim}", ("outside_diameter",))
        tip, base = 1e3 * tooth.tip, 1e3 * tooth.base_radius
        keys = ("tip_alteration", "addendum", "profile_shift", "thickness_allowance")
        key = next(iter(self.given(*keys)), "module")
        if tooth.tip <= tooth.base_radius:
            inside = f"a tip radius of {tip:.6g} mm, inside the base circle of {base:.6g} mm"
            yield Rule(f"gives the teeth {inside}", (key,))
        elif there and tooth.half_angle_at(math.atan(tooth.tip_roll)) <= 0.0:
            meet = f"the flanks meet at a radius of {1e3 * tooth.pointed:.6g} mm"
            lower = tooth.addendum_to(tooth.pointed) - (self.addendum or 1.0)
            hint = f"tip_alteration = {shortened(lower * tooth.module)} would do."
            why = f"leaves pointed teeth: {meet}, before the tip at {tip:.6g} mm"
            yield Rule(why, (key,), hint=hint)

    @cached_property
    def tooth(self) -> Tooth | None:
        """The teeth; None where the gear does not describe them."""
        if self.module is None or self.teeth is None or self.type == "face":
            return None
        given = {key: getattr(self, key) for key in USUAL_TEETH}
        shape = USUAL_TEETH | {
            key: value.si if isinstance(value, Quantity) else value
            for key, value in given.items()
            if value is not None
        }
        shape["addendum"] += shape.pop("tip_alteration") / self.module.si
        return Tooth(
            module=self.module.si, teeth=self.teeth, internal=self.type == "internal", **shape
        )

    @property
    def teeth_and_width(self) -> tuple[Tooth, float]:
        """The teeth and their face width [m] of a gear that gives both."""
        if self.tooth is None or self.face_width is None:
            raise ValueError("a gear without teeth or face width")
        return self.tooth, self.face_width.si

    @property
    def rim_depth(self) -> float | None:
        """Thickness of the rim [m], given or from the outside diameter; None without either."""
        if self.rim is not None:
            return self.rim.si
        if self.tooth is None or self.outside_diameter is None:
            return None
        return 0.5 * self.outside_diameter.si - self.tooth.root

    @property
    def rim_stiffnesses(self) -> tuple[float, ...]:
        """Stiffness of the rim against the harmonics 2, 3, … [N/m]; empty where it is rigid.

        For a thin ring π E I (n² − 1)²/R³, with R its mean radius and I its second moment of area.
        """
        if self.ovalisation is None:
            return ()
        if not isinstance(self.ovalisation, str):
            return tuple(k.si for k in self.ovalisation)
        thick = self.rim_depth
        if self.tooth is None or thick is None or self.face_width is None:
            raise ValueError("a rim without dimensions")
        middle = self.tooth.root + 0.5 * thick
        bending = math.pi * YOUNG * self.face_width.si * thick**3 / 12.0 / middle**3
        return tuple(bending * (n**2 - 1) ** 2 for n in range(2, 2 + HARMONICS))

    @property
    def is_carrier(self) -> bool:
        """Whether it is a carrier, which has no teeth."""
        return self.type == "carrier"

    @property
    def acting_radius(self) -> float:
        """Lever arm of the tooth force [m]: the base radius, or (L1 + L2)/2 of a face gear."""
        if self.base_radius is not None:
            return self.base_radius.si
        if self.tooth is not None:
            return self.tooth.base_radius
        if self.inner_radius is None or self.outer_radius is None:
            raise ValueError("a gear without radii")
        return (self.inner_radius.si + self.outer_radius.si) / 2
