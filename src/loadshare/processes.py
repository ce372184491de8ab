"""Work done side by side in processes of this machine, which loky starts and looks after.

A worker imports no script of the user's, so nobody needs a guard around what calls this.
"""

from __future__ import annotations

import os
import signal
import threading
import time
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from concurrent.futures import Future

Item = TypeVar("Item")
Result = TypeVar("Result")

ENVIRONMENT = {"OPENBLAS_NUM_THREADS": "1"}
"""One thread of BLAS in each: matrices are small, and their sums then always round alike."""
IDLE = 30.0
"""Seconds without work after which a worker ends."""


def side_by_side(
    work: Callable[[Item], Result],
    items: Iterable[Item],
    workers: int,
    stopping: Callable[[], None] | None = None,
) -> Iterator[tuple[Item, Result | None]]:
    """Do work in processes and yield every item with its result, as they come.

    Parameters
    ----------
    work : callable
    items : iterable
    workers : int
        Processes.
    stopping : callable, optional
        Called when the keyboard interrupts, or nobody asks for more; what is under way is then
        finished. Without it workers are killed.

    Yields
    ------
    item
    result
        None where the process died, once among others and once alone.

    Raises
    ------
    Exception
        What `work` raises.
    """
    waiting = deque(items)
    while waiting:
        lost = yield from _crew(work, waiting, workers, stopping)
        # A dead process takes its crew with it; alone, each item shows whether it was the one.
        for item in lost:
            again = yield from _crew(work, deque([item]), 1, stopping)
            yield from ((item, None) for item in again)


def _crew(
    work: Callable[[Item], Result],
    waiting: deque[Item],
    workers: int,
    stopping: Callable[[], None] | None,
) -> Generator[tuple[Item, Result], None, list[Item]]:
    """Work until nothing is waiting or a process dies; return what was under way then."""
    from concurrent.futures import FIRST_COMPLETED, wait

    from loky import BrokenProcessPool, ProcessPoolExecutor

    def lost(future: Future[Result]) -> bool:
        return isinstance(future.exception(), BrokenProcessPool)

    workers = min(workers, len(waiting))
    pool = ProcessPoolExecutor(
        workers, timeout=IDLE, initializer=_enlist, initargs=(os.getpid(),), env=ENVIRONMENT
    )
    running: dict[Future[Result], Item] = {}
    finish = False
    try:
        while waiting or running:
            # No more than are at work: what has been handed in cannot be called back.
            while waiting and len(running) < workers:
                with _interrupts_left():
                    future = pool.submit(work, waiting[0])
                running[future] = waiting.popleft()
            for future in sorted(wait(running, return_when=FIRST_COMPLETED).done, key=lost):
                result = future.result()
                yield running.pop(future), result
    except BrokenProcessPool:
        pass
    except (KeyboardInterrupt, GeneratorExit):
        if stopping is not None:
            stopping()
            finish = True
        raise
    finally:
        pool.shutdown(kill_workers=bool(running) and not finish)
    return list(running.values())


def _enlist(parent: int) -> None:
    """Begin as a worker: Ctrl-C is the parent's affair, and its end is the worker's."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def end() -> None:
        while os.getppid() == parent:
            time.sleep(1.0)
        os._exit(1)

    threading.Thread(target=end, daemon=True).start()


@contextmanager
def _interrupts_left() -> Iterator[None]:
    """Start processes that ignore Ctrl-C from their first moment."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
