"""The seed paper's figures beside the printed ones: ``python -m benchmarks.reproduction``."""

from __future__ import annotations

from pathlib import Path

import typer

from benchmarks.console import SHIPPED, Cases, Folder, Quiet, application, teller
from benchmarks.reproduction import publish
from loadshare.cli.exits import UNUSABLE, fail, writing
from loadshare.errors import LoadshareError


def reproduce(
    folder: Folder = Path("docs"),
    cases: Cases = SHIPPED,
    quiet: Quiet = False,
) -> None:
    """Compute the seed paper's figures and write page and pictures."""
    try:
        found = publish.reproduce(cases, teller(quiet))
    except LoadshareError as error:
        fail([str(error)], UNUSABLE)
    with writing(folder):
        files = found.write(folder)
    for file in files:
        typer.echo(f"Wrote {file}")


app = application(reproduce)

if __name__ == "__main__":
    app()
