"""Elements of all pictures: looks as scales, lines, words, axes, rules."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from typing import Any

from loadshare.report.figure import Figure
from loadshare.report.figures.paths import Point
from loadshare.report.palette import DASHES, INK, SHAPES, SOFT, WARNING, Look
from loadshare.report.vega_lite import OWN_LEGENDS, Channel, Drawing, Row, channel, joined, layer

Subtitle = str | Sequence[str]
LETTERS = 150
"""Most letters of a line of a subtitle: titles of cases may be of any length."""


def channels(field: str, looks: Mapping[str, Look], title: str) -> dict[str, Any]:
    """Return colour and shape by a field's names, with one legend.

    Parameters
    ----------
    field : str
        Field that holds the names.
    looks : mapping of name to Look
    title : str
        Of the legend.

    Returns
    -------
    dict
        Channels by name; a mark takes those that it knows.
    """
    found = distinct(looks)

    def by_name(values: list[Any]) -> Channel:
        scale = {"domain": list(looks), "range": values}
        return channel(f"{field}:N", scale=scale, legend={"title": title})

    return {
        "color": by_name([v.colour for v in found]),
        "shape": by_name([v.shape for v in found]),
    }


def distinct(looks: Mapping[str, Look]) -> list[Look]:
    """Return looks in order; repeated ones get another dash and shape."""
    found: list[Look] = []
    for wanted in looks.values():
        use, number = wanted, 0
        while use in found and number < len(SHAPES):
            number += 1
            dash = DASHES[(DASHES.index(wanted.dash) + number) % len(DASHES)]
            shape = SHAPES[(SHAPES.index(wanted.shape) + number) % len(SHAPES)]
            use = Look(wanted.colour, dash, shape)
        found.append(use)
    return found


def curves(
    rows: Sequence[Row],
    field: str,
    looks: Mapping[str, Look],
    title: str,
    *,
    x: Any,
    y: Any,
    tooltip: Any,
    order: Channel | None = None,
    width: float = 1.8,
    size: float = 26.0,
) -> list[Drawing]:
    """Return lines with a point at every row; colour, dash and shape distinguish the names.

    Parameters
    ----------
    rows : sequence of dict
    field : str
        Field that holds the names.
    looks : mapping of name to Look
    title : str
        Of the legend.
    x, y : channel
    tooltip : list of channels
        Shown for each point.
    order : channel, optional
        Order in which the points are joined; by default from left to right.
    width : float
        Of the lines [px].
    size : float
        Of the points [px²].
    """
    by_name = channels(field, looks, title)
    where = {"x": x, "y": y, "color": by_name["color"]}
    shown = {**where, "shape": by_name["shape"], "tooltip": tooltip}
    along = where | ({"order": order} if order else {})
    # A layer for each dash: a scale of dashes would spoil the legend.
    lines = [
        layer("line", own, along, strokeWidth=width, strokeDash=list(use.dash))
        for name, use in zip(looks, distinct(looks), strict=True)
        if (own := [row for row in rows if row[field] == name])
    ]
    return [*lines, layer("point", rows, shown, filled=True, size=size, opacity=1)]


def rimmed(
    rows: Sequence[Row], channels: Mapping[str, Any], colour: str = "", **style: Any
) -> list[Drawing]:
    """Return words with a white rim, which keeps them readable where they must cross a line.

    Parameters
    ----------
    rows : sequence of dict
        Each with ``text``.
    channels : mapping
        Where the words are.
    colour : str
        Of the letters; without it each row has its own, ``colour``.
    **style
        Of the text mark.
    """
    words = {**channels, "text": channel("text:N")}
    rim = {"color": "white", "stroke": "white", "strokeWidth": 3, "opacity": 0.8}
    own = {} if colour else {"color": channel("colour:N", scale=None)}
    ink = {"color": colour} if colour else {}
    return [
        layer("text", rows, words, **rim, **style),
        layer("text", rows, words | own, **ink, **style),
    ]


def path_rows(points: Iterable[Point], **fields: Any) -> list[Row]:
    """Return the rows of a path: x and y to seven digits, and their order."""
    return [
        {"x": float(f"{x:.7g}"), "y": float(f"{y:.7g}"), "order": k, **fields}
        for k, (x, y) in enumerate(points)
    ]


def padded(low: float, high: float, least: float, share: float = 0.08) -> list[float]:
    """Return a domain around `low` to `high`, at least `least` wide, with a margin."""
    middle, half = (low + high) / 2, max((high - low) / 2, least / 2)
    return [middle - half * (1 + 2 * share), middle + half * (1 + 2 * share)]


def heading(title: str, subtitle: Subtitle = "") -> dict[str, Any]:
    """Return the title of a picture or panel."""
    given = [subtitle] if isinstance(subtitle, str) else subtitle
    lines = [line for text in given for line in textwrap.wrap(text, LETTERS)]
    return {"text": title, "subtitle": lines} if lines else {"text": title}


def figure(name: str, drawing: Drawing, title: str, subtitle: Subtitle = "") -> Figure:
    """Return a drawing as a figure under a title."""
    return Figure(name, drawing | {"title": heading(title, subtitle)})


def hover(*fields: str | tuple[str, ...]) -> list[Channel]:
    """Return what the tooltip shows: fields by their own names, or (field, title, format)."""
    named = [(f, f.partition(":")[0]) if isinstance(f, str) else f for f in fields]
    return [
        channel(field, title=title, **({"format": form[0]} if form else {}))
        for field, title, *form in named
    ]


def axis(
    field: str,
    title: str | None,
    domain: Sequence[float] | None = None,
    *,
    scale: Mapping[str, Any] | None = None,
    **look: Any,
) -> Channel:
    """Return the channel of an axis that ends where its values do, not at round figures.

    Parameters
    ----------
    field : str
    title : str or None
    domain : sequence of float, optional
        Ends of the axis.
    scale : mapping, optional
        Further settings of the scale.
    **look
        Of the axis.
    """
    ends = {} if domain is None else {"domain": list(domain)}
    drawn = {"axis": look} if look else {}
    return channel(field, title=title, scale={"nice": False, **ends, **(scale or {})}, **drawn)


def stages(panels: Iterable[Drawing]) -> Drawing:
    """Return the panels of stages side by side, each with its own legend."""
    return joined("concat", panels, columns=2, resolve=OWN_LEGENDS)


class Panel:
    """A panel that is true to shape.

    Parameters
    ----------
    low, high : (float, float)
        Its corners.
    titles : iterable of str
        Of both axes.
    **look
        Of the axes.

    Attributes
    ----------
    low, high : (float, float)
    x, y : channel
    """

    def __init__(self, low: Point, high: Point, titles: Iterable[str], **look: Any) -> None:
        self.low, self.high = low, high
        self.x, self.y = (
            axis(f"{name}:Q", title, ends, scale={"zero": False}, **look)
            for name, title, *ends in zip("xy", titles, low, high, strict=True)
        )

    def line(
        self, rows: Sequence[Row], by: str = "", tooltip: Any = None, **style: Any
    ) -> list[Drawing]:
        """Return paths as a layer, one for each value of the field `by`; no layer without rows.

        Rows may have a colour each; a filled path is filled with it.
        """
        if not rows:
            return []
        encoding = {"x": self.x, "y": self.y, "order": channel("order:Q")}
        encoding |= {"detail": channel(f"{by}:N")} if by else {}
        encoding |= {"tooltip": tooltip} if tooltip else {}
        if "colour" in rows[0]:
            coloured = ("stroke", "fill") if style.get("filled") else ("stroke",)
            encoding |= dict.fromkeys(coloured, channel("colour:N", scale=None))
        return [layer("line", rows, encoding, **style)]

    def points(self, rows: Sequence[Row], tooltip: Any, **style: Any) -> list[Drawing]:
        """Return points as a layer; no layer without rows."""
        encoding = {"x": self.x, "y": self.y, "tooltip": tooltip}
        return [layer("point", rows, encoding, opacity=1, **style)] if rows else []


BESIDE = {
    "left": {"angle": 270, "align": "right", "baseline": "bottom", "dy": -3, "fontSize": 10},
    "right": {"angle": 270, "align": "right", "baseline": "top", "dy": 4, "fontSize": 10},
}
"""Styles of words that run along a rule, by their side of it."""
BREADTH = 15.0
"""Room that words along a rule need next to it [px]."""
LETTER = 4.5
"""Length of a letter of these words, on average [px]."""
TOP = 4.0
"""Where they begin below the upper end of their rule [px]."""


def rules(
    rows: Sequence[Row], x: Any, pixels: float, *, tooltip: Any = None, words: bool = True
) -> list[Drawing]:
    """Return vertical rules with words along them where there is room; else only in the tooltip.

    Parameters
    ----------
    rows : sequence of dict
        Each with ``x`` and ``text``; ``warns`` makes it a full line in the colour of warnings,
        ``top`` is where its words begin below the upper end of the rule [px].
    x : channel
    pixels : float
        Pixels per unit of x.
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
            look = {"color": colour, "strokeDash": dash, "strokeWidth": 1.3}
            layers.append(layer("rule", [row for row, _ in own], where, **look))
        groups = dict.fromkeys((side, row.get("top", TOP)) for row, side in own if side)
        for side, top in groups if words else ():
            named = [row for row, s in own if s == side and row.get("top", TOP) == top]
            place = {**where, "y": {"value": top}}
            layers += rimmed(named, place, WARNING if warns else INK, **BESIDE[side])
    return layers


def _sides(places: Sequence[float]) -> list[str]:
    """Return the side of each rule [px, rising] with room for its words; empty if neither has."""
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
