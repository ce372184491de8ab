"""The fast method on a graphics processor beside a core: ``python -m benchmarks.graphics``."""

from __future__ import annotations

from dataclasses import asdict
from importlib.util import find_spec
from typing import Annotated

import typer

from benchmarks.console import EVIDENCE, SHIPPED, Cases, Folder, Quiet, application, teller
from benchmarks.documents import read_figures, write_figures
from benchmarks.graphics import report
from benchmarks.machine_facts import facts
from benchmarks.workloads import Workload, branches, linear_branches, workloads
from loadshare.cli.exits import UNUSABLE, fail, writing

FIGURES = "graphics.json"


def graphics(
    folder: Folder = EVIDENCE,
    cases: Cases = SHIPPED,
    count: Annotated[int, typer.Option(help="Number of equilibria of a workload.")] = 300_000,
    registers: Annotated[int, typer.Option(help="Largest number of registers of a thread.")] = 255,
    draw: Annotated[
        bool, typer.Option("--draw", help="Draw the existing figures; measure nothing.")
    ] = False,
    quiet: Quiet = False,
) -> None:
    """Settle samples on a graphics processor and on a core, and write the time that each takes.

    Measuring needs a device and Numba for CUDA; drawing needs neither.
    """
    figures = folder / FIGURES
    if not draw and find_spec("numba_cuda") is None:
        fail(["Numba for CUDA is not installed: pip install 'loadshare[graphics]'"], UNUSABLE)
    if draw and not figures.exists():
        fail([f"{figures}: does not exist; leave out --draw to measure"], UNUSABLE)
    with writing(folder):
        folder.mkdir(parents=True, exist_ok=True)
        if draw:
            files = report.write(read_figures(figures), folder)
        else:
            every = [*workloads(cases, False)[:5], linear_branches(False), branches(False)[1]]
            write_figures(figures, _measured(every, count, registers, quiet))
            files = [figures]
    for file in files:
        typer.echo(f"Wrote {file}")


def _measured(every: list[Workload], count: int, registers: int, quiet: bool) -> dict[str, object]:
    from benchmarks.graphics import measure

    tell, starts, rows = teller(quiet), [], []
    for workload in every:
        starts.append(measure.prepared(workload, count))
        tell(f"{workload.title}: {starts[-1].loading.count} equilibria")
    kernel, floats = measure.kernel_for(starts, registers)
    for workload, start in zip(every, starts, strict=True):
        rows.append(asdict(measure.measured(workload, start, kernel, floats)))
        tell(f"{workload.title}: {rows[-1]}")
    return {"facts": facts() | measure.device_facts(kernel), "rows": rows}


app = application(graphics)

if __name__ == "__main__":
    app()
