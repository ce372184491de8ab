"""Gears that mesh must be able to, and what changes as they turn must be told for all of it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from loadshare.case.draft import Draft
from loadshare.case.gears import Gear
from loadshare.case.keys import Path
from loadshare.case.meshes import Mesh
from loadshare.case.operation import March, Operating
from loadshare.case.place import Vector, axis_of, centres_of, dot, minus
from loadshare.case.teeth import Misfit, tooth_counts
from loadshare.case.words import count
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


def check_list_lengths(draft: Draft) -> Iterator[Problem]:
    """Yield lists whose length is neither 1 nor the number of positions, or of a march's steps."""
    if draft.operating is None:
        return
    cycle = ("operating.positions", draft.operating.positions)
    solved = cycle if draft.march is None else ("march.steps", draft.march.steps)
    fields: list[tuple[Path, object, str, int]] = [
        (("operating", key), getattr(draft.operating, key), *solved) for key in ("torque", "power")
    ]
    for name, mesh in draft.meshes.items():
        fields += [(("meshes", name, *key), value, *cycle) for key, value in mesh.per_position()]
    for path, value, key, needed in fields:
        if isinstance(value, tuple) and len(value) not in (1, needed):
            message = f"has {count(len(value))}, {key} is {needed}"
            yield draft.problem(path, message, f"1 value or {needed}")


def check_teeth_fit(draft: Draft) -> Iterator[Problem]:
    """Yield tooth counts that contradict the base radii of gears that mesh."""
    if not draft.sound("gears", "meshes"):
        return
    _, misfits = _counts(draft)
    for found in misfits:
        number = draft.gears[found.gear].teeth
        message = (
            f"{number} teeth do not fit the {draft.gears[found.other].teeth} of gear "
            f"{found.other}: by the base radii there would be {found.expected:.5g}"
        )
        hint = "The speed ratio of a mesh is that of its base radii, and of its teeth."
        yield draft.problem(("gears", found.gear, "teeth"), message, hint=hint)


def check_turning(draft: Draft) -> Iterator[Problem]:
    """Yield eccentricities of a mesh cycle over which nothing tells how far gears turn."""
    operating = draft.operating
    if operating is None or not draft.sound("gears"):
        return
    if turning_told(operating, draft.march, draft.gears):
        return
    for name, errors in draft.errors.items():
        if errors.eccentricity is not None and errors.eccentricity.amount.si:
            message = (
                f"turns with its gear, but nothing tells how far gears turn over the "
                f"{operating.positions} positions of the mesh cycle: gears.{operating.input}.teeth "
                "is missing"
            )
            hint = (
                f"Give gears.{operating.input}.teeth, or the teeth of any other gear; "
                'operating.rotation = "neglected" if gears shall stand still; or a march.'
            )
            yield draft.problem(("errors", name, "eccentricity"), message, hint=hint)


def turning_told(operating: Operating, march: March | None, gears: Mapping[str, Gear]) -> bool:
    """Tell whether it is known how far gears turn from position to position, if at all."""
    if march is not None or operating.positions == 1 or operating.rotation == "neglected":
        return True
    return any(gear.teeth is not None for gear in gears.values())


def check_march_teeth(draft: Draft) -> Iterator[Problem]:
    """Yield meshes of a march whose law changes over a cycle that nothing tells."""
    if draft.march is None or not draft.sound("gears", "meshes"):
        return
    counts, _ = _counts(draft)
    for name, mesh in draft.meshes.items():
        if mesh.driver in draft.gears and mesh.driver not in counts and _varies(mesh):
            message = (
                "its law changes from position to position, but nothing tells which position the "
                f"march has reached: gears.{mesh.driver}.teeth is missing"
            )
            hint = f"The teeth of {mesh.driven} or of another gear that they mesh with would do."
            yield draft.problem(("meshes", name), message, hint=hint)


def _varies(mesh: Mesh) -> bool:
    if mesh.law_file or mesh.geometry:
        return True
    lists = (values for _, values in mesh.per_position() if isinstance(values, tuple))
    return any(len(set(values)) > 1 for values in lists)


def _counts(draft: Draft) -> tuple[dict[str, float], tuple[Misfit, ...]]:
    """Tooth counts of the gears and what contradicts; misspelt names are reported elsewhere."""
    gears = draft.gears
    pairs = [(m.driver, m.driven) for m in draft.meshes.values()]
    return tooth_counts(
        {name: gear.teeth for name, gear in gears.items()},
        {name: gear.acting_radius for name, gear in gears.items()},
        [(a, b) for a, b in pairs if a in gears and b in gears],
    )
