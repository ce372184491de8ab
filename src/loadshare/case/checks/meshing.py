"""Checks that what changes over the mesh cycle, or as gears turn, is given throughout."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from loadshare.case.checks.fit import mm
from loadshare.case.draft import Draft
from loadshare.case.gears import Gear
from loadshare.case.keys import Path
from loadshare.case.meshes import Mesh
from loadshare.case.operation import March, Operating
from loadshare.case.teeth import CountMisfit, tooth_counts
from loadshare.errors import Problem
from loadshare.numbers import counted


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
            message = f"has {counted(len(value))}, but {key} is {needed}"
            allowed = "1 value" if needed == 1 else f"1 value or {needed}"
            yield draft.problem(path, message, allowed)


def check_teeth_fit(draft: Draft) -> Iterator[Problem]:
    """Yield tooth counts that contradict the base radii of gears that mesh."""
    if not draft.sound("gears", "meshes"):
        return
    _, misfits = tooth_counts(draft.gears, draft.meshes)
    for found in misfits:
        number = draft.gears[found.gear].teeth
        message = (
            f"{number} teeth do not fit the {draft.gears[found.other].teeth} of gear "
            f"{found.other}: the base radii would give {found.expected:.5g}"
        )
        hint = "Base radii and tooth numbers must give the same speed ratio."
        hint += _acting_radius(draft, found)
        yield draft.problem(("gears", found.gear, "teeth"), message, hint=hint)


def _acting_radius(draft: Draft, found: CountMisfit) -> str:
    """Say which acting radius of a face gear would fit: it is not in the middle of its teeth."""
    for name, ratio in ((found.gear, 1.0), (found.other, -1.0)):
        gear, number = draft.gears[name], draft.gears[found.gear].teeth
        if gear.type == "face" and number is not None:
            radius = gear.acting_radius * (number / found.expected) ** ratio
            would_do = f'gears.{name}.base_radius = "{mm(radius)}"'
            if gear.base_radius is not None:
                return f" {would_do} would do."
            middle = "(inner_radius + outer_radius)/2"
            return f" The force on gear {name} acts at {middle}; {would_do} instead would do."
    return ""


def check_turning(draft: Draft) -> Iterator[Problem]:
    """Yield eccentricities if nothing determines how far gears turn over the mesh cycle."""
    operating = draft.operating
    if operating is None or not draft.sound("gears"):
        return
    if turning_is_given(operating, draft.march, draft.gears):
        return
    for name, errors in draft.errors.items():
        if errors.eccentricity is not None and errors.eccentricity.amount.si:
            message = (
                f"turns with its gear, but nothing determines how far gears turn over the "
                f"{operating.positions} positions of the mesh cycle: gears.{operating.input}.teeth "
                "is missing"
            )
            hint = (
                f"Give gears.{operating.input}.teeth, or the teeth of any other gear; "
                'operating.rotation = "neglected" if gears should not rotate; or a march.'
            )
            yield draft.problem(("errors", name, "eccentricity"), message, hint=hint)


def turning_is_given(operating: Operating, march: March | None, gears: Mapping[str, Gear]) -> bool:
    """Tell whether it is known how far gears turn from position to position, if at all."""
    if march is not None or operating.positions == 1 or operating.rotation == "neglected":
        return True
    return any(gear.teeth is not None for gear in gears.values())


def check_march_teeth(draft: Draft) -> Iterator[Problem]:
    """Yield meshes of a march whose law varies over their cycle if nothing gives their position."""
    if draft.march is None or not draft.sound("gears", "meshes"):
        return
    counts, _ = tooth_counts(draft.gears, draft.meshes)
    for name, mesh in draft.meshes.items():
        if mesh.driver in draft.gears and mesh.driver not in counts and _varies(mesh):
            message = (
                "its law changes from position to position, but nothing determines which position "
                f"the march has reached: gears.{mesh.driver}.teeth is missing"
            )
            hint = (
                f"The teeth of {mesh.driven}, or of another gear in mesh with them, would also do."
            )
            yield draft.problem(("meshes", name), message, hint=hint)


def _varies(mesh: Mesh) -> bool:
    if mesh.law_file or mesh.geometry or mesh.law_is_of_contact:
        return True
    lists = (values for _, values in mesh.per_position() if isinstance(values, tuple))
    return any(len(set(values)) > 1 for values in lists)
