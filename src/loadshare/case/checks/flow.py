"""The torque must get from the input to the output, through every mesh."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import chain

from loadshare.case.draft import Draft
from loadshare.case.words import choices
from loadshare.errors import Problem


def check_taken_part(draft: Draft) -> Iterator[Problem]:
    """Yield gears that are in no mesh and on no shaft."""
    if not draft.sound("meshes", "shafts"):
        return
    joined = {gear for mesh in draft.meshes.values() for gear in (mesh.driver, mesh.driven)}
    joined |= {gear for shaft in draft.shafts.values() for gear in shaft.ends}
    gears = draft.names("gears")
    # A misspelt name would make two problems of one.
    for name in gears if joined <= set(gears) else ():
        if name not in joined:
            yield draft.problem(("gears", name), "is in no mesh and on no shaft")


def check_output_reached(draft: Draft) -> Iterator[Problem]:
    """Yield the output where no path of meshes and shafts leads to it."""
    if not _known(draft) or draft.operating is None:
        return
    reached = _reach([draft.operating.input], _steps(draft))
    if draft.operating.output not in reached:
        source = draft.operating.input
        message = (
            f'no path leads here from gear "{source}" over meshes, driver to driven, and shafts'
        )
        hint = f"The torque gets to {choices(name for name in draft.gears if name in reached)}."
        yield draft.problem(("operating", "output"), message, hint=hint)


def check_loaded_meshes(draft: Draft) -> Iterator[Problem]:
    """Yield meshes that are on no path from where torque enters to where it leaves."""
    if not _known(draft) or draft.operating is None or any(check_output_reached(draft)):
        return
    steps = _steps(draft)
    external = list(draft.operating.external)
    ahead = _reach([draft.operating.input, *external], steps)
    behind = _reach([draft.operating.output, *external], [(b, a) for a, b in steps])
    for name, mesh in draft.meshes.items():
        if mesh.driver not in ahead or mesh.driven not in behind:
            message = "carries no torque: it is on no path from the input to the output"
            hint = "Is it named driver-driven?"
            yield draft.problem(("meshes", name), message, hint=hint)


def _known(draft: Draft) -> bool:
    """Tell whether the paths can be followed at all; what hinders it is reported elsewhere."""
    if draft.operating is None or not draft.sound("gears", "meshes", "shafts"):
        return False
    named = {draft.operating.input, draft.operating.output, *draft.operating.external}
    return named | set(chain.from_iterable(_steps(draft))) <= set(draft.gears)


def _steps(draft: Draft) -> list[tuple[str, str]]:
    steps = [(mesh.driver, mesh.driven) for mesh in draft.meshes.values()]
    for a, b in (shaft.ends for shaft in draft.shafts.values()):
        steps += [(a, b), (b, a)]
    return steps


def _reach(sources: Iterable[str], steps: list[tuple[str, str]]) -> set[str]:
    reached, fresh = set(sources), set(sources)
    while fresh:
        fresh = {b for a, b in steps if a in fresh and b not in reached}
        reached |= fresh
    return reached
