"""The work of `python -m benchmarks.stress`: run, save, draw, report."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from pathlib import Path

from benchmarks.documents import read_figures, write_figures
from benchmarks.machine_facts import facts
from benchmarks.stress.draw import draw_map
from benchmarks.stress.report import stability_report
from benchmarks.stress.run import Cell, run

FIGURES = "stability.json"


def stress(
    folder: Path,
    families: Sequence[str],
    peers: bool,
    quick: bool,
    redraw: bool,
    tell: Callable[[str], None],
) -> tuple[list[Cell], list[Path]]:
    """Run (or read) the map, save, draw and report it.

    Parameters
    ----------
    folder : pathlib.Path
        Where the evidence goes.
    families : sequence of str
    peers : bool
        Whether to include peers.
    quick, redraw : bool
        Every tenth problem; read the figures that are there instead of running.
    tell : callable

    Returns
    -------
    list of Cell
    list of pathlib.Path
        Files written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    kept = folder / FIGURES
    if not redraw:
        start = time.perf_counter()
        cells = list(run(families, peers, quick, tell))
        write_figures(
            kept,
            {
                "facts": facts(),
                "quick": quick,
                "seconds": time.perf_counter() - start,
                "cells": [c.to_dict() for c in cells],
            },
        )
    figures = read_figures(kept)
    cells = [_cell(c) for c in figures["cells"]]
    report = folder / "stability.md"
    page = stability_report(cells, figures["facts"], figures["seconds"], figures["quick"])
    report.write_text(page, encoding="utf-8")
    return cells, [kept, *draw_map(cells, folder), report]


def _cell(plain: dict[str, object]) -> Cell:
    return Cell(**plain)  # type: ignore[arg-type]
