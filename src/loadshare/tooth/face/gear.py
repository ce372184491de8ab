"""A face gear and the shaper that generates it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Literal

import numpy as np

from loadshare.involute import InvoluteTooth
from loadshare.tooth.geometry.body import HEIGHTS, RIM, Array, Gear, PitchDeviations, about_y


@dataclass(frozen=True)
class Shaper(InvoluteTooth):
    """The involute spur cutter whose teeth envelop those of a face gear.

    Parameters
    ----------
    module : float
        Module [m].
    teeth : int
        Number of teeth, usually one to three more than the pinion has.
    pressure_angle : float
        Pressure angle [rad].
    profile_shift : float
        Profile shift coefficient.
    addendum : float
        Height of the tip above the datum line in modules; it sets the depth of the face gear's
        root. The tip corner is sharp.
    """

    module: float
    teeth: int
    pressure_angle: float = math.radians(20.0)
    profile_shift: float = 0.0
    addendum: float = 1.25

    @property
    def tip_half_angle(self) -> float:
        """Half the angle of a tooth at the tip [rad]."""
        return self.base_half_angle - (self.tip_roll - math.atan(self.tip_roll))


@dataclass(frozen=True)
class FaceGear(Gear):
    """A face gear, the envelope of a shaper whose axis crosses its own.

    The gear's frame has its origin where the axes of gear and shaper cross, and the teeth point
    to +z. A blank is bounded along the shaper's axis by `inner` and `outer` (at 90°, radii) and
    in depth, the distance from the shaper's axis in the plane of both axes, by `tip_depth`.

    Parameters
    ----------
    teeth : int
        Number of teeth.
    shaper : Shaper
        Its shaper.
    inner, outer : float
        Ends L1 and L2 of the face [m].
    addendum : float
        Height of the teeth above the shaper's pitch cylinder, in modules.
    shaft_angle : float
        Angle between the gear's axis and the shaper's [rad].
    rim : float, optional
        Thickness of the body below the root [m]; by default 1.5 tooth heights.
    youngs_modulus, poisson : float
        Elasticity, [Pa] and 1.
    pitch : PitchDeviations, optional
        Pitch deviations of the loaded flanks.
    """

    teeth: int
    shaper: Shaper
    inner: float
    outer: float
    addendum: float = 1.0
    shaft_angle: float = 0.5 * math.pi
    rim: float | None = None
    youngs_modulus: float = 2.06e11
    poisson: float = 0.3
    pitch: PitchDeviations | None = None

    shape: ClassVar[Literal["face"]] = "face"
    assumed_rim: ClassVar[str] = RIM

    @property
    def pitch_radius(self) -> float:
        """Radius of the circle along which pitch deviations are measured [m]: (L1 + L2)/2."""
        return 0.5 * (self.inner + self.outer)

    @property
    def face_width(self) -> float:
        """L2 − L1 [m]."""
        return self.outer - self.inner

    @property
    def roll_ratio(self) -> float:
        """Rotation of the gear per rotation of the shaper."""
        return self.shaper.teeth / self.teeth

    @property
    def tip_depth(self) -> float:
        """Distance of the tips from the shaper's axis [m]."""
        return self.shaper.radius - self.addendum * self.shaper.module

    @property
    def rim_thickness(self) -> float:
        """Thickness of the body below the root [m]."""
        return self.rim if self.rim is not None else HEIGHTS * (self.shaper.tip - self.tip_depth)

    @cached_property
    def axes(self) -> Array:
        """Shaper's frame in the gear's, as columns: towards the teeth, tangential, axial."""
        return about_y(self.shaft_angle)

    @cached_property
    def axial_scale(self) -> float:
        """Axial coordinate u on the shaper times cos Φ, the same for all contact normals [m].

        From the equation of meshing, which for an involute reads
        u cos Φ = r_bs (1/m − cos γ)/sin γ.
        """
        base, angle = self.shaper.base_radius, self.shaft_angle
        return base * (1.0 / self.roll_ratio - math.cos(angle)) / math.sin(angle)

    def blank(self, points: Array) -> tuple[Array, Array]:
        """Return the length along the shaper's axis and depth of points (..., 3), gear frame [m].

        The points are turned about the gear's axis into the plane of both axes first.
        """
        sine, cosine = math.sin(self.shaft_angle), math.cos(self.shaft_angle)
        radius, z = np.hypot(points[..., 0], points[..., 1]), points[..., 2]
        return radius * sine + z * cosine, radius * cosine - z * sine
