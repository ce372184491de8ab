"""The mesh contact: the one expression from which every sign follows (formulation, section 2)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from loadshare.contact.law import Law
from loadshare.train.gear import Gear, Vector, cross
from loadshare.train.rim import bent
from loadshare.train.ring import transverse
from loadshare.train.seen import speed_in_mesh


class MeshGeometryError(ValueError):
    """The two gears of a mesh cannot mesh as placed."""


@dataclass(frozen=True, slots=True, eq=False)
class Contact:
    """Directions in which the teeth of a driver push the teeth of a driven gear.

    Attributes
    ----------
    radial : ndarray, shape (3,)
        ĉ, which presses the driven gear away from the driver's tooth body.
    tangential : ndarray, shape (3,)
        t̂, the direction in which the driver's teeth run at the pitch point.
    driven_sense : int
        Sense in which a push along t̂ turns the driven gear about its axis.
    """

    radial: Vector
    tangential: Vector
    driven_sense: int

    def normal(self, pressure_angle: float, drive: bool) -> Vector:
        """Return the push on the driven gear: n for the drive flank, n' for the coast flank."""
        along = 1.0 if drive else -1.0
        return (
            along * math.cos(pressure_angle) * self.tangential
            + math.sin(pressure_angle) * self.radial
        )


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """A mesh between a driver and a driven gear, both flanks.

    Attributes
    ----------
    name, driver, driven : str
    radii : tuple of float
        Base radii of driver and driven gear [m].
    drive_normal, coast_normal : ndarray, shape (3,)
        n and n'.
    laws : tuple of Law
        One, or one per position of the mesh cycle, along the line of action. Like the gaps, they
        are in the order in which contact passes through them if the gear named first drives.
    gaps : tuple of float
        Unloaded gap of the drive flank along the line of action [m], one or one per position.
    backlash : float
        Along the line of action [m]; infinite if the coast flank cannot touch.
    named_backwards : bool
        Whether the case names the driven gear first. Only in a mesh with a single flank: the torque
        runs against the order of its name and presses that flank.
    flank_uncertain : bool
        Whether that one flank may be the wrong one: see `train.pressed`.
    phase : float
        Fraction of its cycle that has passed at the first position [-].
    coast_phase : float
        The same for the coast flank.
    coast_gaps : tuple of float
        Gap of the coast flank in excess of the backlash [m], one or one per position.
    averaged : bool
        Whether laws and gaps are means over the part of the cycle around their position, or hold
        from their position on.
    senses : (int, int)
        For driver and driven gear, 1 if their rotation is counted in the sense in which the drive
        flank moves with the driver and pushes the driven gear, −1 if against it: rotations of suns
        and rings are counted as they turn in the housing, while meshes follow how these turn on the
        carrier.
    """

    name: str
    driver: str
    driven: str
    radii: tuple[float, float]
    drive_normal: Vector
    coast_normal: Vector
    laws: tuple[Law, ...]
    gaps: tuple[float, ...]
    backlash: float
    named_backwards: bool = False
    flank_uncertain: bool = False
    phase: float = 0.0
    senses: tuple[int, int] = (1, 1)
    coast_phase: float = 0.0
    coast_gaps: tuple[float, ...] = (0.0,)
    averaged: bool = False

    @property
    def first_radius(self) -> float:
        """Base radius [m] of the gear that the name puts first, on which torques are given."""
        return self.radii[1] if self.named_backwards else self.radii[0]

    def is_drive(self, drive: bool) -> bool:
        """Return whether a flank is the one with which the gear named first drives."""
        return drive != self.named_backwards

    def lever(self, drive: bool) -> float:
        """Return the torque per flank force [m] on the gear named first, positive if it drives."""
        return self.first_radius if self.is_drive(drive) else -self.first_radius

    def closer(self, by: float) -> Mesh:
        """Return the mesh with both flanks closer by a length along the line of action [m]."""
        return replace(self, gaps=tuple(g - by for g in self.gaps), backlash=self.backlash - by)

    @property
    def flanks(self) -> tuple[bool, ...]:
        """The flanks that can touch: drive (True) and, with a finite backlash, coast (False)."""
        # A backlash that is an array of samples is finite.
        free = isinstance(self.backlash, float) and math.isinf(self.backlash)
        return (True,) if free else (True, False)

    @property
    def changes(self) -> bool:
        """Whether its laws or gaps change over its cycle."""
        return len(self.laws) + len(self.gaps) + len(self.coast_gaps) > 3

    def flank_name(self, drive: bool) -> str:
        """Return the name of a flank's row: the mesh's own for the drive flank."""
        return self.name if drive else f"{self.name} coast"

    def law(self, position: int) -> Law:
        """Return the compliance law of a flank at position `position` (0-based) of its laws."""
        return self.laws[position % len(self.laws)]

    def gap(self, position: int, drive: bool) -> float:
        """Return the gap [m] of a flank at position `position` (0-based) of its laws."""
        if drive:
            return self.gaps[position % len(self.gaps)]
        return self.backlash + self.coast_gaps[position % len(self.coast_gaps)]

    def position(self, drive: bool, passed: Any, count: int) -> Any:
        """Return the position (0-based) of its laws at which a flank is.

        Parameters
        ----------
        drive : bool
        passed : float or ndarray
            Number of positions of the cycle that have passed since its teeth touched at the pitch
            point.
        count : int
            Positions of a mesh cycle.
        """
        # A position just reached must not be missed by round-off.
        reached = np.floor(passed + (0.5 if self.averaged else 0.0) + 1e-9)
        # If the gear named second drives, contact passes through the positions backwards.
        return (-reached if drive == self.named_backwards else reached) % count

    def direction(self, drive: bool) -> tuple[float, float, Vector]:
        """Return the coefficients of φ_driver [m], φ_driven [m], relative offset (3,) in δ."""
        driver, driven = (s * r for s, r in zip(self.senses, self.radii, strict=True))
        if drive:
            return driver, -driven, self.drive_normal
        return -driver, driven, self.coast_normal


