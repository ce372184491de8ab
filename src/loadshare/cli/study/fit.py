"""`loadshare fit`: unknown inputs from what was measured."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated

import typer

from loadshare.cli.console import console
from loadshare.cli.exits import writing
from loadshare.cli.files import write_text
from loadshare.cli.study.common import CaseFile, Changes, FittedFile, asked

if TYPE_CHECKING:
    from rich.console import Console

    from loadshare.study.fit import Fit


def fit(
    case: CaseFile,
    unknown: Annotated[
        list[str],
        typer.Option(
            "--unknown",
            metavar="KEY=LOW:HIGH",
            help="Input to fit and its bounds, as in errors.6.installation.direction='0 deg:360 "
            "deg'; may be repeated.",
        ),
    ],
    starts: Annotated[
        int, typer.Option(metavar="N", min=1, help="Starting points; the best answer is taken.")
    ] = 1,
    seed: Annotated[
        int, typer.Option(metavar="N", min=0, help="Seed of the further starting points.")
    ] = 0,
    file: FittedFile = None,
    change: Changes = None,
) -> None:
    """Fit inputs of a case to what was measured."""
    from loadshare.study.fit import fit as fitted
    from loadshare.study.parameter import split_outside

    unknowns: dict[tuple[str, ...], list[str]] = {}
    for text in unknown:
        *keys, bounds = split_outside(text, "=")
        limits = bounds.split(":")
        if not keys or not all(keys) or len(limits) != 2:
            raise typer.BadParameter(
                f"{text!r} is not of the form KEY=LOW:HIGH", param_hint="--unknown"
            )
        unknowns[tuple(keys)] = limits
    with asked(case, change, "starting points", starts) as (loaded, tick):
        found = fitted(loaded, unknowns, starts=starts, seed=seed, progress=tick)
    show_fit(console(), found)
    if file is not None:
        with writing(file):
            write_text(file, found.case.to_toml())
        typer.echo(f"Wrote {file}", err=True)


def show_fit(screen: Console, found: Fit) -> None:
    """Print the fitted values, how sure they are, and what they give."""
    from loadshare.cli.study.compare import show_comparison
    from loadshare.cli.tables.table import show, table

    made = table(("unknown", "unit", "start", "fitted", "±", "bounds"), words=("unknown", "unit"))
    for u in found.unknowns:
        spread = "not determined" if math.isinf(u.deviation) else f"{u.deviation:.3g}"
        made.add_row(
            u.parameter.name,
            u.parameter.unit,
            f"{u.start:.6g}",
            f"{u.value:.6g}",
            spread,
            f"{u.low:g} … {u.high:g}",
        )
    show(screen, "Fitted inputs", made)
    if len(found.unknowns) > 1:
        names = [u.parameter.name for u in found.unknowns]
        made = table(("correlation", *names), words=("correlation",))
        for name, row in zip(names, found.correlation, strict=True):
            made.add_row(name, *("–" if math.isnan(c) else f"{c:+.3f}" for c in row))
        show(screen, "Correlations", made)
    show_comparison(screen, found.comparison)
    if len(found.starts) > 1:
        told = ", ".join("failed" if math.isnan(chi) else f"{chi:.4g}" for chi in found.starts)
        screen.print(f"χ² from each starting point: {told}")
    for warning in found.warnings:
        screen.print(f"WARNING  {warning}")
