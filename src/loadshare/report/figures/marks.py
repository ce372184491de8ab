"""What all pictures are drawn with: rows of plain data, looks as scales, arrows as paths."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from typing import Any

import altair as alt
from altair.utils.schemapi import debug_mode

from loadshare.report.figure import Figure
from loadshare.report.figures.paths import Point
from loadshare.report.palette import DASHES, INK, SHAPES, SOFT, WARNING, Look

# Altair's types differ from mark to mark and from call to call; its schema checks a chart when it
# is turned into a specification.
Drawing = Any
Row = dict[str, Any]
Subtitle = str | Sequence[str]


class _Encoding(alt.FacetedEncoding):
    """Channels that charts share: Altair copies what it joins over and over, layer by layer."""

    def __deepcopy__(self, _: object) -> _Encoding:
        return self


class _Chart(alt.Chart):
    """A chart of which nothing is copied but the chart itself."""

    def __deepcopy__(self, _: object) -> _Chart:
        return self.copy(deep=False)

    def encode(self, *channels: Any, **named: Any) -> Any:
        drawn = super().encode(*channels, **named)
        drawn.encoding = _Encoding(**drawn.encoding._kwds)
        return drawn


def chart(rows: Sequence[Mapping[str, Any]]) -> Drawing:
    """Return a chart on plain rows."""
    # What is checked with the specification need not be checked row by row before.
    with debug_mode(False):
        return _Chart(alt.InlineData(values=tuple(rows)))


def channels(field: str, looks: Mapping[str, Look], title: str) -> dict[str, Any]:
    """Colour and shape by a field's names, with one legend.

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
    names = list(looks)
    legend = alt.Legend(title=title)

    def scale(values: list[Any]) -> alt.Scale:
        return alt.Scale(domain=names, range=values)

    found = distinct(looks)
    return {
        "color": alt.Color(f"{field}:N", scale=scale([v.colour for v in found]), legend=legend),
        "shape": alt.Shape(f"{field}:N", scale=scale([v.shape for v in found]), legend=legend),
    }


def dashed_lines(
    rows: Sequence[Row], field: str, looks: Mapping[str, Look], width: float
) -> list[Drawing]:
    """Lines told apart by their dashes, a layer each: a scale of dashes would spoil the legend.

    Parameters
    ----------
    rows : sequence of dict
    field : str
        Field that holds the names.
    looks : mapping of name to Look
    width : float
        Of the lines [px].
    """
    layers = []
    for name, use in zip(looks, distinct(looks), strict=True):
        own = [row for row in rows if row[field] == name]
        if own:
            layers.append(chart(own).mark_line(strokeWidth=width, strokeDash=list(use.dash)))
    return layers


def distinct(looks: Mapping[str, Look]) -> list[Look]:
    """Looks in order, those that occurred before given another dash and shape."""
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
    order: str | None = None,
    width: float = 1.8,
    size: float = 26.0,
) -> list[Drawing]:
    """Lines with a point at every row; colour, dash and shape tell the names apart.

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
    order : str, optional
        Channel along which the points are joined; by default from left to right.
    width : float
        Of the lines [px].
    size : float
        Of the points [px²].
    """
    by_name = channels(field, looks, title)
    where = {"x": x, "y": y, "color": by_name["color"]}
    along = {"order": order} if order else {}
    lines = [line.encode(**where, **along) for line in dashed_lines(rows, field, looks, width)]
    points = chart(rows).mark_point(filled=True, size=size, opacity=1)
    return [*lines, points.encode(**where, shape=by_name["shape"], tooltip=tooltip)]


def rimmed(base: Drawing, colour: str, **style: Any) -> list[Drawing]:
    """Words with a white rim, which keeps them readable where they must cross a line.

    Parameters
    ----------
    base : Chart
        With the channel text.
    colour : str
    **style
        Of the text mark.
    """
    rim = base.mark_text(color="white", stroke="white", strokeWidth=3, opacity=0.8, **style)
    return [rim, base.mark_text(color=colour, **style)]


def path_rows(points: Iterable[Point], **fields: Any) -> list[Row]:
    """Rows of a path: x and y to seven digits, and their order."""
    return [
        {"x": float(f"{x:.7g}"), "y": float(f"{y:.7g}"), "order": k, **fields}
        for k, (x, y) in enumerate(points)
    ]