@dataclass(frozen=True, slots=True)
class Approach:
    """How the approach of a flank depends on the motions of the two gears and their carriers.

    Attributes
    ----------
    turning : mapping of str to float
        Approach per rotation [m].
    shifting : mapping of str to ndarray, shape (3,)
        Approach per displacement or centre offset. A planet's displacement is counted from its pin,
        which moves with the carrier by p_c + φ_c times `Gear.pin_motion` (formulation, section 12).
    """

    turning: Mapping[str, float]
    shifting: Mapping[str, Vector]


def approach_of(mesh: Mesh, drive: bool, gears: Mapping[str, Gear]) -> Approach:
    r"""Return how the approach of a flank depends on the motions of a train's bodies.

    .. math:: \delta = r_{bi}\varphi_i - r_{bj}\varphi_j + n\cdot((p_i + c_i) - (p_j + c_j)) -
        \text{gap}
    """
    on_driver, on_driven, normal = mesh.direction(drive)
    turning = {mesh.driver: on_driver, mesh.driven: on_driven}
    shifting = {mesh.driver: normal, mesh.driven: -normal}
    for end, push in ((mesh.driver, normal), (mesh.driven, -normal)):
        carrier = gears[end].carrier
        if carrier is not None:
            turning[carrier] = turning.get(carrier, 0.0) + float(push @ gears[end].pin_motion)
            shifting[carrier] = shifting.get(carrier, 0.0) + push
        other = gears[mesh.driven if end == mesh.driver else mesh.driver]
        shifting |= bent(end, other, push, gears)
    return Approach(turning, shifting)


def running_contact(
    gears: Mapping[str, Gear], driver: str, driven: str, way: int | None = None
) -> tuple[Contact, tuple[int, int]]:
    """Return the contact of two gears as they run, seen from their carrier, and `Mesh.senses`.

    Parameters
    ----------
    gears : mapping of str to Gear
    driver, driven : str
    way : int, optional
        1 if the driver runs in the sense in which its rotation is counted, −1 if against it; by
        default, according to its speed in the mesh.
    """
    way = way or (-1 if speed_in_mesh(gears, driver, driven) < 0.0 else 1)
    contact = contact_of(replace(gears[driver], sense=way * gears[driver].sense), gears[driven])
    return contact, (way, contact.driven_sense * gears[driven].sense)


def contact_of(driver: Gear, driven: Gear) -> Contact:
    """Return the contact of two placed gears, face or parallel.

    Raises
    ------
    MeshGeometryError
        If they cannot mesh where they are.
    """
    return (_face if "face" in (driver.kind, driven.kind) else _parallel)(driver, driven)


def _parallel(driver: Gear, driven: Gear) -> Contact:
    """Return the contact of two gears with parallel axes.

    ĉ points from the driver's centre to the pitch point: towards an external partner, away from the
    centre of an internal one. A driver that is itself the internal gear pushes its pinion towards
    its own centre.
    """
    between = transverse(driven.centre - driver.centre, driver.axis)
    distance = math.hypot(*between.tolist())
    if distance == 0.0:
        raise MeshGeometryError("the two centres coincide in the transverse plane")
    outward = between / distance
    to_pitch = -outward if driven.kind == "internal" else outward
    # The pitch point lies beyond the pinion's centre in an internal pair, between the centres
    # otherwise.
    arm = to_pitch if "internal" in (driver.kind, driven.kind) else -to_pitch
    radial = -to_pitch if driver.kind == "internal" else to_pitch
    return _pushed(driver, driven, to_pitch, arm, radial)


def _face(driver: Gear, driven: Gear) -> Contact:
    """Return the contact of a pinion with a face gear.

    The push lies in the pinion's transverse plane with its radial part along the face gear's axis.
    The pitch point is at the acting radius of the face gear, on the side of the pinion.
    """
    pinion, face = (driver, driven) if driven.kind == "face" else (driven, driver)
    towards = pinion.centre - face.centre
    along = float(towards @ pinion.axis)
    height = float(towards @ face.axis)
    if along == 0.0:
        raise MeshGeometryError("the pinion's centre lies on the face gear's axis")
    if height == 0.0:
        raise MeshGeometryError("the pinion's centre lies in the face gear's pitch plane")
    arm = math.copysign(1.0, along) * pinion.axis
    to_face = -math.copysign(1.0, height) * face.axis
    if driver is pinion:
        return _pushed(driver, driven, to_face, arm, to_face)
    return _pushed(driver, driven, arm, to_face, -to_face)


def _pushed(driver: Gear, driven: Gear, to_pitch: Vector, arm: Vector, radial: Vector) -> Contact:
    """Return the contact at a pitch point, given its directions from the two gears' centres."""
    tangential = driver.sense * cross(driver.axis, to_pitch)
    sense = 1 if driven.axis @ cross(arm, tangential) > 0.0 else -1
    return Contact(radial, tangential, sense)
