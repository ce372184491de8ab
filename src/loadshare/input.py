"""Reading of files: only regular ones, up to a size, so that no pipe or device is waited for."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from loadshare.readable import readable


class Unreadable(Exception):  # noqa: N818 -- reported as a problem, never raised to a user
    """The reason why a file cannot be read."""


def read_file(path: Path, most: int) -> bytes:
    """Return the content of a regular file.

    Parameters
    ----------
    path : pathlib.Path
    most : int
        Largest size in bytes.

    Raises
    ------
    OSError
        If it cannot be opened or read.
    Unreadable
        If it is not a regular file, or is larger.
    """
    if "\0" in str(path):
        raise Unreadable("has a name that no file can have")
    with open(path, "rb", opener=_without_waiting) as file:
        known = os.fstat(file.fileno())
        if not stat.S_ISREG(known.st_mode):
            raise Unreadable("is not a regular file")
        # Memory is reserved for its present size; should it grow meanwhile, the rest is not read.
        content = file.read(min(known.st_size, most) + 1)
    if len(content) > most:
        raise Unreadable(f"is larger than {most // 2**20} MiB")
    return content


def stem(path: Path) -> str:
    """Return the name of a file without its ending, as text that can be written.

    A name may contain bytes that are not UTF-8, as in an old archive; each becomes a question mark,
    as on the screen.
    """
    return readable(path.stem.encode(errors="replace").decode())


def real(path: Path) -> Path:
    """Return a path with its links resolved; one whose links form a loop is left unchanged.

    `Path.resolve` raises for such a loop, or not, depending on the version of Python.
    """
    return Path(os.path.realpath(path))


def _without_waiting(path: str, flags: int) -> int:
    """Open a file without blocking, even if it is a pipe without a writer."""
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))
