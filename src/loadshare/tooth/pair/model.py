"""The content of pair files."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import accumulate
from typing import Annotated, Literal

from pydantic import Field, Strict

from loadshare.case.element import Element, Positions, Rule, Text
from loadshare.case.quantity import ANGLE, LENGTH, TORQUE, Angle, Dimension, Length, Quantity
from loadshare.numbers import counted
from loadshare.settings import ALLOWED, TEETH
from loadshare.tooth.analysis.ltca import POINTS

PRESSURE = Dimension("Pa", "a pressure", "206 GPa")

Size = Annotated[Quantity, LENGTH.bounded(above=0)]
Amount = Annotated[Quantity, LENGTH.bounded(at_least=0)]
Steep = Annotated[Quantity, ANGLE.bounded(above=0)]
Modulus = Annotated[Quantity, PRESSURE.bounded(above=0)]
Load = Annotated[Quantity, TORQUE.bounded(above=0)]
Number = Annotated[float, Strict(), Field(ge=-ALLOWED.shape, le=ALLOWED.shape, allow_inf_nan=False)]
Teeth = Annotated[int, Strict(), Field(ge=4, le=ALLOWED.teeth)]

Deviations = Annotated[tuple[Length, ...], Field(min_length=1)]

ABOUT = ("title", "source", "notes", "assumed")
"""Keys that describe a pair but not its teeth."""
STEEL = "206 GPa"


class Modified(Element):
    """Micro-geometry of both flanks of a gear's teeth, as material taken off."""

    tip_relief: Amount = Quantity("0 um", 0.0)
    """Relief at the tip corner [length]."""

    tip_relief_length: Amount = Quantity("0 mm", 0.0)
    """Length of roll, along the line of action, over which the tip relief grows [length]."""

    tip_relief_exponent: Literal[1, 2] = 1
    """1 for linear, 2 for parabolic tip relief [-]."""

    profile_crowning: Amount = Quantity("0 um", 0.0)
    """Height of a parabola at both ends of the usable profile [length]."""

    lead_crowning: Amount = Quantity("0 um", 0.0)
    """Height of a parabola at both ends of the face width [length]."""

    end_relief: Amount = Quantity("0 um", 0.0)
    """Linear relief at both ends of the face width [length]."""

    end_relief_length: Amount = Quantity("0 mm", 0.0)
    """Length along the axis over which the end relief grows [length]."""


class Pitch(Element):
    """Pitch deviations of a gear's loaded flanks, by tooth in the order in which they mesh."""

    single: Deviations | None = None
    """Deviation of the pitch from each tooth to the next, of the last to the first [length]."""

    cumulative: Deviations | None = None
    """How far each tooth is ahead in the sense of rotation [length]; 0 for teeth left out."""

    first_tooth: Annotated[int, Strict(), Field(ge=1)] = 1
    """Tooth that meets at the pitch point at the first position, from 1 [-]."""

    def rules(self) -> Iterator[Rule]:
        """Yield a rule if both lists are given, or neither."""
        if (self.single is None) == (self.cumulative is None):
            yield Rule("needs exactly one list", allowed="single or cumulative")

    @property
    def ahead(self) -> tuple[float, ...]:
        """How far each tooth is ahead [m]; a long pitch sets the next tooth back."""
        if self.cumulative is not None:
            return tuple(value.si for value in self.cumulative)
        steps = (-value.si for value in (self.single or ())[:-1])
        return tuple(accumulate(steps, initial=0.0))


