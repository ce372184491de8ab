"""Members of planetary sets: their speeds, the carriers they are seen from, their pins' motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from loadshare.case.power_flow import on_one_shaft
from loadshare.train.gear import Gear, cross
from loadshare.train.ring import transverse
from loadshare.train.seen import seen_from, speed_on
from loadshare.train.willis import SpeedLinks


def members(
    gears: Mapping[str, Gear],
    meshes: Mapping[str, tuple[str, str]],
    shafts: Mapping[str, tuple[str, str]],
    first: str,
) -> tuple[dict[str, Gear], bool]:
    """Return the members of planetary sets with speeds, frames, pins, and senses that fit them.

    A planet's rotation counts along its sense on the carrier, that of any other gear along its
    sense in the housing: users give torques and clockings in these senses, and gears outside a set
    have no carrier. A gear that turns with a carrier as one piece has no sense on it and keeps the
    one that the walk found, unless a shaft leads out of the set.

    Parameters
    ----------
    gears : mapping of str to Gear
        With the senses that the walk found, the same at both ends of a shaft.
    meshes, shafts : mapping of str to (str, str)
    first : str
        The input gear.

    Returns
    -------
    gears : dict of str to Gear
    determined : bool
        Whether all speeds follow from that of the input.

    Raises
    ------
    ValueError
        If nothing can turn.
    """
    speeds, determined = SpeedLinks.of(gears, meshes, shafts).speeds(first)
    frames = _frames(gears, meshes)
    relative = dict(speeds)
    for name, frame in frames.items():
        if gears[name].kind != "carrier":
            both = speeds[name], speeds[frame]
            relative[name] = speed_on(gears[name], gears[frame], both)
    found = dict(gears)
    for group in on_one_shaft(gears, shafts.values()):
        # A gear at rest in the housing has no sense there.
        seen = [(speeds if relative[n] and not gears[n].carrier else relative)[n] for n in group]
        seen += [relative[name] for name in group]
        way = -1 if next(filter(None, seen), 1.0) < 0.0 else 1
        for name in group:
            found[name] = replace(
                gears[name],
                sense=way * gears[name].sense,
                ratio=way * speeds[name],
                relative=way * relative[name],
                frame_of=frames.get(name),
            )
    found |= {name: _on_pin(gear, found) for name, gear in found.items() if gear.carrier}
    radii = [gear.base_radius for gear in gears.values() if gear.kind != "carrier"]
    for name, gear in found.items():
        if gear.kind == "carrier":
            pins = [
                float(np.linalg.norm(g.pin_motion)) for g in found.values() if g.carrier == name
            ]
            found[name] = replace(gear, base_radius=max(pins or radii))
    return found, determined


def _on_pin(planet: Gear, gears: Mapping[str, Gear]) -> Gear:
    """Return a planet with the displacement of its pin per rotation of its carrier."""
    carrier = gears[planet.carrier or ""]
    arm = transverse(planet.centre - carrier.centre, carrier.axis)
    return replace(planet, pin_motion=carrier.sense * cross(carrier.axis, arm))


def _frames(gears: Mapping[str, Gear], meshes: Mapping[str, tuple[str, str]]) -> dict[str, str]:
    """Return the carrier from which each member of a planetary set is seen."""
    found = {name: name for name, gear in gears.items() if gear.kind == "carrier"}
    for ends in meshes.values():
        carrier = seen_from(gears, *ends)
        if carrier is not None:
            found |= dict.fromkeys(ends, carrier)
    return found
