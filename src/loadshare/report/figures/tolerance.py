"""Pictures of a tolerance study: how Ω scatters, and which inputs cause it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from loadshare.errors import LoadshareError
from loadshare.libraries import xr
from loadshare.numbers import counted, significant
from loadshare.report.figure import Figure
from loadshare.report.figures import marks as drawn
from loadshare.report.figures.marks import axis, heading, hover, rules
from loadshare.report.palette import COLOURS, INK
from loadshare.report.vega_lite import Channel, Drawing, Row, channel, joined, layer, panel

BINS = 60
LEAST = 0.01
"""Margin of the axis where all samples have the same Ω."""
WIDTH, HEIGHT = 420, 190
ROW = 22
"""Height of an input's row [px]."""
MOST = 20
"""Number of inputs that are shown at most; the others are only counted."""
BAR, TOTAL = COLOURS[0], COLOURS[1]
SHARE, BELOW = "share of samples", "samples at or below"
PERCENT: dict[str, Any] = {"format": "~%", "tickCount": 4}
HEADROOM = 1.3
"""Height of the histogram over that of its largest bar."""


def tolerance(data: xr.Dataset, stage: str = "system") -> Figure:
    """Draw the distribution of a stage's Ω with its limit, and each input's share in its variance.

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
        If the stage, or the data needed to draw, is missing.
    """
    stages = [str(s) for s in data["stage"].values] if "stage" in data.coords else []
    if stage not in stages:
        raise LoadshareError(f"no stage {stage!r}. Allowed: {', '.join(stages) or 'none given'}")
    one = data.sel(stage=stage)
    limit = one.attrs.get("limit")
    found = _Distribution(*_histogram(one), _marks(one, limit))
    parts = [joined("vconcat", [found.bars(), found.cumulative()], spacing=14)]
    if "first_order" in one or "total_order" in one:
        parts.append(_inputs(one))
    subtitle = [
        str(one.attrs.get("title") or one.attrs.get("case", "")),
        f"{int(found.counts.sum()):,} samples",
    ]
    if "over" in one.coords:
        subtitle.append(f"torque over the mean of its {one['over'].item()}")
    if limit is not None and "exceedance" in one:
        subtitle.append(_exceedance(one, float(limit)))
    name = "the system" if stage == "system" else f"stage {stage}"
    grid = joined("hconcat", parts, spacing=40)
    return drawn.figure("tolerance", grid, f"Distribution of Ω of {name}", subtitle)


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
    """Return the values that are marked in the distribution: quantiles and the limit."""
    rows: list[Row] = []
    if "quantile" in one:
        rows += [
            {"x": float(v), "text": f"{significant(100.0 * float(p), 4)} %", "warns": False}
            for p, v in zip(one["level"].values, one["quantile"].values, strict=True)
        ]
    if limit is not None:
        rows.append({"x": float(limit), "text": "limit", "warns": True})
    return rows