class Body(Element):
    """The keys common to gears of every kind."""

    teeth: Teeth
    """Number of teeth [-]."""

    rim: Size | None = None
    """Radius at which the gear's body ends; for a face gear, thickness below the root [length]."""

    youngs_modulus: Modulus = Quantity(STEEL, 2.06e11)
    """Modulus of elasticity [pressure]."""

    poisson: Annotated[float, Strict(), Field(ge=0, lt=0.5)] = 0.3
    """Poisson's ratio [-]."""

    pitch: Pitch | None = None
    """Pitch deviations of its teeth."""

    def rules(self) -> Iterator[Rule]:
        """Yield lists of pitch deviations that do not fit the number of teeth."""
        pitch = self.pitch
        if pitch is None:
            return
        for key in pitch.given("single", "cumulative"):
            values = getattr(pitch, key)
            if len(values) > self.teeth or (key == "single" and len(values) < self.teeth):
                most = "" if key == "single" else " at most"
                message = f"has {counted(len(values))}"
                yield Rule(message, ("pitch", key), f"{self.teeth}{most}, one per tooth")
            elif key == "single" and abs(sum(v.si for v in values)) > TEETH.closing:
                off = f"{1e6 * sum(v.si for v in values):.4g} µm"
                yield Rule(f"adds up to {off} around the gear", ("pitch", key), "0")
        if pitch.first_tooth > self.teeth:
            yield Rule("is no tooth", ("pitch", "first_tooth"), f"1 to {self.teeth}")


class Cylindrical(Body):
    """A cylindrical gear, or one half of a herringbone gear."""

    face_width: Size
    """Face width; for a herringbone gear, that of one half [length]."""

    module: Size | None = None
    """Normal module [length]; the driven gear takes it from the driver."""

    pressure_angle: Steep | None = None
    """Normal pressure angle [angle]; the driven gear takes it from the driver."""

    helix_angle: Angle | None = None
    """Helix angle, positive for a right-hand helix [angle]; when left out, 0 for the driver and the
    matching angle for the driven gear."""

    profile_shift: Number = 0.0
    """Profile shift coefficient [-]."""

    addendum: Number = 1.0
    """Height of the tooth above the datum line, in modules [-]."""

    dedendum: Number = 1.25
    """Depth of the tooth below the datum line, in modules [-]."""

    tip_radius: Number = 0.38
    """Tip radius of the generating rack, in modules [-]."""

    internal: bool = False
    """Whether the teeth point inwards."""

    modification: Modified = Modified()
    """Micro-geometry of its flanks."""


class Cutter(Element):
    """The shaper of a face gear, with the module and pressure angle of the pinion."""

    teeth: Teeth
    """Number of teeth, one to three more than the pinion's for localised contact [-]."""

    profile_shift: Number | None = None
    """Profile shift coefficient [-]; the pinion's when left out."""

    addendum: Number = 1.25
    """Height of the tip above the datum line, in modules [-]."""


class Face(Body):
    """A face gear, the envelope of its shaper."""

    inner: Size
    """L1, inner end of the teeth along the pinion's axis from where the axes cross [length]."""

    outer: Size
    """L2, outer end of the teeth along that axis [length]."""

    addendum: Number = 1.0
    """Height of the teeth above the shaper's pitch cylinder, in modules [-]."""

    shaft_angle: Steep = Quantity("90 deg", 1.5707963267948966)
    """Angle between the pinion's axis, pointing away from where the axes cross, and the gear's,
    pointing the way its teeth do [angle]."""

    shaper: Cutter
    """The shaper that cuts it."""


class Parallel(Element):
    """Misalignment of the axes of a cylindrical pair."""

    centre_distance: Length = Quantity("0 mm", 0.0)
    """Change of the centre distance [length]."""

    inclination: Angle = Quantity("0 deg", 0.0)
    """Rotation of the driven axis within the plane of both axes [angle]."""

    deviation: Angle = Quantity("0 deg", 0.0)
    """Rotation of the driven axis out of that plane [angle]."""

    axial_shift: Length = Quantity("0 mm", 0.0)
    """Shift of the driven gear along its axis [length]."""


class Crossed(Element):
    """Misalignment of a face-gear pair."""

    shaft_angle: Angle = Quantity("0 deg", 0.0)
    """Change of the angle between the axes [angle]."""

    offset: Length = Quantity("0 mm", 0.0)
    """Shift of the gear perpendicular to both axes [length]."""

    gear_shift: Length = Quantity("0 mm", 0.0)
    """Shift of the gear along its axis, positive towards the pinion [length]."""

    pinion_shift: Length = Quantity("0 mm", 0.0)
    """Shift of the pinion along its axis, positive away from the gear's axis [length]."""


