"""`loadshare study`: a study that the case itself holds."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated, Any

import typer

from loadshare.cli.console import console, progress
from loadshare.cli.study.common import CaseFile, Changes, answered, end, open_case

if TYPE_CHECKING:
    from rich.console import Console


def study(
    case: CaseFile,
    name: Annotated[
        str | None, typer.Argument(metavar="NAME", help="Which one; left out, all are listed.")
    ] = None,
    change: Changes = None,
) -> None:
    """Run a study that the case holds, [study.NAME]."""
    from loadshare.cli.study.tolerance import rated_progress
    from loadshare.study.named import run_study

    with answered():
        loaded = open_case(case, change)
        if name is None:
            for known, block in loaded.study.items():
                typer.echo(f"{known}: {block.kind}")
            if not loaded.study:
                typer.echo("The case holds no study: add a table [study.NAME].")
            return
        kind = loaded.study[name].kind if name in loaded.study else ""
        bar = rated_progress("samples") if kind == "tolerance" else progress(name, 1)
        with bar as tick:
            found = run_study(loaded, name, progress=tick)
    _show(console(), kind, found)
    end(_open(kind, found))


def _open(kind: str, found: Any) -> list[str]:
    """Return what a study could not answer."""
    from loadshare.cli.study.critical import unconfirmed
    from loadshare.cli.study.sweep import open_points
    from loadshare.cli.study.tolerance import refused_samples

    told: dict[str, Callable[[Any], list[str]]] = {
        "critical": unconfirmed,
        "sweep": open_points,
        "tolerance": refused_samples,
    }
    return told[kind](found) if kind in told else []


def _show(screen: Console, kind: str, found: Any) -> None:
    from loadshare.cli.study.compare import show_comparison
    from loadshare.cli.study.critical import show_critical
    from loadshare.cli.study.fit import show_fit
    from loadshare.cli.study.march import show_march
    from loadshare.cli.study.sensitivity import show_sensitivity
    from loadshare.cli.study.sweep import show_sweep
    from loadshare.cli.study.tolerance import show_tolerance

    shown: dict[str, Callable[[Console, Any], None]] = {
        "compare": show_comparison,
        "critical": show_critical,
        "fit": show_fit,
        "march": show_march,
        "sensitivity": show_sensitivity,
        "sweep": show_sweep,
        "tolerance": show_tolerance,
    }
    shown[kind](screen, found)
