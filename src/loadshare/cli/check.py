"""`loadshare check`: check cases without solving them, and certify results again."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from loadshare.cli.cases import find_cases, open_case
from loadshare.cli.console import say
from loadshare.cli.exits import UNUSABLE, fail
from loadshare.cli.options import CasePaths, Changes, Json
from loadshare.cli.waiting import echo
from loadshare.errors import CaseError, Problem, ResultError
from loadshare.json_text import json_text
from loadshare.numbers import counted

RESULTS = (".json", ".nc")
"""Endings of result files; all others are cases."""


def check(
    cases: CasePaths,
    teeth: Annotated[
        bool,
        typer.Option("--teeth", help="Print what follows from the teeth and dimensions of gears."),
    ] = False,
    change: Changes = None,
    json: Json = False,
) -> None:
    """List all problems of case files without solving them; certify result files again.

    A result is a .json or .nc file that `run` or `batch` wrote.
    """
    found = find_cases(cases)
    problems = bad = 0
    record = []
    for path in found:
        wrong: tuple[Problem, ...] = ()
        try:
            note = _result(path) if path.suffix in RESULTS else _case(path, change)
        except (CaseError, ResultError) as error:
            bad += 1
            wrong = error.problems
            problems += len(wrong)
            if not json:
                echo(str(error), err=True)
        else:
            say(f"OK  {path}{note}", whole=True)
            if teeth and path.suffix not in RESULTS:
                _print_teeth(path, change)
        record.append({"file": str(path), "ok": not wrong, "problems": [asdict(p) for p in wrong]})
    if json:
        echo(json_text({"ok": not bad, "files": record}), nl=False)
    if bad:
        noun = "file" if any(path.suffix in RESULTS for path in found) else "case"
        summary = f"{counted(problems, 'problem')} in {bad} of {counted(len(found), noun)}."
        fail([summary], UNUSABLE)


def _case(path: Path, change: list[str] | None) -> str:
    from loadshare.train import build_train

    build_train(open_case(path, change))
    return ""


def _print_teeth(path: Path, change: list[str] | None) -> None:
    from loadshare.cli.tables.table import show_table
    from loadshare.report.teeth import teeth_tables

    for found in teeth_tables(open_case(path, change)):
        show_table(found)


def _result(path: Path) -> str:
    from loadshare.results.files import load_result

    result = load_result(path)
    return f"  {counted(len(result.positions), 'position')} certified again"
