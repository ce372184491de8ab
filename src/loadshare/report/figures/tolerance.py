"""Pictures of a tolerance study: how Ω scatters, and which input it comes from."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from loadshare.errors import LoadshareError
from loadshare.report.figure import Figure
from loadshare.report.figures.marks import Drawing, Row, chart, heading
from loadshare.report.figures.rules import rules
from loadshare.report.numbers import significant
from loadshare.report.palette import COLOURS, INK

if TYPE_CHECKING:
    import xarray as xr

BINS = 60
LEAST = 0.01
"""Margin of the axis where all samples have the same Ω."""
WIDTH, HEIGHT = 420, 190
ROW = 22
"""Height of an input's row [px]."""
MOST = 20
"""Inputs that are shown; the others are told as a number."""
BAR, TOTAL = COLOURS[0], COLOURS[1]


def tolerance(data: xr.Dataset, stage: str = "system") -> Figure:
    """Distribution of a stage's Ω with its limit, and the share of each input in its variance.

    Parameters
    ----------
    data : xarray.Dataset
        Either ``omega`` (sample, stage), or, for more samples than a picture should hold,
        ``count`` (stage, bin) with the coordinate ``edge`` (one more than bins). Optional:
        ``quantile`` (stage, level); ``exceedance``, ``exceedance_low``, ``exceedance_high``
        (stage), P(Ω > limit) and its 95 % interval, ``limit`` being an attribute of the
        dataset; ``first_order`` and ``total_order`` (stage, input), Sobol indices, each with
        ``…_low`` and ``…_high``.
    stage : str
        Stage to show.

    Returns
    -------
    Figure
        Histogram, cumulative distribution and, where indices are given, bars of the inputs.

    Raises
    ------
    LoadshareError
        If the stage, or what is needed to draw, is not there.
    """
    import altair as alt

    stages = [str(s) for s in data["stage"].values] if "stage" in data.coords else []
    if stage not in stages:
        raise LoadshareError(f"no stage {stage!r}. Allowed: {', '.join(stages) or 'none given'}")
    one = data.sel(stage=stage)
    edges, counts = _histogram(one)
    total = int(counts.sum())
    limit = one.attrs.get("limit")
    marks = _marks(one, limit)
    parts: list[Any] = [
        alt.vconcat(_bars(edges, counts, marks), _cumulative(edges, counts, marks), spacing=14)
    ]
    if "first_order" in one or "total_order" in one:
        parts.append(_inputs(one))
    told = [str(one.attrs.get("title") or one.attrs.get("case", "")), f"{total:,} samples"]
    if "over" in one.coords:
        told.append(f"torque over the mean of its {one['over'].item()}")
    if limit is not None and "exceedance" in one:
        told.append(_exceedance(one, float(limit)))
    name = "the system" if stage == "system" else f"stage {stage}"
    grid = alt.hconcat(*parts, spacing=40)
    return Figure("tolerance", grid.properties(title=heading(f"How Ω of {name} scatters", told)))


def _histogram(one: xr.Dataset) -> tuple[np.ndarray, np.ndarray]:
    if "count" in one and "edge" in one.coords:
        return one["edge"].values.astype(float), one["count"].values.astype(float)
    if "omega" not in one:
        raise LoadshareError(
            "a tolerance study to be drawn needs omega (sample, stage), or count (stage, bin) with "
            "the coordinate edge"
        )
    values = one["omega"].values
    values = values[np.isfinite(values)]
    if values.size == 0:
        raise LoadshareError("no sample of the tolerance study has a certified Ω")
    counts, edges = np.histogram(values, bins=BINS)
    return edges, counts.astype(float)


def _marks(one: xr.Dataset, limit: Any) -> list[Row]:
    """Values that are marked in the distribution: quantiles and the limit."""
    rows: list[Row] = []
    if "quantile" in one:
        rows += [
            {"x": float(v), "text": f"{significant(100.0 * float(p), 4)} %", "warns": False}
            for p, v in zip(one["level"].values, one["quantile"].values, strict=True)
        ]
    if limit is not None:
        rows.append({"x": float(limit), "text": "limit", "warns": True})
    return rows


def _reach(edges: np.ndarray, marks: list[Row]) -> tuple[float, float]:
    """Ends of the axis: all bins and all marks, with a margin."""
    every = [float(edges[0]), float(edges[-1]), *(row["x"] for row in marks)]
    room = 0.03 * (max(every) - min(every)) or LEAST
    return min(every) - room, max(every) + room


def _axis(edges: np.ndarray, marks: list[Row], title: str | None) -> Any:
    import altair as alt

    domain = alt.Scale(domain=list(_reach(edges, marks)), nice=False, zero=False)
    return alt.X("x:Q", title=title, scale=domain, axis=alt.Axis(tickCount=6, grid=False))


