"""What the commands of studies share: their options, and how they end."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from loadshare.cli.changes import open_case
from loadshare.cli.console import Tick, progress
from loadshare.cli.exits import REFUSED, UNUSABLE, fail, problems_told, writing
from loadshare.cli.files import tell_written
from loadshare.cli.options import changes, ending, output
from loadshare.cli.refusal import told
from loadshare.errors import LoadshareError, Refused
from loadshare.output import csv_of, netcdf_of, write_whole

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from loadshare.case import Case

Positions = Annotated[
    list[int] | None,
    typer.Option("--position", metavar="K", help="Only this position, from 1; may be repeated."),
]
Changes = Annotated[
    list[str] | None, changes("--with", "Change the case beforehand; may be repeated.")
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
    file: Path,
    change: list[str] | None,
    what: str,
    total: int | None = 1,
    *,
    rated: bool = False,
) -> Iterator[tuple[Case, Tick | None]]:
    """Open the case of a study and a progress bar; what cannot be answered becomes a message.

    Parameters
    ----------
    file : Path
    change : list of str or None
        Of ``--with``.
    what, total, rated
        Of the bar, as far as known beforehand.
    """
    with answered():
        case = open_case(file, change)
        with progress(what, total, rated=rated) as tick:
            yield case, tick


@contextmanager
def answered() -> Iterator[None]:
    """Turn an unusable case, wrong positions and a refused answer into messages and exit codes."""
    try:
        with problems_told():
            yield
    except Refused as refusal:
        fail([f"REFUSED  {line}" for line in told(refusal)], REFUSED)
    except LoadshareError as error:
        fail([str(error)], UNUSABLE)
    except ValueError as error:
        if not str(error).startswith("position"):
            raise
        fail([str(error)], UNUSABLE)


def end(lines: list[str]) -> None:
    """Leave with the code of a refusal where a study tells that it lacks an answer."""
    if lines:
        fail(lines, REFUSED)


def write_table(
    file: Path | None,
    frame: Callable[[], pd.DataFrame],
    dataset: Callable[[], xr.Dataset] | None = None,
) -> None:
    """Write what was found, if asked for, as a table or labelled arrays by the file's ending."""
    if file is None:
        return

    content: str | bytes
    if file.suffix == ".nc" and dataset is not None:
        content = netcdf_of(dataset())
    else:
        content = csv_of(frame())
    with writing(file):
        write_whole(file, content)
    tell_written(file, err=True)