def padded(low: float, high: float, least: float, share: float = 0.08) -> list[float]:
    """Return a domain around `low` to `high`, at least `least` wide, with a margin."""
    middle, half = (low + high) / 2, max((high - low) / 2, least / 2)
    return [middle - half * (1 + 2 * share), middle + half * (1 + 2 * share)]


def heading(title: str, subtitle: Subtitle = "") -> alt.TitleParams:
    """Return the title of a picture or panel."""
    lines = [subtitle] if isinstance(subtitle, str) else list(subtitle)
    lines = [line for line in lines if line]
    return alt.TitleParams(text=title, subtitle=lines) if lines else alt.TitleParams(text=title)


def figure(name: str, drawing: Drawing, title: str, subtitle: Subtitle = "") -> Figure:
    """Return a drawing as a figure under a title."""
    return Figure(name, drawing.properties(title=heading(title, subtitle)))


def hover(*fields: str | tuple[str, ...]) -> list[alt.Tooltip]:
    """Return what the tooltip shows: fields by their own names, or (field, title, format)."""
    named = [(f, f.partition(":")[0]) if isinstance(f, str) else f for f in fields]
    return [
        alt.Tooltip(field, title=title, format=form[0] if form else alt.Undefined)
        for field, title, *form in named
    ]


def axis(
    channel: type[Any],
    field: str,
    title: str | None,
    domain: Sequence[float] | None = None,
    *,
    scale: Mapping[str, Any] | None = None,
    **look: Any,
) -> Any:
    """Return the channel of an axis that ends where its values do, not at round figures.

    Parameters
    ----------
    channel : type
        Such as ``alt.X``.
    field : str
    title : str or None
    domain : sequence of float, optional
        Ends of the axis.
    scale : mapping, optional
        Further settings of the scale.
    **look
        Of the axis.
    """
    ends = alt.Undefined if domain is None else list(domain)
    drawn = {"axis": alt.Axis(**look)} if look else {}
    return channel(
        field, title=title, scale=alt.Scale(nice=False, domain=ends, **scale or {}), **drawn
    )


def stages(panels: Sequence[Drawing]) -> Drawing:
    """Return the panels of stages side by side, each with its own legend."""
    grid = alt.concat(*panels, columns=2)
    return grid.resolve_scale(color="independent", shape="independent")


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
            axis(channel, f"{name}:Q", title, (a, b), scale={"zero": False}, **look)
            for channel, name, title, a, b in zip(
                (alt.X, alt.Y), "xy", titles, low, high, strict=True
            )
        )

    def line(
        self, rows: Sequence[Row], by: str = "", tooltip: Any = None, **style: Any
    ) -> list[Drawing]:
        """Return paths as a layer, one for each value of the field `by`; no layer without rows.

        Rows may have a colour each; a filled path is filled with it.
        """
        # Channels, not their short forms: to find out which is meant, Altair hashes its schema.
        encoding: dict[str, Any] = {"order": alt.Order("order:Q")}
        encoding |= {"detail": alt.Detail(f"{by}:N")} if by else {}
        encoding |= {"tooltip": tooltip} if tooltip else {}
        if rows and "colour" in rows[0]:
            encoding["stroke"] = alt.Stroke("colour:N", scale=None)
            encoding |= {"fill": alt.Fill("colour:N", scale=None)} if style.get("filled") else {}
        drawn = chart(rows).mark_line(**style)
        return [drawn.encode(x=self.x, y=self.y, **encoding)] if rows else []

    def points(self, rows: Sequence[Row], tooltip: Any, **style: Any) -> list[Drawing]:
        """Return points as a layer; no layer without rows."""
        drawn = chart(rows).mark_point(opacity=1, **style)
        return [drawn.encode(x=self.x, y=self.y, tooltip=tooltip)] if rows else []


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
    """Upright rules with words along them, on the side with space; else only in the tooltip.

    Parameters
    ----------
    rows : sequence of dict
        Each with ``x`` and ``text``; ``warns`` makes it a full line in the colour of warnings,
        ``top`` is where its words begin below the upper end of the rule [px].
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
        groups = dict.fromkeys((side, row.get("top", TOP)) for row, side in own if side)
        for side, top in groups if words else ():
            named = [row for row, s in own if s == side and row.get("top", TOP) == top]
            text = chart(named).encode(**where, y=alt.value(top), text="text:N")
            layers += rimmed(text, WARNING if warns else INK, **BESIDE[side])
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
