"""A time limit for code that might not end."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager

WAITING = 20.0
"""Factor on the limit of processor time that gives the limit of elapsed time."""


class TooLong(BaseException):
    """Code ran longer than its time limit."""


@contextmanager
def limited(seconds: float) -> Iterator[None]:
    """Raise `TooLong` in code that takes longer.

    Processor time counts, so that a busy computer does not matter; code that only waits is limited
    too.
    """

    def stop(*_: object) -> None:
        raise TooLong

    timers = (
        (signal.ITIMER_PROF, signal.SIGPROF, seconds),
        (signal.ITIMER_REAL, signal.SIGALRM, WAITING * seconds),
    )
    before = [signal.signal(sign, stop) for _, sign, _ in timers]
    for timer, _, limit in timers:
        signal.setitimer(timer, limit)
    try:
        yield
    finally:
        for (timer, sign, _), handler in zip(timers, before, strict=True):
            signal.setitimer(timer, 0.0)
            signal.signal(sign, handler)
