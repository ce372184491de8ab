"""`loadshare sweep`: a case over a grid of one or two parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from loadshare.cli.console import console
from loadshare.cli.exits import counted
from loadshare.cli.study.common import (
    CaseFile,
    Changes,
    Positions,
    TableFile,
    asked,
    end,
    write_table,
)

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from loadshare.study.sweep import Sweep

MEANS = {"stage": "omega", "group": "pair_omega"}


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

    over: dict[tuple[str, ...], str] = {}
    for text in setting:
        *keys, grid = split_outside(text, "=")
        if not keys or not all(keys) or not grid:
            raise typer.BadParameter(
                f"{text!r} is not of the form KEY=GRID, as in rings.4.float='0 um:12 um:61'",
                param_hint="--set",
            )
        over[tuple(keys)] = grid
    with asked(case, change, "points") as (loaded, tick):
        found = swept(loaded, over, positions=position, progress=tick)
    show_sweep(console(), found)
    write_table(file, found.to_frame() if file else None, found.dataset if file else None)
    end(open_points(found))


def open_points(found: Sweep) -> list[str]:
    """Return why points have no certified answer; nothing if all have one."""
    failed = [p for p in found.points if p.status != "certified"]
    if not failed:
        return []
    told = dict.fromkeys(f"{p.status}: {p.message.splitlines()[0]}" for p in failed)
    return [*told, f"{counted(len(failed), 'point')} of {len(found.points)} not certified."]


def show_sweep(screen: Console, found: Sweep) -> None:
    """Print the largest Ω of every stage at every point; by the group where that differs."""
    from loadshare.cli.tables.table import show

    tables = {mean: _table(found, kind) for mean, kind in MEANS.items()}
    texts = {mean: [list(column.cells) for column in made.columns] for mean, made in tables.items()}
    alike = texts["stage"] == texts["group"]
    for mean, made in tables.items():
        by = "stage and by group alike" if alike else mean
        show(screen, f"Sweep of {found.case}: largest Ω, by {by}", made)
        if alike:
            return


def _table(found: Sweep, kind: str) -> Table:
    from loadshare.cli.tables.table import table
    from loadshare.report.numbers import omega

    first = next((p.result for p in found.points if p.result is not None), None)
    stages = list(first.omega) if first is not None else []
    heads = [f"{p.name} [{p.unit}]" if p.unit else p.name for p in found.parameters]
    # Where every point is certified, a column that says so would only take room.
    status = [] if found.passed else ["status"]
    made = table((*heads, *(f"Ω {stage}" for stage in stages), *status), words=status)
    for column in made.columns[: len(heads)]:
        # A long key is folded, and its figures stay whole.
        column.no_wrap, column.min_width = False, 9
    for point in found.points:
        shares = [
            omega(getattr(point.result, kind)[stage] if point.result is not None else None)
            for stage in stages
        ]
        values = (f"{value:.6g}" for value in point.values)
        made.add_row(*values, *shares, *([point.status] if status else []))
    return made
