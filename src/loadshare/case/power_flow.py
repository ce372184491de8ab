"""Direction of the torque through the meshes: along their names, or against them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from loadshare.case.gears import Gear

if TYPE_CHECKING:
    from loadshare.case.content import Sections

Steps = list[tuple[str, str]]


def steps(case: Sections) -> Steps:
    """Return the steps of the torque: driver to driven over meshes, either way over shafts.

    In a train with planetary sets it goes either way over all meshes and pins: names decide neither
    which member drives nor which way power circulates in a loop over several sets.
    """
    found = [mesh.ends for mesh in case.meshes.values()]
    both = [shaft.ends for shaft in case.shafts.values()]
    both += found if has_sets(case.gears) else []
    both += [(name, gear.carrier) for name, gear in case.gears.items() if gear.carrier]
    for a, b in both:
        found += [(a, b), (b, a)]
    return found


def has_sets(gears: Mapping[str, Gear]) -> bool:
    """Tell whether a train has planetary sets, where the load decides which flanks are pressed."""
    return any(gear.carrier for gear in gears.values())


def rides_on(gears: Mapping[str, Gear], *names: str) -> str | None:
    """Return the carrier of the first of these gears that rides on one, or None."""
    riding = (gears[name].carrier for name in names if name in gears)
    return next((carrier for carrier in riding if carrier), None)


def on_one_shaft(gears: Iterable[str], shafts: Iterable[tuple[str, str]]) -> list[tuple[str, ...]]:
    """Return the groups of gears that shafts join, in the given order; others are groups of one."""
    order = {name: k for k, name in enumerate(gears)}
    together = {name: {name} for name in order}
    for one, other in shafts:
        joined = together[one] | together[other]
        together |= dict.fromkeys(joined, joined)
    groups = {id(group): group for group in together.values()}
    return [tuple(sorted(group, key=order.__getitem__)) for group in groups.values()]


def nearest_first(
    carriers: Mapping[str, str | None], links: Iterable[tuple[str, str]], first: str
) -> list[str]:
    """Return all gears, sorted by their number of links from the first, then by name.

    Links are meshes, shafts and the pins between gears and their carriers.
    """
    beside: dict[str, set[str]] = {name: set() for name in carriers}
    pins = [(name, carrier) for name, carrier in carriers.items() if carrier]
    for one, other in (*links, *pins):
        beside[one].add(other)
        beside[other].add(one)
    found: dict[str, None] = {}
    for start in (first, *sorted(carriers)):
        level = {start} - found.keys()
        while level:
            found |= dict.fromkeys(sorted(level))
            level = {name for here in level for name in beside[here]} - found.keys()
    return list(found)


def reach(sources: Iterable[str], taken: Steps, avoiding: str | None = None) -> set[str]:
    """Return the gears reached by steps from the sources, which are included, avoiding one gear."""
    ahead: dict[str, list[str]] = {}
    for a, b in taken:
        ahead.setdefault(a, []).append(b)
    reached = {source for source in sources if source != avoiding}
    fresh = [*reached]
    while fresh:
        for gear in ahead.get(fresh.pop(), ()):
            if gear not in reached and gear != avoiding:
                reached.add(gear)
                fresh.append(gear)
    return reached


def backwards(taken: Steps) -> Steps:
    """Return the same steps in the opposite direction."""
    return [(b, a) for a, b in taken]


def from_the_other_end(case: Sections) -> bool:
    """Tell whether the input is where the meshes' names put the output; False without a load."""
    operating = case.operating
    if operating is None:
        return False
    forward = steps(case)
    ahead, behind = reach([operating.input], forward), reach([operating.input], backwards(forward))
    return operating.output not in ahead and operating.output in behind


def against_the_names(case: Sections) -> tuple[bool, ...]:
    """Tell for every input torque but 0 whether it presses the flanks against the meshes' names.

    It does if the torque is negative (the input brakes) or the input is at the other end; with
    both, the usual flanks are pressed.
    """
    turned = from_the_other_end(case)
    torques = case.operating.input_torque if case.operating else ()
    return tuple((torque < 0.0) != turned for torque in torques if torque)
