"""`loadshare study`: a study that the case itself holds."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any

import typer

from loadshare.cli.changes import open_case
from loadshare.cli.console import progress
from loadshare.cli.options import CaseFile
from loadshare.cli.study.common import Changes, answered, end
from loadshare.cli.study.compare import show_comparison
from loadshare.cli.study.critical import show_critical, unconfirmed
from loadshare.cli.study.fit import show_fit
from loadshare.cli.study.march import show_march
from loadshare.cli.study.sensitivity import show_sensitivity
from loadshare.cli.study.sweep import open_points, show_sweep
from loadshare.cli.study.tolerance import refused_samples, show_tolerance

SHOWN: dict[str, Callable[[Any], None]] = {
    "compare": show_comparison,
    "critical": show_critical,
    "fit": show_fit,
    "march": show_march,
    "sensitivity": show_sensitivity,
    "sweep": show_sweep,
    "tolerance": show_tolerance,
}
"""What prints each kind of study."""
OPEN: dict[str, Callable[[Any], list[str]]] = {
    "critical": unconfirmed,
    "sweep": open_points,
    "tolerance": refused_samples,
}
"""What tells the questions that a study could not answer."""


def study(
    case: CaseFile,
    name: Annotated[
        str | None, typer.Argument(metavar="NAME", help="Which one; left out, all are listed.")
    ] = None,
    change: Changes = None,
) -> None:
    """Run a study that the case holds, [study.NAME]."""
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
        rated = kind == "tolerance"
        with progress(*(("samples", None) if rated else (name, 1)), rated=rated) as tick:
            found = run_study(loaded, name, progress=tick)
    SHOWN[kind](found)
    end(OPEN[kind](found) if kind in OPEN else [])