class Analysis(Element):
    """How the pair is analysed."""

    positions: Positions = 5
    """Positions of the mesh cycle [-]."""

    compliance: Literal["finite elements", "slices"] = "finite elements"
    """Model of the teeth: finite elements, or slices, which are a hundred times faster."""

    sampling: Literal["points", "means"] = "points"
    """points: the law of a position is that at its point of the cycle; means: the mean over its
    part of the cycle, so that the mean over the cycle does not depend on their number."""

    points: Annotated[int, Strict(), Field(ge=3, le=ALLOWED.line_points)] = Field(
        default_factory=lambda values: POINTS[values.get("compliance", "finite elements")]
    )
    """Points on a contact line [-]; 32 with finite elements, 16 with slices when left out."""

    teeth: Annotated[int, Strict(), Field(ge=1)] | None = None
    """Teeth in the finite-element model, odd [-]; the contact ratio decides when left out."""

    layers: Annotated[int, Strict(), Field(ge=1)] | None = None
    """Finite elements over the face width [-]; the shape of the tooth decides when left out."""

    def rules(self) -> Iterator[Rule]:
        """Yield options that do not fit the model."""
        for key in self.given("teeth", "layers") if self.compliance == "slices" else ():
            hint = 'Leave it out, or take compliance = "finite elements".'
            yield Rule("applies to finite elements, not to slices", (key,), hint=hint)
        if self.teeth is not None and self.teeth % 2 == 0:
            yield Rule(
                "is even, but the loaded tooth must be in the middle", ("teeth",), "1, 3, 5, …"
            )


class PairContent(Element):
    """The keys common to pair files of every kind."""

    title: Text = ""
    """One line that says what the pair is."""

    source: Text = ""
    """Where its numbers come from."""

    notes: Text = ""
    """Anything else a reader should know."""

    assumed: tuple[str, ...] = ()
    """Key paths of inputs that are assumptions; a star matches any name."""

    torque: Load
    """Rated torque T on the driver [torque]; the law is fitted at 0.1, 0.5 and 0.9 of it."""

    driver: Cylindrical
    """The driving gear."""

    driven: Body
    """The driven gear."""

    analysis: Analysis = Analysis()
    """How the pair is analysed."""

    def rules(self) -> Iterator[Rule]:
        """Yield a model with too many teeth."""
        few, asked = min(self.driver.teeth, self.driven.teeth), self.analysis.teeth
        if asked is not None and asked >= few:
            message = f"is too many for a gear of {few} teeth"
            yield Rule(message, ("analysis", "teeth"), f"odd numbers below {few}, or left out")


class HelicoidContent(PairContent):
    """Two cylindrical gears: spur, helical or herringbone, at most one of them internal."""

    kind: Literal["helicoid"]
    """helicoid: two cylindrical gears."""

    driven: Cylindrical
    """The driven gear."""

    helices: Literal[1, 2] = 1
    """2 for a herringbone pair [-]."""

    helix_gap: Amount = Quantity("0 mm", 0.0)
    """Gap between the halves of a herringbone pair [length]."""

    centre_distance: Size | None = None
    """Centre distance [length]; when left out, that without backlash."""

    misalignment: Parallel = Parallel()
    """Misalignment of the axes."""

    def rules(self) -> Iterator[Rule]:
        """Yield a gap between halves that there are not."""
        yield from super().rules()
        if self.helices == 1 and self.helix_gap.si:
            hint = "Leave it out, or give helices = 2."
            yield Rule("applies only to herringbone pairs", ("helix_gap",), hint=hint)


class FaceGearContent(PairContent):
    """A spur pinion that drives a face gear."""

    kind: Literal["face-gear"]
    """face-gear: a spur pinion and a face gear."""

    driven: Face
    """The face gear."""

    misalignment: Crossed = Crossed()
    """Misalignment of the pair."""


CONTENTS: dict[str, type[HelicoidContent] | type[FaceGearContent]] = {
    "helicoid": HelicoidContent,
    "face-gear": FaceGearContent,
}
