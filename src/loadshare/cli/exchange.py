"""`loadshare import` and `loadshare export`: from and into the files of other programs."""

from __future__ import annotations

from pathlib import Path
from shlex import quote
from typing import Annotated

import typer

from loadshare.cli.cases import open_case
from loadshare.cli.console import say
from loadshare.cli.exits import REFUSED, fail, fail_of, reporting_problems, writing
from loadshare.cli.files import keep_inputs, print_written, save_text
from loadshare.cli.forms import check_case_file
from loadshare.cli.options import CaseFile, Changes, Force, output
from loadshare.input import real
from loadshare.output import STANDARD, write_whole


def import_machine(
    unit: Annotated[
        Path,
        typer.Argument(
            metavar="UNIT",
            help="REXS file (.rexs, .rexsj, .rexsz), folder of CSV tables, or workbook (.xlsx).",
        ),
    ],
    to: Annotated[
        Path | None,
        output(what="Case file to write; by default the name of the unit with .toml."),
    ] = None,
    force: Force = False,
) -> None:
    """Turn a gear unit into a case, and report what was assumed and left out."""
    from loadshare.errors import CaseError
    from loadshare.exchange.rexs import import_rexs
    from loadshare.exchange.spreadsheet import import_tables, is_spreadsheet

    known = real(unit) if unit.is_dir() else unit
    target = to or Path(known.name or "case").with_suffix(".toml")
    check_case_file(target, force)
    keep_inputs([unit])
    with reporting_problems():
        imported = import_tables(unit) if is_spreadsheet(unit) else import_rexs(unit)
    save_text(target, imported.text)
    if target != STANDARD:
        say(f"Imported {', '.join(imported.taken)}.")
        for what, lines in (("Assumed", imported.assumed), ("Left out", imported.left_out)):
            for line in lines:
                say(f"{what}: {line}", whole=True)
    try:
        imported.case(str(target))
    except CaseError as error:
        print_written(target, ". It is not a valid case yet:", err=True)
        fail_of(error.problems, ".")
    print_written(target, f". Solve it with: loadshare run {quote(str(target))}")


def export(
    case: CaseFile,
    unit: Annotated[
        Path, typer.Argument(metavar="UNIT", help="REXS file from which the case was imported.")
    ],
    to: Annotated[Path, output(what="Copy of the REXS file to write.")],
    change: Changes = None,
) -> None:
    """Solve a case and write what was found into a copy of its REXS file."""
    from loadshare.errors import Refused
    from loadshare.exchange.rexs import export_rexs, in_form_of
    from loadshare.job import solve

    keep_inputs([unit])
    if to.suffix and to.suffix.lower() != unit.suffix.lower():
        message = (
            f"{to}: the copy has the form of {unit.name}; give it the same ending, {unit.suffix}"
        )
        raise typer.BadParameter(message, param_hint="--output")
    with reporting_problems("written"):
        loaded = open_case(case, change)
        try:
            copy = in_form_of(unit, export_rexs(solve(loaded), unit))
        except Refused as refusal:
            fail([str(refusal)], REFUSED)
    with writing(to):
        write_whole(to, copy)
    print_written(to)
