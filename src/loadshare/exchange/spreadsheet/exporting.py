"""A case and what was found of it, as tables of a spreadsheet: in a workbook, or in a folder."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from io import BytesIO
from itertools import chain
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any

from loadshare.case.content import Content
from loadshare.case.keys import Path, dotted, values_in, with_unit
from loadshare.case.words import as_given
from loadshare.errors import CaseError, Problem
from loadshare.exchange.spreadsheet.cells import (
    head_of,
    taken,
    text_of,
    value_of,
    with_common_unit,
)
from loadshare.exchange.spreadsheet.importing import ABOUT, ALONE, sheet_names
from loadshare.exchange.spreadsheet.sheet import FOUND
from loadshare.libraries import pd
from loadshare.output import clear, csv_of, without_formulas, write_together
from loadshare.readable import CONTROL

if TYPE_CHECKING:
    from loadshare.results import Result

LONGEST = 32767
"""Characters of a text in a cell of a workbook."""


def export_tables(result: Result) -> dict[str, str]:
    """Return the tables of a case and of its result as CSV, by name.

    Those of the case are read by `import_tables` as the same case; the names of the others begin
    with ``result_``.

    Parameters
    ----------
    result : Result

    Raises
    ------
    CaseError
        If a name or text of the case cannot be put in a cell, as one with a semicolon in a list.
    """
    return {name: csv_of(frame) for name, frame in export_frames(result).items()}


def export_frames(result: Result) -> dict[str, pd.DataFrame]:
    """Return the tables of `export_tables` as data frames."""
    from loadshare.results.dataset import frames

    found = {FOUND + name: frame for name, frame in frames(result).items()}
    return {**dict(case_frames(result.case.to_dict())), **found}


def workbook_of(tables: Mapping[str, pd.DataFrame]) -> bytes:
    """Return tables as a workbook with a sheet for each, in which numbers are numbers.

    Parameters
    ----------
    tables : mapping of str to pandas.DataFrame
        As `export_frames` has them.

    Raises
    ------
    CaseError
        If a text is longer than a cell holds, or has characters that none holds.
    ImportError
        Without openpyxl.
    """
    from openpyxl import Workbook
    from openpyxl.cell import WriteOnlyCell

    safe = {name: without_formulas(frame) for name, frame in tables.items()}
    for name, row in ((name, row) for name, table in safe.items() for row in _rows(table)):
        _check_fit(name, row)
    book = Workbook(write_only=True)
    for name, table in safe.items():
        sheet = book.create_sheet(name)
        for row in _rows(table):
            cells = [WriteOnlyCell(sheet, _cell(value)) for value in row]
            for cell in cells:
                if isinstance(cell.value, str):
                    # A text that begins like a formula is none, "nan" no error, 1_1 no number.
                    cell.data_type = "s"
            sheet.append(cells)
    content = BytesIO()
    book.save(content)
    return content.getvalue()


def _rows(table: pd.DataFrame) -> Iterator[Sequence[Any]]:
    """The heads of a table, then its rows."""
    return chain([list(table.columns)], table.itertuples(index=False, name=None))


def _check_fit(sheet: str, row: Sequence[Any]) -> None:
    """Refuse a text that openpyxl would cut, or XML would change."""
    for text in row:
        if isinstance(text, str) and (len(text) > LONGEST or "\r" in text or CONTROL.search(text)):
            allowed = f"{LONGEST} characters, none of them a control character"
            why, hint = "no cell of a workbook can hold it", "A table as CSV holds any text."
            where = dotted((sheet, str(row[0])))
            raise CaseError([Problem("", where, as_given(text), why, allowed, hint)])


def _cell(value: Any) -> str | float | None:
    """Return what a cell of a workbook holds, which knows no infinity and nothing missing."""
    value = value.item() if hasattr(value, "item") else value
    if value is pd.NA or value is None or value != value:
        return None
    is_number = isinstance(value, int | float) and math.isfinite(value)
    return value if is_number else str(value)


def case_frames(data: Mapping[str, Any]) -> Iterator[tuple[str, pd.DataFrame]]:
    """Yield the tables of a case as data frames of texts, with their names.

    Parameters
    ----------
    data : mapping
        A case as plain data.

    Raises
    ------
    CaseError
        As `export_tables`.
    """
    about = {key: value for key, value in data.items() if not isinstance(value, Mapping)}
    for name in (ABOUT, *Content.model_fields):
        value = about if name == ABOUT else data.get(name)
        if not isinstance(value, Mapping) or not value:
            continue
        above: Path = () if name == ABOUT else (name,)
        if name == ABOUT or name in ALONE:
            leaves = dict(values_in(value))
            cells = [_column(path, [leaf], above) for path, leaf in leaves.items()]
            yield name, _texts(["key", "value"], [[head, text] for head, (text,) in cells])
            continue
        rows = {element: dict(values_in(keys)) for element, keys in value.items()}
        columns = [list(rows)]
        heads = ["name"]
        for path in dict.fromkeys(path for keys in rows.values() for path in keys):
            head, texts = _column(path, [keys.get(path) for keys in rows.values()], (name, "x"))
            heads.append(head)
            columns.append(texts)
        yield name, _texts(heads, [list(row) for row in zip(*columns, strict=True)])


def _column(path: Path, values: list[Any], above: Path) -> tuple[str, list[str]]:
    """Return the head of a column and its cells; None makes an empty one.

    Raises
    ------
    CaseError
        If they would not be read as they are.
    """
    given = [value for value in values if value is not None]
    unit, shown = with_common_unit(given)
    head = with_unit(dotted(path), unit)
    texts = iter([text_of(value) for value in shown])
    cells = ["" if value is None else next(texts) for value in values]
    read, read_unit = head_of(head, above)
    options = taken(read)
    for value, cell in zip(values, cells, strict=True):
        # An empty text is as good as none.
        if value not in (None, "") and (
            (read, read_unit) != ((*above, *path), unit)
            or value_of(cell, unit, options) != value
            # Half a line end, which CSV takes for a whole one.
            or "\r" in cell.replace("\r\n", "")
        ):
            what = "cannot stand in a cell as it is"
            where = dotted((above[0], "…", *path) if len(above) > 1 else (*above, *path))
            spaces = isinstance(value, str) and value != value.strip()
            hint = "A cell loses the spaces at its ends." if spaces else ""
            raise CaseError([Problem("", where, text_of(value), what, hint=hint)])
    return head, cells


def _texts(heads: list[str], rows: list[list[str]]) -> pd.DataFrame:

    return pd.DataFrame(rows, columns=heads, dtype=object)


NEEDED = "operating"
"""Sheet without which no folder is a case."""


def write_tables(folder: FilePath, tables: Mapping[str, pd.DataFrame]) -> None:
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
