"""Rules across a panel, at values at which something happens, with words along them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import altair as alt

from loadshare.report.figures.marks import Drawing, Row, chart, rimmed
from loadshare.report.palette import INK, SOFT, WARNING

BESIDE = {
    "left": {"angle": 270, "align": "right", "baseline": "bottom", "dy": -3, "fontSize": 10},
    "right": {"angle": 270, "align": "right", "baseline": "top", "dy": 4, "fontSize": 10},
}
"""Styles of words that run along a rule, by their side of it."""
BREADTH = 15.0
"""Room that words along a rule need beside it [px]."""


def rules(
    rows: Sequence[Row], x: Any, pixels: float, *, tooltip: Any = None, words: bool = True
) -> list[Drawing]:
    """Upright rules with words along them, on the side that has room; else hovering tells them.

    Parameters
    ----------
    rows : sequence of dict
        Each with ``x`` and ``text``; ``warns`` makes it a full line in the colour of warnings.
    x : channel
    pixels : float
        Of a unit of x.
    tooltip : list of channels, optional
    words : bool
        Whether the words are written.
    """
    ordered = sorted(rows, key=lambda row: row["x"])
    sides = _sides([row["x"] * pixels for row in ordered])
    sided = list(zip(ordered, sides, strict=True))
    where = {"x": x} | ({"tooltip": tooltip} if tooltip else {})
    layers: list[Drawing] = []
    for warns, colour, dash in ((False, SOFT, [4, 3]), (True, WARNING, [1, 0])):
        own = [(row, side) for row, side in sided if row.get("warns", False) is warns]
        if own:
            line = chart([row for row, _ in own]).encode(**where)
            layers.append(line.mark_rule(color=colour, strokeDash=dash, strokeWidth=1.3))
        for side, style in BESIDE.items() if words else ():
            told = [row for row, s in own if s == side]
            if told:
                text = chart(told).encode(**where, y=alt.value(4), text="text:N")
                layers += rimmed(text, WARNING if warns else INK, **style)
    return layers


def _sides(places: Sequence[float]) -> list[str]:
    """Side of each rule [px, rising] on which its words have room; empty where neither has."""
    sides: list[str] = []
    taken = -math.inf
    for place, following in pairwise([*places, math.inf]):
        if taken + BREADTH <= place:
            side, taken = "left", place
        elif place + BREADTH <= following:
            side, taken = "right", place + BREADTH
        else:
            side, taken = "", max(taken, place)
        sides.append(side)
    return sides
