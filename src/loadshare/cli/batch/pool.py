"""Cases side by side, in processes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import typer

from loadshare.cli.batch.work import Outcome, Task, work
from loadshare.processes import side_by_side


def outcomes(tasks: Sequence[Task], jobs: int) -> Iterator[Outcome]:
    """Do all tasks and yield their outcomes as they come.

    Parameters
    ----------
    tasks : sequence of Task
    jobs : int
        Processes; with one, everything is done in this process.

    Yields
    ------
    Outcome
        One per task. A process that dies costs only the case on which it died.
    """
    if jobs == 1:
        yield from map(work, tasks)
        return
    for task, outcome in side_by_side(work, tasks, jobs, _stopping):
        yield outcome or Outcome(
            task.name, str(task.case), "crashed", 0.0, messages=("its process died",)
        )


def _stopping() -> None:
    typer.echo("Stopping; the cases under way are finished first.", err=True)
