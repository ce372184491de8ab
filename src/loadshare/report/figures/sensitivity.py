"""Picture of sensitivities: which inputs move Ω most."""

from __future__ import annotations

import math

from loadshare.arguments import one_of
from loadshare.errors import LoadshareError
from loadshare.numbers import counted
from loadshare.report.figure import Figure
from loadshare.report.figures import marks
from loadshare.report.figures.marks import hover
from loadshare.report.palette import COLOURS
from loadshare.report.vega_lite import Row, channel, layer
from loadshare.study.sensitivity import Sensitivity
from loadshare.study.tolerance.result import OVERS, Over

WIDTH = 320
ROW = 22
"""Height of an input's row [px]."""
MOST = 20
"""Number of inputs that are shown at most; the others are only counted."""
LABEL = 300
"""Longest name of an input [px]."""
ALIKE = 1e-6
"""Relative difference of both sides up to which they share a bar."""
BOTH = "either way"
CALLED = {"falling": "input falls", "rising": "input rises"}


def sensitivity(found: Sensitivity, stage: str = "system", over: Over = "stage") -> Figure:
    """Draw bars of how Ω of a stage changes with every input, largest first.

    A bar is the derivative times the whole value of the input, so that inputs of different units
    can be compared; an input that is 0 has none.

    Parameters
    ----------
    found : Sensitivity
    stage : str
    over : {"stage", "group"}
        Whose mean torque Ω is taken over.

    Raises
    ------
    LoadshareError
        If no input has an effect on such a stage.
    ValueError
        If there is no such mean.
    """
    one_of("over", over, OVERS)
    rates = found.omega if over == "stage" else found.pair_omega
    stages = list(dict.fromkeys(name for by_stage in rates.values() for name in by_stage))
    if stages and stage not in stages:
        raise LoadshareError(f"no stage {stage!r}. Allowed: {', '.join(stages)}")
    bars: dict[str, list[Row]] = {}
    for item in found.inputs:
        value = item.value
        by_side = {
            side: rates[item.key, side].get(stage, math.nan) * value.factor for side in found.sides
        }
        known = {side: rate for side, rate in by_side.items() if math.isfinite(rate)}
        low, high = min(known.values(), default=0.0), max(known.values(), default=0.0)
        if len(known) == len(found.sides) and high - low <= ALIKE * max(abs(low), abs(high)):
            known = {BOTH: high}
        about = {"input": item.key, "value": f"{value.number:.6g} {value.unit}".strip()}
        bars[item.key] = [
            about
            | {"side": CALLED.get(side, side), "rate": rate, "unit": f"per {value.unit or 1}"}
            | {"change": rate * abs(value.number)}
            for side, rate in known.items()
        ]
    order = sorted(bars, key=lambda key: -max((abs(r["change"]) for r in bars[key]), default=0.0))
    shown = [key for key in order if any(row["change"] for row in bars[key])][:MOST]
    rows = [row for key in shown for row in bars[key]]
    name = "the system" if stage == "system" else f"stage {stage}"
    if not rows:
        raise LoadshareError(f"no input is known to change Ω of {name}, so nothing can be drawn")
    sides = [side for side in (BOTH, *CALLED.values()) if any(r["side"] == side for r in rows)]
    axis = {"domain": False, "ticks": False, "labelLimit": LABEL}
    colours = {"domain": sides, "range": list(COLOURS[: len(sides)])}
    several = len(sides) > 1
    legend = {"title": None, "orient": "bottom"} if several else None
    bar = {
        "x": channel("change:Q", title="change of Ω over the whole value of the input"),
        "y": channel("input:N", sort=shown, title=None, axis=axis),
        "color": channel("side:N", scale=colours, legend=legend),
        "tooltip": hover(
            "input:N",
            "value:N",
            ("side:N", "side"),
            ("rate:Q", "dΩ", "+.4g"),
            ("unit:N", "which is"),
            ("change:Q", "over its whole value", "+.4g"),
        ),
    } | ({"yOffset": channel("side:N", sort=sides)} if several else {})
    size = {"width": WIDTH, "height": ROW * max(len(shown), 1)}
    drawing = layer("bar", rows, bar) | size
    left = len(found.inputs) - len(shown)
    subtitle = [
        f"first order, by the mean of the {over}",
        "as an input falls, Ω changes against its bar" if CALLED["falling"] in sides else "",
        f"not shown: {counted(left, 'input')} of less effect, or none" if left else "",
    ]
    return marks.figure("sensitivity", drawing, f"Inputs that affect Ω of {name}", subtitle)
