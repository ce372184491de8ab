"""What cases, results and studies show of themselves: a title, facts, tables.

A console, a notebook, the command and a page are all written from one `View`, so that they cannot
differ; rows that are left out are counted.
"""

from __future__ import annotations

import html
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from loadshare.equality import Comparable
from loadshare.numbers import NONE
from loadshare.table import Table

ROWS = 8
"""Rows of a table that are shown."""
WIDTH = 88
"""Most characters of a line."""

_LEFT, _RIGHT = (
    f'style="text-align:{side};padding:.1em .8em .1em 0"' for side in ("left", "right")
)


@dataclass(frozen=True, slots=True)
class View:
    """A title, facts and tables.

    A console and a notebook show the first rows of the first table; the command and a page show all
    tables.

    Attributes
    ----------
    title : str
    facts : tuple of (str, str)
        Names and values; empty values are left out.
    tables : tuple of Table
        The command says of those without rows that there is none.
    """

    title: str
    facts: tuple[tuple[str, str], ...] = ()
    tables: tuple[Table, ...] = ()

    @property
    def text(self) -> str:
        """Lines for a console."""
        lines = [self.title, *(f"{name}: {value}" for name, value in self.facts if value)]
        if table := self._first:
            heads = [column.title for column in table.columns]
            shown = [heads, *table.texts[:ROWS]]
            columns = [
                _justified(texts, column.figures)
                for texts, column in zip(zip(*shown, strict=True), table.columns, strict=True)
            ]
            lines += [table.title] if table.title != self.title else []
            lines += [f"  {'  '.join(row)}".rstrip() for row in zip(*columns, strict=True)]
            lines += [f"  {left}"] if (left := _left(table)) else []
        return "\n".join(_cut(" ".join(line.split("\n"))) for line in lines)

    @property
    def html(self) -> str:
        """The same for a notebook; every text is escaped, and no script, style or link is used."""
        facts = "".join(
            f"<tr><th {_LEFT}>{_escaped(name)}</th><td {_LEFT}>{_escaped(value)}</td></tr>"
            for name, value in self.facts
            if value
        )
        parts = [f"<div><strong>{_escaped(self.title)}</strong>"]
        parts += [f"<table><tbody>{facts}</tbody></table>"] if facts else []
        if table := self._first:
            sides = [_RIGHT if column.figures else _LEFT for column in table.columns]
            head = _html_row("th", sides, (column.title for column in table.columns))
            body = "".join(_html_row("td", sides, row) for row in table.texts[:ROWS])
            parts += [f"<p>{_escaped(table.title)}</p>"] if table.title != self.title else []
            parts.append(f"<table><thead>{head}</thead><tbody>{body}</tbody></table>")
            parts += [f"<p>{left}</p>"] if (left := _left(table)) else []
        return "".join([*parts, "</div>"])

    @property
    def _first(self) -> Table | None:
        """The first table that has rows."""
        return next((table for table in self.tables if table.rows), None)


class Viewed(Comparable):
    """An object that is shown by its view, in a console and in a notebook."""

    __slots__ = ()

    def _view(self) -> View:
        raise NotImplementedError

    def _left_open(self) -> list[str]:
        """Return lines that name what a study could not answer; none if it answered everything."""
        return []

    def __repr__(self) -> str:
        return self._view().text

    def _repr_html_(self) -> str:
        return self._view().html


def figure(value: float | None, form: str = ".4g") -> str:
    """Return a number as text; a dash for None or NaN."""
    return NONE if value is None or value != value else format(value, form)


def by_name(figures: Any, form: str = ".4f") -> str:
    """Return named figures as text, as in ``I 1.0000, system 1.0013``."""
    return ", ".join(f"{name} {figure(value, form)}" for name, value in dict(figures).items())


def listed(values: Sequence[object]) -> str:
    """Return values as a list in text; of many, only the first ones and the last."""
    words = [str(value) for value in values]
    return ", ".join(words if len(words) <= ROWS else [*words[: ROWS - 1], "…", words[-1]])


def _left(table: Table) -> str:
    """Return a line that counts the rows that are left out; empty if all are shown."""
    left = len(table.rows) - ROWS
    return f"… and {left} more" if left > 0 else ""


def _justified(texts: Sequence[str], right: bool) -> list[str]:
    width = max(map(len, texts))
    return [text.rjust(width) if right else text.ljust(width) for text in texts]


def _html_row(tag: str, sides: Iterable[str], texts: Iterable[str]) -> str:
    cells = zip(sides, texts, strict=True)
    inner = "".join(f"<{tag} {side}>{_escaped(text)}</{tag}>" for side, text in cells)
    return f"<tr>{inner}</tr>"


def _cut(line: str) -> str:
    return line if len(line) <= WIDTH else f"{line[: WIDTH - 1]}…"


def _escaped(text: str) -> str:
    return html.escape(text, quote=True)
