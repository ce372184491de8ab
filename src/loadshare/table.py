"""Tables as they are shown: on a screen, in a notebook, on a page, in the explorer."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field

FOLDED = 24
"""Number of rows above which a table is shown only when asked for."""


@dataclass(frozen=True, slots=True)
class Cell:
    """One cell.

    Attributes
    ----------
    text : str
    value : float or None
        Value by which it is sorted; the text if there is none.
    assumed : bool
        Whether it shows an input that is an assumption.
    link : str
        Place on the page that it leads to, such as "#case-2".
    """

    text: str
    value: float | None = None
    assumed: bool = False
    link: str = ""


@dataclass(frozen=True, slots=True)
class Column:
    """One column.

    Attributes
    ----------
    title : str
        Title, with its unit.
    figures : bool
        Whether it holds figures, which are aligned to the right.
    """

    title: str
    figures: bool = False


@dataclass(frozen=True)
class Table:
    """A table that can be sorted.

    Attributes
    ----------
    title : str
    columns : list of Column
    rows : list of list of Cell
    notes : list of str
        Sentences below it.
    folded : bool
        Whether a page shows it only when asked for.
    most : int or None
        Number of rows that a screen shows; None for all.
    rest : str
        What the other rows are, with ``{}`` for their number: "Not shown: {} inputs."
    """

    title: str
    columns: list[Column]
    rows: list[list[Cell]]
    notes: list[str] = field(default_factory=list)
    folded: bool = False
    most: int | None = None
    rest: str = "and {} more"

    @property
    def texts(self) -> list[list[str]]:
        """The texts of all cells, row by row."""
        return [[cell.text for cell in row] for row in self.rows]

    @property
    def left(self) -> str:
        """A line that counts the rows that a screen does not show; empty if it shows all."""
        left = len(self.rows) - (len(self.rows) if self.most is None else self.most)
        return self.rest.format(left) if left > 0 else ""


Record = dict[str, Cell]


def table(
    title: str,
    rows: Iterable[Record],
    fields: Iterable[str],
    words: Collection[str],
    heads: Mapping[str, str] | None = None,
    notes: Iterable[str] = (),
    most: float = math.inf,
) -> Table:
    """Return a table of some fields of records.

    Parameters
    ----------
    title : str
    rows : iterable of Record
    fields : iterable of str
    words : collection of str
        Fields that hold words; all others hold figures.
    heads : mapping of field to str, optional
        Titles of columns that are not called like their field.
    notes : iterable of str
    most : float
        Number of rows up to which a page shows the table without being asked for it.
    """
    fields = list(fields)
    columns = [Column((heads or {}).get(name, name), name not in words) for name in fields]
    cells = [[row[name] for name in fields] for row in rows]
    return Table(title, columns, cells, list(notes), folded=len(cells) > most)


def text_table(
    title: str,
    columns: Iterable[str],
    rows: Iterable[Iterable[str | Cell]],
    words: Collection[str] = (),
    notes: Iterable[str] = (),
) -> Table:
    """Return a table of texts; a page folds it if it is long.

    Parameters
    ----------
    title : str
    columns : iterable of str
        Titles.
    rows : iterable of iterable of (str or Cell)
    words : collection of str
        Titles of the columns that hold words; all others hold figures.
    notes : iterable of str
    """
    heads = [Column(name, name not in words) for name in columns]
    cells = [[one if isinstance(one, Cell) else Cell(one) for one in row] for row in rows]
    return Table(title, heads, cells, list(notes), folded=len(cells) > FOLDED)
