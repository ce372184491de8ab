"""What the commands of studies share: their options, and how they end."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from loadshare.cli.changes import read_changes
from loadshare.cli.exits import REFUSED, UNUSABLE, fail, problems_told, writing
from loadshare.cli.options import output
from loadshare.cli.refusal import told
from loadshare.errors import Refused

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from loadshare.case import Case

CaseFile = Annotated[Path, typer.Argument(metavar="CASE", help="Case file.")]
Positions = Annotated[
    list[int] | None,
    typer.Option("--position", metavar="K", help="Only this position, from 1; may be repeated."),
]
Changes = Annotated[
    list[str] | None,
    typer.Option(
        "--with", metavar="KEY=VALUE", help="Change the case beforehand; may be repeated."
    ),
]
TableFile = Annotated[
    Path | None, output("-o", "--output", what="Write it to a .csv or a .nc (netCDF) file.")
]
CsvFile = Annotated[Path | None, output("-o", "--output", what="Write it to a .csv file.")]


@contextmanager
def answered() -> Iterator[None]:
    """Turn an unusable case, wrong positions and a refused answer into messages and exit codes."""
    try:
        with problems_told():
            yield
    except Refused as refusal:
        fail([f"REFUSED  {line}" for line in told(refusal)], REFUSED)
    except ValueError as error:
        if not str(error).startswith("position"):
            raise
        fail([str(error)], UNUSABLE)


def end(lines: list[str]) -> None:
    """Leave with the code of a refusal where a study tells that it lacks an answer."""
    if lines:
        fail(lines, REFUSED)


def open_case(file: Path, changes: list[str] | None) -> Case:
    """Return the case of a file, with what ``--with`` changes.

    Raises
    ------
    CaseError
        With all problems of the case.
    """
    from loadshare.case import load_case

    case = load_case(file)
    asked = read_changes(changes or ())
    return case.replace(asked) if asked else case


def check_ending(file: Path | None, *endings: str) -> None:
    """Refuse a file of another kind before anything is solved.

    Raises
    ------
    typer.BadParameter
        If its ending is none of those given.
    """
    if file is not None and file.suffix not in endings:
        known = " or ".join(endings)
        raise typer.BadParameter(f"{file}: must end in {known}", param_hint="--output")


def write_table(
    file: Path | None, frame: pd.DataFrame | None, dataset: xr.Dataset | None = None
) -> None:
    """Write what was found as a table or as labelled arrays, by the ending of the file."""
    if file is None:
        return
    from loadshare.results.files import write_atomically

    def write(path: Path) -> None:
        if file.suffix == ".nc" and dataset is not None:
            dataset.to_netcdf(path, engine="h5netcdf")
        elif frame is not None:
            frame.to_csv(path, index=False)

    with writing(file):
        write_atomically(file, write)
    typer.echo(f"Wrote {file}", err=True)
