"""Checks that gears in mesh fit each other: their positions and their teeth."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import suppress

from loadshare.case.draft import Draft
from loadshare.case.gears import STEEPEST, Gear, Tooth
from loadshare.case.iso1328 import outside
from loadshare.case.line_of_action import (
    centre_distance,
    common_width,
    mesh_distance,
    tangent_distance,
)
from loadshare.case.meshes import Mesh
from loadshare.case.place import Vector, axis_of, dot, minus
from loadshare.case.quantity import ANGLE, LENGTH
from loadshare.errors import Problem
from loadshare.involute import (
    base_distance,
    contact_ratio,
    distance_without_backlash,
    normal_backlash,
)

TOLERANCE = 1e-3
"""Largest mismatch between base radii and centre distance, relative to the latter [-]."""

# Directions are parallel or square to within what three decimals in the file can express [-].
ANGLE_TOLERANCE = 1e-6
TEETH_ALIKE = 1e-6
"""Largest difference between teeth that mesh: relative in module and pressure angle [-], absolute
in the helix angle [rad]."""
OVERLAP = 1e-3
"""Largest overlap of teeth that is put down to rounding in the file, in modules [-]."""


def check_tooth_kinds(draft: Draft) -> Iterator[Problem]:
    """Yield pairs of gears whose kinds of teeth cannot mesh."""
    for name, mesh, driver, driven in _pairs(draft):
        kinds = {driver.type, driven.type}
        if kinds == {"internal"}:
            yield draft.problem(("meshes", name), "two internal gears cannot mesh")
        elif "face" in kinds and "external" not in kinds:
            yield draft.problem(("meshes", name), "a face gear meshes with an external pinion only")
        elif _overgrown(driver, driven):
            ring, pinion = mesh.ends if driver.type == "internal" else mesh.ends[::-1]
            radii = [mm(draft.gears[end].acting_radius) for end in (ring, pinion)]
            what = (
                f"the internal gear {ring}, with a base radius of {radii[0]}, has no room for gear "
                f"{pinion}, with {radii[1]}"
            )
            allowed = "more teeth, and the larger base radius, for the internal gear"
            yield draft.problem(("meshes", name), what, allowed)


def _overgrown(driver: Gear, driven: Gear) -> bool:
    """Return whether an internal gear is no larger than its pinion, so that it has no room."""
    pinion, ring = sorted((driver, driven), key=lambda gear: gear.type == "internal")
    inside = (pinion.type, ring.type) == ("external", "internal")
    return inside and ring.acting_radius <= pinion.acting_radius


def check_racks(draft: Draft) -> Iterator[Problem]:
    """Yield pairs whose teeth do not come from the same rack, wherever the gears are."""
    for name, _, driver, driven in _pairs(draft):
        if (found := _unlike(driver, driven)) is not None:
            message, hint = found
            yield draft.problem(("meshes", name), message, hint=hint)


def check_fit(draft: Draft) -> Iterator[Problem]:
    """Yield pairs whose axes, base radii or pressure angle do not fit their centres."""
    centres = draft.centres()
    for name, mesh, driver, driven in _pairs(draft):
        kinds = {driver.type, driven.type}
        placed = {mesh.driver, mesh.driven} <= centres.keys()
        if placed and "external" in kinds and not _overgrown(driver, driven):
            offset = minus(centres[mesh.driven], centres[mesh.driver])
            fit = _face_fit if "face" in kinds else _parallel_fit
            yield from fit(draft, name, mesh, offset)


def _parallel_fit(draft: Draft, name: str, mesh: Mesh, offset: Vector) -> Iterator[Problem]:
    driver, driven = draft.gears[mesh.driver], draft.gears[mesh.driven]
    if not parallel(driver, driven):
        yield draft.problem(("meshes", name), "the two axes are not parallel")
        return
    yield from _check_face_overlap(draft, name, driver, driven, abs(dot(offset, axis_of(driver))))
    distance = centre_distance(driver, offset)
    if distance <= ANGLE_TOLERANCE * max(driver.acting_radius, driven.acting_radius):
        yield draft.problem(("meshes", name), "the two gears are on the same axis")
        return
    radius = tangent_distance(driver, driven)
    if "internal" in (driver.type, driven.type):
        inner, outer = sorted((driver, driven), key=lambda gear: gear.type == "internal")
        sum_ = f"{mm(outer.acting_radius)} − {mm(inner.acting_radius)}"
    else:
        sum_ = f"{mm(driver.acting_radius)} + {mm(driven.acting_radius)}"
    where = f"the base radii {sum_} = {mm(radius)}"
    unlike = _unlike(driver, driven) is not None
    found: list[Problem] = []
    if mesh.pressure_angle is not None:
        found += _compare(draft, name, mesh, f"{where} do", radius, distance, "centre distance")
    elif not (unlike or math.cos(STEEPEST.si) * distance <= radius < distance):
        what = f"{where} leave no line of action at the centre distance {mm(distance)}"
        most = radius / math.cos(STEEPEST.si)
        allowed = f"a centre distance above {mm(radius)} and up to {mm(most)}"
        yield draft.problem(("meshes", name), what, allowed)
        return
    if driver.tooth is not None and driven.tooth is not None and not unlike:
        teeth = driver.tooth, driven.tooth
        found += _too_near(draft, name, *teeth, distance)
        # A law by formula reports this itself.
        if not found and not isinstance(mesh.law, str):
            found += _too_far(draft, name, *teeth, distance)
    yield from found


def _too_near(
    draft: Draft, name: str, one: Tooth, two: Tooth, distance: float
) -> Iterator[Problem]:
    """Yield teeth that have no room for one another at a centre distance [m]."""
    where = f"at the centre distance {mm(distance)} the teeth"
    if base_distance(one, two) >= distance:
        # Given base radii, which may differ slightly, can still leave a line of action.
        what = f"{where} have no line of action"
        yield draft.problem(("meshes", name), what, hint=_without_backlash(one, two))
        return
    backlash = normal_backlash(one, two, distance)
    if backlash < -OVERLAP * one.module:
        what = f"{where} overlap by {mm(-backlash)}"
        yield draft.problem(("meshes", name), what, hint=_without_backlash(one, two))


def _too_far(draft: Draft, name: str, one: Tooth, two: Tooth, distance: float) -> Iterator[Problem]:
    """Yield teeth whose tips do not reach each other's flanks at a centre distance [m]."""
    ratio = contact_ratio(one, two, distance)
    if ratio <= 0.0:
        what = (
            f"at the centre distance {mm(distance)} the teeth do not reach each other: with tip "
            f"radii of {mm(one.tip)} and {mm(two.tip)}, ε_α = {ratio:.2f}"
        )
        yield draft.problem(("meshes", name), what, hint=_without_backlash(one, two))


