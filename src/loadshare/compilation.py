"""Compiling with Numba: kept on disk, told while it lasts, and never the reason of a failure.

What is compiled is kept where Numba finds a folder to write in: beside the source, else in the
user's cache folder (`NUMBA_CACHE_DIR` comes before both). Where there is none, where Numba cannot
be imported, or where it does not compile, `why_not` says so once, in the log, and those who have
another kernel use that. What is damaged on disk or out of date is compiled anew (`code_cache`).
"""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable
from types import TracebackType
from typing import Any

log = logging.getLogger("loadshare")

PATIENCE = 1.0
"""Seconds after which compiling is told; small functions are done by then."""
AGAIN = 30.0
"""Seconds after which it is told again that compiling goes on."""
COMPILERS = ("numba", "llvmlite")
PREFIX = "Compiling"
"""First word of every message that tells of compiling."""

_lock = threading.Lock()
_reason: str | None = None
_told = False


def why_not() -> str | None:
    """Return why compiled kernels are not used; None if they may be."""
    return _reason


def tell_why_not() -> None:
    """Say once, in the log, that another kernel takes the place of the compiled one, and why."""
    global _told
    with _lock:
        if _told or _reason is None:
            return
        _told = True
    log.warning(
        "The compiled kernel is not used: %s. The vectorised one takes its place: the same "
        "answers, more slowly.",
        _reason,
    )


def give_up(reason: str) -> None:
    """Use compiled kernels no more; the first reason stands."""
    global _reason
    with _lock:
        _reason = _reason or reason


def is_failure(error: BaseException) -> bool:
    """Tell whether an exception comes out of the compiler, and not out of what was compiled."""
    trace: TracebackType | None = error.__traceback__
    while trace is not None:
        name = str(trace.tb_frame.f_globals.get("__name__", ""))
        if name.partition(".")[0] in COMPILERS:
            return True
        trace = trace.tb_next
    return False


def jit(**how: Any) -> Callable[[Callable[..., Any]], Any]:
    """Return a decorator as `numba.njit`, for functions whose compiled code is to be kept.

    Without Numba a function stays what it is. Where nothing can be kept, it is compiled in memory.
    `why_not` knows of both.

    Parameters
    ----------
    **how
        Options of `numba.njit`.
    """

    def decorated(function: Callable[..., Any]) -> Any:
        made = within(**how)(function)
        if made is function:
            return function
        # Imports Numba, which is there by now.
        from loadshare.code_cache import CodeCache, Lost

        try:
            made._cache = CodeCache(function, lambda e: _watch.not_kept(words_of(e)))
        except Exception as error:  # noqa: BLE001 -- there is another way, whatever it is
            why = words_of(error)
            made._cache = Lost(lambda: _watch.not_kept(why))
            give_up(
                f"there is no folder in which compiled code could be kept ({words_of(error)}); set "
                "NUMBA_CACHE_DIR to one that can be written"
            )
        return made

    return decorated


def within(**how: Any) -> Callable[[Callable[..., Any]], Any]:
    """Return a decorator as `numba.njit`, for functions that are compiled into others only."""

    def decorated(function: Callable[..., Any]) -> Any:
        try:
            from numba import njit

            _watch.attach()
            return njit(**how)(function)
        except Exception as error:  # noqa: BLE001 -- also an interpreter that Numba does not know
            give_up(f"Numba cannot be used ({words_of(error)})")
            return function

    return decorated


def at_hand(*functions: Any) -> bool:
    """Tell whether functions run without compiling; what was kept on disk is loaded.

    Parameters
    ----------
    *functions
        Of `jit`.
    """
    return why_not() is None and all(f.overloads or f._cache.load_all(f) for f in functions)


def words_of(error: BaseException) -> str:
    """Return the kind of an exception and the first line of what it says."""
    first = str(error).strip().splitlines()
    return f"{type(error).__name__}: {first[0]}" if first else type(error).__name__


class _Watch:
    """Tells while something is compiled, after a moment and then again and again."""

    def __init__(self) -> None:
        self._depth = 0
        self._begun = 0.0
        self._spent = 0.0
        self._attached = False
        self._teller: threading.Thread | None = None
        self._complained = False

    def attach(self) -> None:
        """Listen to Numba; once."""
        with _lock:
            if self._attached:
                return
            self._attached = True
        from numba.core import event

        watch = self

        class Listener(event.Listener):
            def on_start(self, event: Any) -> None:
                watch.started()

            def on_end(self, event: Any) -> None:
                watch.ended()

        event.register("numba:compile", Listener())

    def started(self) -> None:
        """One more function is being compiled."""
        with _lock:
            self._depth += 1
            if self._depth > 1:
                return
            self._begun = time.monotonic()
            if self._teller is None:
                self._teller = threading.Thread(target=self._tell, daemon=True)
                self._teller.start()

    def ended(self) -> None:
        """One is done."""
        with _lock:
            self._depth -= 1
            if self._depth == 0:
                self._spent += time.monotonic() - self._begun

    def not_kept(self, why: str) -> None:
        """Say once that what was compiled is lost at the end."""
        with _lock:
            if self._complained:
                return
            self._complained = True
        log.warning("%s: what was compiled could not be kept (%s).", PREFIX, why)

    def _elapsed(self) -> float:
        running = time.monotonic() - self._begun if self._depth else 0.0
        return self._spent + running

    def _tell(self) -> None:
        """Run beside the compiler until nothing was compiled for a moment."""
        told = False
        idle = 0
        following = PATIENCE
        while idle < 2:
            time.sleep(PATIENCE)
            with _lock:
                elapsed, busy = self._elapsed(), self._depth > 0
            idle = 0 if busy else idle + 1
            if busy and elapsed >= following:
                following = AGAIN if not told else following + AGAIN
                text = f"{elapsed:.0f} s so far" if told else _FIRST
                told = True
                log.warning("%s: %s", PREFIX, text)
        with _lock:
            self._teller = None
            elapsed, self._spent = self._spent, 0.0
        if told:
            log.warning("%s: done after %.0f s", PREFIX, elapsed)


_FIRST = (
    "the first use of this version here takes one to three minutes of processor time; later ones "
    "find the compiled kernel on disk"
)
_watch = _Watch()
