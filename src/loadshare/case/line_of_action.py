"""Lines of action, as meshes give them or as they follow from the positions of the gears."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from loadshare.case.gears import Gear
from loadshare.case.meshes import Mesh
from loadshare.case.place import Vector, axis_of, dot, minus
from loadshare.case.quantity import Quantity
from loadshare.involute import normal_backlash

WRITTEN = 1e-6
"""Largest error of heights due to rounding in the file, relative to the face width [-]."""


@dataclass(frozen=True, slots=True)
class LineOfAction:
    """The direction in which the teeth of a mesh push.

    Attributes
    ----------
    pressure_angle : float
        Transverse working pressure angle [rad].
    helix_angle : float
        Base helix angle [rad].
    """

    pressure_angle: float
    helix_angle: float


def centre_distance(driver: Gear, offset: Vector) -> float:
    """Return the distance of a centre from a gear's axis [m].

    Parameters
    ----------
    driver : Gear
    offset : tuple of float
        The centre, relative to the gear's own [m].
    """
    along = dot(offset, axis_of(driver))
    return math.sqrt(max(dot(offset, offset) - along**2, 0.0))


def mesh_distance(mesh: Mesh, gears: Mapping[str, Gear], centres: Mapping[str, Vector]) -> float:
    """Return the centre distance of a mesh of two gears with parallel axes [m]."""
    return centre_distance(gears[mesh.driver], minus(centres[mesh.driven], centres[mesh.driver]))


def common_width(one: Gear, two: Gear, along: float) -> float | None:
    """Return how wide the faces of two gears overlap [m]; None if a gear gives no face width.

    Parameters
    ----------
    one, two : Gear
    along : float
        Distance of their centres along the axis [m].
    """
    if one.face_width is None or two.face_width is None:
        return None
    widths = one.face_width.si, two.face_width.si
    common, narrower = 0.5 * sum(widths) - along, min(widths)
    # Heights are rounded in the file: faces side by side do not overlap.
    if common <= WRITTEN * narrower:
        return 0.0
    return common if common < narrower * (1.0 - WRITTEN) else narrower


def facing(
    mesh: Mesh, gears: Mapping[str, Gear], centres: Mapping[str, Vector]
) -> tuple[Gear, Gear]:
    """Return driver and driven gear, with both faces cut to their overlap.

    The gears are unchanged if the narrower face overlaps entirely or not at all, or if a gear gives
    no face width.

    Parameters
    ----------
    mesh : Mesh
        Of two gears with parallel axes.
    gears : mapping of str to Gear
    centres : mapping of str to tuple of float
        Centres of both gears [m].
    """
    driver, driven = gears[mesh.driver], gears[mesh.driven]
    offset = minus(centres[mesh.driven], centres[mesh.driver])
    common = common_width(driver, driven, abs(dot(offset, axis_of(driver))))
    if not common or common == min(g.face_width.si for g in (driver, driven) if g.face_width):
        return driver, driven
    cut = {"face_width": Quantity(f"{common!r} m", common)}
    return driver.model_copy(update=cut), driven.model_copy(update=cut)


def tangent_distance(driver: Gear, driven: Gear) -> float:
    """Return the sum of two base radii, or their difference with an internal gear [m]."""
    radii = driver.acting_radius, driven.acting_radius
    return abs(radii[0] - radii[1]) if "internal" in (driver.type, driven.type) else sum(radii)


def line_of_action(
    mesh: Mesh, gears: Mapping[str, Gear], centres: Mapping[str, Vector]
) -> LineOfAction | None:
    """Return the line of action of a mesh, as given or else as it follows from the centres.

    cos α_wt = |r_b2 ± r_b1| / a. None if the angle is neither given nor follows. For a planet it is
    always computed: only then do the pins take exactly the torque that sun and ring leave.

    Parameters
    ----------
    mesh : Mesh
    gears : mapping of str to Gear
    centres : mapping of str to tuple of float
        Centres of both gears [m].
    """
    driver, driven = gears[mesh.driver], gears[mesh.driven]
    helix = mesh.helix_angle.si if mesh.helix_angle is not None else _base_helix(driver, driven)
    if driver.is_carrier or driven.is_carrier:
        return None
    if mesh.pressure_angle is not None and not (driver.carrier or driven.carrier):
        return LineOfAction(mesh.pressure_angle.si, helix)
    if "face" in (driver.type, driven.type):
        return None
    distance = mesh_distance(mesh, gears, centres)
    radius = tangent_distance(driver, driven)
    return LineOfAction(math.acos(radius / distance), helix) if radius < distance else None


def backlash_of_teeth(
    mesh: Mesh, gears: Mapping[str, Gear], centres: Mapping[str, Vector]
) -> float | None:
    """Return the backlash that the teeth leave along the line of action [m]; None without teeth.

    The line of action lies in the transverse plane: j_bn / cos β_b.

    Parameters
    ----------
    mesh : Mesh
    gears : mapping of str to Gear
    centres : mapping of str to tuple of float
        Centres of both gears [m].
    """
    driver, driven = gears[mesh.driver], gears[mesh.driven]
    if driver.tooth is None or driven.tooth is None:
        return None
    # Rounding in the file may make teeth that touch overlap slightly.
    left = normal_backlash(driver.tooth, driven.tooth, mesh_distance(mesh, gears, centres))
    return max(left / math.cos(driver.tooth.base_helix_angle), 0.0)


def _base_helix(driver: Gear, driven: Gear) -> float:
    tooth = driver.tooth or driven.tooth
    return 0.0 if tooth is None else abs(tooth.base_helix_angle)
