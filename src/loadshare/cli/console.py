"""Where text goes: stdout for answers, stderr for progress and beside a file on stdout."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Protocol

from loadshare.cli.files import is_stdout_taken

if TYPE_CHECKING:
    from rich.console import Console


class Tick(Protocol):
    """Called with how much is done, and of how much."""

    def __call__(self, done: int, total: int) -> None:
        """Tell that `done` of `total` are finished."""


def console(*, stderr: bool = False) -> Console:
    """Return a console that prints titles and units as they are: brackets are no markup here.

    Where a file goes to stdout, all that is said goes to stderr.
    """
    from rich.console import Console

    return Console(stderr=stderr or is_stdout_taken(), markup=False, emoji=False, highlight=False)


def say(*told: object, style: str | None = None, whole: bool = False) -> None:
    """Print an answer; `whole` leaves its lines to be broken by the terminal, as paths need."""
    console().print(*told, style=style, soft_wrap=whole)


def say_all(lines: Iterable[str], *, whole: bool = False) -> None:
    """Print lines of an answer."""
    for line in lines:
        say(line, whole=whole)


@contextmanager
def progress(what: str, total: int | None, *, rated: bool = False) -> Iterator[Tick | None]:
    """Show a progress bar on a terminal; yield None, and show nothing, in a pipe or a log.

    Parameters
    ----------
    what : str
        What is counted, in front of the bar.
    total : int or None
        How many there are; None if that is not known beforehand.
    rated : bool
        Whether the bar tells rate and time left, for what comes by the thousands.
    """
    screen = console(stderr=True)
    if not screen.is_terminal:
        yield None
        return
    from rich import progress as bars
    from rich.text import Text

    class Rate(bars.ProgressColumn):
        def render(self, task: bars.Task) -> Text:
            speed = task.finished_speed or task.speed
            return Text("" if speed is None else f"{speed:,.0f}/s")

    left = (bars.TextColumn("left"), bars.TimeRemainingColumn())
    columns = (
        bars.TextColumn("{task.description}"),
        bars.BarColumn(),
        bars.MofNCompleteColumn(),
        *((Rate(), bars.TimeElapsedColumn(), *left) if rated else (bars.TimeElapsedColumn(),)),
    )
    # Parts of what is rated come seconds apart: a short memory would show no rate between them.
    memory = 300.0 if rated else 30.0
    with bars.Progress(
        *columns, console=screen, transient=True, speed_estimate_period=memory
    ) as bar:
        task = bar.add_task(what, total=total)
        yield lambda done, total: bar.update(task, completed=done, total=total)
