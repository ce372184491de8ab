"""Picture of a comparison: measured figures against those that are computed."""

from __future__ import annotations

import altair as alt

from loadshare.report.figure import Figure
from loadshare.report.figures import marks
from loadshare.report.figures.marks import Row, chart, hover, padded
from loadshare.report.palette import COLOURS, FAINT, SOFT
from loadshare.study.compare import Comparison

WIDTH = 340
ROW = 22
"""Height of a figure's row [px]."""
LABEL = 300
"""Longest name of a figure [px]."""
EXPECTED = 2.0
"""Standard deviations within which 95 % of the figures should lie."""


def comparison(found: Comparison) -> Figure:
    """Picture of every measured figure: computed less measured, in standard deviations.

    Parameters
    ----------
    found : Comparison
    """
    rows: list[Row] = [
        {
            "figure": _name(d.target.key, d.target.position),
            "deviations": d.deviations,
            "measured": d.target.value,
            "uncertainty": d.target.uncertainty,
            "computed": d.computed,
            "unit": d.target.unit or "–",
        }
        for d in found.deviations
    ]
    names = [row["figure"] for row in rows]
    reach = [EXPECTED, -EXPECTED, *(row["deviations"] for row in rows)]
    title = "computed less measured, in standard deviations"
    scale = alt.Scale(domain=padded(min(reach), max(reach), 1.0), nice=False)
    x = alt.X("deviations:Q", title=title, scale=scale)
    looks = alt.Axis(domain=False, ticks=False, labelLimit=LABEL)
    y = alt.Y("figure:N", sort=names, title=None, axis=looks)
    band = alt.Chart(alt.InlineData(values=[{"low": -EXPECTED, "high": EXPECTED}]))
    drawing = alt.layer(
        band.mark_rect(color=FAINT).encode(x=alt.X("low:Q", title=title, scale=scale), x2="high:Q"),
        alt.Chart(alt.InlineData(values=[{"at": 0.0}])).mark_rule(color=SOFT).encode(x="at:Q"),
        chart(rows)
        .mark_point(filled=True, opacity=1, size=60, color=COLOURS[0])
        .encode(
            x=x,
            y=y,
            tooltip=hover(
                "figure:N",
                ("measured:Q", "measured", ".6g"),
                ("uncertainty:Q", "±", ".3g"),
                ("computed:Q", "computed", ".6g"),
                "unit:N",
                ("deviations:Q", "in standard deviations", "+.2f"),
            ),
        ),
    ).properties(width=WIDTH, height=ROW * len(rows))
    subtitle = [
        f"χ² = {found.chi_square:.4g} over {len(rows)} figures",
        f"grey: ±{EXPECTED:g} standard deviations of the measurement",
    ]
    return marks.figure("comparison", drawing, "Measured against computed", subtitle)


def _name(key: str, position: int | None) -> str:
    return f"{key} at {position}" if position else key
