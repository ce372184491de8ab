"""`loadshare check`: whether cases can be used, without solving them, and results believed."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from loadshare.cli.exits import UNUSABLE, counted, fail
from loadshare.cli.find import find_cases
from loadshare.cli.options import CasePaths
from loadshare.errors import CaseError, ResultError

RESULTS = (".json", ".nc")
"""Endings of result files; all others are cases."""


def check(
    cases: CasePaths,
    teeth: Annotated[
        bool,
        typer.Option("--teeth", help="Tell what follows from teeth and dimensions of gears."),
    ] = False,
) -> None:
    """List all problems of case files without solving them; certify result files again.

    A result is a .json or .nc file that `run` or `batch` wrote.
    """
    found = find_cases(cases)
    problems = bad = 0
    for path in found:
        try:
            told = _result(path) if path.suffix in RESULTS else _case(path)
        except (CaseError, ResultError) as error:
            bad += 1
            problems += len(error.problems)
            typer.echo(str(error), err=True)
        else:
            typer.echo(f"OK  {path}{told}")
            if teeth and path.suffix not in RESULTS:
                _print_teeth(path)
    if bad:
        noun = "file" if any(path.suffix in RESULTS for path in found) else "case"
        told = f"{counted(problems, 'problem')} in {bad} of {counted(len(found), noun)}."
        fail([told], UNUSABLE)


def _case(path: Path) -> str:
    from loadshare.case import load_case
    from loadshare.train import build_train

    build_train(load_case(path))
    return ""


def _print_teeth(path: Path) -> None:
    from loadshare.case import load_case
    from loadshare.cli.tables.table import show, table
    from loadshare.report.teeth import teeth_tables

    for found in teeth_tables(load_case(path)):
        words = [column.title for column in found.columns if not column.figures]
        rows = ([cell.text for cell in row] for row in found.rows)
        show(found.title, table([column.title for column in found.columns], rows, words))


def _result(path: Path) -> str:
    from loadshare.results import load_result

    result = load_result(path)
    return f"  {counted(len(result.positions), 'position')} certified again"
