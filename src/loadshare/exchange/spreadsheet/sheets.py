"""Sheets as rows of texts: the CSV files of a folder, or the sheets of a workbook."""

from __future__ import annotations

import csv
import zipfile
from dataclasses import dataclass
from io import BytesIO, StringIO
from pathlib import Path

from loadshare.errors import CaseError, Problem
from loadshare.input import Unreadable, read_file
from loadshare.settings import ALLOWED

WORKBOOK = ".xlsx"


@dataclass(frozen=True)
class Sheet:
    """A sheet.

    Attributes
    ----------
    name : str
    place : str
        File, and sheet of a workbook, for messages.
    rows : list of list of str
    """

    name: str
    place: str
    rows: list[list[str]]

    def at(self, row: int, column: int) -> str:
        """Where a cell is, in the words of a spreadsheet; row and column counted from 0."""
        letters, rest = "", column + 1
        while rest:
            rest, letter = divmod(rest - 1, 26)
            letters = chr(ord("A") + letter) + letters
        return f"{self.place}: row {row + 1}, column {letters}"


def sheets_of(path: Path) -> list[Sheet]:
    """Read the CSV files of a folder, or the sheets of a workbook.

    Raises
    ------
    CaseError
        If they cannot be read; all problems are listed.
    """
    if path.suffix.lower() == WORKBOOK:
        return _of_workbook(path)
    try:
        files = sorted(f for f in path.iterdir() if f.suffix.lower() == ".csv" and f.stem[0] != ".")
    except OSError as error:
        raise _unread(path, (error.strerror or "cannot be read").lower()) from None
    if not files:
        raise _unread(path, "holds no CSV file")
    sheets: list[Sheet] = []
    problems: list[Problem] = []
    for file in files[: ALLOWED.entries]:
        try:
            sheets.append(_of_csv(file))
        except CaseError as error:
            problems += error.problems
    if problems:
        raise CaseError(problems)
    return sheets


def _of_csv(file: Path) -> Sheet:
    try:
        text = read_file(file, ALLOWED.other_bytes).decode("utf-8-sig")
        rows = list(csv.reader(StringIO(text, newline=""), strict=True))
    except OSError as error:
        raise _unread(file, (error.strerror or "cannot be read").lower()) from None
    except Unreadable as error:
        raise _unread(file, str(error)) from None
    except UnicodeDecodeError as error:
        raise _unread(file, f"is not UTF-8 text at byte {error.start}") from None
    except csv.Error as error:
        raise _unread(file, f"is not CSV: {error}") from None
    first = next((cell for row in rows[:1] for cell in row), "")
    if rows and len(rows[0]) == 1 and (";" in first or "\t" in first):
        hint = "Save it with commas between cells, and points in numbers."
        raise _unread(file, "has no commas between its cells", hint)
    return Sheet(file.stem.strip().lower(), str(file), rows)


def _of_workbook(path: Path) -> list[Sheet]:
    try:
        from openpyxl import load_workbook
    except ImportError:
        hint = (
            "Install it with: pip install 'loadshare[spreadsheet]'. Or save every sheet as a CSV "
            "file in one folder, and import the folder."
        )
        raise _unread(path, "is a workbook, which needs openpyxl to be read", hint) from None
    try:
        book = load_workbook(_workbook_content(path), read_only=True, data_only=True)
        return [
            Sheet(
                sheet.title.strip().lower(),
                f"{path}: sheet {sheet.title}",
                [[_text(cell) for cell in row] for row in sheet.iter_rows(values_only=True)],
            )
            for sheet in book.worksheets
        ]
    except OSError as error:
        raise _unread(path, (error.strerror or "cannot be read").lower()) from None
    except Unreadable as error:
        raise _unread(path, str(error)) from None
    except Exception as error:  # noqa: BLE001 -- whatever openpyxl raises of what is damaged
        raise _unread(path, f"is a damaged workbook ({type(error).__name__})") from None


def _workbook_content(path: Path) -> BytesIO:
    """What a workbook holds, which must not unpack into very much more."""
    content = BytesIO(read_file(path, ALLOWED.other_bytes))
    with zipfile.ZipFile(content) as archive:
        if sum(part.file_size for part in archive.infolist()) > 4 * ALLOWED.other_bytes:
            raise Unreadable(f"unpacks into more than {4 * ALLOWED.other_bytes // 2**20} MiB")
    return content


def _text(cell: object) -> str:
    if cell is None:
        return ""
    if isinstance(cell, bool):
        return str(cell).lower()
    return f"{cell:.15g}" if isinstance(cell, float) else str(cell)


def _unread(path: Path, why: str, hint: str = "") -> CaseError:
    return CaseError([Problem(str(path), "", "", why, hint=hint)])
