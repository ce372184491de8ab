"""`loadshare run`: solve one case and print the result."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache, partial
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias

import typer

from loadshare.cli.cases import open_case
from loadshare.cli.console import progress, say
from loadshare.cli.exits import marked_lines, refused_document, reporting_problems, writing
from loadshare.cli.files import print_written
from loadshare.cli.forms import FOLDER, Output, figure_of, outputs, tables_of, write_all
from loadshare.cli.options import CaseFile, Changes, Method, Positions, Solver, Tolerance
from loadshare.errors import Refused
from loadshare.json_text import json_text
from loadshare.libraries import pd

if TYPE_CHECKING:
    from loadshare.case import Case
    from loadshare.results import Result

FORMS = ("json", "nc", "csv", "parquet", "xlsx", "html", "svg", "png", "pdf", "toml", "folder")
PictureName: TypeAlias = Literal["share", "torque", "floats", "law", "train"]
Picture = Annotated[
    PictureName,
    typer.Option(
        metavar="NAME", help="Content of .svg, .png and .pdf: share, torque, floats, law or train."
    ),
]
Loads = Annotated[
    bool,
    typer.Option("--loads", help="Print the loads on gears, bearings or pins, and shafts."),
]
Cycle = Annotated[
    bool,
    typer.Option(
        "--cycle",
        help="Print transmission error, stiffness, load share and point of the cycle of every "
        "mesh at every position.",
    ),
]


def run(
    case: CaseFile,
    file: Annotated[
        list[Output] | None,
        outputs(
            *FORMS, what="Write the result; .html is a report, .toml the case with its changes"
        ),
    ] = None,
    picture: Picture = "share",
    solver: Solver = "auto",
    method: Method = "newton",
    tolerance: Tolerance = 1e-9,
    position: Positions = None,
    no_reduce: Annotated[
        bool,
        typer.Option("--no-reduce", help="Solve with all contacts in play, leaving nothing out."),
    ] = False,
    loads: Loads = False,
    cycle: Cycle = False,
    explain: Annotated[
        bool,
        typer.Option(
            "--explain", help="Show how each --position, or the first, was solved and certified."
        ),
    ] = False,
    search: Annotated[
        bool,
        typer.Option(
            "--search",
            help="Search each --position, or the first, for other answers: random starts and a "
            "path from large clearances.",
        ),
    ] = False,
    change: Changes = None,
) -> None:
    """Solve a case and print load sharing, floats and certificate."""
    from loadshare.cli.tables.result import print_heading, print_result
    from loadshare.report.words import period_text
    from loadshare.train import build_train

    with reporting_problems():
        loaded = open_case(case, change)
        train = build_train(loaded)
    wanted = _wanted(position, train.count)
    print_heading(loaded, str(case), train.count, wanted, change or ())
    if train.period is not None:
        say(period_text(train.period, train.input), whole=True)
    how = {"solver": solver, "method": method, "reduce": not no_reduce, "tolerance": tolerance}
    result, refusal = _solved(loaded, wanted, how)
    if result is not None:
        print_result(result, len(wanted), loads=loads, cycle=cycle)
        if search:
            from loadshare.job.search import search as others

            for at in result.positions if position else result.positions[:1]:
                say(f"Position {at.position}: {others(loaded, at.position).text}", whole=True)
    if explain:
        _print_explanations(loaded, wanted if position else wanted[:1], how)
    if refusal is not None:
        _end_refused(refusal, loaded.name, file or ())
    elif file and result is not None:
        made = partial(_page, result, str(case), change or ())
        _write(file, result, loaded, made, picture)


def _solved(
    case: Case, positions: Sequence[int], how: dict[str, Any]
) -> tuple[Result | None, Refused | None]:
    """Return the certified result of a case, and the refusal, if any."""
    from loadshare.job import solve

    try:
        with progress("positions", len(positions)) as tick:
            return solve(case, positions=positions, progress=tick, **how), None
    except Refused as refusal:
        return refusal.partial, refusal


def _print_explanations(case: Case, positions: Sequence[int], how: dict[str, Any]) -> None:
    from loadshare.cli.tables.explanation import print_explanation
    from loadshare.job import explain

    for index in positions:
        try:
            answer = explain(case, index, **how)
        except Refused:
            answer = None
        print_explanation(index, answer)


def _end_refused(refusal: Refused, case: str, files: Sequence[Output]) -> None:
    """Write the refusal as JSON, and print it with the files that were not written.

    Raises
    ------
    typer.Exit
        Always.
    """
    written = [output for output in files if output.form == "json"]
    document = json_text(refused_document(refusal, case))
    others = [output.file for output in files if output not in written]
    lines = [f"{file}: not written, as there is no answer" for file in others]
    write_all(written, {"json": lambda: document}, missing=[*marked_lines(refusal), *lines])


def _page(result: Result, case: str, changes: Sequence[str]) -> str:
    from loadshare.report.page import chapter, report_page

    return report_page([replace(chapter(result.case, case, result=result), changes=changes)])


def _write(
    files: Sequence[Output], result: Result, given: Case, page: Callable[[], str], picture: str
) -> None:
    from loadshare.exchange.spreadsheet import write_tables
    from loadshare.results.document import netcdf_content

    def changed() -> str:
        from loadshare.tooth import written_in

        folders = [output.file.parent for output in files if output.form == "toml"]
        return written_in(given, folders).to_toml()

    made = cache(partial(_tables, result))

    def workbook() -> bytes:
        from loadshare.exchange.spreadsheet import workbook_of

        return workbook_of(made())

    single = [output for output in files if output.form != FOLDER]
    for output in files:
        if output.form == FOLDER:
            with writing(output.file):
                write_tables(output.file, made())
            print_written(output.file, err=True)
    frame = tables_of("run", result.to_frame)
    drawn = figure_of(lambda: getattr(result.plot, picture)())
    makers = {**frame, **drawn, "json": result.to_json, "nc": lambda: netcdf_content(result)}
    makers |= {"html": page, "xlsx": workbook, "toml": changed}
    write_all(single, makers)


def _tables(result: Result) -> dict[str, pd.DataFrame]:
    from loadshare.exchange.spreadsheet import export_frames

    with reporting_problems("written"):
        return export_frames(result)


def _wanted(positions: list[int] | None, count: int) -> list[int]:
    """Return the positions to solve, each once."""
    wanted = list(dict.fromkeys(positions or range(1, count + 1)))
    wrong = [k for k in wanted if not 1 <= k <= count]
    if wrong:
        there = f"positions 1 to {count}" if count > 1 else "position 1 only"
        given = ", ".join(map(str, wrong))
        raise typer.BadParameter(f"{given}: this case has {there}", param_hint="--position")
    return wanted
