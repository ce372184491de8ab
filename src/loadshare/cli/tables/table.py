"""The one look of all tables."""

from __future__ import annotations

from collections.abc import Iterable

from rich import box
from rich.console import Console
from rich.table import Table


def table(columns: Iterable[str], words: Iterable[str] = ()) -> Table:
    """Return an empty table.

    Parameters
    ----------
    columns : iterable of str
        Headers.
    words : iterable of str
        Headers of the columns that hold words: set to the left and folded if need be. All others
        hold figures, which are set to the right and not broken as long as they fit.
    """
    made = Table(
        box=box.SIMPLE_HEAD, show_edge=False, header_style="", pad_edge=False, collapse_padding=True
    )
    words = set(words)
    for column in columns:
        if column in words:
            made.add_column(column, overflow="fold")
        else:
            made.add_column(column, justify="right", no_wrap=True, overflow="fold")
    return made


def show(console: Console, title: str, made: Table) -> None:
    """Print a table under its title."""
    console.print()
    console.print(title, style="bold")
    console.print(made)


def fits(console: Console, made: Table) -> bool:
    """Whether a table stands on the console without a column being squeezed."""
    endless = console.options.update(max_width=10_000)
    return console.measure(made, options=endless).maximum <= console.width
