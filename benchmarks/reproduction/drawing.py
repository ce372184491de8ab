"""The page's pictures: computed curves, with what the paper prints marked on them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from loadshare.report.figure import Figure
from loadshare.report.figures.marks import (
    Drawing,
    Row,
    channels,
    chart,
    curves,
    heading,
    padded,
    rimmed,
    rules,
)
from loadshare.report.numbers import decimals
from loadshare.report.palette import FAINT, INK, Look

WIDTH, HEIGHT = 330, 250
PAPER = "paper"
SIDES: dict[str, dict[str, Any]] = {
    "right": {"align": "left", "dx": 9},
    "left": {"align": "right", "dx": -9},
    "right above": {"align": "left", "dx": 6, "dy": -9},
    "left above": {"align": "right", "dx": -6, "dy": -9},
    "left below": {"align": "right", "dx": 4, "dy": 14},
}
"""Where text is placed relative to a mark."""
CROSS = "M-0.7,-0.7L0.7,0.7M-0.7,0.7L0.7,-0.7"


@dataclass(frozen=True)
class Printed:
    """A printed figure in a panel.

    Attributes
    ----------
    x, y : float
    text : str
        Beside its mark.
    side : str
        Of the mark on which the text is placed: one of `SIDES`.
    """

    x: float
    y: float
    text: str = PAPER
    side: str = "right"


@dataclass(frozen=True)
class Level:
    """A printed value that holds over all x, in the colour of a curve.

    Attributes
    ----------
    y : float
    name : str
        Of the curve.
    along : float
        Where its words begin, from 0 (left) to 1.
    below : bool
        Whether they are placed below it.
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
        What the names are: "gear", "mesh".
    printed : sequence of Printed
    band : (low, high) or None
        Printed range of y, shaded.
    rules : sequence of (x, text)
        Where something happens.
    levels : sequence of Level
    least : float
        Least height of the y axis: what is smaller shall not look large.
    true_to_shape : bool
        Equal scales on both axes.
    ticks : sequence of float
        Of the x axis, where round numbers would not do.
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
        Of the file.
    title, subtitle : str
        Heading, and what the marks mean.
    panels : sequence of Panel
    """
    import altair as alt

    columns = 3 if len(panels) == 3 else 2
    drawn = alt.concat(*(_panel(p, 2 if columns == 2 else 3) for p in panels), columns=columns)
    drawn = drawn.resolve_scale(color="independent", shape="independent")
    return Figure(name, drawn.properties(title=heading(title, subtitle)))


def _panel(panel: Panel, columns: int) -> Drawing:
    import altair as alt

    rows = _rows(panel)
    x, y = _axes(panel, rows)
    colour = channels("name", panel.looks, panel.named)["color"]
    layers: list[Any] = []
    if panel.band:
        low, high = panel.band
        area = chart([{"y": low, "y2": high}]).mark_rect(color=FAINT)
        layers.append(area.encode(y=y, y2="y2:Q"))
    for level in panel.levels:
        line = chart([{"y": level.y, "name": level.name}]).encode(y=y)
        rule = line.mark_rule(strokeDash=[1, 3], strokeWidth=1.6)
        layers.append(rule.encode(color=colour))
        words = line.encode(
            x=alt.value(4 + level.along * WIDTH),
            text=alt.value(f"{PAPER}, {level.name}"),
        )
        side = {"baseline": "top", "dy": 4} if level.below else {"baseline": "bottom", "dy": -2}
        layers += rimmed(words, INK, align="left", fontSize=10, **side)
    hover = [
        alt.Tooltip("name:N", title=panel.named),
        alt.Tooltip("x:Q", title=panel.x_title),
        alt.Tooltip("y:Q", title=panel.y_title, format=".6~g"),
    ]
    layers += curves(
        rows, "name", panel.looks, panel.named, x=x, y=y, tooltip=hover, order="order:Q"
    )
    width = WIDTH if columns == 2 else 235
    if panel.rules:
        marks = [{"x": at, "text": text} for at, text in panel.rules]
        xs = [row["x"] for row in (*rows, *marks)]
        layers += rules(marks, x, width / (max(xs) - min(xs)))
    layers += _printed(panel.printed, x, y)
    height = WIDTH if panel.true_to_shape else HEIGHT
    return alt.layer(*layers).properties(width=width, height=height, title=heading(panel.title))


def _rows(panel: Panel) -> list[Row]:
    """Points of all curves to seven digits of the largest: round-off shall not change the file."""
    points = [point for curve in panel.curves.values() for point in curve]
    of_x, of_y = (decimals(values, 7) for values in zip(*points, strict=True))
    return [
        {"x": round(x, of_x) + 0.0, "y": round(y, of_y) + 0.0, "name": name, "order": k}
        for name, curve in panel.curves.items()
        for k, (x, y) in enumerate(curve)
    ]


def _axes(panel: Panel, rows: Sequence[Row]) -> tuple[Any, Any]:
    """Both axes, around the curves and what is printed."""
    import altair as alt

    xs = [r["x"] for r in rows] + [p.x for p in panel.printed]
    ys = [r["y"] for r in rows] + [p.y for p in panel.printed]
    ys += [*(panel.band or ()), *(level.y for level in panel.levels)]
    if panel.true_to_shape:
        middles = [(min(v) + max(v)) / 2 for v in (xs, ys)]
        side = max(max(v) - min(v) for v in (xs, ys))
        domains = [padded(m - side / 2, m + side / 2, side) for m in middles]
        scales = [alt.Scale(domain=d, nice=False, zero=False) for d in domains]
    else:
        domain = padded(min(ys), max(ys), panel.least)
        scales = [
            alt.Scale(nice=False, zero=False, padding=6),
            alt.Scale(domain=domain, nice=False),
        ]
    # A count beside given ticks would thin them out.
    ticks = {"values": list(panel.ticks)} if panel.ticks else {"tickCount": 6}
    x_axis = alt.Axis(**ticks, grid=panel.true_to_shape)
    x = alt.X("x:Q", title=panel.x_title, scale=scales[0], axis=x_axis)
    y = alt.Y("y:Q", title=panel.y_title, scale=scales[1], axis=alt.Axis(tickCount=6))
    return x, y


def _printed(marks: Sequence[Printed], x: Any, y: Any) -> list[Drawing]:
    """Oblique crosses in ink, each with its words."""
    if not marks:
        return []
    rows = [{"x": m.x, "y": m.y, "text": m.text, "side": m.side} for m in marks]
    cross = chart(rows).mark_point(
        shape=CROSS, size=90, filled=False, color=INK, strokeWidth=2, opacity=1
    )
    layers: list[Drawing] = [cross.encode(x=x, y=y)]
    for side, style in SIDES.items():
        own = [row for row in rows if row["side"] == side]
        if own:
            words = chart(own).encode(x=x, y=y, text="text:N")
            layers += rimmed(words, INK, **style, fontSize=10)
    return layers
