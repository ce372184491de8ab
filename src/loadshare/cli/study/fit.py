"""`loadshare fit`: unknown inputs from what was measured."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated

import typer

from loadshare.cli.console import say, say_all
from loadshare.cli.forms import (
    FIGURES,
    TABLES,
    Makers,
    Output,
    figure_of,
    outputs,
    tables_of,
    write_all,
)
from loadshare.cli.options import CaseFile, Changes, over, ranges_of
from loadshare.cli.study.common import running_study
from loadshare.cli.study.compare import show_comparison
from loadshare.cli.tables.table import show, table

if TYPE_CHECKING:
    import pandas as pd

    from loadshare.study.fit import Fit


def fit(
    case: CaseFile,
    unknown: Annotated[
        list[str],
        over(
            "LOW:HIGH",
            "Input to fit and its bounds, as in errors.6.installation.direction='0 deg:360 deg'; "
            "may be repeated.",
        ),
    ],
    starts: Annotated[
        int, typer.Option(metavar="N", min=1, help="Starting points; the best answer is taken.")
    ] = 1,
    seed: Annotated[
        int, typer.Option(metavar="N", min=0, help="Random seed of the other starting points.")
    ] = 0,
    file: Annotated[list[Output] | None, outputs("toml", *TABLES, *FIGURES)] = None,
    change: Changes = None,
) -> None:
    """Fit inputs of a case to what was measured."""
    from loadshare.study.fit import fit as fitted

    unknowns = ranges_of(unknown, "KEY=LOW:HIGH")
    with running_study(case, change, "starting points", starts) as (loaded, tick):
        found = fitted(loaded, unknowns, starts=starts, seed=seed, progress=tick)
    show_fit(found)
    write_all(file, made_of_fit(found))


def made_of_fit(found: Fit) -> Makers:
    """Return what makes the files of a fit: the fitted case, tables and a picture."""

    def frame() -> pd.DataFrame:
        import pandas as pd

        rows = [
            (u.parameter.name, u.parameter.unit, u.start, u.value, u.deviation, u.low, u.high)
            for u in found.unknowns
        ]
        heads = ["unknown", "unit", "start", "fitted", "deviation", "low", "high"]
        return pd.DataFrame(rows, columns=heads)

    tables = tables_of("fit", frame, chi_square=found.comparison.chi_square)
    return {**tables, **figure_of(found.plot), "toml": found.case.to_toml}


def show_fit(found: Fit) -> None:
    """Print the fitted values, how sure they are, and what they give."""
    rows = (
        (
            u.parameter.name,
            u.parameter.unit,
            f"{u.start:.6g}",
            f"{u.value:.6g}",
            "not determined" if math.isinf(u.deviation) else f"{u.deviation:.3g}",
            f"{u.low:g} … {u.high:g}",
        )
        for u in found.unknowns
    )
    heads = ("unknown", "unit", "start", "fitted", "±", "bounds")
    show("Fitted inputs", table(heads, rows, words=("unknown", "unit")))
    if len(found.unknowns) > 1:
        names = [u.parameter.name for u in found.unknowns]
        correlations = (
            (name, *("–" if math.isnan(c) else f"{c:+.3f}" for c in row))
            for name, row in zip(names, found.correlation, strict=True)
        )
        made = table(("correlation", *names), correlations, words=("correlation",))
        show("Correlations", made)
    show_comparison(found.comparison)
    if len(found.starts) > 1:
        reached = ", ".join("failed" if math.isnan(chi) else f"{chi:.4g}" for chi in found.starts)
        say(f"χ² from each starting point: {reached}")
    say_all(f"WARNING  {warning}" for warning in found.warnings)
