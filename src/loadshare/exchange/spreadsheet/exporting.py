"""Export of a case and its result as tables of a spreadsheet, in a workbook or a folder."""

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
"""Largest number of characters in a cell of a workbook."""


def export_tables(result: Result) -> dict[str, str]:
    """Return the tables of a case and of its result as CSV, by name.

    `import_tables` reads those of the case as the same case; the names of the others begin with
    ``result_``.

    Parameters
    ----------
    result : Result

    Raises
    ------
    CaseError
        If a name or text of the case does not fit in a cell, such as one with a semicolon in a
        list.
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
        As `export_frames` returns them.

    Raises
    ------
    CaseError
        If a text is too long for a cell, or has characters that no cell can hold.
    ImportError
        If openpyxl is not installed.
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
                    # Stays a text even if it looks like a formula, an error (nan) or a number
                    # (1_1).
                    cell.data_type = "s"
            sheet.append(cells)
    content = BytesIO()
    book.save(content)
    return content.getvalue()


def _rows(table: pd.DataFrame) -> Iterator[Sequence[Any]]:
    """Return the heads of a table, then its rows."""
    return chain([list(table.columns)], table.itertuples(index=False, name=None))


def _check_fit(sheet: str, row: Sequence[Any]) -> None:
    """Refuse a text that openpyxl would cut, or XML would change."""
    for text in row:
        if isinstance(text, str) and (len(text) > LONGEST or "\r" in text or CONTROL.search(text)):
            allowed = f"{LONGEST} characters, none of them a control character"
            why, hint = "no cell of a workbook can hold it", "A CSV table can hold any text."
            where = dotted((sheet, str(row[0])))
            raise CaseError([Problem("", where, as_given(text), why, allowed, hint)])


def _cell(value: Any) -> str | float | None:
    """Return the content of a workbook's cell; infinity becomes a text, a missing value None."""
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
            cells = [_column(path, [leaf], [above]) for path, leaf in leaves.items()]
            yield name, _texts(["key", "value"], [[head, text] for head, (text,) in cells])
            continue
        rows = {element: dict(values_in(keys)) for element, keys in value.items()}
        elements = [(name, element) for element in rows]
        columns = [list(rows)]
        heads = ["name"]
        for path in dict.fromkeys(path for keys in rows.values() for path in keys):
            head, texts = _column(path, [keys.get(path) for keys in rows.values()], elements)
            heads.append(head)
            columns.append(texts)
        yield name, _texts(heads, [list(row) for row in zip(*columns, strict=True)])


def _column(path: Path, values: list[Any], above: Sequence[Path]) -> tuple[str, list[str]]:
    """Return the head of a column and its cells; None makes an empty one.

    `above` has the element of every cell.

    Raises
    ------
    CaseError
        If they would be read back as something else.
    """
    given = [value for value in values if value is not None]
    unit, shown = with_common_unit(given)
    head = with_unit(dotted(path), unit)
    read, read_unit = head_of(head, above[0])
    options = taken(read)
    texts = iter([text_of(value, options) for value in shown])
    cells = ["" if value is None else next(texts) for value in values]
    for value, cell, element in zip(values, cells, above, strict=True):
        # An empty text counts as none.
        if value not in (None, "") and (
            (read, read_unit) != ((*above[0], *path), unit)
            or value_of(cell, unit, options) != value
            # A lone carriage return, which CSV takes for a line end.
            or "\r" in cell.replace("\r\n", "")
        ):
            what = "cannot be written to a cell as it is"
            spaces = isinstance(value, str) and value != value.strip()
            hint = "A cell loses leading and trailing spaces." if spaces else ""
            where = dotted((*element, *path))
            raise CaseError([Problem("", where, as_given(value), what, hint=hint)])
    return head, cells


def _texts(heads: list[str], rows: list[list[str]]) -> pd.DataFrame:

    return pd.DataFrame(rows, columns=heads, dtype=object)


NEEDED = "operating"
"""Sheet without which a folder is no case."""


def write_tables(folder: FilePath, tables: Mapping[str, pd.DataFrame]) -> None:
    """Write tables as the CSV files of a folder, and remove those of an earlier answer.

    Other files of the folder stay. An interruption leaves the old tables, the new ones, or a folder
    that is refused as a case.

    Parameters
    ----------
    folder : Path
    tables : mapping of str to pandas.DataFrame
        As `export_frames` returns them.

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
