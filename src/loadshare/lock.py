"""One at a time in a folder: a lock of the system, which ends with the process that holds it."""

from __future__ import annotations

import errno
import logging
import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager, nullcontext, suppress
from pathlib import Path

from loadshare.errors import LoadshareError

log = logging.getLogger("loadshare")

LOCK = ".loadshare.lock"
"""File of the lock; it says who holds it, and is removed when that one is done."""
TAKEN = (errno.EACCES, errno.EDEADLK) if sys.platform == "win32" else (errno.EWOULDBLOCK,)
"""What the system answers where another process holds a lock."""
AGAIN = 0.05
"""Seconds after which those who wait look again."""
FAR = 1 << 30
"""Byte that is locked on Windows, beyond the text, which others are to read."""


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """Be the only one who works in a folder.

    Where nothing can be written, or the file system has no locks, nobody is kept out.

    Parameters
    ----------
    folder : Path
        One that exists.

    Raises
    ------
    LoadshareError
        If another process works there; it names the process, its machine, and since when.
    """
    file = folder / LOCK
    handle = _acquired(file)
    if handle is None:
        yield
        return
    with _held(file, handle):
        from socket import gethostname

        text = f"process {os.getpid()} on {gethostname()}, since {_now()}"
        with suppress(OSError):
            # On a full disk it is held all the same, without the name of its holder.
            os.ftruncate(handle, 0)
            os.write(handle, text.encode())
        yield


@contextmanager
def one_after_another(
    file: Path, waiting: Callable[[], AbstractContextManager[object]] = nullcontext
) -> Iterator[bool]:
    """Be the only one who does something, once all who were before have done it.

    Where nothing can be written, or the file system has no locks, nobody waits.

    Parameters
    ----------
    file : Path
        Of the lock, in a folder that exists.
    waiting : callable, optional
        Returns a context in which to wait; not called if there is nobody to wait for.

    Yields
    ------
    bool
        Whether another process was waited for.
    """
    waited = False
    with ExitStack() as context:
        while True:
            try:
                handle = _acquired(file, logging.DEBUG)
                break
            except LoadshareError:
                if not waited:
                    context.enter_context(waiting())
                waited = True
                time.sleep(AGAIN)
    if handle is None:
        yield waited
        return
    with _held(file, handle):
        yield waited


@contextmanager
def _held(file: Path, handle: int) -> Iterator[None]:
    """Let go of a lock in the end."""
    try:
        yield
    finally:
        # While it is held; on Windows a file can be removed only when it is closed.
        with suppress(OSError):
            file.unlink()
        _close(handle)
        with suppress(OSError):
            if sys.platform == "win32":
                file.unlink()


def _acquired(file: Path, level: int = logging.WARNING) -> int | None:
    """Return an open file that this process has locked; None where none can be."""
    while True:
        try:
            handle = os.open(file, os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0), 0o666)
        except OSError as error:
            log.debug("%s: no lock: %s", file, error)
            return None
        try:
            _lock(handle)
            # Whoever had it before may have removed the file between the two steps.
            if os.path.samestat(os.fstat(handle), file.stat()):
                return handle
        except FileNotFoundError:
            pass
        except OSError as error:
            holder = _holder(handle)
            _close(handle)
            if error.errno in TAKEN:
                raise LoadshareError(
                    f"{file.parent}: is in use by {holder}. Wait until that has ended, or give "
                    "another folder."
                ) from None
            words = "%s: this file system has no locks; work here one at a time."
            log.log(level, words, file.parent)
            return None
        _close(handle)


def _holder(handle: int) -> str:
    """Return who wrote that it holds the lock."""
    with suppress(OSError):
        return os.read(handle, 200).decode(errors="replace") or "another process"
    return "another process"


def _close(handle: int) -> None:
    # A file that is closed is closed, whatever error that raises.
    with suppress(OSError):
        os.close(handle)


def _lock(handle: int) -> None:
    if sys.platform == "win32":
        import msvcrt

        os.lseek(handle, FAR, os.SEEK_SET)
        try:
            msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
        finally:
            os.lseek(handle, 0, os.SEEK_SET)
    else:
        import fcntl

        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)


def _now() -> str:
    return time.strftime("%Y-%m-%d %H:%M:%S %z")
