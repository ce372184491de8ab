"""Printing unless hushed, and a line shown while libraries load, erased by the next output.

The first command of a fresh installation reads some hundred megabytes of libraries from the disk,
which takes seconds.
"""

from __future__ import annotations

import logging
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

import typer

from loadshare.compile_watch import progress
from loadshare.readable import readable

LINE = "Loading libraries …"
DELAY = 0.4
"""Time after which it is shown [s]; quicker commands do not show it."""
_ERASE = "\r\033[K"


class _Line:
    """The line, shown by a timer and erased by the next output."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._over = self._shown = False
        self._timer = threading.Timer(DELAY, self._show)
        self._timer.daemon = True
        self._timer.start()

    def _show(self) -> None:
        with self._lock:
            if not self._over:
                self._shown = True
                sys.stderr.write(LINE)
                sys.stderr.flush()

    def erase(self) -> None:
        """Erase the line for good."""
        self._timer.cancel()
        with self._lock:
            if self._shown and not self._over:
                sys.stderr.write(_ERASE)
                sys.stderr.flush()
            self._over = True


_line: list[_Line] = []


@contextmanager
def waiting() -> Iterator[None]:
    """Show on a terminal that libraries are being loaded, until something is printed or done.

    If only errors are printed, neither this nor that something is being compiled is reported.
    """
    before = progress.level
    if is_hushed():
        progress.setLevel(logging.ERROR)
    elif sys.stderr.isatty():
        _line[:] = [_Line()]
    try:
        yield
    finally:
        erase_line()
        progress.setLevel(before)


def erase_line() -> None:
    """Erase the line, to make room for what is printed now."""
    while _line:
        _line.pop().erase()


def echo(text: str, *, err: bool = False, nl: bool = True) -> None:
    """Print a line to stdout or stderr, without control characters, as names of files may hold."""
    erase_line()
    typer.echo(readable(text), err=err, nl=nl)


_hushed: ContextVar[bool] = ContextVar("hushed", default=False)


def hush(wanted: bool) -> None:
    """Print only errors from here on, or everything."""
    _hushed.set(wanted)


def is_hushed() -> bool:
    """Return whether only errors are printed."""
    return _hushed.get()
