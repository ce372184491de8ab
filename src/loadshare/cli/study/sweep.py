"""`loadshare sweep`: a case over a grid of one or two parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from loadshare.cli.forms import FIGURES, Makers, Output, figure_of, outputs, tables_of, write_all
from loadshare.cli.options import CaseFile, Changes, Positions, over, split_setting
from loadshare.cli.study.common import end, running_study
from loadshare.cli.tables.table import show, table
from loadshare.output import netcdf_of
from loadshare.report.numbers import omega

if TYPE_CHECKING:
    from rich.table import Table

    from loadshare.study.sweep import Sweep

SWEPT = ("csv", "nc", "parquet", "xlsx", "json", *FIGURES)
MEANS = {"stage": "omega", "group": "pair_omega"}


def sweep(
    case: CaseFile,
    grids: Annotated[
        list[str],
        over(
            "GRID",
            "Input and its values, as in rings.4.float='0 um:12 um:61' (first, last, how many) or "
            "'a, b, c'; KEY=KEY=GRID ties keys; a star matches any name. One or two.",
        ),
    ],
    file: Annotated[list[Output] | None, outputs(*SWEPT)] = None,
    position: Positions = None,
    change: Changes = None,
) -> None:
    """Solve a case over a grid of one or two inputs."""
    from loadshare.study.sweep import sweep as swept

    form = "KEY=GRID, as in rings.4.float='0 um:12 um:61'"
    parameters = dict(split_setting(text, form) for text in grids)
    with running_study(case, change, "points") as (loaded, tick):
        found = swept(loaded, parameters, positions=position, progress=tick)
    show_sweep(found)
    write_all(file, made_of_sweep(found))
    end(found)


def made_of_sweep(found: Sweep) -> Makers:
    """Return what makes the files of a sweep."""
    return {
        **tables_of("sweep", found.to_frame, case=found.case, passed=found.passed),
        **figure_of(found.plot),
        "nc": lambda: netcdf_of(found.dataset),
    }


def show_sweep(found: Sweep) -> None:
    """Print the largest Ω of every stage at every point; by the group where that differs."""
    tables = {mean: _table(found, kind) for mean, kind in MEANS.items()}
    texts = [[list(column.cells) for column in made.columns] for made in tables.values()]
    if texts[0] == texts[1]:
        tables = {"stage and by group alike": tables["stage"]}
    for mean, made in tables.items():
        show(f"Sweep of {found.case}: largest Ω, by {mean}", made)


def _table(found: Sweep, kind: str) -> Table:
    stages = list(found.largest(kind, 0))
    heads = [f"{p.name} [{p.unit}]" if p.unit else p.name for p in found.parameters]
    # Where every point is certified, a column that says so would only take room.
    status = [] if found.passed else ["status"]
    rows = (
        (
            *(f"{value:.6g}" for value in point.values),
            *map(omega, found.largest(kind, k).values()),
            *([point.status] if status else []),
        )
        for k, point in enumerate(found.points)
    )
    made = table((*heads, *(f"Ω {stage}" for stage in stages), *status), rows, words=status)
    for column in made.columns[: len(heads)]:
        # A long key is folded, and its figures stay whole.
        column.no_wrap, column.min_width = False, 9
    return made
