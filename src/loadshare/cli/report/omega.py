"""The coefficients of the stages and of the system."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rich.console import Console

from loadshare.cli.report.numbers import NONE, omega
from loadshare.cli.report.tables import show, table
from loadshare.results import Result

Shares = Sequence[tuple[int, Mapping[str, float | None]]]


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
            _reached(stage, meshes),
            omega(result.pair_omega[name]),
            _reached(pair, meshes),
        )
    show(console, "Load-sharing coefficient Ω: largest over branches and positions", made)


def _reached(shares: Shares, meshes: Sequence[str]) -> str:
    """Return the branch, and the position if it matters, at which Ω is largest."""
    found = [(s[m], m, k) for k, s in shares for m in meshes]
    known = [(v, m, k) for v, m, k in found if v is not None]
    if not known:
        return "" if not meshes else NONE
    largest, mesh, position = max(known, key=lambda f: f[0])
    top = [(m, k) for v, m, k in known if omega(v) == omega(largest)]
    if len(top) == len(found):
        return "all alike"
    if sum(m == mesh for m, _ in top) == len(shares):
        return mesh
    return f"{mesh}, position {position}"
