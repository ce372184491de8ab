"""Picture of critical values: when each element changes its state along an input."""

from __future__ import annotations

from typing import Any

from loadshare.numbers import Unit, counted, printed_unit
from loadshare.report.figure import Figure
from loadshare.report.figures import marks
from loadshare.report.figures.marks import axis, hover
from loadshare.report.palette import COLOURS, FAINT, SHAPES
from loadshare.report.vega_lite import Drawing, Row, channel, layer, panel
from loadshare.study.critical import Critical

WIDTH = 460
ROW = 24
"""Height of an element's row [px]."""
LABEL = 300
"""Longest name of an element [px]."""


def critical(found: Critical) -> Figure:
    """Draw the events of all positions: an element in a row, the input along x.

    Parameters
    ----------
    found : Critical

    Returns
    -------
    Figure
        Points by the kind of event; intervals without a proof are grey.
    """
    events: list[Row] = [
        {
            "value": event.value,
            "element": event.element,
            "event": event.kind,
            "position": event.position,
            "before": event.before,
            "after": event.after,
            "confirmed": "yes" if event.confirmed else "no",
        }
        for event in found.events
    ]
    elements = list(dict.fromkeys(e["element"] for e in events)) or ["no event"]
    kinds = list(dict.fromkeys(e["event"] for e in events))
    looks = {"domain": False, "ticks": False, "grid": True, "labelLimit": LABEL}
    layers: list[Drawing] = []
    if found.unproved:
        gaps = [
            {"start": u.start, "stop": u.stop, "position": u.position, "why": u.why}
            for u in found.unproved
        ]
        ends = {
            "x": axis("start:Q", None, [found.start, found.stop]),
            "x2": channel("stop"),
            "tooltip": hover(
                ("start:Q", "not proved from"), ("stop:Q", "to"), "position:Q", "why:N"
            ),
        }
        layers.append(layer("rect", gaps, ends, color=FAINT))
    colours = {"domain": kinds, "range": list(COLOURS[: len(kinds)])}
    shapes = {"domain": kinds, "range": [SHAPES[n % len(SHAPES)] for n in range(len(kinds))]}
    legend: Any = {"title": None, "orient": "bottom", "columns": 2} if kinds else None
    along = Unit(printed_unit(found.parameter.unit)).title(found.parameter.name)
    where = {
        "x": axis("value:Q", along, [found.start, found.stop]),
        "y": channel("element:N", title=None, scale={"domain": elements}, axis=looks),
        "color": channel("event:N", scale=colours, legend=legend),
        "shape": channel("event:N", scale=shapes, legend=legend),
        "tooltip": hover(
            ("value:Q", along, ".8g"),
            "position:Q",
            "element:N",
            "event:N",
            "before:N",
            "after:N",
            "confirmed:N",
        ),
    }
    points = events or [{"value": None, "element": "no event"}]
    layers.append(layer("point", points, where, filled=True, opacity=1, size=60))
    drawing = panel(layers, WIDTH, ROW * len(elements))
    open_ = f"{counted(len(found.unproved), 'interval')} not proved, grey" if found.unproved else ""
    return marks.figure("critical", drawing, "Where contacts, floats and splines change", open_)
