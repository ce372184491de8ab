"""The command itself, and the summary of the outcomes of all cases."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer

from loadshare._version import __version__
from loadshare.cli.batch.work import (
    GOOD,
    SUMMARY,
    UNWRITTEN,
    Outcome,
    Task,
    outcomes,
    result_names,
)
from loadshare.cli.cases import find_cases, read_changes
from loadshare.cli.console import progress, say, say_all
from loadshare.cli.exits import REFUSED, UNUSABLE, fail, writing
from loadshare.cli.options import CasePaths, Changes, Json, Method, Solver, Tolerance
from loadshare.cli.stop import Stop
from loadshare.cli.waiting import echo, is_hushed
from loadshare.errors import LoadshareError
from loadshare.json_text import json_text
from loadshare.numbers import counted
from loadshare.output import STANDARD, clear, make_folder, write_whole


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
            "-j",
            "--jobs",
            metavar="N",
            min=1,
            help="Number of processes; one per processor by default.",
        ),
    ] = None,
    solver: Solver = "auto",
    method: Method = "newton",
    tolerance: Tolerance = 1e-9,
    force: Annotated[
        bool, typer.Option("--force", help="Solve again even what is already solved.")
    ] = False,
    change: Changes = None,
    json: Json = False,
) -> None:
    """Solve many cases, keeping what is already solved.

    Writes one JSON file per case and a summary.json into DIR. A bad case does not stop the others.
    After an interruption, the same command continues.
    """
    from loky import cpu_count

    from loadshare.lock import alone_in

    if folder == STANDARD:
        message = "-: a batch writes many files into a folder; --json prints its summary"
        raise typer.BadParameter(message, param_hint="--output")
    changes = read_changes(change or ())
    found = find_cases(cases)
    how = {"solver": solver, "method": method, "tolerance": tolerance}
    tasks = [
        Task(case, name, folder / f"{name}.json", how, len(found), force, changes)
        for case, name in zip(found, result_names(found), strict=True)
    ]
    with writing(folder):
        make_folder(folder)
    summary = folder / f"{SUMMARY}.json"
    stop = Stop(_stopping)
    try:
        with alone_in(folder), stop:
            clear([summary, *(task.target for task in tasks)])
            done = _done(tasks, min(jobs or cpu_count(), len(tasks)), stop)
            ordered = [done[task.name] for task in tasks if task.name in done]
            waiting = [str(task.case) for task in tasks if task.name not in done]
            # Printed first, so that it appears even if nothing can be written.
            print_summary(ordered)
            document = summary_document(ordered, how, waiting)
            with writing(summary):
                write_whole(summary, json_text(document))
            if json:
                echo(json_text(document), nl=False)
            elif is_hushed():
                for line in _lines(done for done in ordered if done.outcome not in GOOD):
                    echo(line, err=True)
            if stop.requested:
                message = f"Interrupted: {len(ordered)} of {len(tasks)} cases done."
                fail([message, "The same command continues; what is certified is kept."], stop.code)
    except LoadshareError as error:
        fail([str(error)], UNUSABLE)
    if any(outcome.outcome == UNWRITTEN for outcome in ordered):
        raise typer.Exit(UNUSABLE)
    if any(outcome.outcome not in GOOD for outcome in ordered):
        raise typer.Exit(REFUSED)


def _done(tasks: Sequence[Task], jobs: int, stop: Stop) -> dict[str, Outcome]:
    """Do all tasks, or as many as signals allow, and return their outcomes by name."""
    done: dict[str, Outcome] = {}
    try:
        with progress("cases", len(tasks)) as tick:
            for outcome in outcomes(tasks, jobs, lambda: stop.requested):
                done[outcome.name] = outcome
                tick(len(done), len(tasks))
        stop.over()
    except KeyboardInterrupt:
        stop.requested = True
    return done


def _stopping() -> None:
    # Past the buffers of stderr: a signal may arrive while they are being written to.
    message = "Stopping after the cases in progress. Press Ctrl-C again to abandon them.\n"
    os.write(2, message.encode())


STYLES = {"certified": "green", "kept": "green"}


def print_summary(outcomes: Sequence[Outcome]) -> None:
    """Print one row per case, and below what went wrong; nothing if no case was done."""
    from rich.text import Text

    from loadshare.cli.tables.table import show, table
    from loadshare.numbers import NONE, omega, small

    if not outcomes:
        return
    made = table(
        ("case", "outcome", "positions", "Ω system", "worst residual", "seconds"),
        words=("case", "outcome"),
    )
    for done in outcomes:
        made.add_row(
            done.name,
            Text(done.outcome, style=STYLES.get(done.outcome, "bold red")),
            str(done.positions),
            omega(done.omega),
            NONE if done.worst is None else small(done.worst),
            f"{done.seconds:.2f}",
        )
    show("Cases", made)
    say_all(_lines(outcomes), whole=True)
    say(counts(outcomes))


def _lines(outcomes: Iterable[Outcome]) -> Iterator[str]:
    """Yield what went wrong, and warnings."""
    for done in outcomes:
        yield from (f"{done.name}: {done.outcome}: {message}" for message in done.messages)


def counts(outcomes: Sequence[Outcome]) -> str:
    """Return the number of cases with each outcome, in words."""
    found = Counter(done.outcome for done in outcomes)
    text = ", ".join(f"{number} {outcome}" for outcome, number in found.most_common())
    return f"{counted(len(outcomes), 'case')}: {text}"


def summary_document(
    outcomes: Sequence[Outcome], settings: dict[str, Any], waiting: Sequence[str]
) -> dict[str, Any]:
    """Return the summary as plain data.

    Parameters
    ----------
    outcomes : sequence of Outcome
    settings : dict
        Solver, method, tolerance.
    waiting : sequence of str
        Cases that an interruption left undone.
    """
    cases = []
    for done in outcomes:
        record = asdict(done)
        message = "\n".join(record.pop("messages"))
        cases.append(record | {"message": message})
    return {
        "version": __version__,
        **settings,
        "passed": not waiting and all(done.outcome in GOOD for done in outcomes),
        "counts": dict(Counter(done.outcome for done in outcomes)),
        "cases": cases,
        "not_done": list(waiting),
    }
