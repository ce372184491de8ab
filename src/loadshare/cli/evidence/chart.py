"""`loadshare chart`: speed against accuracy, measured and drawn."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from loadshare.cli.evidence.console import DRAWING, SHIPPED, Cases, Folder, Quiet, need, teller
from loadshare.cli.exits import UNUSABLE, fail, writing

EVIDENCE = Path("docs/evidence")


def chart(
    folder: Folder = EVIDENCE,
    cases: Cases = SHIPPED,
    quick: Annotated[
        bool, typer.Option("--quick", help="Fewer samples: a look, not evidence.")
    ] = False,
    redraw: Annotated[
        bool, typer.Option("--redraw", help="Draw the figures that are there; measure nothing.")
    ] = False,
    quiet: Quiet = False,
) -> None:
    """Measure speed against accuracy, ours and peers, and write charts and report."""
    need((*DRAWING, "mpmath"), "chart")
    from loadshare.errors import LoadshareError
    from loadshare.evidence.chart.run import FIGURES
    from loadshare.evidence.chart.run import chart as measured

    if redraw and not (folder / FIGURES).exists():
        fail([f"{folder / FIGURES}: is not there; leave --redraw out to measure"], UNUSABLE)
    try:
        with writing(folder):
            files = measured(folder, cases, quick, redraw, teller(quiet))
    except LoadshareError as error:
        fail([str(error)], UNUSABLE)
    for file in files:
        typer.echo(f"Wrote {file}")
