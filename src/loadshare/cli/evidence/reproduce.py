"""`loadshare reproduce`: the seed paper's figures, computed and set beside the printed ones."""

from __future__ import annotations

from pathlib import Path

import typer

from loadshare.cli.evidence.console import DRAWING, SHIPPED, Cases, Folder, Quiet, need, teller
from loadshare.cli.exits import UNUSABLE, fail, writing


def reproduce(
    folder: Folder = Path("docs"),
    cases: Cases = SHIPPED,
    quiet: Quiet = False,
) -> None:
    """Compute the seed paper's figures and write page and pictures."""
    need(DRAWING, "reproduce")
    from loadshare.errors import LoadshareError
    from loadshare.evidence.reproduction.publish import reproduce as computed

    try:
        found = computed(cases, teller(quiet))
    except LoadshareError as error:
        fail([str(error)], UNUSABLE)
    with writing(folder):
        files = found.write(folder)
    for file in files:
        typer.echo(f"Wrote {file}")
