"""Short displays of cases and results: a few lines in a console, a small table in a notebook.

Both are written from one `View`, so that they cannot differ; rows that are left out are counted.
"""

from __future__ import annotations

import html
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from loadshare.equality import Comparable

ROWS = 8
"""Rows of a table that are shown."""
WIDTH = 88
"""Most characters of a line."""

_CELL = 'style="text-align:left;padding:.1em .8em .1em 0"'


@dataclass(frozen=True, slots=True)
class View:
    """A title, facts, and the first rows of a table.

    Attributes
    ----------
    title : str
    facts : tuple of (str, str)
        Names and values; empty values are left out.
    columns : tuple of str
    rows : tuple of tuple of str
        As many cells as there are columns.
    """

    title: str
    facts: tuple[tuple[str, str], ...] = ()
    columns: tuple[str, ...] = ()
    rows: tuple[tuple[str, ...], ...] = ()

    @property
    def text(self) -> str:
        """Lines for a console."""
        lines = [self.title, *(f"{name}: {value}" for name, value in self.facts if value)]
        shown = [self.columns, *self.rows[:ROWS]] if self.rows else []
        widths = [max(map(len, column)) for column in zip(*shown, strict=True)]
        for row in shown:
            cells = (cell.ljust(width) for cell, width in zip(row, widths, strict=True))
            lines.append(("  " + "  ".join(cells)).rstrip())
        if self._left:
            lines.append(f"  {self._left}")
        return "\n".join(_cut(" ".join(line.split("\n"))) for line in lines)

    @property
    def html(self) -> str:
        """The same for a notebook; every text is escaped, and no script, style or link is used."""
        facts = "".join(
            f"<tr><th {_CELL}>{_escaped(name)}</th><td {_CELL}>{_escaped(value)}</td></tr>"
            for name, value in self.facts
            if value
        )
        parts = [f"<div><strong>{_escaped(self.title)}</strong>"]
        parts += [f"<table><tbody>{facts}</tbody></table>"] if facts else []
        if self.rows:
            head = "".join(f"<th {_CELL}>{_escaped(name)}</th>" for name in self.columns)
            body = "".join(
                f"<tr>{''.join(f'<td {_CELL}>{_escaped(cell)}</td>' for cell in row)}</tr>"
                for row in self.rows[:ROWS]
            )
            table = f"<thead><tr>{head}</tr></thead><tbody>{body}</tbody>"
            parts.append(f"<table>{table}</table>")
        parts += [f"<p>{_escaped(self._left)}</p>"] if self._left else []
        return "".join([*parts, "</div>"])

    @property
    def _left(self) -> str:
        return f"… and {len(self.rows) - ROWS} more" if len(self.rows) > ROWS else ""


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
    return "–" if value is None or value != value else format(value, form)


def by_name(figures: Any, form: str = ".4f") -> str:
    """Return named figures as text, as in ``I 1.0000, system 1.0013``."""
    return ", ".join(f"{name} {figure(value, form)}" for name, value in dict(figures).items())


def listed(values: Sequence[object]) -> str:
    """Return values as a list in text; of many, only the first ones and the last."""
    words = [str(value) for value in values]
    return ", ".join(words if len(words) <= ROWS else [*words[: ROWS - 1], "…", words[-1]])


def _cut(line: str) -> str:
    return line if len(line) <= WIDTH else f"{line[: WIDTH - 1]}…"


def _escaped(text: str) -> str:
    return html.escape(text, quote=True)
