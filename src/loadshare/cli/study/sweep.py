"""`loadshare sweep`: a case over a grid of one or two parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from loadshare.cli.console import console, progress
from loadshare.cli.exits import REFUSED, counted, fail
from loadshare.cli.study.common import (
    CaseFile,
    Changes,
    Positions,
    TableFile,
    answered,
    check_ending,
    open_case,
    write_table,
)

if TYPE_CHECKING:
    from rich.console import Console

    from loadshare.study.sweep import Sweep


def sweep(
    case: CaseFile,
    setting: Annotated[
        list[str],
        typer.Option(
            "--set",
            metavar="KEY=GRID",
            help="Parameter and its values, as in rings.4.float='0 um:12 um:61' (first, last, how "
            "many) or 'a, b, c'; KEY=KEY=GRID ties keys; a star stands for any name. One or two.",
        ),
    ],
    file: TableFile = None,
    position: Positions = None,
    change: Changes = None,
) -> None:
    """Solve a case over a grid of one or two inputs."""
    from loadshare.study.parameter import split_outside
    from loadshare.study.sweep import sweep as swept

    check_ending(file, ".csv", ".nc")
    over: dict[tuple[str, ...], str] = {}
    for text in setting:
        *keys, grid = split_outside(text, "=")
        if not keys or not all(keys) or not grid:
            raise typer.BadParameter(
                f"{text!r} is not of the form KEY=GRID, as in rings.4.float='0 um:12 um:61'",
                param_hint="--set",
            )
        over[tuple(keys)] = grid
    with answered():
        loaded = open_case(case, change)
        with progress("points", 1) as tick:
            found = swept(loaded, over, positions=position, progress=tick)
    show_sweep(console(), found)
    write_table(file, found.to_frame() if file else None, found.dataset if file else None)
    failed = [p for p in found.points if p.status != "certified"]
    if failed:
        told = dict.fromkeys(f"{p.status}: {p.message.splitlines()[0]}" for p in failed)
        fail(
            [*told, f"{counted(len(failed), 'point')} of {len(found.points)} not certified."],
            REFUSED,
        )


def show_sweep(screen: Console, found: Sweep) -> None:
    """Print the largest Ω of every stage at every point."""
    from loadshare.cli.tables.table import show, table
    from loadshare.report.numbers import omega

    first = next((p.result for p in found.points if p.result is not None), None)
    stages = list(first.omega) if first is not None else []
    heads = [f"{p.name} [{p.unit}]" if p.unit else p.name for p in found.parameters]
    made = table(
        (*heads, *(f"Ω {s}" for s in stages), *(f"Ω {s}, group" for s in stages), "status"),
        words=("status",),
    )
    for point in found.points:
        shares = []
        for kind in ("omega", "pair_omega"):
            values = getattr(point.result, kind) if point.result is not None else {}
            shares += [omega(values.get(stage)) for stage in stages]
        made.add_row(*(f"{value:.6g}" for value in point.values), *shares, point.status)
    show(screen, f"Sweep of {found.case}", made)