def _without_backlash(one: Tooth, two: Tooth) -> str:
    """Say which centre distance two gears have without backlash, if there is one."""
    with suppress(ValueError):
        return f"Without backlash, it would be {mm(distance_without_backlash(one, two))}."
    return ""


def _check_face_overlap(
    draft: Draft, name: str, driver: Gear, driven: Gear, along: float
) -> Iterator[Problem]:
    """Yield gears that are too far apart along their axes [m] for their teeth to touch."""
    if common_width(driver, driven, along) == 0.0:
        widths = [gear.face_width.si for gear in (driver, driven) if gear.face_width]
        what = (
            f"the faces do not overlap: the centres are {mm(along)} apart along the axis, "
            f"the face widths {mm(widths[0])} and {mm(widths[1])}"
        )
        allowed = f"less than {mm(0.5 * sum(widths))} along the axis"
        yield draft.problem(("meshes", name), what, allowed)


def _unlike(driver: Gear, driven: Gear) -> tuple[str, str] | None:
    """Return how the racks of two gears differ, and a hint; None if they do not.

    Also None if one of them does not give its teeth, or if no teeth could mesh there.
    """
    one, two = driver.tooth, driven.tooth
    if one is None or two is None or not parallel(driver, driven):
        return None
    if one.internal and two.internal:
        return None
    if not math.isclose(one.module, two.module, rel_tol=TEETH_ALIKE):
        return f"the gears have different modules, {mm(one.module)} and {mm(two.module)}", ""
    if not math.isclose(one.pressure_angle, two.pressure_angle, rel_tol=TEETH_ALIKE):
        angles = f"{_deg(one.pressure_angle)} and {_deg(two.pressure_angle)}"
        return f"the gears have different normal pressure angles, {angles}", ""
    helix = -one.kind * two.kind * one.helix_angle
    if abs(two.helix_angle - helix) > TEETH_ALIKE:
        angles = f"{_deg(one.helix_angle)} and {_deg(two.helix_angle)}"
        hands = "the same hand" if one.kind * two.kind < 0 else "opposite hands"
        hint = f"These gears need helix angles of the same size and of {hands}."
        return f"the helix angles {angles} do not mesh", hint
    return None


def toothed_pairs(
    draft: Draft,
) -> Iterator[tuple[str, tuple[str, str], tuple[Tooth, Tooth], float]]:
    """Yield meshes whose gears both give their teeth, with ends, teeth and centre distance [m].

    Gears that could not mesh at any distance are left out, as that is reported already.
    """
    centres = draft.centres()
    for name, mesh, driver, driven in _pairs(draft):
        one, two = driver.tooth, driven.tooth
        if one is None or two is None or not {mesh.driver, mesh.driven} <= centres.keys():
            continue
        if (one.internal and two.internal) or _overgrown(driver, driven):
            continue
        if _unlike(driver, driven) is not None:
            continue
        if parallel(driver, driven):
            yield name, mesh.ends, (one, two), mesh_distance(mesh, draft.gears, centres)


