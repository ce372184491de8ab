"""What the commands of studies share: their options, and how they end."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from loadshare.cli.changes import read_changes
from loadshare.cli.console import Tick, progress
from loadshare.cli.exits import REFUSED, UNUSABLE, fail, problems_told, writing
from loadshare.cli.options import ending, output
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


def _file(what: str, *endings: str) -> object:
    return output("-o", "--output", what=what, callback=ending(*endings))


TableFile = Annotated[
    Path | None, _file("Write it to a .csv or a .nc (netCDF) file.", ".csv", ".nc")
]
CsvFile = Annotated[Path | None, _file("Write it to a .csv file.", ".csv")]
FittedFile = Annotated[Path | None, _file("Write the fitted case to a .toml file.", ".toml")]


@contextmanager
def asked(
    file: Path, changes: list[str] | None, what: str, total: int = 1
) -> Iterator[tuple[Case, Tick | None]]:
    """Open the case of a study and a progress bar; what cannot be answered becomes a message.

    Parameters
    ----------
    file : Path
    changes : list of str or None
        Of ``--with``.
    what : str
        What the bar counts.
    total : int
        How many there are, as far as known beforehand.
    """
    with answered():
        case = open_case(file, changes)
        with progress(what, total) as tick:
            yield case, tick


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
