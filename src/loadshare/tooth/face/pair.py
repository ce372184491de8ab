"""A spur pinion that drives a face gear."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from loadshare.involute import inv, inverse_inv
from loadshare.settings import TEETH
from loadshare.tooth.cylindrical.body import HelicoidBody
from loadshare.tooth.cylindrical.flank import HelicoidFlank
from loadshare.tooth.cylindrical.gear import HelicoidGear
from loadshare.tooth.face.body import FaceBody
from loadshare.tooth.face.flank import FaceFlank, root_of
from loadshare.tooth.face.gear import FaceGear
from loadshare.tooth.geometry.body import Array, Placement, about_y
from loadshare.tooth.geometry.gap import Extents
from loadshare.tooth.geometry.valley import Flanks, Known, Valleys, anchor, span
from loadshare.tooth.unloaded.positions import GearPair, between

Roll = TypeVar("Roll", float, Array)


@dataclass(frozen=True)
class FaceMisalignment:
    """Misalignment of a face-gear pair.

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
class FaceGearPair(GearPair):
    """A spur pinion and a face gear, built by `face_gear_pair`.

    The pinion's axis points away from the gear's, and the middle of its face width is over the
    middle of the gear's. Stations of a contact line are distances along the major axis of the
    contact ellipse from the ideal pair's point of contact.

    Parameters
    ----------
    pinion : HelicoidGear
        The driver, an external spur gear.
    gear : FaceGear
        The driven face gear.
    misalignment : FaceMisalignment
        Misalignment of the pair.
    """

    pinion: HelicoidGear
    gear: FaceGear
    misalignment: FaceMisalignment = field(default_factory=FaceMisalignment)

    driven_side = -1

    @cached_property
    def working_angle(self) -> float:
        """Pressure angle between pinion and shaper [rad].

        The pinion fills the space of the face gear without backlash, as the shaper does, if the
        teeth of both are equally thick on the pitch circles of the internal pair they would form.
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
        """Coordinate along the shaper's axis of all points of contact of the ideal pair [m]."""
        return self.gear.axial_scale / math.cos(self.working_angle)

    def shaper_roll(self, roll: Roll) -> Roll:
        """Return the shaper's angle of roll at the ideal pair's contact, from the pinion's."""
        pitch = math.tan(self.working_angle)
        return pitch + self.pinion.base_radius / self.gear.shaper.base_radius * (roll - pitch)

    def pinion_roll(self, roll: float) -> float:
        """Return the pinion's angle of roll at the ideal pair's contact, from the shaper's."""
        pitch = math.tan(self.working_angle)
        return pitch + self.gear.shaper.base_radius / self.pinion.base_radius * (roll - pitch)

    @cached_property
    def roll_range(self) -> tuple[float, float]:
        """Pinion's angles of roll with the ideal contact at the gear's tip, and at its own tip."""
        tip, end = self.gear.shaper.tip_roll, self.gear.tip_depth
        first = root_of(lambda roll: self.depth(roll) - end, -2.0 * tip, tip)
        return self.pinion_roll(first), self.pinion.tip_roll

    def depth(self, roll: float) -> float:
        """Return the depth in the blank of the ideal pair's contact at a roll of the shaper [m]."""
        point = FaceFlank(self.gear).point(np.array(roll), np.array(-self.working_angle))
        return float(self.gear.blank(point)[1])

    @cached_property
    def driver(self) -> HelicoidBody:
        """The pinion's tooth."""
        return HelicoidBody(self.pinion)

    @cached_property
    def driven(self) -> FaceBody:
        """The face gear's tooth."""
        off, ideal = self.misalignment, self.gear.shaft_angle
        crossing = self.axis_distance / math.sin(ideal)
        # Where the axes should cross, in the fixed frame.
        centre = np.array([-self.axis_distance, 0.0, -self.gear.pitch_radius])
        centre = centre - crossing * about_y(-ideal)[:, 2]
        axes = about_y(-ideal - off.shaft_angle)
        origin = centre + (crossing + off.gear_shift) * axes[:, 2]
        origin = origin + np.array([0.0, off.offset, -off.pinion_shift])
        return FaceBody(self.gear, Placement(origin, axes))

    @cached_property
    def flanks(self) -> tuple[HelicoidFlank, FaceFlank]:
        """The flanks that touch."""
        return HelicoidFlank(self.pinion), FaceFlank(self.gear, self.driven_side)

    def ideal(self, phase: Array) -> tuple[Array, Array]:
        """Return the rotations at which the pair without misalignment touches [rad].

        At phase 0 pair 0 touches at the pitch point of pinion and shaper.
        """
        shaper, pitch = self.gear.shaper, inv(self.working_angle)
        turn = 2.0 * math.pi * phase / self.pinion.teeth
        driver = pitch - self.pinion.base_half_angle + turn
        at_pitch = math.pi / self.gear.teeth
        at_pitch += self.gear.roll_ratio * (pitch - shaper.base_half_angle)
        return driver, at_pitch + turn / self.ratio

    def valleys(self, pairs: Array, driver: Array, driven: Array) -> Valleys:
        """Return lines of pairs (m,) at rotations (m,) [rad] from the ideal points of contact."""
        # Below the base circle there is no involute; no pair is active near it.
        roll = np.maximum(self.roll(pairs, 0.0, driver), 0.25 * self.pinion.form_roll)
        own = roll, np.full_like(roll, self.contact_length - self.gear.pitch_radius)
        other = self.shaper_roll(roll), np.full_like(roll, -self.working_angle)
        patches = self.driver_patch(pairs, own, driver), self.driven_patch(pairs, other, driven)
        turns = np.stack(self.turns(pairs, driver, driven), axis=-1)
        start = anchor(own, other, patches)
        nothing = Known(np.empty((len(pairs), 0)), np.empty((len(pairs), 0, 5)))
        return Valleys(self._numbers, turns, start, nothing)

    @cached_property
    def _numbers(self) -> Flanks:
        place = self.driven.placement
        return Flanks(self.flanks[0].numbers, self.flanks[1].numbers, place.axes, place.origin)

    def extents(self, driver: Array, driven: Array) -> Extents:
        """Return the pairs' lines on both active flanks at positions (k,), by position and pair.

        A line lies on both flanks where its least margin is positive.
        """
        position, pairs, valleys, reach = self._candidates(driver, driven)

        def margin(stations: Array, lines: NDArray[np.int64], *, near: bool = False) -> Array:
            nonlocal valleys
            here = valleys.rows(lines)
            found = here.guess(stations) if near else None
            if found is None:
                found = here.find(stations, TEETH.near_edge)
            if not valleys.known.found.size:
                valleys = valleys.knowing(stations, found)
            a, b, c, d, gap = np.moveaxis(found, -1, 0)
            least = np.min(list(self.margins((a, b), (c, d)).values()), axis=0)
            return np.where(np.isfinite(gap), least, -1.0)

        found, start, end = span(margin, reach)
        position, pairs, trace = position[found], pairs[found], valleys.rows(found).trace
        return Extents(position, pairs, start, end, driver[position], driven[position], trace)

    def margins_about(self, driver: Array, driven: Array) -> Mapping[str, Array]:
        """Return margins along the lines of pairs near contact, whether on both flanks or not."""
        _, _, valleys, reach = self._candidates(driver, driven)
        found = valleys.find(reach[:, None] * np.linspace(-1.0, 1.0, 33), TEETH.near_edge)
        a, b, c, d, _ = np.moveaxis(found, -1, 0)
        return self.margins((a, b), (c, d))

    def _candidates(
        self, driver: Array, driven: Array
    ) -> tuple[NDArray[np.int64], Array, Valleys, Array]:
        """Return positions, pairs, lines and farthest stations (m,) of pairs that may touch."""
        per_tooth = 2.0 * math.pi / self.pinion.teeth
        # At other stations, lines reach past the ideal contact's range of roll.
        ends = np.array(self.roll_range)[:, None] + [[-per_tooth], [per_tooth]]
        position, pairs = between(*(ends - self.roll(np.zeros(1), 0.0, driver)) / per_tooth)
        valleys = self.valleys(pairs, driver[position], driven[position])
        return position, pairs, valleys, self._reach(valleys)

    def _reach(self, valleys: Valleys) -> Array:
        """Return how far from their anchors lines (m,) may reach on both flanks [m]."""
        pinion, gear = 0.5 * self.pinion.face_width, 0.5 * self.gear.face_width
        point, major = valleys.start.point, np.abs(valleys.start.major)
        along = np.maximum(major[:, 2], 0.2)
        # The ends of the gear are arcs, which curve away beside the pinion's axis.
        beside = np.abs(point[:, 1]) + major[:, 1] / along * min(pinion, gear)
        half = np.minimum(pinion, gear + 0.5 * beside**2 / self.gear.inner)
        return np.asarray(1.1 * (half + abs(self.contact_length - self.gear.pitch_radius)) / along)
