"""`loadshare stress`: the map of stability, or one of its problems."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from loadshare.cli.evidence.chart import EVIDENCE
from loadshare.cli.evidence.console import DRAWING, Folder, Quiet, need, teller
from loadshare.cli.exits import REFUSED, UNUSABLE, fail, writing

if TYPE_CHECKING:
    from loadshare.evidence.stress.problem import Family


def stress(
    folder: Folder = EVIDENCE,
    family: Annotated[
        str | None, typer.Option("--family", metavar="NAME", help="Only this family.")
    ] = None,
    problem: Annotated[
        int | None,
        typer.Option("--problem", metavar="N", help="Only this problem of --family: explain it."),
    ] = None,
    ours: Annotated[bool, typer.Option("--ours", help="Leave the peers out.")] = False,
    quick: Annotated[bool, typer.Option("--quick", help="Every tenth problem.")] = False,
    redraw: Annotated[
        bool, typer.Option("--redraw", help="Draw the figures that are there; run nothing.")
    ] = False,
    case: Annotated[
        Path | None, typer.Option("--case", metavar="FILE", help="Write the problem as a case.")
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Try problems from harmless to extreme on every method, and write map and report."""
    from loadshare.evidence.stress.families import FAMILIES

    if family is not None and family not in FAMILIES:
        there = ", ".join(FAMILIES)
        raise typer.BadParameter(f"{family!r}; there are {there}", param_hint="--family")
    if problem is not None:
        if family is None:
            raise typer.BadParameter("goes with --family", param_hint="--problem")
        _explain(FAMILIES[family], problem, case)
        return
    need(DRAWING, "stress")
    from loadshare.evidence.stress.publish import FIGURES
    from loadshare.evidence.stress.publish import stress as mapped

    if redraw and not (folder / FIGURES).exists():
        fail([f"{folder / FIGURES}: is not there; leave --redraw out to run"], UNUSABLE)
    chosen = [family] if family else list(FAMILIES)
    with writing(folder):
        cells, files = mapped(folder, chosen, not ours, quick, redraw, teller(quiet))
    for file in files:
        typer.echo(f"Wrote {file}")
    missed = [c for c in cells if c.method == "ours" and c.failures]
    if missed:
        told = (f"{c.family}: {len(c.failures)} not as it should be" for c in missed)
        fail(told, REFUSED)


def _explain(family: Family, number: int, case: Path | None) -> None:
    """Tell what a problem is, what is known of it, and what ours makes of it."""
    from loadshare.cli.files import write_text
    from loadshare.evidence.stress.truth import truth_of
    from loadshare.evidence.stress.verdict import judge, ours
    from loadshare.train import build_train

    try:
        problem = family.problem(number)
    except IndexError as error:
        raise typer.BadParameter(str(error), param_hint="--problem") from error
    truth = truth_of(build_train(problem.case))
    verdict = judge(problem, ours)
    typer.echo(f"{problem.name}: {family.title}, {family.knob} {problem.level:g}")
    answer = "has an answer" if truth.solvable else "has no answer"
    typer.echo(f"The problem {answer}: {truth.why}")
    typer.echo(f"Ours, in {verdict.seconds:.3f} s: {verdict.outcome.value}: {verdict.told}")
    if case is not None:
        with writing(case):
            write_text(case, problem.case.to_toml())
        typer.echo(f"Wrote {case}")
    if not verdict.as_it_should_be:
        raise typer.Exit(REFUSED)
