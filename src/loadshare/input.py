"""Files that are read: regular ones, up to a size, so that no pipe or device is waited for."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from loadshare.readable import readable


class Unreadable(Exception):  # noqa: N818 -- reported as a problem, never raised to a user
    """Why a file is none that can be read."""


def read_file(path: Path, most: int) -> bytes:
    """Return what a regular file holds.

    Parameters
    ----------
    path : pathlib.Path
    most : int
        Bytes that it may hold.

    Raises
    ------
    OSError
        If it cannot be opened or read.
    Unreadable
        If it is no regular file, or larger.
    """
    if "\0" in str(path):
        raise Unreadable("has a name that no file can have")
    with open(path, "rb", opener=_without_waiting) as file:
        known = os.fstat(file.fileno())
        if not stat.S_ISREG(known.st_mode):
            raise Unreadable("is not a regular file")
        # It may grow meanwhile; room is made for what is there.
        content = file.read(min(known.st_size, most) + 1)
    if len(content) > most:
        raise Unreadable(f"is larger than {most // 2**20} MiB")
    return content


def stem(path: Path) -> str:
    """Return what a file gives its name to: without its ending, and as text that can be written.

    A name may have bytes that are no UTF-8, as of a file from an old archive; each is a question
    mark, as on the screen.
    """
    return readable(path.stem.encode(errors="replace").decode())


def real(path: Path) -> Path:
    """Return a path without links; one that leads around in a circle unchanged.

    `Path.resolve` raises there, or not, by the version of Python.
    """
    return Path(os.path.realpath(path))


def _without_waiting(path: str, flags: int) -> int:
    """Open a file at once, though it be a pipe that nobody writes."""
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))
