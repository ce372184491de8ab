"""The work of `python -m benchmarks.chart`: measure, save, draw, report."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from benchmarks.chart.draw import draw_branches, draw_precision
from benchmarks.chart.long_run import long_run
from benchmarks.chart.measure import OURS, OURS_BATCH, Measure, measure, prepare
from benchmarks.chart.report import speed_report
from benchmarks.documents import read_figures, write_figures
from benchmarks.machine_facts import facts
from benchmarks.peers import PEERS
from benchmarks.workloads import branches, linear_branches, workloads

SCALED = (
    OURS_BATCH,
    "Clarabel, update",
    "Clarabel, update, reduced",
    "DAQP",
    "DAQP, reduced",
)
"""Methods measured on 4 to 64 branches."""
FIGURES = "speed.json"


def measure_all(cases: Path, quick: bool, tell: Callable[[str], None]) -> dict[str, Any]:
    """Measure everything and return plain figures.

    Parameters
    ----------
    cases : pathlib.Path
        Folder of shipped cases.
    quick : bool
        Fewer samples, no long run.
    tell : callable
        Called with the name of each measurement.
    """
    start = time.perf_counter()
    found: list[Measure] = []
    loads = [*workloads(cases, quick), linear_branches(quick)]
    for workload in loads:
        tell(f"{workload.title}: references in 50 digits")
        found += measure(workload, (*OURS, *PEERS), tell, prepare(workload))
    scaling: list[Measure] = []
    for workload in branches(quick):
        tell(f"{workload.title}: references in 50 digits")
        scaling += [m for m in measure(workload, SCALED, tell, prepare(workload)) if _tightest(m)]
    memory: dict[str, float] = {}
    if not quick:
        tell("10^6 equilibria")
        memory = long_run(next(w for w in loads if w.name == "law"))
    return {
        "facts": facts(),
        "quick": quick,
        "seconds": time.perf_counter() - start,
        "titles": {w.name: w.title for w in loads},
        "measures": [m.to_dict() for m in found],
        "branches": [m.to_dict() for m in scaling],
        "memory": memory,
    }


def _tightest(m: Measure) -> bool:
    return m.tolerance is None or m.tolerance == PEERS[m.method].tolerances[-1]


def publish(figures: Mapping[str, Any], folder: Path) -> list[Path]:
    """Draw and report figures.

    Returns
    -------
    list of pathlib.Path
        The files.
    """
    measures = [_measure(m) for m in figures["measures"]]
    scaling = [_measure(m) for m in figures["branches"]]
    written = draw_precision(measures, figures["titles"], folder)
    written += draw_branches(scaling, folder)
    report = folder / "speed.md"
    page = speed_report(
        measures,
        scaling,
        figures["titles"],
        figures["facts"],
        figures["memory"],
        figures["seconds"],
        figures["quick"],
    )
    report.write_text(page, encoding="utf-8")
    return [*written, report]


def _measure(plain: Mapping[str, Any]) -> Measure:
    numbers = (
        "microseconds",
        "cpu",
        "inside",
        "inside_cpu",
        "reported",
        "median",
        "worst",
        "setup",
    )
    filled: dict[str, Any] = {
        k: float("nan") if k in numbers and v is None else v for k, v in plain.items()
    }
    return Measure(**filled)


def chart(
    folder: Path, cases: Path, quick: bool, redraw: bool, tell: Callable[[str], None]
) -> list[Path]:
    """Measure (or read) the figures, save, draw and report them.

    Parameters
    ----------
    folder : pathlib.Path
        Where the evidence goes.
    cases : pathlib.Path
    quick, redraw : bool
        Fewer samples; read the figures that are there instead of measuring.
    tell : callable

    Returns
    -------
    list of pathlib.Path
        Files written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    kept = folder / FIGURES
    if not redraw:
        write_figures(kept, measure_all(cases, quick, tell))
    return [kept, *publish(read_figures(kept), folder)]
