"""Checks that the torque gets from the input to the output, and through every mesh."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from graphlib import CycleError, TopologicalSorter
from itertools import chain

from loadshare.case.checks.names import carriers_in
from loadshare.case.draft import Draft
from loadshare.case.power_flow import (
    Steps,
    against_the_names,
    backwards,
    from_the_other_end,
    has_sets,
    on_one_shaft,
    reach,
    steps,
)
from loadshare.case.quantity import LENGTH
from loadshare.case.words import choices
from loadshare.errors import Problem


def check_taken_part(draft: Draft) -> Iterator[Problem]:
    """Yield gears that are in no mesh and on no shaft, and carriers that also carry no planet."""
    if not draft.sound("meshes", "shafts"):
        return
    joined = {gear for mesh in draft.meshes.values() for gear in mesh.ends}
    joined |= {gear for shaft in draft.shafts.values() for gear in shaft.ends}
    joined |= {gear.carrier for gear in draft.gears.values() if gear.carrier}
    gears = draft.names("gears")
    carriers = carriers_in(draft)
    # Any gear that could not be read may be a planet.
    unread = set(gears) - set(carriers) - draft.gears.keys()
    # A misspelt name would make two problems of one.
    for name in gears if joined <= set(gears) else ():
        if name in joined or (unread and name in carriers):
            continue
        alone = " and carries no planet" if name in carriers else ""
        yield draft.problem(("gears", name), f"is in no mesh and on no shaft{alone}")


def check_output_reached(draft: Draft) -> Iterator[Problem]:
    """Yield the output if no path of meshes and shafts leads to it."""
    if not _known(draft) or draft.operating is None:
        return
    source, taken = draft.operating.input, _steps(draft)
    reached = reach([source], taken)
    if draft.operating.output not in reached:
        message = f'no path of meshes (driver to driven) and shafts leads here from gear "{source}"'
        hint = f"The torque reaches {choices(name for name in draft.gears if name in reached)}."
        back = [
            n for n, m in draft.meshes.items() if m.driven in reached and m.driver not in reached
        ]
        if back and draft.operating.output in reach([source], [*taken, *backwards(taken)]):
            hint += f" Meshes are named driver-driven, but these lead back: {choices(back)}."
        yield draft.problem(("operating", "output"), message, hint=hint)


def check_loaded_meshes(draft: Draft) -> Iterator[Problem]:
    """Yield meshes that are on no path from where torque enters to where it leaves."""
    if not _known(draft) or draft.operating is None or any(check_output_reached(draft)):
        return
    taken = _steps(draft)
    # Gears that the housing holds can supply or take any torque.
    external = [*draft.operating.external, *(n for n, g in draft.gears.items() if g.held)]
    ahead = reach([draft.operating.input, *external], taken)
    behind = reach([draft.operating.output, *external], backwards(taken))
    turned = _turned(draft)
    ends = {n: m.ends[::-1] if turned else m.ends for n, m in draft.meshes.items()}
    back = set(_leading_back(draft, ends, taken, external))
    for name, (first, last) in ends.items():
        if first not in ahead or last not in behind or name in back:
            message = "carries no torque: it is on no path from the input to the output"
            hint = (
                "Is the mesh named driver-driven? If it only idles, give the gear at its end a "
                'torque of "0 N*m" in operating.external.'
            )
            yield draft.problem(("meshes", name), message, hint=hint)


def _leading_back(
    draft: Draft, ends: Mapping[str, tuple[str, str]], taken: Steps, external: Collection[str]
) -> Iterator[str]:
    """Yield meshes with one flank that would lead torque back to where it has come from.

    Torque reaches their first gear only through their last one, or leaves the last one only through
    the first. This happens in a ring of meshes if one of its branches is named from the output on.
    """
    operating = draft.operating
    if operating is None or has_sets(draft.gears) or not _goes_round(draft):
        return
    sources, sinks = {operating.input, *external}, {operating.output, *external}
    back = backwards(taken)
    pairs = set(ends.values())
    for name, (first, last) in ends.items():
        twice = (last, first) in pairs
        if twice or draft.meshes[name].given("backlash", "normal_backlash"):
            continue
        fed = first in reach(sources, taken, avoiding=last)
        if not fed or last not in reach(sinks, back, avoiding=first):
            yield name


def _goes_round(draft: Draft) -> bool:
    """Tell whether meshes, driver to driven, lead back to the same gear or to one on its shaft."""
    joined = on_one_shaft(draft.gears, [shaft.ends for shaft in draft.shafts.values()])
    group = {gear: together for together in joined for gear in together}
    follows: dict[tuple[str, ...], set[tuple[str, ...]]] = {}
    for mesh in draft.meshes.values():
        follows.setdefault(group[mesh.driven], set()).add(group[mesh.driver])
    try:
        TopologicalSorter(follows).prepare()
    except CycleError:
        return True
    return False


def check_pressed_flanks(draft: Draft) -> Iterator[Problem]:
    """Yield meshes that need a backlash because torque presses their other flank.

    Torque that runs against a mesh's name presses its coast flank. A mesh without a backlash has
    one flank only, and its play is unknown. So if some torque runs against the names, every mesh
    needs a backlash, unless all torques do and no mesh has one.
    """
    if not _known(draft) or draft.operating is None:
        return
    against = against_the_names(draft)
    given = {n for n, m in draft.meshes.items() if m.given("backlash", "normal_backlash")}
    if not any(against) or (all(against) and not given):
        return
    for name in draft.meshes:
        if name not in given:
            why = "other meshes have one" if given else "presses the usual flanks elsewhere"
            message = f"is missing: the torque runs against the meshes' names, and {why}"
            hint = "The backlash determines when the other flank of the mesh carries load."
            yield draft.problem(("meshes", name, "backlash"), message, LENGTH.allowed, hint)


def _known(draft: Draft) -> bool:
    """Tell whether the paths can be followed at all; what prevents it is reported elsewhere."""
    if draft.operating is None or not draft.sound("gears", "meshes", "shafts"):
        return False
    named = {draft.operating.input, draft.operating.output, *draft.operating.external}
    return named | set(chain.from_iterable(_steps(draft))) <= set(draft.gears)


def _steps(draft: Draft) -> Steps:
    """Return the torque's steps from the input on, along the names of the meshes or against."""
    taken = draft.cached("steps", lambda: steps(draft))
    return backwards(taken) if _turned(draft) else taken


def _turned(draft: Draft) -> bool:
    """Return whether the input is where the meshes' names put the output."""
    return draft.cached("turned", lambda: from_the_other_end(draft))
