"""`loadshare march`: revolutions with spline friction that remembers its slip."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Annotated

import typer

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
from loadshare.cli.options import CaseFile, Changes, Gear
from loadshare.cli.study.common import running_study
from loadshare.cli.tables.table import show, table
from loadshare.output import netcdf_of

if TYPE_CHECKING:
    from loadshare.study.march import March


def march(
    case: CaseFile,
    gear: Gear = None,
    revolutions: Annotated[
        float | None, typer.Option(metavar="X", min=0.0, help="Revolutions to march.")
    ] = None,
    steps: Annotated[int | None, typer.Option(metavar="N", min=1, help="Number of steps.")] = None,
    file: Annotated[list[Output] | None, outputs(*TABLES, *FIGURES)] = None,
    change: Changes = None,
) -> None:
    """March through revolutions; spline friction depends on the slip before."""
    from loadshare.study.march import march as marched

    with running_study(case, change, "steps") as (loaded, tick):
        found = marched(loaded, gear=gear, revolutions=revolutions, steps=steps, progress=tick)
    show_march(found)
    write_all(file, made_of_march(found))


def made_of_march(found: March) -> Makers:
    """Return what makes the files of a march."""
    return {
        **tables_of("march", found.to_dataframe),
        **figure_of(found.plot),
        "nc": lambda: netcdf_of(found.dataset),
    }


def show_march(found: March) -> None:
    """Print load sharing over the march, and what every spline did."""
    from loadshare.cli.tables.result import print_result

    print_result(found.result, len(found.slips))
    if not found.slips or not found.slips[0]:
        say("\nNo spline holds a gear: there is nothing to remember.")
        return
    rows = []
    for gear in found.slips[0]:
        steps = [step[gear] for step in found.slips]
        stages = ", ".join(f"{s} {n}×" for s, n in Counter(s.stage for s in steps).most_common())
        sizes = [float((s.slip @ s.slip) ** 0.5) * 1e6 for s in steps]
        total = sum(s.dissipated for s in steps)
        rows.append((gear, stages, f"{min(sizes):.3f} … {max(sizes):.3f}", f"{total:.4g}"))
    heads = ("spline", "stages", "slip [µm]", "dissipated [J]")
    show("Splines", table(heads, rows, words=heads[:2]))
