"""`loadshare compare`: measured against computed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from loadshare.cli.console import console
from loadshare.cli.exits import counted
from loadshare.cli.study.common import (
    CaseFile,
    Changes,
    CsvFile,
    asked,
    write_table,
)

if TYPE_CHECKING:
    from rich.console import Console

    from loadshare.study.compare import Comparison


def compare(case: CaseFile, file: CsvFile = None, change: Changes = None) -> None:
    """Compare what was measured with what is computed."""
    from loadshare.study.compare import compare as compared

    with asked(case, change, "positions") as (loaded, tick):
        found = compared(loaded, progress=tick)
    show_comparison(console(), found)
    if file is not None:
        write_table(file, found.to_frame())


def show_comparison(screen: Console, found: Comparison) -> None:
    """Print every measured figure beside the computed one."""
    from loadshare.cli.tables.table import show, table

    made = table(
        ("measured", "of", "at", "figure", "±", "computed", "difference", "in ±"),
        words=("measured", "of", "at"),
    )
    for d in found.deviations:
        target = d.target
        unit = f" [{target.unit}]" if target.unit else ""
        made.add_row(
            target.measurement,
            f"{target.quantity} {target.where}{unit}",
            "all" if target.position is None else str(target.position),
            f"{target.value:.6g}",
            f"{target.uncertainty:.3g}",
            f"{d.computed:.6g}",
            f"{d.difference:+.3g}",
            f"{d.deviations:+.2f}",
        )
    show(screen, "Measured against computed", made)
    screen.print(f"χ² = {found.chi_square:.4g} over {counted(len(found.deviations), 'figure')}")
