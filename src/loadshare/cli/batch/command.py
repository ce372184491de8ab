"""The command itself."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from loadshare.cli.batch.summary import print_summary, summary_document
from loadshare.cli.batch.work import (
    GOOD,
    SUMMARY,
    UNWRITTEN,
    Outcome,
    Task,
    outcomes,
    result_names,
)
from loadshare.cli.console import progress
from loadshare.cli.exits import INTERRUPTED, REFUSED, UNUSABLE, fail, writing
from loadshare.cli.files import write_document
from loadshare.cli.find import find_cases
from loadshare.cli.options import CasePaths, Method, Solver, Tolerance


def batch(
    cases: CasePaths,
    folder: Annotated[
        Path,
        typer.Option(
            "-o", "--output", metavar="DIR", file_okay=False, help="Folder for the results."
        ),
    ],
    jobs: Annotated[
        int | None,
        typer.Option(
            "-j", "--jobs", metavar="N", min=1, help="Processes; by default one per processor."
        ),
    ] = None,
    solver: Solver = "auto",
    method: Method = "newton",
    tolerance: Tolerance = 1e-9,
    force: Annotated[
        bool, typer.Option("--force", help="Solve again what is there already.")
    ] = False,
) -> None:
    """Solve many cases, keeping what is solved already.

    Writes one JSON file per case and a summary.json into DIR. A bad case stops no other. After an
    interruption the same command goes on.
    """
    from loky import cpu_count

    found = find_cases(cases)
    tasks = [
        Task(case, name, folder / f"{name}.json", solver, method, tolerance, force)
        for case, name in zip(found, result_names(found), strict=True)
    ]
    with writing(folder):
        folder.mkdir(parents=True, exist_ok=True)
    done: dict[str, Outcome] = {}
    interrupted = False
    with progress("cases", len(tasks)) as tick:
        try:
            for outcome in outcomes(tasks, min(jobs or cpu_count(), len(tasks))):
                done[outcome.name] = outcome
                if tick is not None:
                    tick(len(done), len(tasks))
        except KeyboardInterrupt:
            interrupted = True
    ordered = [done[task.name] for task in tasks if task.name in done]
    waiting = [str(task.case) for task in tasks if task.name not in done]
    settings = {"solver": solver, "method": method, "tolerance": tolerance}
    summary = folder / f"{SUMMARY}.json"
    with writing(summary):
        write_document(summary, summary_document(ordered, settings, waiting))
    print_summary(ordered)
    if interrupted:
        told = f"Interrupted: {len(ordered)} of {len(tasks)} cases done."
        fail([told, "The same command goes on; what is certified is kept."], INTERRUPTED)
    if any(outcome.outcome == UNWRITTEN for outcome in ordered):
        raise typer.Exit(UNUSABLE)
    if any(outcome.outcome not in GOOD for outcome in ordered):
        raise typer.Exit(REFUSED)
