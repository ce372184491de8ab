"""Speed against accuracy, measured and drawn: ``python -m benchmarks.chart``."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Annotated

import typer

from benchmarks.chart import run
from benchmarks.console import EVIDENCE, SHIPPED, Cases, Folder, Quiet, application, teller
from loadshare.cli.exits import UNUSABLE, fail, writing
from loadshare.errors import LoadshareError


def chart(
    folder: Folder = EVIDENCE,
    cases: Cases = SHIPPED,
    quick: Annotated[
        bool, typer.Option("--quick", help="Use fewer samples: for a look, not as evidence.")
    ] = False,
    redraw: Annotated[
        bool, typer.Option("--redraw", help="Draw the existing figures; measure nothing.")
    ] = False,
    quiet: Quiet = False,
) -> None:
    """Measure speed and accuracy of loadshare and peers, and write charts and report."""
    if not redraw and find_spec("mpmath") is None:
        fail(["mpmath is not installed: pip install 'loadshare[bench]'"], UNUSABLE)
    if redraw and not (folder / run.FIGURES).exists():
        fail([f"{folder / run.FIGURES}: does not exist; leave out --redraw to measure"], UNUSABLE)
    try:
        with writing(folder):
            files = run.chart(folder, cases, quick, redraw, teller(quiet))
    except LoadshareError as error:
        fail([str(error)], UNUSABLE)
    for file in files:
        typer.echo(f"Wrote {file}")


app = application(chart)

if __name__ == "__main__":
    app()
