"""Log messages about compiling: that it is going on, for how long, and that code is not kept."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

log = logging.getLogger("loadshare")
progress = logging.getLogger("loadshare.compiling")
"""For what is no fault: a command with ``--quiet`` leaves it out."""

PATIENCE = 1.0
"""Seconds after which compiling is announced; small functions are done by then."""
AGAIN = 30.0
"""Seconds between further messages while compiling goes on."""
PREFIX = "Compiling"
"""First word of every message about compiling."""
_FIRST = (
    "the first use of this version here takes from a few seconds (tooth contact) to three minutes "
    "(many samples) of processor time; later ones find what is compiled on disk"
)


class Watch:
    """Logs that something is being compiled, after a moment and then at intervals.

    Attributes
    ----------
    complained : bool
        Whether it has been reported that compiled code is lost when the process ends.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._depth = 0
        self._started_at = 0.0
        self._spent = 0.0
        self._attached = False
        self._teller: threading.Thread | None = None
        self.complained = False

    def attach(self) -> None:
        """Subscribe to Numba's compile events; only once."""
        with self._lock:
            if self._attached:
                return
            self._attached = True
        from numba.core import event

        outer = self

        class Listener(event.Listener):
            def on_start(self, event: Any) -> None:
                outer.started()

            def on_end(self, event: Any) -> None:
                outer.ended()

        event.register("numba:compile", Listener())

    def started(self) -> None:
        """Count one more function that is being compiled."""
        with self._lock:
            self._depth += 1
            if self._depth > 1:
                return
            self._started_at = time.monotonic()
            if self._teller is None:
                self._teller = threading.Thread(target=self._tell, daemon=True)
                self._teller.start()

    def ended(self) -> None:
        """Count one function as done."""
        with self._lock:
            self._depth -= 1
            if self._depth == 0:
                self._spent += time.monotonic() - self._started_at

    @contextmanager
    def waiting(self) -> Iterator[None]:
        """Report the wait for another process that compiles as if this one were compiling."""
        self.started()
        try:
            yield
        finally:
            self.ended()

    def not_kept(self, why: str) -> None:
        """Log once that compiled code is lost when the process ends."""
        with self._lock:
            if self.complained:
                return
            self.complained = True
        log.warning("%s: what was compiled could not be kept (%s).", PREFIX, why)

    def wait(self, seconds: float) -> None:
        """Wait until the last message on compiling is logged, for `seconds` at most."""
        teller = self._teller
        if teller is not None:
            teller.join(seconds)

    def _elapsed(self) -> float:
        running = time.monotonic() - self._started_at if self._depth else 0.0
        return self._spent + running

    def _tell(self) -> None:
        """Run alongside the compiler until nothing has been compiled for a moment."""
        announced = False
        idle = 0
        following = PATIENCE
        while idle < 2:
            time.sleep(PATIENCE)
            with self._lock:
                elapsed, busy = self._elapsed(), self._depth > 0
            idle = 0 if busy else idle + 1
            if busy and elapsed >= following:
                following = AGAIN if not announced else following + AGAIN
                text = f"{elapsed:.0f} s so far" if announced else _FIRST
                announced = True
                progress.warning("%s: %s", PREFIX, text)
        with self._lock:
            self._teller = None
            elapsed, self._spent = self._spent, 0.0
        if announced:
            progress.warning("%s: done after %.0f s", PREFIX, elapsed)


watch = Watch()
