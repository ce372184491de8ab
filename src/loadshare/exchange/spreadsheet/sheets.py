"""Sheets as rows of texts: the CSV files of a folder, or the sheets of a workbook."""

from __future__ import annotations

import csv
from io import StringIO
from pathlib import Path

from loadshare.errors import CaseError, Problem
from loadshare.exchange.imported import reading, refuse
from loadshare.exchange.spreadsheet.sheet import Sheet
from loadshare.exchange.spreadsheet.workbook import ENDING, sheets_of_workbook
from loadshare.input import read_file
from loadshare.settings import ALLOWED


def sheets_of(path: Path) -> list[Sheet]:
    """Read the CSV files of a folder, or the sheets of a workbook.

    Raises
    ------
    CaseError
        If they cannot be read; all problems are listed.
    """
    if path.suffix.lower() == ENDING:
        return sheets_of_workbook(path)
    with reading(path):
        files = sorted(f for f in path.iterdir() if f.suffix.lower() == ".csv" and f.stem[0] != ".")
    if not files:
        refuse(path, "contains no CSV file")
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
    # A cell may be as long as its file; other users of the module keep their limit.
    limit = csv.field_size_limit(ALLOWED.other_bytes)
    try:
        with reading(file):
            text = read_file(file, ALLOWED.other_bytes).decode("utf-8-sig")
        rows = list(csv.reader(StringIO(text, newline=""), strict=True))
    except UnicodeDecodeError as error:
        refuse(file, f"is not UTF-8 text at byte {error.start}")
    except csv.Error as error:
        refuse(file, f"is not CSV: {error}")
    finally:
        csv.field_size_limit(limit)
    first = next((cell for row in rows[:1] for cell in row), "")
    if rows and len(rows[0]) == 1 and (";" in first or "\t" in first):
        hint = "Save it with commas between cells, and points in numbers."
        refuse(file, "has no commas between its cells", hint)
    return Sheet(file.stem.strip().lower(), str(file), rows)
