"""A case from the tables of a spreadsheet: a sheet for each section, a row for each element."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path as FilePath
from typing import Any

from loadshare.case.content import Content
from loadshare.case.keys import Path, dotted
from loadshare.case.words import as_given, choices, did_you_mean
from loadshare.errors import CaseError, Problem
from loadshare.exchange.imported import Data, Imported, commented
from loadshare.exchange.spreadsheet.cells import head_of, taken, value_of
from loadshare.exchange.spreadsheet.sheet import FOUND, Sheet
from loadshare.exchange.spreadsheet.sheets import sheets_of
from loadshare.exchange.spreadsheet.workbook import ENDING
from loadshare.output import FORMULA
from loadshare.settings import ALLOWED

ABOUT = "case"
"""Sheet of the keys outside all tables, such as the title."""
ALONE = ("operating", "march")
"""Sections that are one element."""
FILES = ("law_file", "geometry")
"""Keys that name files, relative to the case file."""


def sheet_names() -> list[str]:
    """Return the names of all sheets of a case."""
    return [ABOUT, *(n for n in Content.model_fields if taken((n, "x")) or n in ALONE)]


def is_spreadsheet(path: FilePath) -> bool:
    """Tell whether a file or folder is for `import_tables`."""
    return path.is_dir() or path.suffix.lower() == ENDING


def import_tables(path: str | FilePath) -> Imported:
    """Import a case from a folder of CSV files, or a workbook.

    Every sheet is a section of the case file. Sheets of named elements have ``name`` and keys in
    their head. The operating point, the march and the keys outside all tables (sheet ``case``) have
    the columns ``key`` and ``value``.

    Parameters
    ----------
    path : str or pathlib.Path

    Returns
    -------
    Imported

    Raises
    ------
    CaseError
        If a sheet cannot be read; problems name sheet, row and column.
    """
    path = FilePath(path)
    reader = _Reader()
    for sheet in sheets_of(path):
        reader.read(sheet)
    if reader.problems:
        raise CaseError(reader.problems)
    sections = [name for name in Content.model_fields if name in reader.data]
    data: Data = {name: reader.data[name] for name in sections}
    counts = tuple(
        f"{name} ({len(data[name])})"
        for name in sections
        if isinstance(data[name], Mapping) and name not in ALONE
    )
    left = tuple(dict.fromkeys(reader.left_out))
    return Imported(data, commented(data, (), left), counts, (), left, reader.places)


@dataclass
class _Reader:
    """Conversion of sheets to a case."""

    data: Data = field(default_factory=dict)
    places: dict[Path, str] = field(default_factory=dict)
    left_out: list[str] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)

    def read(self, sheet: Sheet) -> None:
        """Read one sheet."""
        if sheet.name.startswith(FOUND):
            self.left_out.append("tables of a result, which follows from the case")
            return
        known = sheet_names()
        if sheet.name not in known and not sheet.problems and not sheet.holds_anything:
            self.left_out.append("empty sheets")
        elif sheet.name not in known:
            hint = did_you_mean(sheet.name, known)
            self._tell(sheet.place, f"{sheet.name} is not a table of a case", choices(known), hint)
        elif len(sheet.rows) > ALLOWED.entries:
            self._tell(sheet.place, f"has {len(sheet.rows)} rows", f"at most {ALLOWED.entries}")
        elif sheet.problems:
            self.problems += sheet.problems
        elif sheet.name == ABOUT or sheet.name in ALONE:
            self._keys_and_values(sheet)
        else:
            self._elements(sheet)

    def _tell(self, place: str, message: str, allowed: str = "", hint: str = "") -> None:
        self.problems.append(Problem(place, "", "", message, allowed, hint))

    def _keys_and_values(self, sheet: Sheet) -> None:
        """Read a sheet of keys and values."""
        above: Path = () if sheet.name == ABOUT else (sheet.name,)
        if above:
            self.data.setdefault(sheet.name, {})
        if not sheet.rows or [cell.strip().lower() for cell in sheet.rows[0][:2]] != [
            "key",
            "value",
        ]:
            self._tell(sheet.at(0, 0), "has no heading", "key, value")
            return
        for number, row in enumerate(sheet.rows[1:], start=1):
            key, value, *more = [*(cell.strip() for cell in row), "", ""]
            for column, cell in enumerate(more, start=2):
                if cell:
                    self._tell(sheet.at(number, column), "is outside the columns key and value")
            if key:
                path = self._path(sheet, number, 0, key, above)
                if path is not None and value:
                    self._put(sheet.at(number, 1), *path, value)
            elif value:
                self._tell(sheet.at(number, 0), "has a value but no key", "a key")

    def _elements(self, sheet: Sheet) -> None:
        """Read a sheet with a row for every element."""
        head = [cell.strip() for cell in sheet.rows[0]] if sheet.rows else []
        named = next((k for k, text in enumerate(head) if text.lower() == "name"), None)
        if named is None:
            self._tell(sheet.at(0, 0), "has no heading", "name, then keys of the case file")
            return
        section = self.data.setdefault(sheet.name, {})
        for column, text in enumerate(head):
            if text and text in head[:column]:
                self._tell(sheet.at(0, column), f"{text} appears twice")
        columns = [
            self._path(sheet, 0, column, text, (sheet.name, "x"))
            if text and column != named
            else None
            for column, text in enumerate(head)
        ]
        for number, row in enumerate(sheet.rows[1:], start=1):
            cells = [cell.strip() for cell in row]
            if not any(cells):
                continue
            name = cells[named] if named < len(cells) else ""
            name = name[1:] if name.startswith("'") and FORMULA.match(name[1:]) else name
            if not name or name in section:
                self._tell(
                    sheet.at(number, named),
                    f"the name {as_given(name)} appears twice" if name else "has no name",
                )
                continue
            section[name] = {}
            self.places[sheet.name, name] = sheet.at(number, named)
            for column, cell in enumerate(cells):
                if column == named:
                    continue
                if column >= len(head) or not head[column]:
                    if cell:
                        self._tell(sheet.at(number, column), f"{as_given(cell)} has no heading")
                elif cell and (found := columns[column]) is not None:
                    path, unit = found
                    self._put(sheet.at(number, column), (sheet.name, name, *path[2:]), unit, cell)

    def _path(
        self, sheet: Sheet, row: int, column: int, text: str, above: Path
    ) -> tuple[Path, str] | None:
        try:
            return head_of(text, above)
        except ValueError:
            allowed = "a key such as face_width, or centre.distance [mm] with its unit"
            self._tell(sheet.at(row, column), f"{as_given(text)} is not a key", allowed)
            return None

    def _put(self, place: str, path: Path, unit: str, text: str) -> None:
        """Store a value under its key."""
        value: Any = value_of(text, unit, taken(path))
        here = self.data
        for number, step in enumerate(path[:-1], start=1):
            here = here.setdefault(str(step), {})
            if not isinstance(here, dict):
                self._tell(place, f"{dotted(path)} cannot be combined with {dotted(path[:number])}")
                return
        if str(path[-1]) in here:
            self._tell(place, f"{dotted(path)} appears twice")
            return
        here[str(path[-1])] = value
        if path[-1] not in FILES:
            self.places[path] = place
