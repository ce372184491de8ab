"""Output of text: answers go to stdout, progress to stderr; all to stderr if a file is on stdout.

With ``--quiet`` or ``--json``, neither answers nor progress are printed.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import TYPE_CHECKING

from loadshare.cli.files import is_stdout_taken
from loadshare.cli.waiting import echo, erase_line, is_hushed
from loadshare.progress import Progress
from loadshare.readable import readable

if TYPE_CHECKING:
    from rich.console import Console


@dataclass
class _Stand:
    """Progress of the work that is under way."""

    what: str
    done: int = 0
    total: int | None = None


_at: ContextVar[_Stand | None] = ContextVar("under way", default=None)


def begin() -> None:
    """Note that nothing is under way yet."""
    _at.set(None)


def stand() -> tuple[int, int]:
    """Return how much is done, and of how much; zeros while that is not known."""
    known = _at.get()
    return (known.done, known.total or 0) if known else (0, 0)


def under_way() -> str:
    """Return how far the command has come, as the middle of a sentence; empty if not started."""
    known = _at.get()
    if known is None:
        return ""
    if not known.done:
        return f" before the first of the {known.what} was done"
    return f" after {known.done:,} of {known.total:,} {known.what}"


def console(*, stderr: bool = False) -> Console:
    """Return a console that prints titles and units as they are: brackets are no markup here.

    Where a file goes to stdout, all text goes to stderr.
    """
    import os

    from rich import console as rich

    class Screen(rich.Console):
        def on_broken_pipe(self) -> None:
            """Go on when nobody reads any more, as with ``| head``: files are still written."""
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, self.file.fileno())
            os.close(nowhere)

    erase_line()
    return Screen(stderr=stderr or is_stdout_taken(), markup=False, emoji=False, highlight=False)


def say(*parts: object, style: str | None = None, whole: bool = False) -> None:
    """Print an answer; with `whole` only the terminal breaks its lines, as paths need."""
    if is_hushed():
        return
    shown = (readable(part) if isinstance(part, str) else part for part in parts)
    console().print(*shown, style=style, soft_wrap=whole)


def say_all(lines: Iterable[str], *, whole: bool = False) -> None:
    """Print lines of an answer."""
    for line in lines:
        say(line, whole=whole)


def print_note(note: str) -> None:
    """Print a note on stderr."""
    if not is_hushed():
        echo(f"Note: {note}", err=True)


@contextmanager
def progress(what: str, total: int | None, *, rated: bool = False) -> Iterator[Progress]:
    """Count what is done, and show on a terminal how much that is and how long the rest will take.

    Parameters
    ----------
    what : str
        What is counted, in front of the bar.
    total : int or None
        Their total number; None if it is not known beforehand.
    rated : bool
        Whether the bar shows a rate, for what comes by the thousands.
    """
    known = _Stand(what, total=total)
    _at.set(known)

    def count(done: int, total: int) -> None:
        known.done, known.total = done, total

    screen = console(stderr=True)
    if not screen.is_terminal or is_hushed():
        yield count
        return
    from rich import progress as bars
    from rich.text import Text

    class Rate(bars.ProgressColumn):
        def render(self, task: bars.Task) -> Text:
            speed = task.finished_speed or task.speed
            return Text("" if speed is None else f"{speed:,.0f}/s")

    columns = (
        bars.TextColumn("{task.description}"),
        bars.BarColumn(),
        bars.MofNCompleteColumn(),
        *([Rate()] if rated else []),
        bars.TimeElapsedColumn(),
        bars.TextColumn("left"),
        bars.TimeRemainingColumn(),
    )
    # Rated parts come seconds apart: a short memory would show no rate between them.
    memory = 300.0 if rated else 30.0
    with bars.Progress(
        *columns, console=screen, transient=True, speed_estimate_period=memory
    ) as bar:
        task = bar.add_task(what, total=total)

        def tick(done: int, total: int) -> None:
            count(done, total)
            bar.update(task, completed=done, total=total)

        yield tick
