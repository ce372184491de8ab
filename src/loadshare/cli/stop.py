"""Ctrl-C and SIGTERM: a command that is stopped says what was kept and how to continue."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable
from types import FrameType
from typing import Any

from loadshare.cli.exits import INTERRUPTED, TERMINATED


class Stop:
    """Signals that a command received.

    It is interrupted once at most: what it then still says and writes is short, and whoever
    presses Ctrl-C again and again shall read it too.

    Parameters
    ----------
    gently : callable, optional
        Called at the first Ctrl-C, where the command then comes to its end by itself; the second
        interrupts it. Without it the first one does. SIGTERM always does: what sends it kills soon.

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
        """Take Ctrl-C and SIGTERM; what the process ignores it goes on ignoring."""
        if threading.current_thread() is threading.main_thread():
            for number in (signal.SIGINT, signal.SIGTERM):
                if signal.getsignal(number) != signal.SIG_IGN:
                    self._before[number] = signal.signal(number, self._take)
        return self

    def __exit__(self, kind: object, error: object, _: object) -> None:
        if self.requested:
            # A process that was stopped has nothing left to do but to end. Where it was met in a
            # text that exec() runs, as dataclasses do, CPython under -m would end it by SIGINT in
            # place of its exit code; the next text makes it forget that.
            exec("")
            if self._thrown and (error is None or isinstance(error, SystemError | ImportError)):
                # Nothing of it is left, or what a compiled module makes of it, where it was met
                # while modules were loading.
                raise KeyboardInterrupt
            return
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def over(self) -> None:
        """Take no more signals: what is left is to say what was kept."""
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
