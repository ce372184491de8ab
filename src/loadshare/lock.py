"""Exclusive work in a folder, by a system lock that ends with the process that holds it."""

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
"""Name of the lock file; it names the holder, which removes it when it is done."""
TAKEN = (errno.EACCES, errno.EDEADLK) if sys.platform == "win32" else (errno.EWOULDBLOCK,)
"""Error codes of the system where another process holds the lock."""
AGAIN = 0.05
"""Seconds between two attempts to take a lock."""
FAR = 1 << 30
"""Byte that is locked on Windows: beyond the text, which others must be able to read."""


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """Be the only process that works in a folder.

    Where nothing can be written, or the file system has no locks, nobody is kept out.

    Parameters
    ----------
    folder : Path
        An existing folder.

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
            # On a full disk the lock is held all the same, but does not name its holder.
            os.ftruncate(handle, 0)
            os.write(handle, text.encode())
        yield


@contextmanager
def one_after_another(
    file: Path, waiting: Callable[[], AbstractContextManager[object]] = nullcontext
) -> Iterator[None]:
    """Take a lock in turn, once the processes that took it before have released it.

    Where nothing can be written, or the file system has no locks, nobody waits.

    Parameters
    ----------
    file : Path
        The lock file, in an existing folder.
    waiting : callable, optional
        Returns a context in which to wait; not called if there is nobody to wait for.
    """
    waits = False
    with ExitStack() as context:
        while True:
            try:
                handle = _acquired(file, logging.DEBUG)
                break
            except LoadshareError:
                if not waits:
                    context.enter_context(waiting())
                waits = True
                time.sleep(AGAIN)
    if handle is None:
        yield
        return
    with _held(file, handle):
        yield


@contextmanager
def _held(file: Path, handle: int) -> Iterator[None]:
    """Release a lock at the end."""
    try:
        yield
    finally:
        # Removed while the lock is held; on Windows only a closed file can be removed.
        with suppress(OSError):
            file.unlink()
        _close(handle)
        with suppress(OSError):
            if sys.platform == "win32":
                file.unlink()


def _acquired(file: Path, level: int = logging.WARNING) -> int | None:
    """Return an open file that this process has locked; None where no file can be locked."""
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
    """Return the holder that the lock file names."""
    with suppress(OSError):
        return os.read(handle, 200).decode(errors="replace") or "another process"
    return "another process"


def _close(handle: int) -> None:
    # The file is closed even where closing it raises an error.
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
