"""Picture of a comparison: measured figures against those that are computed."""

from __future__ import annotations

from loadshare.numbers import NONE, counted
from loadshare.report.figure import Figure
from loadshare.report.figures import marks
from loadshare.report.figures.marks import axis, hover, padded
from loadshare.report.palette import COLOURS, FAINT, SOFT
from loadshare.report.vega_lite import Row, channel, layer, panel
from loadshare.study.compare import Comparison

WIDTH = 340
ROW = 22
"""Height of a figure's row [px]."""
LABEL = 300
"""Longest name of a figure [px]."""
EXPECTED = 2.0
"""Standard deviations within which 95 % of the figures should lie."""


def comparison(found: Comparison) -> Figure:
    """Draw every measured figure: computed less measured, in standard deviations.

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
            "unit": d.target.unit or NONE,
        }
        for d in found.deviations
    ]
    names = [row["figure"] for row in rows]
    reach = [EXPECTED, -EXPECTED, *(row["deviations"] for row in rows)]
    title = "computed less measured, in standard deviations"
    domain = padded(min(reach), max(reach), 1.0)
    looks = {"domain": False, "ticks": False, "labelLimit": LABEL}
    where = {
        "x": axis("deviations:Q", title, domain),
        "y": channel("figure:N", sort=names, title=None, axis=looks),
        "tooltip": hover(
            "figure:N",
            ("measured:Q", "measured", ".6g"),
            ("uncertainty:Q", "±", ".3g"),
            ("computed:Q", "computed", ".6g"),
            "unit:N",
            ("deviations:Q", "in standard deviations", "+.2f"),
        ),
    }
    band = {"x": axis("low:Q", title, domain), "x2": channel("high")}
    layers = [
        layer("rect", [{"low": -EXPECTED, "high": EXPECTED}], band, color=FAINT),
        layer("rule", [{"at": 0.0}], {"x": channel("at:Q")}, color=SOFT),
        layer("point", rows, where, filled=True, opacity=1, size=60, color=COLOURS[0]),
    ]
    drawing = panel(layers, WIDTH, ROW * len(rows))
    subtitle = [
        f"χ² = {found.chi_square:.4g} over {counted(len(rows), 'figure')}",
        f"grey: ±{EXPECTED:g} standard deviations of the measurement",
    ]
    return marks.figure("comparison", drawing, "Measured against computed", subtitle)


def _name(key: str, position: int | None) -> str:
    return f"{key} at {position}" if position else key