def _rules(edges: np.ndarray, marks: list[Row], x: Any, *, words: bool) -> list[Drawing]:
    import altair as alt

    low, high = _reach(edges, marks)
    hover = [alt.Tooltip("text:N", title="mark"), alt.Tooltip("x:Q", title="Ω", format=".5f")]
    return rules(marks, x, WIDTH / (high - low), tooltip=hover, words=words)


def _bars(edges: np.ndarray, counts: np.ndarray, marks: list[Row]) -> Drawing:
    import altair as alt

    part = counts / counts.sum()
    rows = [
        {"x": float(a), "x2": float(b), "share": float(v), "count": float(c)}
        for a, b, v, c in zip(edges[:-1], edges[1:], part, counts, strict=True)
    ]
    x = _axis(edges, marks, None)
    hover = [
        alt.Tooltip("x:Q", title="Ω from", format=".5f"),
        alt.Tooltip("x2:Q", title="to", format=".5f"),
        alt.Tooltip("share:Q", title="share of samples", format=".4%"),
    ]
    bars = chart(rows).mark_rect(color=BAR, opacity=0.85, stroke="white", strokeWidth=0.3)
    y = alt.Y("share:Q", title="share of samples", axis=alt.Axis(format="~%", tickCount=4))
    layers = [bars.encode(x=x, x2="x2:Q", y=y, y2=alt.datum(0), tooltip=hover)]
    return alt.layer(*layers, *_rules(edges, marks, x, words=True)).properties(
        width=WIDTH, height=HEIGHT
    )


def _cumulative(edges: np.ndarray, counts: np.ndarray, marks: list[Row]) -> Drawing:
    import altair as alt

    reached = np.concatenate([[0.0], np.cumsum(counts) / counts.sum()])
    rows = [{"x": float(v), "p": float(p)} for v, p in zip(edges, reached, strict=True)]
    x = _axis(edges, marks, "Ω")
    hover = [
        alt.Tooltip("x:Q", title="Ω", format=".5f"),
        alt.Tooltip("p:Q", title="samples at or below", format=".4%"),
    ]
    y = alt.Y("p:Q", title="samples at or below", axis=alt.Axis(format="~%", tickCount=4))
    line = chart(rows).mark_line(color=BAR, strokeWidth=1.8, point={"size": 12, "color": BAR})
    layers = [line.encode(x=x, y=y, tooltip=hover)]
    return alt.layer(*layers, *_rules(edges, marks, x, words=False)).properties(
        width=WIDTH, height=HEIGHT // 2
    )


def _inputs(one: xr.Dataset) -> Drawing:
    import altair as alt

    orders = [n for n in ("first_order", "total_order") if n in one]
    key = one[orders[-1]]
    by_size = key.isel(input=np.argsort(-np.nan_to_num(key.values)))
    names = [str(n) for n in by_size["input"].values]
    shown = names[:MOST]
    called = {"first_order": "alone", "total_order": "with all it interacts with"}
    rows: list[Row] = []
    for order in orders:
        for name in shown:
            row: Row = {"input": name, "order": called[order]}
            row["index"] = float(one[order].sel(input=name))
            for end in ("low", "high"):
                if f"{order}_{end}" in one:
                    row[end] = float(one[f"{order}_{end}"].sel(input=name))
            rows.append(row)
    domain = [called[order] for order in orders]
    colours = [BAR, TOTAL][: len(domain)]
    y = alt.Y("input:N", sort=shown, title=None, axis=alt.Axis(domain=False, ticks=False))
    offset = alt.YOffset("order:N", sort=domain)
    base = chart(rows).encode(y=y, yOffset=offset)
    hover = [
        alt.Tooltip("input:N"),
        alt.Tooltip("order:N", title="its part"),
        alt.Tooltip("index:Q", title="share of the variance", format=".4f"),
        *([alt.Tooltip("low:Q", format=".4f")] if "low" in rows[0] else []),
        *([alt.Tooltip("high:Q", format=".4f")] if "high" in rows[0] else []),
    ]
    bars = base.mark_bar(height=ROW * 0.36).encode(
        x=alt.X("index:Q", title="share of the variance of Ω", axis=alt.Axis(tickCount=5)),
        color=alt.Color(
            "order:N", scale=alt.Scale(domain=domain, range=colours), legend=alt.Legend(title=None)
        ),
        tooltip=hover,
    )
    layers: list[Any] = [bars]
    if "low" in rows[0] and "high" in rows[0]:
        layers.append(base.mark_rule(color=INK).encode(x="low:Q", x2="high:Q"))
    left = len(names) - len(shown)
    title = heading("Where it comes from", f"and {left} inputs of less effect" if left else "")
    return alt.layer(*layers).properties(width=260, height=ROW * len(shown), title=title)


def _exceedance(one: xr.Dataset, limit: float) -> str:
    told = f"P(Ω > {limit:g}) = {significant(float(one['exceedance']), 3)}"
    if "exceedance_low" in one and "exceedance_high" in one:
        low, high = float(one["exceedance_low"]), float(one["exceedance_high"])
        told += f" (95 %: {significant(low, 3)} to {significant(high, 3)})"
    return told