@dataclass(frozen=True)
class _Distribution:
    """Bins of Ω, and what is marked in them.

    Attributes
    ----------
    edges, counts : ndarray, shape (bins + 1,) and (bins,)
    marks : list of dict
    """

    edges: np.ndarray
    counts: np.ndarray
    marks: list[Row]

    def along(self, title: str | None, *, words: bool) -> tuple[Channel, list[Drawing]]:
        """Return an axis of Ω with all bins and all marks, and rules at the marks."""
        every = [float(self.edges[0]), float(self.edges[-1]), *(row["x"] for row in self.marks)]
        room = 0.03 * (max(every) - min(every)) or LEAST
        low, high = min(every) - room, max(every) + room
        x = axis("x:Q", title, [low, high], scale={"zero": False}, tickCount=6, grid=False)
        tooltip = hover(("text:N", "mark"), ("x:Q", "Ω", ".5f"))
        return x, rules(self.marks, x, WIDTH / (high - low), tooltip=tooltip, words=words)

    def bars(self) -> Drawing:
        """Draw the share of the samples in each bin."""
        part = self.counts / self.counts.sum()
        rows = [
            {"x": float(a), "x2": float(b), "share": float(v), "count": float(c)}
            for a, b, v, c in zip(self.edges[:-1], self.edges[1:], part, self.counts, strict=True)
        ]
        # The names of the marks are above the bars.
        room = HEADROOM if self.marks else 1.0
        x, marked = self.along(None, words=True)
        where = {
            "x": x,
            "x2": channel("x2"),
            "y": axis("share:Q", SHARE, [0.0, room * float(part.max())], **PERCENT),
            "y2": {"datum": 0},
            "tooltip": hover(
                ("x:Q", "Ω from", ".5f"), ("x2:Q", "to", ".5f"), ("share:Q", SHARE, ".4%")
            ),
        }
        style = {"color": BAR, "opacity": 0.85, "stroke": "white", "strokeWidth": 0.3}
        return panel([layer("rect", rows, where, **style), *marked], WIDTH, HEIGHT)

    def cumulative(self) -> Drawing:
        """Draw the share of the samples at or below each edge."""
        reached = np.concatenate([[0.0], np.cumsum(self.counts) / self.counts.sum()])
        rows = [{"x": float(v), "p": float(p)} for v, p in zip(self.edges, reached, strict=True)]
        x, marked = self.along("Ω", words=False)
        where = {
            "x": x,
            "y": channel("p:Q", title=BELOW, axis=PERCENT),
            "tooltip": hover(("x:Q", "Ω", ".5f"), ("p:Q", BELOW, ".4%")),
        }
        style = {"color": BAR, "strokeWidth": 1.8, "point": {"size": 12, "color": BAR}}
        return panel([layer("line", rows, where, **style), *marked], WIDTH, HEIGHT // 2)


def _inputs(one: xr.Dataset) -> Drawing:
    orders = [n for n in ("first_order", "total_order") if n in one]
    key = one[orders[-1]]
    by_size = key.isel(input=np.argsort(-np.nan_to_num(key.values)))
    names = [str(n) for n in by_size["input"].values]
    shown = names[:MOST]
    called = {"first_order": "alone", "total_order": "with interactions"}
    rows: list[Row] = []
    for order in orders:
        for name in shown:
            of = one.sel(input=name)
            ends = {e: float(of[f"{order}_{e}"]) for e in ("low", "high") if f"{order}_{e}" in one}
            rows.append({"input": name, "order": called[order], "index": float(of[order]), **ends})
    domain = [called[order] for order in orders]
    looks = {"domain": False, "ticks": False}
    where = {
        "y": channel("input:N", sort=shown, title=None, axis=looks),
        "yOffset": channel("order:N", sort=domain),
    }
    bounds = [end for end in ("low", "high") if any(end in row for row in rows)]
    tooltip = hover(
        "input:N",
        ("order:N", "share"),
        ("index:Q", "share of the variance", ".4f"),
        *((f"{end}:Q", end, ".4f") for end in bounds),
    )
    colours = {"domain": domain, "range": [BAR, TOTAL][: len(domain)]}
    bar = where | {
        "x": channel("index:Q", title="share of the variance of Ω", axis={"tickCount": 5}),
        "color": channel("order:N", scale=colours, legend={"title": None}),
        "tooltip": tooltip,
    }
    layers = [layer("bar", rows, bar, height=ROW * 0.36)]
    if len(bounds) == 2:
        span = where | {"x": channel("low:Q"), "x2": channel("high")}
        layers.append(layer("rule", rows, span, color=INK))
    left = len(names) - len(shown)
    others = f"and {counted(left, 'less influential input')}" if left else ""
    title = heading("Causes of the scatter", others)
    return panel(layers, 260, ROW * len(shown), title=title)


def _exceedance(one: xr.Dataset, limit: float) -> str:
    text = f"P(Ω > {limit:g}) = {significant(float(one['exceedance']), 3)}"
    if "exceedance_low" in one and "exceedance_high" in one:
        low, high = float(one["exceedance_low"]), float(one["exceedance_high"])
        text += f" (95 %: {significant(low, 3)} to {significant(high, 3)})"
    return text
