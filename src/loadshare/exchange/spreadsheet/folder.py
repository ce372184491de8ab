"""A folder of tables, which is one case with its result: what an earlier answer left goes."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from loadshare.exchange.spreadsheet.importing import sheet_names
from loadshare.exchange.spreadsheet.sheet import FOUND
from loadshare.output import clear, csv_of, write_together

if TYPE_CHECKING:
    import pandas as pd

NEEDED = "operating"
"""Sheet without which no folder is a case."""


def write_tables(folder: Path, tables: Mapping[str, pd.DataFrame]) -> None:
    """Write tables as the CSV files of a folder, and remove those of an earlier answer.

    Other files of the folder stay. An interruption leaves the tables that were there, or the new
    ones, or a folder that is refused as a case.

    Parameters
    ----------
    folder : Path
    tables : mapping of str to pandas.DataFrame
        As `export_frames` has them.

    Raises
    ------
    NotWritten
        If a table cannot be written.
    """
    from loadshare.results.dataset import TABLES

    texts = {folder / f"{name}.csv": csv_of(frame) for name, frame in tables.items()}
    own = (*sheet_names(), *(FOUND + name for name in TABLES.values()))
    files = [folder / f"{name}.csv" for name in own]
    clear(files)
    write_together(texts, [file for file in files if file not in texts], folder / f"{NEEDED}.csv")
