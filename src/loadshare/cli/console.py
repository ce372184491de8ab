"""Where text goes: stdout for answers, stderr for progress."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from rich.console import Console


class Tick(Protocol):
    """Called with how much is done, and of how much."""

    def __call__(self, done: int, total: int) -> None:
        """Tell that `done` of `total` are finished."""


def console(*, stderr: bool = False) -> Console:
    """Return a console that prints titles and units as they are: brackets are no markup here."""
    from rich.console import Console

    return Console(stderr=stderr, markup=False, emoji=False, highlight=False)


@contextmanager
def progress(what: str, total: int) -> Iterator[Tick | None]:
    """Show a progress bar on a terminal; yield None, and show nothing, in a pipe or a log.

    Parameters
    ----------
    what : str
        What is counted, in front of the bar.
    total : int
        How many there are.
    """
    screen = console(stderr=True)
    if not screen.is_terminal:
        yield None
        return
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=screen, transient=True) as bar:
        task = bar.add_task(what, total=total)
        yield lambda done, total: bar.update(task, completed=done, total=total)
