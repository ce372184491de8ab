"""The page's pictures: computed curves, with the printed values marked on them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from loadshare.numbers import decimals
from loadshare.report.figure import Figure
from loadshare.report.figures import marks
from loadshare.report.figures.marks import (
    axis,
    channels,
    curves,
    heading,
    hover,
    padded,
    rimmed,
    rules,
)
from loadshare.report.palette import FAINT, INK, Look
from loadshare.report.vega_lite import OWN_LEGENDS, Channel, Drawing, Row, channel, joined, layer
from loadshare.report.vega_lite import panel as one_panel

WIDTH, HEIGHT = 330, 250
PAPER = "paper"
SIDES: dict[str, dict[str, Any]] = {
    "right": {"align": "left", "dx": 9},
    "left": {"align": "right", "dx": -9},
    "right above": {"align": "left", "dx": 6, "dy": -9},
    "left above": {"align": "right", "dx": -6, "dy": -9},
    "left below": {"align": "right", "dx": 4, "dy": 14},
}
"""Placement of text relative to a mark."""
CROSS = "M-0.7,-0.7L0.7,0.7M-0.7,0.7L0.7,-0.7"


@dataclass(frozen=True)
class Printed:
    """A printed figure in a panel.

    Attributes
    ----------
    x, y : float
    text : str
        Text beside its mark.
    side : str
        Side of the mark on which the text is placed: one of `SIDES`.
    """

    x: float
    y: float
    text: str = PAPER
    side: str = "right"


@dataclass(frozen=True)
class Level:
    """A printed value that is constant over x, in the colour of a curve.

    Attributes
    ----------
    y : float
    name : str
        Of the curve.
    along : float
        Start of its label, from 0 (left) to 1.
    below : bool
        Whether the label is below it.
    """

    y: float
    name: str
    along: float = 0.0
    below: bool = False


@dataclass(frozen=True)
class Panel:
    """One plot of a picture.

    Attributes
    ----------
    title : str
    x_title, y_title : str
        With units.
    curves : mapping of name to points (x, y)
    looks : mapping of name to Look
    named : str
        Title of the legend: "gear", "mesh".
    printed : sequence of Printed
    band : (low, high) or None
        Printed range of y, shaded.
    rules : sequence of (x, text)
        Vertical lines at events, with labels.
    levels : sequence of Level
    least : float
        Smallest range of the y axis, so that small differences do not look large.
    true_to_shape : bool
        Equal scales on both axes.
    ticks : sequence of float
        Of the x axis, if round numbers do not suit it.
    """

    title: str
    x_title: str
    y_title: str
    curves: Mapping[str, Sequence[tuple[float, float]]]
    looks: Mapping[str, Look]
    named: str
    printed: Sequence[Printed] = ()
    band: tuple[float, float] | None = None
    rules: Sequence[tuple[float, str]] = ()
    levels: Sequence[Level] = ()
    least: float = 0.0
    true_to_shape: bool = False
    ticks: Sequence[float] = ()


def picture(name: str, title: str, subtitle: str, panels: Sequence[Panel]) -> Figure:
    """Return panels side by side.

    Parameters
    ----------
    name : str
        Name of the file.
    title, subtitle : str
        Heading, and the meaning of the marks.
    panels : sequence of Panel
    """
    columns = 3 if len(panels) == 3 else 2
    drawn = [_panel(one, columns) for one in panels]
    whole = joined("concat", drawn, columns=columns, resolve=OWN_LEGENDS)
    return marks.figure(name, whole, title, subtitle)


def _panel(panel: Panel, columns: int) -> Drawing:
    rows = _rows(panel)
    x, y = _axes(panel, rows)
    colour = channels("name", panel.looks, panel.named)["color"]
    layers: list[Any] = []
    if panel.band:
        low, high = panel.band
        ends = {"y": y, "y2": channel("y2")}
        layers.append(layer("rect", [{"y": low, "y2": high}], ends, color=FAINT))
    for level in panel.levels:
        line = [{"y": level.y, "name": level.name, "text": f"{PAPER}, {level.name}"}]
        across = {"y": y, "color": colour}
        layers.append(layer("rule", line, across, strokeDash=[1, 3], strokeWidth=1.6))
        place = {"x": {"value": 4 + level.along * WIDTH}, "y": y}
        side = {"baseline": "top", "dy": 4} if level.below else {"baseline": "bottom", "dy": -2}
        layers += rimmed(line, place, INK, align="left", fontSize=10, **side)
    tooltip = hover(("name:N", panel.named), ("x:Q", panel.x_title), ("y:Q", panel.y_title, ".6~g"))
    order = channel("order:Q")
    layers += curves(rows, "name", panel.looks, panel.named, x=x, y=y, tooltip=tooltip, order=order)
    width = WIDTH if columns == 2 else 235
    if panel.rules:
        events = [{"x": at, "text": text} for at, text in panel.rules]
        xs = [row["x"] for row in (*rows, *events)]
        layers += rules(events, x, width / (max(xs) - min(xs)))
    layers += _printed(panel.printed, x, y)
    height = WIDTH if panel.true_to_shape else HEIGHT
    return one_panel(layers, width, height, title=heading(panel.title))


def _rows(panel: Panel) -> list[Row]:
    """Return the points of all curves, rounded so that round-off does not change the file."""
    points = [point for curve in panel.curves.values() for point in curve]
    of_x, of_y = (decimals(values, 7) for values in zip(*points, strict=True))
    return [
        {"x": round(x, of_x) + 0.0, "y": round(y, of_y) + 0.0, "name": name, "order": k}
        for name, curve in panel.curves.items()
        for k, (x, y) in enumerate(curve)
    ]


def _axes(panel: Panel, rows: Sequence[Row]) -> tuple[Channel, Channel]:
    """Return both axes, around the curves and the printed values."""
    xs = [r["x"] for r in rows] + [p.x for p in panel.printed]
    ys = [r["y"] for r in rows] + [p.y for p in panel.printed]
    ys += [*(panel.band or ()), *(level.y for level in panel.levels)]
    if panel.true_to_shape:
        middles = [(min(v) + max(v)) / 2 for v in (xs, ys)]
        side = max(max(v) - min(v) for v in (xs, ys))
        domains = [padded(m - side / 2, m + side / 2, side) for m in middles]
        scales: list[dict[str, Any]] = [{"domain": ends, "zero": False} for ends in domains]
    else:
        domain = padded(min(ys), max(ys), panel.least)
        scales = [{"zero": False, "padding": 6}, {"domain": domain}]
    # A tick count beside given ticks would thin them out.
    ticks = {"values": list(panel.ticks)} if panel.ticks else {"tickCount": 6}
    x = axis("x:Q", panel.x_title, scale=scales[0], **ticks, grid=panel.true_to_shape)
    return x, axis("y:Q", panel.y_title, scale=scales[1], tickCount=6)


def _printed(printed: Sequence[Printed], x: Channel, y: Channel) -> list[Drawing]:
    """Draw oblique crosses in ink, each with its label."""
    if not printed:
        return []
    rows = [{"x": p.x, "y": p.y, "text": p.text, "side": p.side} for p in printed]
    where = {"x": x, "y": y}
    cross = {"shape": CROSS, "size": 90, "filled": False, "color": INK, "strokeWidth": 2}
    layers = [layer("point", rows, where, opacity=1, **cross)]
    for side, style in SIDES.items():
        own = [row for row in rows if row["side"] == side]
        if own:
            layers += rimmed(own, where, INK, **style, fontSize=10)
    return layers
