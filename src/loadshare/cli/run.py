"""`loadshare run`: solve one case and print what was found."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

from loadshare.cli.changes import open_case
from loadshare.cli.console import progress, say
from loadshare.cli.exits import REFUSED, UNUSABLE, fail, problems_told, writing
from loadshare.cli.files import write_document, write_text
from loadshare.cli.options import CaseFile, Method, Solver, Tolerance, changes, output
from loadshare.cli.refusal import refused_document, told
from loadshare.errors import Refused
from loadshare.output import clear, csv_of, write_whole

if TYPE_CHECKING:
    from loadshare.case import Case
    from loadshare.results import Result

Tables = Annotated[
    Path | None,
    typer.Option(
        metavar="FOLDER",
        help="Write case and result as CSV tables for a spreadsheet into this folder, or into a "
        "workbook (.xlsx).",
    ),
]
Loads = Annotated[
    bool,
    typer.Option("--loads", help="Tell what gears, bearings or pins, and shafts carry."),
]
Cycle = Annotated[
    bool,
    typer.Option(
        "--cycle",
        help="Tell transmission error, stiffness, load share and place in the cycle of every "
        "mesh at every position.",
    ),
]


def run(
    case: CaseFile,
    json: Annotated[Path | None, output("--json", what="Write the result as JSON.")] = None,
    netcdf: Annotated[Path | None, output("--netcdf", what="Write labelled arrays.")] = None,
    csv: Annotated[Path | None, output("--csv", what="Write torques and Ω as a table.")] = None,
    tables: Tables = None,
    solver: Solver = "auto",
    method: Method = "newton",
    tolerance: Tolerance = 1e-9,
    position: Annotated[
        list[int] | None,
        typer.Option(metavar="K", help="Solve only this position, from 1; may be repeated."),
    ] = None,
    no_reduce: Annotated[
        bool, typer.Option("--no-reduce", help="Solve the whole scene, leaving nothing out.")
    ] = False,
    loads: Loads = False,
    cycle: Cycle = False,
    explain: Annotated[
        bool,
        typer.Option(
            "--explain", help="Tell how each --position, or the first, was solved and certified."
        ),
    ] = False,
    search: Annotated[
        bool,
        typer.Option(
            "--search",
            help="Search each --position, or the first, for other answers: random starts, and a "
            "path from generous clearance.",
        ),
    ] = False,
    change: Annotated[
        list[str] | None,
        changes(
            "--set",
            "Change the case, as in operating.torque='100 N*m'; may be repeated. "
            "No value removes the key.",
        ),
    ] = None,
) -> None:
    """Solve a case and print load sharing, floats and certificate."""
    from loadshare.cli.tables.result import print_heading, print_result
    from loadshare.report.words import period_told
    from loadshare.train import build_train

    with problems_told():
        loaded = open_case(case, change)
        train = build_train(loaded)
    wanted = _wanted(position, train.count)
    print_heading(loaded, str(case), train.count, wanted, change or ())
    if train.period is not None:
        say(period_told(train.period, train.input), whole=True)
    how = {"solver": solver, "method": method, "reduce": not no_reduce, "tolerance": tolerance}
    result, refusal = _solved(loaded, wanted, how)
    if result is not None:
        print_result(result, len(wanted), loads=loads, cycle=cycle)
        if search:
            there = [p.position for p in result.positions]
            _print_search(loaded, there if position else there[:1])
    if explain:
        _print_explanations(loaded, wanted if position else wanted[:1], how)
    if refusal is not None:
        _end_refused(refusal, loaded.name, json, (netcdf, csv, tables))
    assert result is not None
    _write(json, result.to_json)
    _write(netcdf, result.to_netcdf)
    _write(csv, lambda file: write_text(file, csv_of(result.to_frame())))
    if tables is not None:
        _write_tables(tables, result)


def _solved(
    case: Case, positions: Sequence[int], how: dict[str, Any]
) -> tuple[Result | None, Refused | None]:
    """Return what is certified of a case, and what was refused."""
    from loadshare.job import solve

    try:
        with progress("positions", len(positions)) as tick:
            return solve(case, positions=positions, progress=tick, **how), None
    except Refused as refusal:
        return refusal.partial, refusal


def _print_search(case: Case, positions: Sequence[int]) -> None:
    from loadshare.job.search import search

    for index in positions:
        say(f"Position {index}: {search(case, index).told}", whole=True)


def _print_explanations(case: Case, positions: Sequence[int], how: dict[str, Any]) -> None:
    from loadshare.cli.tables.explanation import print_explanation
    from loadshare.job import explain

    for index in positions:
        try:
            answer = explain(case, index, **how)
        except Refused:
            answer = None
        print_explanation(index, answer)


def _end_refused(
    refusal: Refused, case: str, json: Path | None, others: Sequence[Path | None]
) -> NoReturn:
    """Write the refusal as JSON, tell it, and which files were not written."""
    _write(json, lambda file: write_document(file, refused_document(refusal, case)))
    lines = [f"REFUSED  {line}" for line in told(refusal)]
    fail([*lines, *(f"{f}: not written, for want of an answer" for f in others if f)], REFUSED)


def _write_tables(folder: Path, result: Result) -> None:
    from loadshare.exchange.spreadsheet import export_tables, workbook_of

    with problems_told():
        made = export_tables(result)
    if folder.suffix.lower() == ".xlsx":
        try:
            book = workbook_of(made)
        except ImportError:
            hint = "Install it with: pip install 'loadshare[spreadsheet]'."
            fail([f"{folder}: a workbook needs openpyxl to be written. {hint}"], UNUSABLE)
        _write(folder, partial(write_whole, content=book))
        return
    files = {folder / f"{name}.csv": text for name, text in made.items()}
    clear(files)
    for file, text in files.items():
        _write(file, partial(write_text, text=text))


def _wanted(positions: list[int] | None, count: int) -> list[int]:
    """Return the positions to solve, each once."""
    wanted = list(dict.fromkeys(positions or range(1, count + 1)))
    wrong = [k for k in wanted if not 1 <= k <= count]
    if wrong:
        there = f"positions 1 to {count}" if count > 1 else "position 1 only"
        given = ", ".join(map(str, wrong))
        raise typer.BadParameter(f"{given}: this case has {there}", param_hint="--position")
    return wanted


def _write(file: Path | None, write: Callable[[Path], object]) -> None:
    if file is not None:
        with writing(file):
            write(file)
