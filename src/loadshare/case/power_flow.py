"""Which way the torque runs through the meshes: along their names, or against them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from loadshare.case.gears import Gear

if TYPE_CHECKING:
    from loadshare.case.content import Sections

Steps = list[tuple[str, str]]


def steps(case: Sections) -> Steps:
    """Return the steps of the torque: driver to driven over meshes, either way over shafts.

    In a train with planetary sets it goes either way over all meshes and pins: which member drives
    is no matter of names, nor which way the power of a loop over several sets goes round.
    """
    found = [mesh.ends for mesh in case.meshes.values()]
    both = [shaft.ends for shaft in case.shafts.values()]
    both += found if has_sets(case.gears) else []
    both += [(name, gear.carrier) for name, gear in case.gears.items() if gear.carrier]
    for a, b in both:
        found += [(a, b), (b, a)]
    return found


def has_sets(gears: Mapping[str, Gear]) -> bool:
    """Tell whether a train has planetary sets, in which the load tells the flanks."""
    return any(gear.carrier for gear in gears.values())


def rides_on(gears: Mapping[str, Gear], *names: str) -> str | None:
    """Return the carrier on which one of some gears rides, if any."""
    riding = (gears[name].carrier for name in names if name in gears)
    return next((carrier for carrier in riding if carrier), None)


def on_one_shaft(gears: Iterable[str], shafts: Iterable[tuple[str, str]]) -> list[tuple[str, ...]]:
    """Return the gears that shafts join, in their order, and each of the others by itself."""
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
    """Return all gears, those nearer to one first, and as near by name, however they are written.

    Over meshes and shafts, and over pins from gears to their carriers.
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
    """Return the gears that steps lead to, the sources among them, through all gears but one."""
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
    """Return the same steps the other way."""
    return [(b, a) for a, b in taken]


def from_the_other_end(case: Sections) -> bool:
    """Tell whether the input is where the meshes' names put the output; not without a load."""
    operating = case.operating
    if operating is None:
        return False
    forward = steps(case)
    ahead, behind = reach([operating.input], forward), reach([operating.input], backwards(forward))
    return operating.output not in ahead and operating.output in behind


def against_the_names(case: Sections) -> tuple[bool, ...]:
    """Tell for every input torque whether it presses the flanks that the meshes' names do not.

    It does where the torque is negative (the input brakes), and where the input is at the other
    end; both together press the usual flanks.
    """
    turned = from_the_other_end(case)
    torques = case.operating.input_torque if case.operating else ()
    return tuple((torque < 0.0) != turned for torque in torques if torque)
