"""The coefficients of the stages and of the system."""

from __future__ import annotations

from rich.console import Console

from loadshare.cli.tables.table import show, table
from loadshare.report.numbers import omega
from loadshare.report.reached import reached
from loadshare.results import Result


def print_omega(console: Console, result: Result) -> None:
    """Print the largest Ω of every stage and of the system, and where each is reached."""
    if not result.stages:
        console.print("\nNo stages are named, so there is no load-sharing coefficient.")
        return
    made = table(
        ("stage", "over stage mean", "reached at", "over group mean", "at"),
        words=("stage", "reached at", "at"),
    )
    made.columns[-1].header = "reached at"
    stage = [(p.position, p.share) for p in result.positions]
    pair = [(p.position, p.pair_share) for p in result.positions]
    for name, value in result.omega.items():
        meshes = result.stages.get(name, ())
        made.add_row(
            name,
            omega(value),
            reached(stage, meshes),
            omega(result.pair_omega[name]),
            reached(pair, meshes),
        )
    show(console, "Load-sharing coefficient Ω: largest over branches and positions", made)
