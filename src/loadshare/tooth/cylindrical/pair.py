"""Two cylindrical gears in mesh: their contact lines lie in the plane of action."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TypeVar

import numpy as np

from loadshare.involute import inv, working_angle
from loadshare.settings import TEETH
from loadshare.tooth.cylindrical.body import HelicoidBody
from loadshare.tooth.cylindrical.flank import HelicoidFlank
from loadshare.tooth.cylindrical.gear import HelicoidGear
from loadshare.tooth.geometry.body import Array, Placement, about_x, about_y
from loadshare.tooth.geometry.gap import Extents, Trace, meet
from loadshare.tooth.unloaded.positions import GearPair, between

Roll = TypeVar("Roll", float, Array)


@dataclass(frozen=True)
class Misalignment:
    """Misalignment of the axes of a cylindrical pair.

    Parameters
    ----------
    centre_distance : float
        Change of the centre distance [m].
    inclination : float
        Turn of the driven axis within the common plane of the axes [rad], positive if the driven
        gear's axis leans to +x at +z.
    deviation : float
        Turn of the driven axis out of that plane [rad], positive if it leans to +y at +z, the
        direction in which the driver's teeth run at the pitch point.
    axial_shift : float
        Shift of the driven gear along its axis [m].
    """

    centre_distance: float = 0.0
    inclination: float = 0.0
    deviation: float = 0.0
    axial_shift: float = 0.0


@dataclass(frozen=True)
class HelicoidPair(GearPair):
    """A pair of cylindrical gears, built by `helicoid_pair`.

    Stations of a contact line are axial coordinates.

    Parameters
    ----------
    driver_gear, driven_gear : HelicoidGear
        The gears; at most one is internal.
    centre_distance : float
        Centre distance before misalignment [m].
    misalignment : Misalignment
        Misalignment of the axes.
    """

    driver_gear: HelicoidGear
    driven_gear: HelicoidGear
    centre_distance: float
    misalignment: Misalignment = field(default_factory=Misalignment)

    @property
    def kind(self) -> int:
        """σ of the pair: +1 for two external gears, −1 with an internal one."""
        return self.driver_gear.kind * self.driven_gear.kind

    @cached_property
    def driven_side(self) -> int:
        """Side of the driven tooth that is pushed."""
        return self.kind

    @property
    def actual_distance(self) -> float:
        """Centre distance including its misalignment [m]."""
        return self.centre_distance + self.misalignment.centre_distance

    @cached_property
    def working_angle(self) -> float:
        """Transverse pressure angle at the actual centre distance [rad]."""
        return working_angle(self.driver_gear, self.driven_gear, self.actual_distance)

    @cached_property
    def roll_range(self) -> tuple[float, float]:
        """Range of the driver's angle of roll in which both flanks are active."""
        own = sorted((self.driver_gear.form_roll, self.driver_gear.tip_roll))
        other = sorted(
            self.partner_roll(roll, of_driven=True)
            for roll in (self.driven_gear.form_roll, self.driven_gear.tip_roll)
        )
        return max(own[0], other[0]), min(own[1], other[1])

    def partner_roll(self, roll: Roll, *, of_driven: bool = False) -> Roll:
        """Return the other gear's angle of roll at the same point of the line of action.

        Parameters
        ----------
        roll : array or float
            Angle of roll [rad] of the driver, or of the driven gear if `of_driven`.
        of_driven : bool
            Whether `roll` is that of the driven gear.
        """
        scale = self.driver_gear.base_radius / self.driven_gear.base_radius
        pitch = math.tan(self.working_angle)
        return pitch - self.kind * (1.0 / scale if of_driven else scale) * (roll - pitch)

    @property
    def overlap_ratio(self) -> float:
        """Overlap ratio ε_β of one half."""
        first, last = self.ends
        twist = abs(self.driver_gear.twist)
        return max(last - first, 0.0) * twist * self.driver_gear.teeth / (2.0 * math.pi)

    @property
    def ends(self) -> tuple[float, float]:
        """Axial coordinates of the ends of the contact lines, where both faces overlap [m]."""
        shift = self.misalignment.axial_shift
        own, other = 0.5 * self.driver_gear.face_width, 0.5 * self.driven_gear.face_width
        return max(-own, shift - other), min(own, shift + other)

    @cached_property
    def driver(self) -> HelicoidBody:
        """The driver's tooth."""
        return HelicoidBody(self.driver_gear)

    @cached_property
    def driven(self) -> HelicoidBody:
        """The driven gear's tooth."""
        off = self.misalignment
        # The pitch point is on +x of both centres when the driven gear is internal.
        towards = -1.0 if self.driven_gear.internal else 1.0
        axes = about_y(off.inclination) @ about_x(-off.deviation)
        centre = np.array([towards * self.actual_distance, 0.0, 0.0]) + off.axial_shift * axes[:, 2]
        return HelicoidBody(self.driven_gear, Placement(centre, axes))

    @cached_property
    def flanks(self) -> tuple[HelicoidFlank, HelicoidFlank]:
        """The flanks that touch."""
        return HelicoidFlank(self.driver_gear), HelicoidFlank(self.driven_gear, self.driven_side)

    def ideal(self, phase: Array) -> tuple[Array, Array]:
        """Return the rotations at which the unmodified, parallel pair touches [rad].

        At phase 0 pair 0 touches at the pitch point in the middle of the common face.
        """
        one, two = self.driver_gear, self.driven_gear
        pitch = inv(self.working_angle)
        turn = 2.0 * math.pi * phase / one.teeth - one.twist * 0.5 * sum(self.ends)
        driver = one.kind * pitch - one.base_half_angle + turn
        # The driven flank faces the driver: its base tangent is the same line of action.
        facing = (math.pi if self.kind > 0 else 0.0) - one.kind * self.working_angle
        at_pitch = self.driven_side * (two.kind * math.tan(self.working_angle))
        at_pitch += facing - self.driven_side * two.base_half_angle
        at_pitch += two.twist * self.misalignment.axial_shift
        return driver, at_pitch - self.kind * turn / self.ratio

    def extents(self, driver: Array, driven: Array) -> Extents:
        """Return the pairs' lines on both active flanks at positions (k,), by position and pair."""
        gear = self.driver_gear
        first, last = self.roll_range
        low, high = self.ends
        per_tooth = 2.0 * math.pi / gear.teeth
        reach = abs(gear.twist) * max(abs(low), abs(high))
        middle = self.roll(np.zeros(1), np.zeros(1), driver)
        # The pair numbers between which the roll is in the range, for either kind of driver.
        bounds = [gear.kind * (roll - middle) / per_tooth for roll in (first - reach, last + reach)]
        position, pairs = between(*np.sort(bounds, axis=0))
        driver, driven = driver[position], driven[position]
        at_middle = self.roll(pairs, np.zeros_like(pairs), driver)
        slope = gear.kind * gear.twist
        if slope == 0.0:
            start, end = np.full_like(pairs, low), np.full_like(pairs, high)
            inside = (at_middle >= first) & (at_middle <= last) & (low < high)
        else:
            crossing = np.sort([(first - at_middle) / slope, (last - at_middle) / slope], axis=0)
            start, end = np.maximum(crossing[0], low), np.minimum(crossing[1], high)
            inside = end - start > TEETH.shortest * (high - low)
        rows = pairs[inside], driver[inside], driven[inside]
        return Extents(
            position[inside],
            rows[0],
            start[inside],
            end[inside],
            *rows[1:],
            lambda stations: self.trace(*rows, stations),
        )

    def margins_about(self, driver: Array, driven: Array) -> Mapping[str, Array]:
        """Return margins along the lines of pairs near contact, whether on both flanks or not."""
        gear, (first, last) = self.driver_gear, self.roll_range
        axial = np.linspace(*self.ends, 33)
        step = 2.0 * math.pi / gear.teeth
        middle = self.roll(np.zeros(1), np.zeros(1), driver)
        pairs = np.rint(gear.kind * (0.5 * (first + last) - middle) / step) + np.arange(-1.0, 2.0)
        roll, axial = np.broadcast_arrays(self.roll(pairs[:, None], axial, driver), axial)
        other = self.partner_roll(roll), axial - self.misalignment.axial_shift
        return self.margins((roll, axial), other)

    def trace(self, pairs: Array, driver: Array, driven: Array, stations: Array) -> Trace:
        """Return flanks and gap at axial stations (m, n) [m] of the lines of pairs (m,)."""
        pairs, driver, driven = pairs[:, None], driver[:, None], driven[:, None]
        roll = self.roll(pairs, stations, driver)
        own = self.driver_patch(pairs, (roll, stations), driver)
        start = (self.partner_roll(roll), stations - self.misalignment.axial_shift)
        other, driven_at, gap = meet(
            own, lambda a, b: self.driven_patch(pairs, (a, b), driven), start
        )
        slope = self.driver_gear.kind * self.driver_gear.twist
        tangent = slope * own.rays[0] + own.rays[1]
        return Trace(own, other, (roll, stations), driven_at, gap, tangent)
