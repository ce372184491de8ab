"""A spur pinion that drives a face gear."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar, TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from loadshare.tooth.cylindrical.body import HelicoidBody
from loadshare.tooth.cylindrical.flank import HelicoidFlank
from loadshare.tooth.cylindrical.gear import HelicoidGear
from loadshare.tooth.face.body import FaceBody
from loadshare.tooth.face.flank import FaceFlank
from loadshare.tooth.face.gear import FaceGear
from loadshare.tooth.geometry.body import Array
from loadshare.tooth.geometry.flank import Patch
from loadshare.tooth.geometry.gap import Extents
from loadshare.tooth.geometry.involute import inv, inverse_inv
from loadshare.tooth.geometry.placement import Placement, fixed
from loadshare.tooth.geometry.span import span
from loadshare.tooth.geometry.valley import Flanks, Known, Valleys, anchor
from loadshare.tooth.unloaded.contact import MeshPosition
from loadshare.tooth.unloaded.positions import between, positions

Roll = TypeVar("Roll", float, Array)

# Where a line leaves the flanks, a Newton step below this [m] is the last: picometres are left.
NEAR_EDGE = 1e-7


@dataclass(frozen=True)
class FaceMisalignment:
    """How far a face-gear pair is off.

    Parameters
    ----------
    shaft_angle : float
        Change of the angle between the axes [rad], about the point where they should cross.
    offset : float
        Shift of the gear [m] in the direction in which the pinion's teeth run at the pitch point;
        the axes no longer cross.
    gear_shift : float
        Shift of the gear along its axis [m], positive towards the pinion.
    pinion_shift : float
        Shift of the pinion along its axis [m], positive away from the gear's axis.
    """

    shaft_angle: float = 0.0
    offset: float = 0.0
    gear_shift: float = 0.0
    pinion_shift: float = 0.0


@dataclass(frozen=True)
class FaceGearPair:
    """A spur pinion and a face gear, built by `face_gear_pair`.

    The fixed frame has the pinion's axis as z, pointing away from the gear's axis, and the middle
    of the pinion's face width as origin, which stands over the middle of the gear's. The pitch
    point lies on +x. Stations of a contact line are distances along the major axis of the contact
    ellipse from the ideal pair's point of contact.

    Parameters
    ----------
    pinion : HelicoidGear
        The driver, an external spur gear.
    gear : FaceGear
        The driven face gear.
    misalignment : FaceMisalignment
        How far the pair is off.
    """

    pinion: HelicoidGear
    gear: FaceGear
    misalignment: FaceMisalignment = field(default_factory=FaceMisalignment)

    driven_side: ClassVar[int] = -1
    driven_step: ClassVar[int] = 1
    helices: ClassVar[int] = 1
    overlap_ratio: ClassVar[float] = 0.0

    @property
    def ratio(self) -> float:
        """Teeth of the gear over teeth of the pinion."""
        return self.gear.teeth / self.pinion.teeth

    @property
    def arm(self) -> float:
        """Base radius of the pinion [m]."""
        return self.pinion.base_radius

    @cached_property
    def working_angle(self) -> float:
        """Pressure angle between pinion and shaper [rad].

        The pinion fills the space of the face gear without backlash, as the shaper does, when both
        teeth are equally thick on the pitch circles on which they would roll on each other inside.
        """
        shaper = self.gear.shaper
        teeth = shaper.teeth - self.pinion.teeth
        if teeth == 0:
            return shaper.pressure_angle
        shift = shaper.profile_shift - self.pinion.profile_shift
        change = 2.0 * shift * math.tan(shaper.pressure_angle) / teeth
        return inverse_inv(inv(shaper.pressure_angle) + change)

    @cached_property
    def axis_distance(self) -> float:
        """Distance of the pinion's axis from the shaper's, towards the gear [m]."""
        difference = self.gear.shaper.base_radius - self.pinion.base_radius
        return difference / math.cos(self.working_angle)

    @property
    def contact_length(self) -> float:
        """Coordinate along the shaper's axis of every point of contact of the ideal pair [m]."""
        return self.gear.axial_scale / math.cos(self.working_angle)

    @property
    def middle(self) -> float:
        """Middle of the gear's face width (L1 + L2)/2 [m], where the pinion's middle stands."""
        return 0.5 * (self.gear.inner + self.gear.outer)

    def shaper_roll(self, roll: Roll) -> Roll:
        """Shaper's angle of roll at the ideal pair's contact, from the pinion's."""
        pitch = math.tan(self.working_angle)
        return pitch + self.pinion.base_radius / self.gear.shaper.base_radius * (roll - pitch)

    def pinion_roll(self, roll: float) -> float:
        """Pinion's angle of roll at the ideal pair's contact, from the shaper's."""
        pitch = math.tan(self.working_angle)
        return pitch + self.gear.shaper.base_radius / self.pinion.base_radius * (roll - pitch)

    @cached_property
    def first_roll(self) -> float:
        """Pinion's angle of roll where the gear's tip leaves it, for the ideal pair."""
        gear, flank = self.gear, FaceFlank(self.gear)
        phi = np.array(-self.working_angle)

        def depth(roll: float) -> float:
            point = flank.point(np.array(roll), phi)
            return float(gear.blank(point)[1]) - gear.tip_depth

        tip = gear.shaper.tip_roll
        return self.pinion_roll(float(brentq(depth, -2.0 * tip, tip, xtol=1e-14)))

    @property
    def contact_ratio(self) -> float:
        """Contact ratio of the ideal pair without load."""
        return (self.pinion.tip_roll - self.first_roll) * self.pinion.teeth / (2.0 * math.pi)

    @cached_property
    def driver(self) -> HelicoidBody:
        """The pinion's tooth."""
        return HelicoidBody(self.pinion, fixed())

    @cached_property
    def driven(self) -> FaceBody:
        """The face gear's tooth."""
        off, ideal = self.misalignment, self.gear.shaft_angle
        crossing = self.axis_distance / math.sin(ideal)
        axes = self._gear_axes(ideal)
        # Where the axes should cross, in the fixed frame.
        centre = np.array([-self.axis_distance, 0.0, -self.middle]) - crossing * axes[:, 2]
        axes = self._gear_axes(ideal + off.shaft_angle)
        origin = centre + (crossing + off.gear_shift) * axes[:, 2]
        origin = origin + np.array([0.0, off.offset, -off.pinion_shift])
        return FaceBody(self.gear, Placement(origin, axes))

    @staticmethod
    def _gear_axes(shaft_angle: float) -> Array:
        sine, cosine = math.sin(shaft_angle), math.cos(shaft_angle)
        return np.array([[cosine, 0.0, -sine], [0.0, 1.0, 0.0], [sine, 0.0, cosine]])

    @cached_property
    def _flanks(self) -> tuple[HelicoidFlank, FaceFlank]:
        return HelicoidFlank(self.pinion), FaceFlank(self.gear, self.driven_side)

    def ideal(self, phase: Array) -> tuple[Array, Array]:
        """Rotations at which the pair without misalignment touches [rad].

        At phase 0 pair 0 touches at the pitch point of pinion and shaper.
        """
        shaper, pitch = self.gear.shaper, inv(self.working_angle)
        turn = 2.0 * math.pi * phase / self.pinion.teeth
        driver = pitch - self.pinion.base_half_angle + turn
        at_pitch = math.pi / self.gear.teeth
        at_pitch += self.gear.roll_ratio * (pitch - shaper.base_half_angle)
        return driver, at_pitch + turn / self.ratio

    def valleys(self, pairs: Array, driver: Array, driven: Array) -> Valleys:
        """Lines of pairs (m,) at rotations (m,) [rad], from the ideal pair's points of contact."""
        gear = self.pinion
        phi = driver + 2.0 * math.pi * pairs / gear.teeth + gear.base_half_angle
        roll = self.working_angle + phi
        # Below the base circle there is no involute; no pair is active near it.
        roll = np.maximum(roll, 0.25 * gear.form_roll)
        own = roll, np.full_like(roll, self.contact_length - self.middle)
        other = self.shaper_roll(roll), np.full_like(roll, -self.working_angle)
        flanks = self.driver_patch(pairs, own, driver), self.driven_patch(pairs, other, driven)
        turns = _turn(self.pinion, pairs, driver), _turn(self.gear, pairs, driven)
        begun = anchor(own, other, flanks)
        return Valleys(self._numbers, np.stack(turns, axis=-1), begun, Known.nothing(len(pairs)))

    @cached_property
    def _numbers(self) -> Flanks:
        driver, driven = self._flanks
        place = self.driven.placement
        return Flanks(driver.numbers, driven.numbers, place.axes, place.origin)

    def driver_patch(self, pairs: Array, at: tuple[Array, Array], rotation: Array) -> Patch:
        """Points of the pinion's flanks at surface parameters `at`, fixed frame."""
        return self._flanks[0].patch(*at, _turn(self.pinion, pairs, rotation))

    def driven_patch(self, pairs: Array, at: tuple[Array, Array], rotation: Array) -> Patch:
        """Points of the gear's flanks at surface parameters `at`, fixed frame."""
        place = self.driven.placement
        patch = self._flanks[1].patch(*at, _turn(self.gear, pairs, rotation))
        return patch.turned(place.axes, place.origin)

    def margins(
        self, driver_at: tuple[Array, Array], driven_at: tuple[Array, Array]
    ) -> Mapping[str, Array]:
        """Distance to every edge of the active flanks by name [m], negative beyond it."""
        roll, axial = driver_at
        pinion, gear = self.pinion, self.gear
        length, depth = gear.blank(self._flanks[1].point(*driven_at))
        return {
            "driver tip": pinion.base_radius * (pinion.tip_roll - roll),
            "driver root": pinion.base_radius * (roll - pinion.form_roll),
            "driver face": 0.5 * pinion.face_width - np.abs(axial),
            "driven tip": depth - gear.tip_depth,
            "driven root": gear.shaper.base_radius * (gear.shaper.tip_roll - driven_at[0]),
            "driven inner end": length - gear.inner,
            "driven outer end": gear.outer - length,
        }

    def extents(self, driver: Array, driven: Array) -> Extents:
        """Lines of the pairs on both active flanks at positions (k,), by position and pair.

        A line's part on both flanks is where its least margin is positive.
        """
        position, pairs, valleys, reach = self._candidates(driver, driven)

        def margin(stations: Array, lines: NDArray[np.int64], *, near: bool = False) -> Array:
            nonlocal valleys
            here = valleys.rows(lines)
            found = here.guess(stations) if near else None
            if found is None:
                found = here.find(stations, NEAR_EDGE)
            if not valleys.known.found.size:
                valleys = valleys.knowing(stations, found)
            a, b, c, d, gap = found
            least = np.min(list(self.margins((a, b), (c, d)).values()), axis=0)
            return np.where(np.isfinite(gap), least, -1.0)

        found, start, end = span(margin, reach)
        valleys = valleys.rows(found)
        return Extents(
            position[found],
            pairs[found],
            start,
            end,
            driver[position[found]],
            driven[position[found]],
            valleys.trace,
        )

    def margins_about(self, driver: Array, driven: Array) -> Mapping[str, Array]:
        """Margins along the lines of pairs near contact, on both flanks or not."""
        _, _, valleys, reach = self._candidates(driver, driven)
        a, b, c, d, _ = valleys.find(reach[:, None] * np.linspace(-1.0, 1.0, 33), NEAR_EDGE)
        return self.margins((a, b), (c, d))

    def _candidates(
        self, driver: Array, driven: Array
    ) -> tuple[NDArray[np.int64], Array, Valleys, Array]:
        """Positions, pairs, lines and farthest stations (m,) of pairs that may be in contact."""
        gear = self.pinion
        per_tooth = 2.0 * math.pi / gear.teeth
        middle = self.working_angle + driver + gear.base_half_angle
        # Lines of neighbouring stations reach past the ideal contact's range of roll.
        first, last = self.first_roll - per_tooth, gear.tip_roll + per_tooth
        position, pairs = between((first - middle) / per_tooth, (last - middle) / per_tooth)
        valleys = self.valleys(pairs, driver[position], driven[position])
        width = min(gear.face_width, self.gear.outer - self.gear.inner)
        along = np.maximum(np.abs(valleys.start.major[:, 2]), 0.2)
        reach = 1.1 * (0.5 * width + abs(self.contact_length - self.middle)) / along
        return position, pairs, valleys, reach

    def positions(self, phases: Sequence[float], points_per_line: int) -> tuple[MeshPosition, ...]:
        """Unloaded contact at phases of the mesh cycle; see `positions.positions`."""
        return positions(self, phases, points_per_line)


def _turn(gear: HelicoidGear | FaceGear, pairs: Array, rotation: Array) -> Array:
    """How far the teeth of pairs have turned at rotations of their gear [rad]."""
    return rotation + 2.0 * math.pi / gear.teeth * pairs
