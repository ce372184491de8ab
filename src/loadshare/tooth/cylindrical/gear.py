"""A cylindrical involute gear and the dimensions that follow from its data."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal, NamedTuple

from loadshare.involute import InvoluteTooth
from loadshare.tooth.geometry.body import HALVED, HEIGHTS, RIM, Gear, PitchDeviations

HALF = 0.5
"""Least radius, over the root radius, at which the body of an external gear is assumed to end."""


class Modification(NamedTuple):
    """Micro-geometry of both flanks of a tooth; every amount is material taken off [m].

    Amounts are measured along the flank's normal. They are floats, because code that is compiled
    reads them; other types of numbers would compile it again.

    Parameters
    ----------
    tip_relief : float
        Relief C_αa at the tip corner.
    tip_relief_length : float
        Length of roll, along the transverse line of action, over which the relief grows [m].
    tip_relief_exponent : {1, 2}
        1 for linear, 2 for parabolic relief, which starts without a kink.
    profile_crowning : float
        Crowning C_α: a parabola with this height at both ends of the usable profile.
    lead_crowning : float
        Crowning C_β: a parabola with this height at both ends of the face width.
    end_relief : float
        Linear relief C_βI,II at both ends of the face width.
    end_relief_length : float
        Length along the axis over which the end relief grows [m].
    """

    tip_relief: float = 0.0
    tip_relief_length: float = 0.0
    tip_relief_exponent: Literal[1, 2] = 1
    profile_crowning: float = 0.0
    lead_crowning: float = 0.0
    end_relief: float = 0.0
    end_relief_length: float = 0.0


@dataclass(frozen=True)
class HelicoidGear(InvoluteTooth, Gear):
    """An involute spur or helical gear, external or internal; one half of a herringbone gear.

    Parameters
    ----------
    module : float
        Normal module [m].
    teeth : int
        Number of teeth, positive for internal gears too.
    face_width : float
        Face width [m], of one half for a herringbone gear.
    pressure_angle : float
        Normal pressure angle [rad].
    helix_angle : float
        Helix angle at the reference circle [rad], positive for a right-hand helix.
    profile_shift : float
        Profile shift coefficient x.
    addendum, dedendum : float
        Heights of the tooth above and below the datum line, in modules.
    tip_radius : float
        Tip radius of the generating rack in modules. An internal gear has this radius between
        flank and root circle.
    internal : bool
        Whether the teeth point to the axis.
    modification : Modification
        Micro-geometry.
    helices : {1, 2}
        2 for a herringbone gear.
    helix_gap : float
        Gap between the two halves of a herringbone gear [m].
    rim : float, optional
        Inner radius of the gear's body, outer radius if internal [m]; by default 1.5 tooth
        heights of material below the root, but not below half the root radius if external.
    youngs_modulus, poisson : float
        Elasticity, [Pa] and 1.
    pitch : PitchDeviations, optional
        Pitch deviations of the loaded flanks.
    """

    module: float
    teeth: int
    face_width: float
    pressure_angle: float = math.radians(20.0)
    helix_angle: float = 0.0
    profile_shift: float = 0.0
    addendum: float = 1.0
    dedendum: float = 1.25
    tip_radius: float = 0.38
    internal: bool = False
    modification: Modification = field(default_factory=Modification)
    helices: Literal[1, 2] = 1
    helix_gap: float = 0.0
    rim: float | None = None
    youngs_modulus: float = 2.06e11
    poisson: float = 0.3
    pitch: PitchDeviations | None = None

    @property
    def shape(self) -> Literal["external", "internal"]:
        """Kind of gear body."""
        return "internal" if self.internal else "external"

    @property
    def pitch_radius(self) -> float:
        """Radius of the circle along which pitch deviations are measured [m]."""
        return self.radius

    @cached_property
    def twist(self) -> float:
        """Turn of the transverse section per axial length, tan β / r [rad/m]."""
        return math.tan(self.helix_angle) / self.radius

    def half_angle(self, radius: float) -> float:
        """Return half the angle of a tooth [rad] at a radius [m] not below the base radius."""
        return self.half_angle_at(math.acos(self.base_radius / radius))

    @property
    def straight_dedendum(self) -> float:
        """Depth below the datum line to which the rack's flank is straight, in modules."""
        return self.dedendum - self.tip_radius * (1.0 - math.sin(self.pressure_angle))

    @property
    def least_profile_shift(self) -> float:
        """Profile shift below which the rack undercuts an external gear.

        h* − z sin²α_t/(2 cos β), h* the depth of the rack's straight flank in modules.
        """
        return self.straight_dedendum - 0.5 * self.teeth * math.sin(
            self.transverse_angle
        ) ** 2 / math.cos(self.helix_angle)

    @cached_property
    def form_roll(self) -> float:
        """Angle of roll where the fillet ends and the involute begins [rad].

        External: generated by the end of the rack's straight flank. Internal: where the root
        radius is tangent to it.
        """
        if self.internal:
            fillet = self.tip_radius * self.module
            beside = math.sqrt((self.root - fillet) ** 2 - self.base_radius**2)
            return (fillet + beside) / self.base_radius
        depth = (self.straight_dedendum - self.profile_shift) * self.module
        past_pitch = depth / math.sin(self.transverse_angle)
        return math.tan(self.transverse_angle) - past_pitch / self.base_radius

    @property
    def rim_radius(self) -> float:
        """Radius at which the gear's body ends [m]."""
        return self._assumed_radius if self.rim is None else self.rim

    @property
    def rim_thickness(self) -> float:
        """Thickness of the body below the root [m]."""
        return abs(self.root - self.rim_radius)

    @property
    def _assumed_radius(self) -> float:
        """Default radius at which the gear's body ends [m]."""
        # A hub held at a radius close to zero would wind up without limit.
        least = 0.0 if self.internal else HALF * self.root
        return max(self.root - self.kind * HEIGHTS * abs(self.tip - self.root), least)

    @property
    def assumed_rim(self) -> str:
        """Default depth of the body below the teeth, in words."""
        return HALVED if self._assumed_radius == HALF * self.root else RIM
