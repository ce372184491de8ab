"""The sheets of a workbook: values as a spreadsheet program shows them, or a problem."""

from __future__ import annotations

import re
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import date, time, timedelta
from io import BytesIO
from pathlib import Path
from typing import IO, Any

from loadshare.errors import Problem
from loadshare.exchange.imported import reading, refuse
from loadshare.exchange.spreadsheet.sheet import FOUND, Sheet, cell_of
from loadshare.input import Unreadable, read_file
from loadshare.settings import ALLOWED

ENDING = ".xlsx"
NOT_CALCULATED = re.compile(rb"""\sfullCalcOnLoad\s*=\s*["'](?:1|true)["']""")
"""Request to calculate on opening, from programs that write formulas but no values."""
NOT_SAVED = (
    "is a formula whose value was not saved",
    "Open the workbook in a spreadsheet program and save it, or write the value.",
)
DATES = (date, time, timedelta)
DATE = (
    "is a date or a time, which programs make of a name such as 4-6",
    "Format the cell as text, or as a number, and enter the value again.",
)


def sheets_of_workbook(path: Path) -> list[Sheet]:
    """Read the sheets of a workbook.

    Raises
    ------
    CaseError
        If it cannot be read.
    """
    try:
        from openpyxl import load_workbook
    except ImportError:
        hint = (
            "Install it with: pip install 'loadshare[spreadsheet]'. Or save every sheet as a CSV "
            "file in one folder, and import the folder."
        )
        refuse(path, "is a workbook, which needs openpyxl to be read", hint)
    with reading(path):
        try:
            content, calculated, named = _content(path)
            book = load_workbook(content, read_only=True, data_only=True)
            _check_whole(book.sheetnames, named)
            return [_sheet(path, sheet, calculated) for sheet in book.worksheets]
        except (OSError, Unreadable):
            raise
        except Exception as error:  # noqa: BLE001 -- whatever openpyxl raises for a damaged file
            refuse(path, f"is a damaged workbook ({type(error).__name__})")


def _check_whole(found: list[str], named: list[str]) -> None:
    """Refuse a workbook that lacks sheets which it names: openpyxl silently skips them."""
    if lost := [name for name in named if name not in found]:
        raise Unreadable(f"is a damaged workbook: it lacks its sheet {lost[0]!r}")


def _content(path: Path) -> tuple[BytesIO, bool, list[str]]:
    """Return a workbook's bytes, whether its formulas have been calculated, and its sheet names.

    A workbook that unpacks into far more than its own size is refused.
    """
    content = BytesIO(read_file(path, ALLOWED.other_bytes))
    from openpyxl.xml.functions import fromstring

    with zipfile.ZipFile(content) as archive:
        parts = archive.infolist()
        if sum(part.file_size for part in parts) > 4 * ALLOWED.other_bytes:
            raise Unreadable(f"unpacks into more than {4 * ALLOWED.other_bytes // 2**20} MiB")
        heads = [archive.read(p) for p in parts if p.filename.endswith("workbook.xml")]
    sheets = (e for head in heads for e in fromstring(head).iter() if e.tag.endswith("}sheet"))
    return content, not any(map(NOT_CALCULATED.search, heads)), [e.get("name") for e in sheets]


def _sheet(path: Path, sheet: Any, calculated: bool) -> Sheet:
    name, place = sheet.title.strip().lower(), f"{path}: sheet {sheet.title}"
    if name.startswith(FOUND):
        return Sheet(name, place, [])
    # The size stated in a file may be out of date.
    sheet.reset_dimensions()
    rows: list[list[str]] = []
    dates: list[tuple[int, int]] = []
    cells = 0
    for number, row in enumerate(sheet.iter_rows(values_only=True)):
        cells += len(row)
        if cells > ALLOWED.cells:
            raise Unreadable(f"has more than {ALLOWED.cells} cells in sheet {sheet.title}")
        dates += [(number + 1, column) for column, c in enumerate(row, 1) if isinstance(c, DATES)]
        texts = [_text(cell) for cell in row]
        if any(texts):
            if number > ALLOWED.entries:
                raise Unreadable(f"has more than {ALLOWED.entries} rows in sheet {sheet.title}")
            rows += [[] for _ in range(number - len(rows))]
            rows.append(texts)
    with sheet._get_source() as source:
        notes = _Notes.read(source, calculated)
    problems = [
        *_told(place, notes.formulas, NOT_SAVED),
        *_told(place, dates, DATE),
        *_merged(place, rows, notes.merged),
    ]
    return Sheet(name, place, rows, tuple(problems))


@dataclass(frozen=True)
class _Notes:
    """What a sheet holds besides values; rows and columns counted from 1.

    Attributes
    ----------
    formulas : list of tuple (int, int)
        Row and column of every formula without a value that a spreadsheet program saved.
    merged : list of str
        Ranges of cells that are merged.
    """

    formulas: list[tuple[int, int]]
    merged: list[str]

    @classmethod
    def read(cls, source: IO[bytes], calculated: bool) -> _Notes:
        """Read them from the XML of a sheet: openpyxl shows either values or formulas."""
        from openpyxl.utils.cell import coordinate_to_tuple
        from openpyxl.xml.constants import SHEET_MAIN_NS
        from openpyxl.xml.functions import iterparse

        notes, row = cls([], []), 0
        namespace = f"{{{SHEET_MAIN_NS}}}"
        for _, element in iterparse(source):
            if element.tag == f"{namespace}mergeCell":
                notes.merged.append(element.get("ref", ""))
            elif element.tag == f"{namespace}row":
                row, column = int(float(element.get("r", row + 1))), 0
                for cell in element:
                    column += 1
                    if cell.get("r"):
                        column = coordinate_to_tuple(cell.get("r"))[1]
                    if cell.find(f"{namespace}f") is None:
                        continue
                    # The value of a formula may be an empty text.
                    saved = cell.findtext(f"{namespace}v") or cell.get("t") == "str"
                    if not (calculated and saved):
                        notes.formulas.append((row, column))
                element.clear()
        return notes


def _told(place: str, cells: list[tuple[int, int]], words: tuple[str, str]) -> Iterator[Problem]:
    """Yield a problem for each of some cells, in the same words."""
    for row, column in cells[: ALLOWED.problems]:
        yield Problem(cell_of(place, row - 1, column - 1), "", "", words[0], hint=words[1])


def _merged(place: str, rows: list[list[str]], ranges: list[str]) -> Iterator[Problem]:
    """Give every row of merged cells their value; yield a problem for those across columns.

    A head that is merged with cells below it stays one head.
    """
    from openpyxl.utils.cell import range_boundaries

    filled, most = 0, sum(len(row) + 1 for row in rows)
    for merged in ranges:
        left, top, right, bottom = range_boundaries(merged)
        row = rows[top - 1] if top <= len(rows) else []
        value = row[left - 1] if left <= len(row) else ""
        if left != right and value:
            hint = "Unmerge them, and write the value into every cell to which it applies."
            yield Problem(f"{place}: {merged}", "", "", "is merged across columns", hint=hint)
        elif left == right and top > 1:
            below = rows[top:bottom]
            filled += len(below)
            if filled > most:
                raise Unreadable("has merged cells that overlap")
            for cells in below:
                cells += [""] * (left - len(cells))
                cells[left - 1] = value


def _text(cell: object) -> str:
    if cell is None:
        return ""
    if isinstance(cell, bool):
        return str(cell).lower()
    return f"{cell:.15g}" if isinstance(cell, float) else str(cell)
