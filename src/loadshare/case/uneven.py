"""Planetary sets whose surroundings differ from direction to direction.

A set is seen from its carrier, and the housing turns backwards about it. What holds the set's other
members looks the same all the way round if it is the same in all directions, and if no member moves
in two such views at once.
"""

from __future__ import annotations

from loadshare.case.content import Sections
from loadshare.case.power_flow import rides_on


def is_uneven(case: Sections) -> bool:
    """Tell whether a set turns whose surroundings do not look the same all the way round.

    It follows from which keys are given, not from their numbers, so that samples agree on it.
    """
    operating = case.operating
    turns = case.march is not None or (operating is not None and operating.rotation == "teeth")
    return turns and any(_differs(case, name, seen) for name, seen in _views(case).items())


def _differs(case: Sections, name: str, seen: set[str | None]) -> bool:
    """Whether what holds a gear has directions, or the gear moves in two views at once."""
    gear = case.gears[name]
    if isinstance(gear.support, tuple):
        return True
    limits = [s[name] for s in (case.rings, case.bearings) if name in s]
    if any("offset" in limit.model_fields_set for limit in limits):
        return True
    neighbours = getattr(case.rings.get(name), "neighbours", None)
    if neighbours or any(name in (ring.neighbours or ()) for ring in case.rings.values()):
        return True
    if len(seen) == 1:
        return False
    held = gear.support in (None, "rigid") and not gear.ovalisation
    return name in case.errors or case.floats(name) or not held


def _views(case: Sections) -> dict[str, set[str | None]]:
    """Carriers from which the gears that ride on none are seen, None for the housing."""
    found: dict[str, set[str | None]] = {
        name: {name} for name, gear in case.gears.items() if gear.is_carrier
    }
    for mesh in case.meshes.values():
        carrier = rides_on(case.gears, *mesh.ends)
        for end in mesh.ends:
            if not case.gears[end].carrier:
                found.setdefault(end, set()).add(carrier)
    return {name: seen for name, seen in found.items() if seen != {None}}
