"""Structures of random planetary sets: stars whose planets ride on a carrier."""

from __future__ import annotations

import math
from collections.abc import Callable

from benchmarks.random_trains.dice import Dice
from benchmarks.random_trains.layouts import (
    Layout,
    double_star,
    polar,
    pressure,
    star,
    stepped_star,
)


def _carried(star: Callable[[Dice], Layout]) -> Callable[[Dice], Layout]:
    """Return a star as a set: planets on a carrier; any member is held, driven or driving."""

    def drawn(dice: Dice) -> Layout:
        layout = star(dice)
        inner, outer = layout.input, layout.output
        for name, gear in layout.gears.items():
            if name not in (inner, outer):
                gear["carrier"] = "carrier"
        layout.gears["carrier"] = {"type": "carrier", "centre": ["0 m", "0 m"]}
        layout.radius["carrier"] = layout.radius[inner]
        layout.floats |= {inner: None, outer: None, "carrier": None}
        members = [inner, outer, "carrier"]
        for end in ("input", "output"):
            setattr(layout, end, dice.pick(members))
            members.remove(getattr(layout, end))
        layout.gears[members[0]]["held"] = True
        if dice.chance(0.3):
            # The member is held by an elastic mount.
            del layout.gears[members[0]]["held"]
            layout.gears["housing"] = {"type": "carrier", "centre": ["0 m", "0 m"], "held": True}
            layout.radius["housing"] = layout.radius[inner]
            layout.shafts.append((members[0], "housing"))
        return layout

    return drawn


def _split(star: Callable[[Dice], Layout]) -> Callable[[Dice], Layout]:
    """Return a star as a set in which a layshaft joins two members: a loop; no member is held."""

    def drawn(dice: Dice) -> Layout:
        layout = _carried(star)(dice)
        held = next((n for n, gear in layout.gears.items() if gear.pop("held", False)), "")
        if layout.gears.pop("housing", None):
            held = layout.shafts.pop()[0]
        angle, about, far = pressure(dice), dice.between(0.05, 0.1), dice.between(0.05, 0.1)
        small = dice.between(0.3, 0.8) * (about + far)
        place = polar((about + far) / math.cos(angle), dice.angle())
        layout.gear("g1", about, 0j, -0.5)
        layout.gear("l1", far, place, -0.5)
        layout.gear("l2", about + far - small, place, -0.7)
        layout.gear("g2", small, 0j, -0.7)
        layout.meshes |= {("g1", "l1"): angle, ("l2", "g2"): angle}
        joined = dice.pick([layout.input, layout.output])
        if dice.chance(0.7):
            # A layshaft between sun and ring: only then may the senses contradict each other.
            if held == "carrier":
                layout.output, held = held, layout.output
            joined = layout.output if layout.input == "carrier" else layout.input
        layout.shafts += [(joined, "g1"), ("l1", "l2"), ("g2", held)]
        layout.floats |= {"l1": None, "l2": None}
        return layout

    return drawn


PLANETARY: dict[str, Callable[[Dice], Layout]] = {
    "planetary": _carried(star),
    "stepped planetary": _carried(stepped_star),
    "double planetary": _carried(double_star),
}
"""All structures of a single set by name."""
LOOPS: dict[str, Callable[[Dice], Layout]] = {
    "split planetary": _split(star),
    "split stepped planetary": _split(stepped_star),
    "split double planetary": _split(double_star),
}
"""All structures with a loop."""
