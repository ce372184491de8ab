"""`loadshare run`: solve one case and print what was found."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from loadshare.cli.changes import read_changes
from loadshare.cli.console import console, progress
from loadshare.cli.exits import REFUSED, fail, problems_told, writing
from loadshare.cli.files import write_document, write_text
from loadshare.cli.options import Method, Solver, Tolerance, output
from loadshare.cli.refusal import refused_document, told
from loadshare.errors import Refused

if TYPE_CHECKING:
    from loadshare.results import Result


def run(
    case: Annotated[Path, typer.Argument(metavar="CASE", help="Case file.")],
    json: Annotated[Path | None, output("--json", what="Write the result as JSON.")] = None,
    netcdf: Annotated[Path | None, output("--netcdf", what="Write labelled arrays.")] = None,
    csv: Annotated[Path | None, output("--csv", what="Write torques and Ω as a table.")] = None,
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
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="Change the case, as in operating.torque='100 N*m'; may be repeated. "
            "No value removes the key.",
        ),
    ] = None,
) -> None:
    """Solve a case and print load sharing, floats and certificate."""
    from loadshare.case import load_case
    from loadshare.cli.tables import print_heading, print_result
    from loadshare.job import solve
    from loadshare.train import build_train

    changes = read_changes(change or ())
    with problems_told():
        loaded = load_case(case)
        if changes:
            loaded = loaded.replace(changes)
        train = build_train(loaded)
    wanted = _wanted(position, train.count)
    screen = console()
    print_heading(screen, loaded, str(case), train.count, wanted, change or ())
    refusal: Refused | None = None
    result: Result | None
    try:
        with progress("positions", len(wanted)) as tick:
            result = solve(
                loaded,
                solver=solver,
                method=method,
                reduce=not no_reduce,
                tolerance=tolerance,
                positions=wanted,
                progress=tick,
            )
    except Refused as refused:
        refusal, result = refused, refused.partial
    if result is not None:
        print_result(screen, result, len(wanted))
    if search and result is not None:
        from loadshare.job.search import search as searched

        there = [p.position for p in result.positions]
        for index in there if position else there[:1]:
            screen.print(f"Position {index}: {searched(loaded, index).told}", soft_wrap=True)
    if explain:
        from loadshare.cli.tables.explanation import print_explanation
        from loadshare.job import explain as explained

        for index in wanted if position else wanted[:1]:
            try:
                answer = explained(
                    loaded,
                    index,
                    solver=solver,
                    method=method,
                    reduce=not no_reduce,
                    tolerance=tolerance,
                )
            except Refused:
                answer = None
            print_explanation(screen, index, answer)
    if refusal is None:
        assert result is not None
        _write(json, result.to_json)
        _write(netcdf, result.to_netcdf)
        _write(csv, lambda file: write_text(file, result.to_frame().to_csv(index=False)))
        return
    if json is not None:
        with writing(json):
            write_document(json, refused_document(refusal, loaded.name))
    lines = [f"REFUSED  {line}" for line in told(refusal)]
    lines += [f"{file}: not written, for want of an answer" for file in (netcdf, csv) if file]
    fail(lines, REFUSED)


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
