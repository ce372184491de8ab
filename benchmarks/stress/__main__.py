"""The map of stability, or one of its problems: ``python -m benchmarks.stress``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from benchmarks.console import EVIDENCE, Folder, Quiet, application, teller
from benchmarks.stress import publish, verdict
from benchmarks.stress.families import FAMILIES
from benchmarks.stress.problem import Family
from benchmarks.stress.truth import truth_of
from loadshare.cli.exits import REFUSED, UNUSABLE, fail, writing
from loadshare.output import write_whole
from loadshare.train import build_train


def stress(
    folder: Folder = EVIDENCE,
    family: Annotated[
        str | None, typer.Option("--family", metavar="NAME", help="Only this family.")
    ] = None,
    problem: Annotated[
        int | None,
        typer.Option(
            "--problem", metavar="N", help="Run and explain only this problem of --family."
        ),
    ] = None,
    ours: Annotated[bool, typer.Option("--ours", help="Leave the peers out.")] = False,
    quick: Annotated[bool, typer.Option("--quick", help="Every tenth problem.")] = False,
    redraw: Annotated[
        bool, typer.Option("--redraw", help="Draw the existing figures; run nothing.")
    ] = False,
    case: Annotated[
        Path | None, typer.Option("--case", metavar="FILE", help="Write the problem as a case.")
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Try problems from harmless to extreme on every method, and write map and report."""
    if family is not None and family not in FAMILIES:
        there = ", ".join(FAMILIES)
        raise typer.BadParameter(f"{family!r}; there are {there}", param_hint="--family")
    if problem is not None:
        if family is None:
            raise typer.BadParameter("goes with --family", param_hint="--problem")
        _explain(FAMILIES[family], problem, case)
        return
    if redraw and not (folder / publish.FIGURES).exists():
        fail([f"{folder / publish.FIGURES}: does not exist; leave out --redraw to run"], UNUSABLE)
    chosen = [family] if family else list(FAMILIES)
    with writing(folder):
        cells, files = publish.stress(folder, chosen, not ours, quick, redraw, teller(quiet))
    for file in files:
        typer.echo(f"Wrote {file}")
    missed = [c for c in cells if c.method == "ours" and c.failures]
    if missed:
        lines = (f"{c.family}: {len(c.failures)} not as it should be" for c in missed)
        fail(lines, REFUSED)


def _explain(family: Family, number: int, case: Path | None) -> None:
    """Print a problem, what is known about it, and the answer of the library."""
    try:
        problem = family.problem(number)
    except IndexError as error:
        raise typer.BadParameter(str(error), param_hint="--problem") from error
    truth = truth_of(build_train(problem.case))
    found = verdict.judge(problem, verdict.ours)
    typer.echo(f"{problem.name}: {family.title}, {family.knob} {problem.level:g}")
    answer = "has an answer" if truth.solvable else "has no answer"
    typer.echo(f"The problem {answer}: {truth.why}")
    typer.echo(f"Ours, in {found.seconds:.3f} s: {found.outcome.value}: {found.reason}")
    if case is not None:
        with writing(case):
            write_whole(case, problem.case.to_toml())
        typer.echo(f"Wrote {case}")
    if not found.as_it_should_be:
        raise typer.Exit(REFUSED)


app = application(stress)

if __name__ == "__main__":
    app()
