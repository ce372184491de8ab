"""A sheet as rows of texts, from a CSV file or a workbook."""

from __future__ import annotations

from dataclasses import dataclass

from loadshare.errors import Problem

FOUND = "result_"
"""Beginning of the names of sheets that hold a result."""


@dataclass(frozen=True)
class Sheet:
    """A sheet.

    Attributes
    ----------
    name : str
    place : str
        File, and sheet of a workbook, for messages.
    rows : list of list of str
    problems : tuple of Problem
        Why it cannot be read as a table of a case.
    """

    name: str
    place: str
    rows: list[list[str]]
    problems: tuple[Problem, ...] = ()

    @property
    def holds_anything(self) -> bool:
        """Whether any cell is filled; programs add empty sheets to new workbooks."""
        return any(cell.strip() for row in self.rows for cell in row)

    def at(self, row: int, column: int) -> str:
        """Return where a cell is, as a spreadsheet counts; `row` and `column` count from 0."""
        return cell_of(self.place, row, column)


def cell_of(place: str, row: int, column: int) -> str:
    """Return where a cell is, as a spreadsheet counts; `row` and `column` count from 0."""
    letters, rest = "", column + 1
    while rest:
        rest, letter = divmod(rest - 1, 26)
        letters = chr(ord("A") + letter) + letters
    return f"{place}: row {row + 1}, column {letters}"
