"""Gears that mesh must be able to: kinds, axes, radii and centre distances."""

from __future__ import annotations

import math
from collections.abc import Iterator

from loadshare.case.draft import Draft
from loadshare.case.gears import Gear
from loadshare.case.meshes import Mesh
from loadshare.case.place import Vector, axis_of, centres_of, dot, minus
from loadshare.errors import Problem

TOLERANCE = 1e-3
"""How far base radii may miss the centre distance, as a part of it [-]."""

# Two directions are the same, or square, within what three written decimals leave open [-].
SQUARE = 1e-6


def check_tooth_kinds(draft: Draft) -> Iterator[Problem]:
    """Yield pairs of gears whose kinds of teeth cannot mesh."""
    for name, _, driver, driven in _pairs(draft):
        kinds = {driver.type, driven.type}
        if kinds == {"internal"}:
            yield draft.problem(("meshes", name), "two internal gears cannot mesh")
        elif "face" in kinds and "external" not in kinds:
            yield draft.problem(("meshes", name), "a face gear meshes with an external pinion only")


def check_fit(draft: Draft) -> Iterator[Problem]:
    """Yield pairs whose axes, base radii and pressure angle do not fit where they stand."""
    centres = centres_of(draft.gears)
    for name, mesh, driver, driven in _pairs(draft):
        kinds = {driver.type, driven.type}
        if mesh.driver in centres and mesh.driven in centres and "external" in kinds:
            offset = minus(centres[mesh.driven], centres[mesh.driver])
            fit = _face_fit if "face" in kinds else _parallel_fit
            yield from fit(draft, name, mesh, offset)


def _parallel_fit(draft: Draft, name: str, mesh: Mesh, offset: Vector) -> Iterator[Problem]:
    driver, driven = draft.gears[mesh.driver], draft.gears[mesh.driven]
    axis = axis_of(driver)
    if 1 - abs(dot(axis, axis_of(driven))) > SQUARE:
        yield draft.problem(("meshes", name), "the two axes are not parallel")
        return
    along = dot(offset, axis)
    distance = math.sqrt(max(dot(offset, offset) - along**2, 0.0))
    if distance <= SQUARE * max(driver.acting_radius, driven.acting_radius):
        yield draft.problem(("meshes", name), "the two gears stand on the same axis")
        return
    if "internal" in (driver.type, driven.type):
        inner, outer = sorted((driver, driven), key=lambda gear: gear.type == "internal")
        radii = outer.acting_radius - inner.acting_radius
        sum_ = f"{_mm(outer.acting_radius)} − {_mm(inner.acting_radius)}"
    else:
        radii = driver.acting_radius + driven.acting_radius
        sum_ = f"{_mm(driver.acting_radius)} + {_mm(driven.acting_radius)}"
    where = f"the base radii {sum_} = {_mm(radii)} do"
    yield from _compare(draft, name, mesh, where, radii, distance, "centre distance")


def _face_fit(draft: Draft, name: str, mesh: Mesh, offset: Vector) -> Iterator[Problem]:
    pinion, face = sorted(
        (draft.gears[mesh.driver], draft.gears[mesh.driven]), key=lambda gear: gear.type == "face"
    )
    axis = axis_of(face)
    if abs(dot(axis, axis_of(pinion))) > SQUARE:
        yield draft.problem(
            ("meshes", name), "the axes of a face gear and its pinion are not square"
        )
        return
    radius = pinion.acting_radius
    where = f"the pinion's base radius {_mm(radius)} does"
    height = abs(dot(offset, axis))
    yield from _compare(draft, name, mesh, where, radius, height, "height over the face gear")


def _compare(
    draft: Draft, name: str, mesh: Mesh, where: str, radius: float, distance: float, what: str
) -> Iterator[Problem]:
    """Yield a problem where a distance, seen along the line of action, is not the radius."""
    reach = distance * math.cos(mesh.pressure_angle.si)
    if abs(reach - radius) <= TOLERANCE * distance:
        return
    message = f"{where} not fit the {what} {_mm(distance)}, which times the cosine is {_mm(reach)}"
    hint = ""
    if math.cos(math.radians(45)) * distance <= radius < distance:
        hint = (
            f"A pressure angle of {math.degrees(math.acos(radius / distance)):.4g} deg would fit."
        )
    yield draft.problem(("meshes", name, "pressure_angle"), message, hint=hint)


def _pairs(draft: Draft) -> Iterator[tuple[str, Mesh, Gear, Gear]]:
    for name, mesh in draft.meshes.items():
        driver, driven = draft.gears.get(mesh.driver), draft.gears.get(mesh.driven)
        if driver is not None and driven is not None and driver is not driven:
            yield name, mesh, driver, driven


def _mm(length: float) -> str:
    return f"{1e3 * length:.6g} mm"
