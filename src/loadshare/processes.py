"""Work done in parallel processes on this machine, which loky starts and supervises.

A worker does not import the user's script, so calls from there need no ``__main__`` guard.
"""

from __future__ import annotations

import os
import signal
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from loadshare.errors import LoadshareError

if TYPE_CHECKING:
    from concurrent.futures import Future

    from loky import ProcessPoolExecutor

Item = TypeVar("Item")
Result = TypeVar("Result")

ENVIRONMENT = {"OPENBLAS_NUM_THREADS": "1"}
"""One thread of BLAS in each worker: matrices are small, and sums then always round alike."""
IDLE = 30.0
"""Seconds without work after which a worker ends."""
WATCH = 1.0
"""Seconds between two checks by a worker that its parent still exists."""


def side_by_side(
    work: Callable[[Item], Result],
    items: Iterable[Item],
    workers: int,
    stopped: Callable[[], bool] = lambda: False,
) -> Iterator[tuple[Item, Result | None]]:
    """Do work in processes and yield every item with its result, in the order of completion.

    Parameters
    ----------
    work : callable
    items : iterable
    workers : int
        Number of processes.
    stopped : callable, optional
        Returns whether to start nothing more; work in progress is then finished.

    Yields
    ------
    item
    result
        None where the process died twice: at first, and again after all others had been started.

    Raises
    ------
    LoadshareError
        If the current folder no longer exists, without which no process can be started.
    Exception
        What `work` raises. Processes that are still at work then, or when the caller stops
        iterating or is interrupted, are killed.
    """
    from concurrent.futures import FIRST_COMPLETED, wait

    from loky import BrokenProcessPool

    try:
        Path.cwd()
    except FileNotFoundError:
        message = (
            "the current folder no longer exists, but processes start in it; change to another"
        )
        raise LoadshareError(message) from None
    waiting = deque((item, False) for item in items)
    pool = [Worker() for _ in range(min(workers, len(waiting)))]
    free = list(pool)
    busy: dict[Future[Result], tuple[Worker, Item, bool]] = {}
    try:
        while busy or (waiting and not stopped()):
            # One item for each free worker: work that has been submitted cannot be withdrawn.
            while waiting and free and not stopped():
                worker = free.pop()
                item, again = waiting.popleft()
                busy[worker.begin(work, item)] = worker, item, again
            for future in wait(busy, return_when=FIRST_COMPLETED).done:
                worker, item, again = busy.pop(future)
                free.append(worker)
                try:
                    result = future.result()
                except BrokenProcessPool:
                    worker.end()
                    if again:
                        yield item, None
                    else:
                        waiting.append((item, True))
                else:
                    yield item, result
    finally:
        with _signals_held():
            for worker in pool:
                worker.end()


class Worker:
    """A pool of one process, replaced if it dies: a pool of many that loses one loses them all."""

    def __init__(self) -> None:
        self.pool: ProcessPoolExecutor | None = None

    def begin(self, work: Callable[[Item], Result], item: Item) -> Future[Result]:
        """Start work on an item."""
        from loky import BrokenProcessPool, ProcessPoolExecutor

        while True:
            if self.pool is None:
                self.pool = ProcessPoolExecutor(
                    1, timeout=IDLE, initializer=_enlist, initargs=(os.getpid(),), env=ENVIRONMENT
                )
            try:
                with _signals_held():
                    found: Future[Result] = self.pool.submit(work, item)
            except BrokenProcessPool:
                # The process died after the previous item.
                self.end()
            else:
                return found

    def end(self) -> None:
        """Kill the process, at work or not: its work is no longer needed."""
        if self.pool is not None:
            self.pool.shutdown(kill_workers=True)
            self.pool = None


def _enlist(parent: int) -> None:
    """Initialise a worker: it leaves Ctrl-C to its parent, and ends when the parent does."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, HELD)

    def end() -> None:
        while os.getppid() == parent:
            time.sleep(WATCH)
        os._exit(1)

    threading.Thread(target=end, daemon=True).start()


HELD = (signal.SIGINT, signal.SIGTERM)
"""Signals that are held back while processes are started or ended."""


@contextmanager
def _signals_held() -> Iterator[None]:
    """Hold back signals: none is lost, and none leaves a process behind that nobody knows of.

    Processes that are started meanwhile hold them back too, until `_enlist` has run.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, HELD)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
