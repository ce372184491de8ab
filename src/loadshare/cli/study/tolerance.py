"""`loadshare tolerance`: what scattering inputs do to load sharing."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from loadshare.cli.console import Tick, console
from loadshare.cli.exits import UNUSABLE, counted, fail
from loadshare.cli.study.common import CaseFile, Changes, answered, end, open_case

if TYPE_CHECKING:
    from rich.console import Console

    from loadshare.study.tolerance.result import Tolerance
    from loadshare.study.tolerance.statistics import Estimate, Summary

SHOWN = 20
"""Inputs, and messages, that are shown."""
ROUND_OFF = 1e-12
"""Deviation over the mean that says nothing."""


def tolerance(
    case: CaseFile,
    name: Annotated[
        str | None,
        typer.Argument(
            metavar="NAME", help="Which study; left out, the case has one of this kind."
        ),
    ] = None,
    samples: Annotated[
        int | None, typer.Option(metavar="N", min=1, help="Samples, instead of the case's.")
    ] = None,
    seed: Annotated[
        int | None, typer.Option(metavar="S", min=0, help="Seed, instead of the case's.")
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="FOLDER",
            file_okay=False,
            help="Folder for the samples (Parquet); a study that was killed goes on from there.",
        ),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="Dask scheduler whose workers solve the samples."),
    ] = None,
    workers: Annotated[int, typer.Option(metavar="K", min=1, help="Processes.")] = 2,
    worst: Annotated[
        bool, typer.Option("--worst/--no-worst", help="Look for the worst case as well.")
    ] = True,
    change: Changes = None,
) -> None:
    """Let inputs scatter as [study.NAME] says, and tell how load sharing does."""
    from loadshare.errors import CaseError, LoadshareError, Refused
    from loadshare.study.tolerance.study import tolerance as studied

    with answered():
        loaded = open_case(case, change)
        try:
            with rated_progress("samples") as tick:
                found = studied(
                    loaded,
                    study=name,
                    samples=samples,
                    seed=seed,
                    out=out,
                    scheduler=scheduler,
                    workers=workers,
                    worst=worst,
                    progress=tick,
                )
        except (CaseError, Refused):
            raise
        except LoadshareError as error:
            fail([str(error)], UNUSABLE)
    show_tolerance(console(), found)
    if out is not None:
        typer.echo(f"Wrote {out}", err=True)
    end(refused_samples(found))


def refused_samples(found: Tolerance) -> list[str]:
    """Return how many samples have no certified answer; nothing if all have one."""
    if not found.refused:
        return []
    return [f"{counted(found.refused, 'sample')} of {found.samples} not certified."]


@contextmanager
def rated_progress(what: str) -> Iterator[Tick | None]:
    """Show a progress bar with rate and time left on a terminal; yield None in a pipe or a log."""
    screen = console(stderr=True)
    if not screen.is_terminal:
        yield None
        return
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        ProgressColumn,
        Task,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )
    from rich.text import Text

    class Rate(ProgressColumn):
        def render(self, task: Task) -> Text:
            speed = task.finished_speed or task.speed
            return Text("" if speed is None else f"{speed:,.0f}/s")

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        Rate(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    # Parts come seconds apart: a short memory would show no rate between them.
    with Progress(*columns, console=screen, transient=True, speed_estimate_period=300.0) as bar:
        task = bar.add_task(what, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


def show_tolerance(screen: Console, found: Tolerance) -> None:
    """Print how Ω scatters, from which inputs it comes, and the worst case."""
    settings = found.settings
    screen.print(
        f"Tolerance study of {found.case}: {found.samples:,} {settings['sampling']} samples, "
        f"seed {settings['seed']}, {counted(len(settings['positions']), 'position')}, "
        f"largest residual {found.residual:.1e}"
    )
    _show_inputs(screen, found)
    _show_omega(screen, found)
    _show_shares(screen, found)
    _show_others(screen, found)
    _show_worst(screen, found)
    for text, count in list(found.messages.items())[:SHOWN]:
        screen.print(f"REFUSED  {count}×  {text}")
    if found.design_refused:
        told = counted(found.design_refused, "sample")
        screen.print(f"WARNING  {told} for the shares of variance refused; their rows are left out")


def _show_inputs(screen: Console, found: Tolerance) -> None:
    from loadshare.cli.tables.table import show, table

    made = table(("input", "scatters"), words=("input", "scatters"))
    for drawn in found.inputs.every[:SHOWN]:
        made.add_row(drawn.name, str(drawn.distribution))
    show(screen, "Inputs", made)
    _tell_left(screen, len(found.inputs.every))


def _show_omega(screen: Console, found: Tolerance) -> None:
    from loadshare.cli.tables.table import show, table

    levels = list(found.omega[0].summary.quantiles) if found.omega else []
    limit = [] if found.limit is None else [f"P(Ω > {found.limit:g})"]
    figures = table(("Ω", "mean", "deviation", "largest", *limit), words=("Ω",))
    quantiles = table(("Ω", *(f"{100 * level:g} %" for level in levels)), words=("Ω",))
    for one in found.omega:
        if one.over not in found.overs:
            continue
        s = one.summary
        above = [_interval(one.exceedance)] if one.exceedance is not None else []
        label = f"{one.stage}, group" if one.over == "group" else one.stage
        figures.add_row(
            label, f"{s.mean.value:.5f}", f"{_spread(s):.2g}", f"{s.highest:.5f}", *above
        )
        quantiles.add_row(label, *(f"{q.value:.5f}" for q in s.quantiles.values()))
    show(screen, "Largest Ω over branches and positions", figures)
    show(screen, "Its quantiles", quantiles)
    if found.limit is not None or any(one.shares for one in found.omega):
        screen.print("Intervals in brackets: 95 %.")


def _spread(found: Summary) -> float:
    """Deviation; none where it is round-off of the mean."""
    return found.deviation if found.deviation > ROUND_OFF * abs(found.mean.value) else 0.0


def _interval(found: Estimate, form: str = ".4g") -> str:
    return f"{found.value:{form}} ({found.low:{form}} … {found.high:{form}})"


def _show_shares(screen: Console, found: Tolerance) -> None:
    from loadshare.cli.tables.table import show, table

    for one in found.omega:
        if one.stage != "system" or one.over not in found.overs or not one.shares:
            continue
        made = table(("input", "alone", "with interactions"), words=("input",))
        shares = sorted(one.shares, key=lambda s: -s.total.value)
        for share in shares[:SHOWN]:
            made.add_row(share.unit, *(_interval(e, ".3f") for e in (share.first, share.total)))
        mean = "group" if one.over == "group" else "stage"
        show(screen, f"Shares of the variance of Ω of the system, by the mean of the {mean}", made)
        _tell_left(screen, len(shares))


def _show_others(screen: Console, found: Tolerance) -> None:
    from loadshare.cli.tables.table import show, table

    heads = ("mean", "deviation", "smallest", "largest")

    def cells(s: Summary, factor: float = 1.0) -> list[str]:
        values = (s.mean.value, _spread(s), s.lowest, s.highest)
        return [f"{factor * value:.5g}" for value in values]

    made = table(("mesh", *heads), words=("mesh",))
    for mesh, summary in found.torque.items():
        made.add_row(mesh, *cells(summary))
    show(screen, "Largest driver torque over positions [N*m]", made)
    if found.floats:
        made = table(("float", *heads, "on its boundary"), words=("float",))
        for one in found.floats:
            pressed = "–" if one.pressed is None else f"{100 * one.pressed:.4g} %"
            made.add_row(one.gear, *cells(one.way, 1e6), pressed)
        show(screen, "Largest way of floats over positions [um]", made)


def _show_worst(screen: Console, found: Tolerance) -> None:
    from loadshare.cli.tables.table import show, table

    for one in found.worst:
        made = table(("input", "value", "of its tolerance"), words=("input", "of its tolerance"))
        for drawn in found.inputs.every:
            unit = drawn.distribution.unit
            value = f"{one.inputs[drawn.name]:.6g} {unit}".strip()
            made.add_row(drawn.name, value, one.at[drawn.name])
        mean = f"by the mean of the {one.over}"
        show(screen, f"Worst case found within the tolerances: Ω = {one.omega:.5f} {mean}", made)
        screen.print(f"Certified; the best of {one.solved:,} trials, there may be a worse one")


def _tell_left(screen: Console, count: int) -> None:
    if count > SHOWN:
        screen.print(f"and {count - SHOWN} more")
