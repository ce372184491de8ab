"""Detection of planetary sets whose surroundings differ with direction.

A set is seen in the frame of its carrier, in which the housing turns backwards. The supports of its
other members look the same at every angle if each is the same in all directions, and if no member
is seen in two such frames at once.
"""

from __future__ import annotations

from loadshare.case.content import Sections
from loadshare.case.power_flow import rides_on


def is_uneven(case: Sections) -> bool:
    """Tell whether a set turns in surroundings that differ with direction.

    This depends on which keys are given, not on their values, so that all samples agree.
    """
    operating = case.operating
    turns = case.march is not None or (operating is not None and operating.rotation == "teeth")
    return turns and any(_differs(case, name, seen) for name, seen in _views(case).items())


def _differs(case: Sections, name: str, seen: set[str | None]) -> bool:
    """Return whether a gear's support has directions, or the gear moves in two frames at once."""
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
    """Return the carriers from which gears that ride on none are seen; None is the housing."""
    found: dict[str, set[str | None]] = {
        name: {name} for name, gear in case.gears.items() if gear.is_carrier
    }
    for mesh in case.meshes.values():
        carrier = rides_on(case.gears, *mesh.ends)
        for end in mesh.ends:
            if not case.gears[end].carrier:
                found.setdefault(end, set()).add(carrier)
    return {name: seen for name, seen in found.items() if seen != {None}}
