"""Inputs that would act only together with another, which is not there."""

from __future__ import annotations

from collections.abc import Iterator

from loadshare.case.draft import Draft
from loadshare.errors import Problem


def check_idle_inputs(draft: Draft) -> Iterator[Problem]:
    """Yield what was given and bears on nothing for want of something else."""
    for name, mesh in draft.meshes.items():
        if mesh.helix_angle.si and mesh.backlash is None:
            message = "turns a circumferential backlash into one along the line of action, but"
            path = ("meshes", name, "helix_angle")
            if mesh.normal_backlash is not None:
                told, hint = "the backlash is given along it", "Give backlash in its place."
            else:
                told, hint = f'meshes."{name}".backlash is missing', "Give it, or drop the angle."
            yield draft.problem(path, f"{message} {told}", hint=hint)
    for name, ring in draft.rings.items():
        if ring.radius is not None and "measured" in ring.model_fields_set:
            path = ("rings", name, "measured")
            message = "is for rings that roll on neighbours: a circle stands in the housing"
            yield draft.problem(path, message, hint="Leave it out.")
