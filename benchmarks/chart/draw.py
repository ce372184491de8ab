"""Work-precision charts, and time against the number of branches."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benchmarks.chart.measure import OURS, Measure
from benchmarks.drawing import altair, styled, write
from benchmarks.peers import PEERS

FLOOR = 1e-16
"""Smaller errors, below one rounding, are drawn here."""
COLOURS = {
    "ours, batch": "#b30000",
    "ours, batch (new case)": "#d9544f",
    "ours, batch (NumPy)": "#e06666",
    "ours, solve (new case)": "#b36b00",
    "ours, solve (again)": "#7a0000",
    "Clarabel, new": "#9ecae1",
    "Clarabel, update": "#3182bd",
    "Clarabel, update, reduced": "#6a51a3",
    "Clarabel, Picard": "#08519c",
    "power cone": "#54278f",
    "OSQP": "#31a354",
    "PIQP": "#a1d99b",
    "DAQP": "#006d2c",
    "DAQP, reduced": "#66c2a4",
    "moreau": "#969696",
    "CVXPY, rebuilt": "#fd8d3c",
    "CVXPY, parameters": "#e6a800",
    "SLSQP": "#636363",
    "trust-constr": "#bdbdbd",
    "trial states": "#000000",
}
SHAPES = (
    "circle",
    "square",
    "diamond",
    "triangle-up",
    "triangle-down",
    "cross",
    "triangle-right",
    "triangle-left",
)


def draw_precision(measures: Sequence[Measure], titles: dict[str, str], folder: Path) -> list[Path]:
    """Draw error against time, one panel per workload.

    A filled mark is the median error, the open mark above it the worst; a line joins them.

    Parameters
    ----------
    measures : sequence of Measure
    titles : dict of str
        Of the workloads, in order.
    folder : pathlib.Path

    Returns
    -------
    list of pathlib.Path
        The files.
    """
    alt = altair()

    colour, shape = _by_method(measures)
    panels = []
    for workload, title in titles.items():
        rows = [_row(m) for m in measures if m.workload == workload and math.isfinite(m.median)]
        base = alt.Chart(alt.Data(values=rows)).encode(
            x=alt.X("us:Q", title="µs per equilibrium", scale=_log(1.0, 1e6), axis=_powers()),
            color=colour,
            tooltip=[
                alt.Tooltip(f"{f}:N", title=f)
                for f in ("method", "tolerance", "time", "median error", "worst error", "certified")
            ],
        )
        error = alt.Y(
            "median:Q",
            title="relative error against 50 digits",
            scale=_log(FLOOR, 10.0),
            axis=_powers(),
        )
        panels.append(
            alt.layer(
                base.mark_rule(opacity=0.35).encode(y=error, y2="worst:Q"),
                base.mark_point(filled=False, size=45, opacity=0.8).encode(
                    y=alt.Y("worst:Q"), shape=shape
                ),
                base.mark_point(filled=True, size=70, opacity=1.0).encode(y=error, shape=shape),
            ).properties(title=title, width=330, height=250)
        )
    chart = alt.concat(*panels, columns=2).properties(
        title=alt.Title(
            "Speed against accuracy",
            subtitle="filled: median error, open: worst error; left and low is better",
        )
    )
    return write(styled(chart), folder / "speed")


def draw_branches(measures: Sequence[Measure], folder: Path) -> list[Path]:
    """Draw time per equilibrium against the number of branches.

    Returns
    -------
    list of pathlib.Path
        The files.
    """
    alt = altair()

    colour, shape = _by_method(measures)
    rows = [
        _row(m) | {"branches": int(m.workload.removeprefix("branches-"))}
        for m in measures
        if math.isfinite(m.microseconds)
    ]
    base = alt.Chart(alt.Data(values=rows)).encode(
        x=alt.X("branches:Q", scale=alt.Scale(type="log", base=2), axis=alt.Axis(format="d")),
        y=alt.Y("us:Q", title="µs per equilibrium", scale=alt.Scale(type="log"), axis=_powers()),
        color=colour,
        tooltip=[alt.Tooltip(f"{f}:N") for f in ("method", "branches", "time", "worst error")],
    )
    first = min((r["us"] for r in rows), default=1.0)
    slope = [{"branches": n, "us": first * (n / 4) ** 2} for n in (4, 64)]
    guide = (
        alt.Chart(alt.Data(values=slope))
        .mark_line(strokeDash=[4, 4], color="#888888")
        .encode(x="branches:Q", y="us:Q")
    )
    points = base.mark_point(filled=True, size=70).encode(shape=shape)
    chart = alt.layer(guide, base.mark_line(), points).properties(
        width=420,
        height=300,
        title=alt.Title(
            "Cost against the number of branches", subtitle="dashed: growth with the square"
        ),
    )
    return write(styled(chart), folder / "branches")


def _by_method(measures: Sequence[Measure]) -> tuple[Any, Any]:
    """Return colours and shapes of the methods that were measured."""
    alt = altair()

    names = [n for n in (*OURS, *PEERS) if any(m.method == n for m in measures)]
    legend = alt.Legend(title=None, symbolOpacity=1.0)
    shapes = [SHAPES[k % len(SHAPES)] for k in range(len(names))]
    colours = alt.Scale(domain=names, range=[COLOURS[n] for n in names])
    return (
        alt.Color("method:N", scale=colours, legend=legend),
        alt.Shape("method:N", scale=alt.Scale(domain=names, range=shapes), legend=legend),
    )


def _row(m: Measure) -> dict[str, Any]:
    return {
        "method": m.method,
        "us": m.microseconds,
        "median": min(max(m.median, FLOOR), 10.0),
        "worst": min(max(m.worst, FLOOR), 10.0),
        "tolerance": "–" if m.tolerance is None else f"{m.tolerance:.0e}",
        "time": f"{m.microseconds:.3g} µs",
        "median error": f"{m.median:.1e}",
        "worst error": f"{m.worst:.1e}",
        "certified": f"{m.certified} of {m.samples}",
    }


def _log(low: float, high: float) -> Any:
    alt = altair()

    return alt.Scale(type="log", domain=[low, high], clamp=True)


def _powers() -> Any:
    alt = altair()

    return alt.Axis(format=".0e", tickCount=6)
