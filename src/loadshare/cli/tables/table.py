"""The common layout of all tables."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from copy import copy
from dataclasses import replace
from typing import TYPE_CHECKING

from loadshare.cli.console import console, say, say_all

if TYPE_CHECKING:
    from rich.console import RenderableType
    from rich.table import Column
    from rich.table import Table as Rich

    from loadshare.table import Record, Table
    from loadshare.view import Viewed

GAP = 2
"""Width between columns."""
LONGEST = 20
"""Length above which a header, such as a key with its unit, may be folded over its figures."""
FOLDED = 12
"""Width to which words and headers may be folded."""


def table(
    columns: Iterable[str],
    rows: Iterable[Iterable[RenderableType]] = (),
    words: Iterable[str] = (),
) -> Rich:
    """Return a table.

    Parameters
    ----------
    columns : iterable of str
        Headers.
    rows : iterable of iterable of str
        Cells.
    words : iterable of str
        Headers of the columns that hold words: aligned left and folded if need be. All others hold
        figures, which are aligned right and not broken as long as they fit.
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
            whole = len(column) <= LONGEST
            made.add_column(column, justify="right", no_wrap=whole, overflow="fold")
    for row in rows:
        made.add_row(*row)
    return made


def show(title: str, made: Rich) -> None:
    """Print a table under its title; if it is too wide, in parts, so that no figure is cut."""
    for k, part in enumerate(_parts(made, console().width)):
        say()
        say(title if k == 0 else f"{title}, further columns", style="bold")
        say(part)


def show_table(found: Table, *, notes: bool = True) -> None:
    """Print a table, the number of rows that are left out, and its notes if wanted."""
    if not found.rows:
        say(f"\n{found.title}: none")
    else:
        words = [column.title for column in found.columns if not column.figures]
        heads = [column.title for column in found.columns]
        show(found.title, table(heads, found.texts[: found.most], words))
    say_all([*([found.left] if found.left else []), *(found.notes if notes else [])])


def show_view(found: Viewed) -> None:
    """Print all tables of what was found."""
    for one in found._view().tables:
        show_table(one)


def _parts(made: Rich, width: int) -> list[Rich]:
    """Return a table as tables of at most some width, each with the first column."""
    least = [_least(column) for column in made.columns]
    for column, need in zip(made.columns[1:], least[1:], strict=True):
        # A header that does not even fit next to the first column is folded.
        column.no_wrap &= least[0] + GAP + need <= width
    least = [_least(column) for column in made.columns]
    for column, need in zip(made.columns, least, strict=True):
        column.min_width = need
    parts: list[list[int]] = [[0]]
    for k in range(1, len(least)):
        if sum(least[i] + GAP for i in [*parts[-1], k]) - GAP > width and len(parts[-1]) > 1:
            parts.append([0])
        parts[-1].append(k)
    return [made] if len(parts) == 1 else [_of_columns(made, part) for part in parts]


def _least(column: Column) -> int:
    """Return the least width of a column: figures stay whole, words and headers fold."""
    from rich.cells import cell_len

    cells = max((cell_len(str(cell)) for cell in column.cells), default=0)
    header = cell_len(str(column.header))
    if column.justify != "right":
        return min(max(cells, header), FOLDED)
    return max(cells, header if column.no_wrap else min(header, FOLDED))


def _of_columns(made: Rich, some: list[int]) -> Rich:
    """Return a table of some columns of another."""
    part = copy(made)
    part.columns = [replace(made.columns[k], _index=at) for at, k in enumerate(some)]
    return part


def fits(made: Rich) -> bool:
    """Return whether a table fits the console without squeezing a column."""
    screen = console()
    endless = screen.options.update(max_width=10_000)
    return screen.measure(made, options=endless).maximum <= screen.width


def texts(records: Iterable[Record], fields: Collection[str], words: Iterable[str]) -> Rich:
    """Return a table of some fields of records, each under its name."""
    return table(fields, ([record[f].text for f in fields] for record in records), words)
