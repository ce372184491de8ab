"""The groups of a stage must split it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from loadshare.case.draft import Draft
from loadshare.errors import Problem


def check_stage_groups(draft: Draft) -> Iterator[Problem]:
    """Yield meshes that a stage names twice, and groups that do not split the stage."""
    for name, stage in draft.stages.items():
        path = ("stages", name)
        twice = [mesh for mesh, count in Counter(stage.meshes).items() if count > 1]
        if twice:
            yield draft.problem((*path, "meshes"), f"names {', '.join(twice)} more than once")
        if stage.groups is None:
            continue
        grouped = Counter(mesh for group in stage.groups for mesh in group)
        for mesh, count in grouped.items():
            if mesh not in stage.meshes:
                yield draft.problem((*path, "groups"), f'"{mesh}" is not among the stage\'s meshes')
            elif count > 1:
                yield draft.problem((*path, "groups"), f'"{mesh}" is in {count} groups')
        left = [mesh for mesh in dict.fromkeys(stage.meshes) if mesh not in grouped]
        if left:
            yield draft.problem((*path, "groups"), f"{', '.join(left)} is in no group")
