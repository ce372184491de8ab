"""Structures of random planetary sets: stars whose planets ride on a carrier."""

from __future__ import annotations

from collections.abc import Callable

from benchmarks.random_trains.dice import Dice
from benchmarks.random_trains.layouts import Layout, double_star, star, stepped_star


def _carried(star: Callable[[Dice], Layout]) -> Callable[[Dice], Layout]:
    """Return a star as a set: its planets on a carrier, any member held, driven and driving."""

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
            # Held by a mount that yields.
            del layout.gears[members[0]]["held"]
            layout.gears["housing"] = {"type": "carrier", "centre": ["0 m", "0 m"], "held": True}
            layout.radius["housing"] = layout.radius[inner]
            layout.shafts.append((members[0], "housing"))
        return layout

    return drawn


PLANETARY: dict[str, Callable[[Dice], Layout]] = {
    "planetary": _carried(star),
    "stepped planetary": _carried(stepped_star),
    "double planetary": _carried(double_star),
}
"""Every structure, by name."""
