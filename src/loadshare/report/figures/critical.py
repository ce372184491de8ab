"""Picture of critical values: when each element changes its state along an input."""

from __future__ import annotations

import altair as alt

from loadshare.report.figure import Figure
from loadshare.report.figures import marks
from loadshare.report.figures.marks import Drawing, axis, chart, hover
from loadshare.report.palette import COLOURS, FAINT, SHAPES
from loadshare.study.critical import Critical

WIDTH = 460
ROW = 24
"""Height of an element's row [px]."""
LABEL = 300
"""Longest name of an element [px]."""


def critical(found: Critical) -> Figure:
    """Picture of the events of all positions: an element in a row, the input along x.

    Parameters
    ----------
    found : Critical

    Returns
    -------
    Figure
        Points by the kind of event; intervals without a proof are grey.
    """
    events = [
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
    x = axis(alt.X, "value:Q", found.parameter.column, [found.start, found.stop])
    looks = alt.Axis(domain=False, ticks=False, grid=True, labelLimit=LABEL)
    y = alt.Y("element:N", title=None, scale=alt.Scale(domain=elements), axis=looks)
    layers: list[Drawing] = []
    if found.unproved:
        gaps = [
            {"start": u.start, "stop": u.stop, "position": u.position, "why": u.why}
            for u in found.unproved
        ]
        ends = {"x": axis(alt.X, "start:Q", None, [found.start, found.stop]), "x2": "stop:Q"}
        tooltip = hover(("start:Q", "not proved from"), ("stop:Q", "to"), "position:Q", "why:N")
        layers.append(chart(gaps).mark_rect(color=FAINT).encode(**ends, tooltip=tooltip))
    colours = alt.Scale(domain=kinds, range=list(COLOURS[: len(kinds)]))
    shapes = alt.Scale(domain=kinds, range=[SHAPES[n % len(SHAPES)] for n in range(len(kinds))])
    legend = alt.Legend(title=None, orient="bottom", columns=2)
    points = chart(events or [{"value": None, "element": "no event"}])
    layers.append(
        points.mark_point(filled=True, opacity=1, size=60).encode(
            x=x,
            y=y,
            color=alt.Color("event:N", scale=colours, legend=legend if kinds else None),
            shape=alt.Shape("event:N", scale=shapes, legend=legend if kinds else None),
            tooltip=hover(
                ("value:Q", found.parameter.column, ".8g"),
                "position:Q",
                "element:N",
                "event:N",
                "before:N",
                "after:N",
                "confirmed:N",
            ),
        )
    )
    drawing = alt.layer(*layers).properties(width=WIDTH, height=ROW * len(elements))
    open_ = f"{len(found.unproved)} intervals not proved, grey" if found.unproved else ""
    return marks.figure("critical", drawing, "Where contacts, floats and splines change", open_)
