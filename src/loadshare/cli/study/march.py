"""`loadshare march`: revolutions with spline friction that remembers its slip."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Annotated

import typer

from loadshare.cli.console import say
from loadshare.cli.options import CaseFile
from loadshare.cli.study.common import Changes, TableFile, asked, write_table
from loadshare.cli.tables.table import show, table

if TYPE_CHECKING:
    from loadshare.study.march import March


def march(
    case: CaseFile,
    gear: Annotated[
        str | None, typer.Option(metavar="NAME", help="Gear whose revolutions are counted.")
    ] = None,
    revolutions: Annotated[
        float | None, typer.Option(metavar="X", min=0.0, help="How far to march.")
    ] = None,
    steps: Annotated[int | None, typer.Option(metavar="N", min=1, help="Number of steps.")] = None,
    file: TableFile = None,
    change: Changes = None,
) -> None:
    """March through revolutions with spline friction that remembers its slip."""
    from loadshare.study.march import march as marched

    with asked(case, change, "steps") as (loaded, tick):
        found = marched(loaded, gear=gear, revolutions=revolutions, steps=steps, progress=tick)
    show_march(found)
    write_table(file, found.result.to_frame, lambda: found.dataset)


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
