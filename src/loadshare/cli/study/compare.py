"""`loadshare compare`: measured against computed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from loadshare.cli.console import say
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
from loadshare.cli.options import CaseFile, Changes
from loadshare.cli.study.common import running_study
from loadshare.cli.tables.table import show, table
from loadshare.report.numbers import counted

if TYPE_CHECKING:
    from loadshare.study.compare import Comparison, Deviation


def compare(
    case: CaseFile,
    file: Annotated[list[Output] | None, outputs(*TABLES, *FIGURES)] = None,
    change: Changes = None,
) -> None:
    """Compare what was measured with what is computed."""
    from loadshare.study.compare import compare as compared

    with running_study(case, change, "positions") as (loaded, tick):
        found = compared(loaded, progress=tick)
    show_comparison(found)
    write_all(file, made_of_comparison(found))


def made_of_comparison(found: Comparison) -> Makers:
    """Return what makes the files of a comparison."""
    tables = tables_of("compare", found.to_frame, chi_square=found.chi_square)
    return {**tables, **figure_of(found.plot)}


def show_comparison(found: Comparison) -> None:
    """Print every measured figure next to the computed one."""
    words = ("measured", "of", "at")
    heads = (*words, "figure", "±", "computed", "difference", "in ±")
    show("Measured against computed", table(heads, map(_row, found.deviations), words))
    say(f"χ² = {found.chi_square:.4g} over {counted(len(found.deviations), 'figure')}")


def _row(d: Deviation) -> tuple[str, ...]:
    target = d.target
    unit = f" [{target.unit}]" if target.unit else ""
    return (
        target.measurement,
        f"{target.quantity} {target.where}{unit}",
        "all" if target.position is None else str(target.position),
        f"{target.value:.6g}",
        f"{target.uncertainty:.3g}",
        f"{d.computed:.6g}",
        f"{d.difference:+.3g}",
        f"{d.deviations:+.2f}",
    )
