"""Temporary folders of samples, removed by the process that made them or by a later one."""

from __future__ import annotations

import os
import shutil
import tempfile
import time
from contextlib import ExitStack, suppress
from pathlib import Path

from loadshare.errors import LoadshareError
from loadshare.lock import LOCK, alone_in

PREFIX = "loadshare-samples-"
INSIDE = "samples"
"""The folder that holds the study; only the lock is next to it, so that no folder of a user is
mistaken for one of these."""
NEW = 60.0
"""Age in seconds up to which a free lock is taken for one that its process is about to hold."""


class TemporaryFolder:
    """A folder for samples, locked by the system for as long as this process lives.

    A process that is killed cannot remove its folder; whichever process makes the next one does.

    Attributes
    ----------
    path : pathlib.Path

    Raises
    ------
    LoadshareError
        If there is no place for temporary files.
    """

    def __init__(self) -> None:
        try:
            self._above = Path(tempfile.mkdtemp(prefix=PREFIX))
            remove_left(self._above.parent)
            self._held = ExitStack()
            self._held.enter_context(alone_in(self._above))
            self.path = self._above / INSIDE
            self.path.mkdir()
        except OSError as error:
            raise LoadshareError(
                f"samples: there is no folder for temporary files ({error.strerror or error}). "
                "Allowed: a folder that can be written, as TMPDIR, or as --output (out in Python)"
            ) from None

    def remove(self) -> None:
        """Remove the folder with all its content."""
        shutil.rmtree(self.path, ignore_errors=True)
        self._held.close()
        shutil.rmtree(self._above, ignore_errors=True)


def remove_left(folder: Path) -> None:
    """Remove folders that killed processes left: nobody holds their locks."""
    for path in folder.glob(f"{PREFIX}*"):
        with suppress(OSError, LoadshareError):
            if _is_left(path):
                with alone_in(path):
                    shutil.rmtree(path / INSIDE, ignore_errors=True)
                path.rmdir()


def _is_left(path: Path) -> bool:
    """Return whether a folder looks like a temporary one, is not new, and belongs to this user."""
    own = not hasattr(os, "getuid") or path.lstat().st_uid == os.getuid()
    if not own or path.is_symlink() or not path.is_dir():
        return False
    held = {file.name for file in path.iterdir()}
    if LOCK not in held or held - {LOCK, INSIDE} or (path / INSIDE).is_symlink():
        return False
    return time.time() - (path / LOCK).stat().st_mtime > NEW
