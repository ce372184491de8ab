"""Cases side by side, in processes."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import get_context

import typer

from loadshare.cli.batch.work import Outcome, Task, work


def processors() -> int:
    """Return how many processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


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
    lost: list[Task] = []
    for task, outcome in _pooled(tasks, jobs):
        if outcome is None:
            lost.append(task)
        else:
            yield outcome
    # A dead process takes the whole pool with it; alone, each case shows whether it was the one.
    for task in lost:
        for _, outcome in _pooled([task], 1):
            yield outcome or Outcome(
                task.name, str(task.case), "crashed", 0.0, messages=("its process died",)
            )


def _pooled(tasks: Sequence[Task], jobs: int) -> Iterator[tuple[Task, Outcome | None]]:
    pool = ProcessPoolExecutor(jobs, mp_context=get_context("spawn"), initializer=_leave_interrupts)
    try:
        with _interrupts_left():
            futures = {pool.submit(work, task): task for task in tasks}
        for future in as_completed(futures):
            try:
                yield futures[future], future.result()
            except BrokenProcessPool:
                yield futures[future], None
    except KeyboardInterrupt:
        typer.echo("Stopping; the cases under way are finished first.", err=True)
        raise
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _leave_interrupts() -> None:
    """Leave Ctrl-C to the main process, which lets the cases under way come to their end."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


@contextmanager
def _interrupts_left() -> Iterator[None]:
    """Start processes that ignore Ctrl-C from their first moment, before their initializer runs."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
