"""The one look of all tables."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import TYPE_CHECKING

from loadshare.cli.console import console, say

if TYPE_CHECKING:
    from rich.console import RenderableType
    from rich.table import Table

    from loadshare.report.records import Record


def table(
    columns: Iterable[str],
    rows: Iterable[Iterable[RenderableType]] = (),
    words: Iterable[str] = (),
) -> Table:
    """Return a table.

    Parameters
    ----------
    columns : iterable of str
        Headers.
    rows : iterable of iterable of str
        Cells.
    words : iterable of str
        Headers of the columns that hold words: set to the left and folded if need be. All others
        hold figures, which are set to the right and not broken as long as they fit.
    """
    from rich import box
    from rich.table import Table

    made = Table(
        box=box.SIMPLE_HEAD, show_edge=False, header_style="", pad_edge=False, collapse_padding=True
    )
    words = set(words)
    for column in columns:
        if column in words:
            made.add_column(column, overflow="fold")
        else:
            made.add_column(column, justify="right", no_wrap=True, overflow="fold")
    for row in rows:
        made.add_row(*row)
    return made


def show(title: str, made: Table) -> None:
    """Print a table under its title."""
    say()
    say(title, style="bold")
    say(made)


def fits(made: Table) -> bool:
    """Whether a table fits the console without squeezing a column."""
    screen = console()
    endless = screen.options.update(max_width=10_000)
    return screen.measure(made, options=endless).maximum <= screen.width


def texts(records: Iterable[Record], fields: Collection[str], words: Iterable[str]) -> Table:
    """Return a table of some fields of records, each under its name."""
    return table(fields, ([record[f].text for f in fields] for record in records), words)
