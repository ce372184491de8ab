"""Tables as plain data."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Cell:
    """One cell.

    Attributes
    ----------
    text : str
    value : float or None
        By which it is sorted; the text where there is none.
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
        With its unit.
    figures : bool
        Whether it holds figures, which are set to the right.
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
        Whether it is shown only when asked for.
    """

    title: str
    columns: list[Column]
    rows: list[list[Cell]]
    notes: list[str] = field(default_factory=list)
    folded: bool = False


def columns(words: Iterable[str], figures: Iterable[str]) -> list[Column]:
    """Columns of words, then columns of figures."""
    return [*(Column(t) for t in words), *(Column(t, figures=True) for t in figures)]


def chosen(records: Iterable[Mapping[str, Cell]], *fields: str) -> list[list[Cell]]:
    """Return rows of some fields of records."""
    return [[record[field] for field in fields] for record in records]
