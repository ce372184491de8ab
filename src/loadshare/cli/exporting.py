"""`loadshare export`: what was found, into a copy of the file that the case was imported from."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from loadshare.cli.changes import open_case
from loadshare.cli.exits import REFUSED, fail, reporting_problems
from loadshare.cli.files import keep_inputs, save_text, tell_written
from loadshare.cli.options import CaseFile, Changes, output


def export(
    case: CaseFile,
    unit: Annotated[
        Path, typer.Argument(metavar="UNIT", help="REXS file from which the case was imported.")
    ],
    to: Annotated[Path, output(what="Copy of it to write.")],
    change: Changes = None,
) -> None:
    """Solve a case and write what was found into a copy of its REXS file."""
    from loadshare.errors import Refused
    from loadshare.exchange.rexs import export_rexs
    from loadshare.job import solve

    keep_inputs([unit])
    if to.suffix and to.suffix.lower() != unit.suffix.lower():
        message = f"{to}: it will be what {unit.name} is; give it that ending, {unit.suffix}"
        raise typer.BadParameter(message, param_hint="--output")
    with reporting_problems():
        loaded = open_case(case, change)
        try:
            text = export_rexs(solve(loaded), unit)
        except Refused as refusal:
            fail([str(refusal)], REFUSED)
    save_text(to, text)
    tell_written(to)
