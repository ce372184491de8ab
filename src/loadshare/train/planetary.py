"""The members of planetary sets: how they turn, from where they are seen, where their pins move."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from loadshare.train.gear import Gear, cross
from loadshare.train.ring import transverse
from loadshare.train.willis import NOISE, Links, along, seen_from


def members(
    gears: Mapping[str, Gear],
    meshes: Mapping[str, tuple[str, str]],
    shafts: Mapping[str, tuple[str, str]],
    walks: Mapping[str, str],
    first: str,
) -> tuple[dict[str, Gear], bool]:
    """Return the members of planetary sets with speeds, frames, pins, and senses that fit these.

    Parameters
    ----------
    gears : mapping of str to Gear
        Their senses walked, in a set those of the relative motion.
    meshes, shafts : mapping of str to (str, str)
    walks : mapping of str to str
        Gear from which the walk to each began: of all walks but that of the input the way round is
        anybody's guess.
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
    speeds, determined = Links.of(gears, meshes, shafts).speeds(first)
    frames = _frames(gears, meshes)
    relative = dict(speeds)
    for name, frame in frames.items():
        if gears[name].kind != "carrier":
            apart = speeds[name] - along(gears[name], gears[frame]) * speeds[frame]
            # What goes round with its carrier as one piece does not turn on it.
            relative[name] = apart if abs(apart) > NOISE * abs(speeds[frame]) else 0.0
    turned = {}
    for seed in dict.fromkeys(walks.values()):
        moving = (relative[name] for name, walk in walks.items() if walk == seed and relative[name])
        turned[seed] = -1 if seed != first and next(moving, 1.0) < 0.0 else 1
    found = {}
    for name, gear in gears.items():
        way = turned[walks[name]]
        found[name] = replace(
            gear,
            sense=way * gear.sense,
            ratio=way * speeds[name],
            relative=way * relative[name],
            frame_of=frames.get(name),
        )
    found |= {name: _on_pin(gear, found) for name, gear in found.items() if gear.carrier}
    radii = [gear.base_radius for gear in gears.values() if gear.kind != "carrier"]
    for name, gear in found.items():
        if gear.kind == "carrier":
            pins = [float(np.linalg.norm(g.seat)) for g in found.values() if g.carrier == name]
            found[name] = replace(gear, base_radius=max(pins or radii))
    return found, determined


def _on_pin(planet: Gear, gears: Mapping[str, Gear]) -> Gear:
    """Return a planet with the way of its pin per rotation of its carrier."""
    carrier = gears[planet.carrier or ""]
    arm = transverse(planet.centre - carrier.centre, carrier.axis)
    return replace(planet, seat=carrier.sense * cross(carrier.axis, arm))


def _frames(gears: Mapping[str, Gear], meshes: Mapping[str, tuple[str, str]]) -> dict[str, str]:
    """Carrier from which a member of a planetary set is seen."""
    found = {name: name for name, gear in gears.items() if gear.kind == "carrier"}
    for ends in meshes.values():
        carrier = seen_from(gears, *ends)
        if carrier is not None:
            found |= dict.fromkeys(ends, carrier)
    return found
