"""Compilation with Numba: kept on disk, reported while it lasts, and never the cause of a failure.

Compiled code is kept where Numba finds a folder to write in: next to the source, else in the
user's cache folder (`NUMBA_CACHE_DIR` comes before both). Where there is none, where Numba cannot
be imported, or where it does not compile, `log_why_not` says so once in the log, and callers that
have another kernel use that. Code that is damaged or out of date is compiled again (`code_cache`).
"""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable
from dataclasses import dataclass
from types import TracebackType
from typing import Any

from loadshare.compile_watch import watch

log = logging.getLogger("loadshare")

COMPILERS = ("numba", "llvmlite")

_lock = threading.Lock()


@dataclass(slots=True)
class Usable:
    """Whether compiled kernels may be used in this process.

    Attributes
    ----------
    reason : str or None
        Why not.
    reported : bool
        Whether the log says so.
    """

    reason: str | None = None
    reported: bool = False


usable = Usable()


def why_not() -> str | None:
    """Return why compiled kernels are not used; None if they may be."""
    return usable.reason


def log_why_not() -> None:
    """Say once, in the log, that another kernel takes the place of the compiled one, and why."""
    with _lock:
        if usable.reported or usable.reason is None:
            return
        usable.reported = True
    log.warning(
        "The compiled kernel is not used: %s. The vectorised one takes its place: the same "
        "answers, more slowly.",
        usable.reason,
    )


def give_up(reason: str) -> None:
    """Use compiled kernels no more; the first reason is kept."""
    with _lock:
        usable.reason = usable.reason or reason


def is_failure(error: BaseException) -> bool:
    """Return whether an exception comes from the compiler, not from the compiled code."""
    trace: TracebackType | None = error.__traceback__
    while trace is not None:
        name = str(trace.tb_frame.f_globals.get("__name__", ""))
        if name.partition(".")[0] in COMPILERS:
            return True
        trace = trace.tb_next
    return False


def jit(**how: Any) -> Callable[[Callable[..., Any]], Any]:
    """Return a decorator like `numba.njit`, for functions whose compiled code is to be kept.

    Without Numba a function is left as it is. Where nothing can be kept, it is compiled in memory.
    `why_not` returns the reason in both cases.

    Parameters
    ----------
    **how
        Options of `numba.njit`.
    """

    def decorated(function: Callable[..., Any]) -> Any:
        made = _made(function, no_cfunc_wrapper=True, **how)
        if made is function:
            return function
        # This imports Numba, which is known to exist by now.
        from loadshare.code_cache import CodeCache, NoCache

        try:
            made._cache = cache = CodeCache(function, lambda e: watch.not_kept(words_of(e)))
            made.compile = cache.compiling(made.compile)
        except Exception as error:  # noqa: BLE001 -- whatever it is, another kernel is used
            why = words_of(error)
            made._cache = NoCache(lambda: watch.not_kept(why))
            give_up(
                f"there is no folder in which compiled code could be kept ({words_of(error)}); set "
                "NUMBA_CACHE_DIR to one that can be written"
            )
        return made

    return decorated


def within(**how: Any) -> Callable[[Callable[..., Any]], Any]:
    """Return a decorator like `numba.njit`, for functions that only compiled functions call."""

    def decorated(function: Callable[..., Any]) -> Any:
        # The wrapper for calls from Python would take a fifth of the time to compile.
        return _made(function, no_cpython_wrapper=True, no_cfunc_wrapper=True, **how)

    return decorated


def _made(function: Callable[..., Any], **how: Any) -> Any:
    try:
        from numba import njit

        from loadshare import reference_type  # noqa: F401 -- registers references with Numba

        watch.attach()
        return njit(**how)(function)
    except Exception as error:  # noqa: BLE001 -- also an interpreter that Numba does not support
        give_up(f"Numba cannot be used ({words_of(error)})")
        return function


def is_available(*functions: Any) -> bool:
    """Return whether functions can run without compiling; code kept on disk is loaded.

    Parameters
    ----------
    *functions
        Functions decorated by `jit`.
    """
    return why_not() is None and all(f.overloads or f._cache.load_all(f) for f in functions)


def words_of(error: BaseException) -> str:
    """Return the type of an exception and the first line of its message."""
    first = str(error).strip().splitlines()
    return f"{type(error).__name__}: {first[0]}" if first else type(error).__name__
