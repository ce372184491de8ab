"""Chart of both models of the teeth: time against accuracy.

Run with ``python -m benchmarks.ltca_chart docs/pictures/ltca_models.svg``. It shows whole analyses
of the shipped pairs at five positions and three loads, by finite elements of three refinements, by
slices on the gear's body and by slices on half-planes. The error is that of the mean stiffness
against the limit of refinement, K₀ of K(h) = K₀ + c hᵖ through the three.
"""

from __future__ import annotations

import sys
from functools import partial
from itertools import pairwise
from typing import Any

import altair as alt
from scipy.optimize import brentq

from benchmarks.ltca import CLOCK, PAIRS, POSITIONS, on_half_planes, table
from benchmarks.ltca_evidence import refined
from loadshare.report.figure import Figure
from loadshare.report.palette import COLOURS
from loadshare.tooth.analysis.fit import FIT_LOADS
from loadshare.tooth.analysis.ltca import PairCompliance, ltca, pair_compliance
from loadshare.tooth.compliance.finite import FiniteElements
from loadshare.tooth.pair.file import load_pair

LEVELS = (1, 2, 3)
LAYERS = {"p12": 3, "p46": 4, "p610": 2}
"""Elements over the face width at level 1."""
MODELS = (*(f"elements, level {n}" for n in LEVELS), "slices", "slices on half-planes")


def measured(name: str) -> dict[str, tuple[float, float]]:
    """Return time [s] and mean stiffness [N·m/rad] of every model for a shipped pair."""
    pair = load_pair(PAIRS / f"{name}.toml")
    gears = pair.geometry

    def compliance(model: str) -> PairCompliance:
        if not model.startswith("elements"):
            on_body = "half-planes" not in model
            return pair_compliance(gears, "slices") if on_body else on_half_planes(gears)
        mesh = refined(int(model[-1]), LAYERS[name])
        driver = FiniteElements(gears.driver, 1, teeth=3, divisions=mesh)
        driven = FiniteElements(gears.driven, gears.driven_side, teeth=3, divisions=mesh)
        return PairCompliance(driver, driven, "finite elements")

    def mean_of(model: str) -> float:
        analysis = ltca(gears, pair.torque, POSITIONS, FIT_LOADS, compliance(model))
        return float(analysis.secant(0.9).mean())

    found = {}
    for model in MODELS:
        repeat = 2 if model.startswith("elements") else 40
        mean, spent = CLOCK.timed(partial(mean_of, model), repeat)
        found[model] = spent, mean
    return found


def limit(stiffness: list[float]) -> float:
    """Return K₀ from stiffnesses with 1, 2 and 3 elements per length."""
    first, second = (a - b for a, b in pairwise(stiffness))

    def misfit(p: float) -> float:
        return float((1.0 - 2.0**-p) * second - (2.0**-p - 3.0**-p) * first)

    order = brentq(misfit, 0.1, 8.0)
    return float(stiffness[0] - first / (1.0 - 2.0**-order))


def main() -> None:
    """Measure, print the figures and write the chart."""
    rows: list[dict[str, Any]] = []
    for name in LAYERS:
        found = measured(name)
        exact = limit([found[model][1] for model in MODELS[: len(LEVELS)]])
        for model, (spent, mean) in found.items():
            error = 100.0 * (mean / exact - 1.0)
            family = "finite elements" if model.startswith("elements") else model
            rows.append({"pair": name, "model": model, "family": family, "s": spent, "%": error})
    table(
        ("pair", "model", "whole analysis [s]", "error of mean K"),
        [[r["pair"], r["model"], f"{r['s']:.3f}", f"{r['%']:+.2f} %"] for r in rows],
    )
    Figure("ltca_models", chart(rows)).save(sys.argv[1])


def chart(rows: list[dict[str, Any]]) -> Any:
    """Draw errors over times, both logarithmic; lines join the refinements of the elements."""
    data = alt.InlineData(values=[row | {"%": abs(row["%"])} for row in rows])
    families = ["finite elements", "slices", "slices on half-planes"]
    seconds, percents = (0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0), (0.3, 1.0, 3.0, 10.0, 30.0)
    base = alt.Chart(data).encode(
        x=alt.X("s:Q", title="processor time of the whole analysis [s]")
        .scale(type="log", domain=[seconds[0], seconds[-1]], nice=False)
        .axis(values=seconds),
        y=alt.Y("%:Q", title="error of the mean stiffness [%]")
        .scale(type="log", domain=[percents[0], 40.0], nice=False)
        .axis(values=percents),
        color=alt.Color("pair:N", title="pair").scale(domain=list(LAYERS), range=list(COLOURS[:3])),
    )
    lines = base.mark_line(strokeWidth=1.2).transform_filter(alt.datum.family == "finite elements")
    shape = alt.Shape("family:N", title="model").scale(
        domain=families, range=["circle", "diamond", "triangle-up"]
    )
    tooltip = [alt.Tooltip(key) for key in ("pair:N", "model:N", "s:Q", "%:Q")]
    points = base.mark_point(filled=True, size=70, opacity=1.0).encode(shape=shape, tooltip=tooltip)
    return (lines + points).properties(
        width=430, height=270, title="Both models of the teeth: time against accuracy"
    )


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python -m benchmarks.ltca_chart PICTURE.svg")
    main()