def _face_fit(draft: Draft, name: str, mesh: Mesh, offset: Vector) -> Iterator[Problem]:
    pinion, face = sorted(
        (draft.gears[mesh.driver], draft.gears[mesh.driven]), key=lambda gear: gear.type == "face"
    )
    axis, along = axis_of(face), axis_of(pinion)
    if abs(dot(axis, along)) > ANGLE_TOLERANCE:
        yield draft.problem(
            ("meshes", name), "the axes of a face gear and its pinion are not at right angles"
        )
        return
    if mesh.pressure_angle is None:
        hint = "It follows from the base radii only if both gears are cylindrical."
        yield draft.problem(("meshes", name, "pressure_angle"), "is missing", ANGLE.allowed, hint)
        return
    past = math.sqrt(max(dot(offset, offset) - dot(offset, axis) ** 2 - dot(offset, along) ** 2, 0))
    if past > TOLERANCE * face.acting_radius:
        what = f"the pinion's axis misses the face gear's axis by {mm(past)}"
        hint = "The axes must intersect: correct the centres or the axes."
        yield draft.problem(("meshes", name), what, hint=hint)
        return
    radius = pinion.acting_radius
    where = f"the pinion's base radius {mm(radius)} does"
    height = abs(dot(offset, axis))
    yield from _compare(draft, name, mesh, where, radius, height, "height over the face gear")


def _compare(
    draft: Draft, name: str, mesh: Mesh, where: str, radius: float, distance: float, what: str
) -> Iterator[Problem]:
    """Yield a problem if the distance times the cosine of the pressure angle is not the radius."""
    if mesh.pressure_angle is None:
        return
    reach = distance * math.cos(mesh.pressure_angle.si)
    if abs(reach - radius) <= TOLERANCE * distance:
        return
    message = (
        f"{where} not fit the {what} {mm(distance)}, whose product with the cosine of the angle "
        f"is {mm(reach)}"
    )
    hint = ""
    if math.cos(STEEPEST.si) * distance <= radius < distance:
        hint = f"A pressure angle of {_deg(math.acos(radius / distance))} would fit."
        if what == "centre distance":
            hint += " When left out, it follows from the radii."
    yield draft.problem(("meshes", name, "pressure_angle"), message, hint=hint)


def check_formula_laws(draft: Draft) -> Iterator[Problem]:
    """Yield keys of the gears that a mesh law by formula needs and that are missing."""
    for name, mesh, driver, driven in _pairs(draft):
        if not isinstance(mesh.law, str):
            continue
        if "face" in (driver.type, driven.type):
            hint = 'Give the law in numbers, or geometry = "pair.toml".'
            yield draft.problem(("meshes", name, "law"), "is for cylindrical gears only", "", hint)
            continue
        hint = f'It is required with meshes."{name}".law = "{mesh.law}".'
        for key, gear in ((mesh.driver, driver), (mesh.driven, driven)):
            for missing in ("module", "teeth", "face_width"):
                if getattr(gear, missing) is None:
                    yield draft.problem(("gears", key, missing), "is missing", hint=hint)


def check_backlash_of_teeth(draft: Draft) -> Iterator[Problem]:
    """Yield backlashes that are to follow from teeth which are not given."""
    for name, mesh, driver, driven in _pairs(draft):
        if mesh.backlash != "teeth":
            continue
        bare = [end for end, g in zip(mesh.ends, (driver, driven), strict=True) if g.tooth is None]
        if bare:
            what = f"the teeth of {' and '.join(bare)} are not given"
            hint = "It needs teeth and module of both gears, which must be cylindrical."
            yield draft.problem(("meshes", name, "backlash"), what, LENGTH.allowed, hint)


def check_tolerance_classes(draft: Draft) -> Iterator[Problem]:
    """Yield gears with a tolerance class to which its standard does not apply."""
    for name, gear in draft.gears.items():
        if gear.tolerance_class is not None:
            for what in outside(gear):
                path = ("gears", name, "tolerance_class")
                yield draft.problem(path, f"does not apply to {what}", hint="Leave it out.")


def _pairs(draft: Draft) -> Iterator[tuple[str, Mesh, Gear, Gear]]:
    for name, mesh in draft.meshes.items():
        driver, driven = draft.gears.get(mesh.driver), draft.gears.get(mesh.driven)
        if driver is None or driven is None or driver is driven:
            continue
        if not (driver.is_carrier or driven.is_carrier):
            yield name, mesh, driver, driven


def parallel(one: Gear, other: Gear) -> bool:
    """Tell whether the axes of two gears are parallel."""
    return 1 - abs(dot(axis_of(one), axis_of(other))) <= ANGLE_TOLERANCE


def mm(length: float) -> str:
    """Return a length in mm, as messages show it."""
    return f"{1e3 * length:.6g} mm"


def _deg(angle: float) -> str:
    return f"{math.degrees(angle):.4g} deg"
