"""Ctrl-C and SIGTERM: a command that is stopped says what was kept and how to continue."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable
from types import FrameType
from typing import Any

from loadshare.cli.exits import INTERRUPTED, TERMINATED


class Stop:
    """Handling of the signals that a command receives.

    The command is interrupted once at most: what it prints and writes after that is short, and
    should reach even those who press Ctrl-C again and again.

    Parameters
    ----------
    gently : callable, optional
        Called at the first Ctrl-C, after which the command ends by itself; the second one
        interrupts it. Without `gently` the first one does. SIGTERM always does, because its sender
        will soon kill the process.

    Attributes
    ----------
    requested : bool
        Whether the command was stopped, and nothing more is to be started.
    code : int
        Exit code of a command that was stopped.
    """

    def __init__(self, gently: Callable[[], None] | None = None) -> None:
        self.gently, self.requested, self.code = gently, False, INTERRUPTED
        self._over = self._thrown = False
        self._before: dict[int, Any] = {}

    def __enter__(self) -> Stop:
        """Handle Ctrl-C and SIGTERM, except where the process ignores them."""
        if threading.current_thread() is threading.main_thread():
            for number in (signal.SIGINT, signal.SIGTERM):
                if signal.getsignal(number) != signal.SIG_IGN:
                    self._before[number] = signal.signal(number, self._take)
        return self

    def __exit__(self, kind: object, error: object, _: object) -> None:
        if self.requested:
            # A stopped process has nothing left to do but to end. If the signal came while exec()
            # was running a text, as in dataclasses, CPython under -m would end the process by
            # SIGINT instead of its exit code; running another text makes it forget that.
            exec("")
            if self._thrown and (error is None or isinstance(error, SystemError | ImportError)):
                # While modules were loading, the interruption may have been lost, or turned into
                # another error by a compiled module.
                raise KeyboardInterrupt
            return
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def over(self) -> None:
        """Ignore further signals: all that is left is to say what was kept."""
        self._over = True

    def _take(self, number: int, _: FrameType | None) -> None:
        """Handle a signal.

        Raises
        ------
        KeyboardInterrupt
            If the command is to end at once.
        """
        if self._over:
            return
        if number == signal.SIGINT and self.gently is not None and not self.requested:
            self.requested = True
            self.gently()
            return
        self.requested = self._over = self._thrown = True
        self.code = TERMINATED if number == signal.SIGTERM else INTERRUPTED
        raise KeyboardInterrupt
