"""The C library that counts file-system calls and makes one fail: compile, load, set, read."""

from __future__ import annotations

import errno
import mmap
import os
import shutil
import struct
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

SOURCE = Path(__file__).with_name("shim.c")
ROOM = 1024
FIELDS = struct.Struct(f"=6q{ROOM}s64s{ROOM}s{ROOM}s")
"""Layout of `struct control`."""
SHORT, KILL = -1, -2


class Fault(NamedTuple):
    """The effect on a call, and whether the disk stays full from then on."""

    error: int
    lasting: bool = False


FAULTS = {
    "ENOSPC": Fault(errno.ENOSPC),
    "EIO": Fault(errno.EIO),
    "EACCES": Fault(errno.EACCES),
    "EINTR": Fault(errno.EINTR),
    "short": Fault(SHORT),
    "kill": Fault(KILL),
    "full": Fault(errno.ENOSPC, lasting=True),
}


def why_not() -> str:
    """Return why calls cannot be made to fail here; empty if they can."""
    if sys.platform != "linux":
        return "calls are made to fail by LD_PRELOAD, which is Linux's"
    if shutil.which("cc") is None:
        return "there is no C compiler (cc)"
    return ""


@dataclass(frozen=True, slots=True)
class Seen:
    """The calls that the library counted.

    Attributes
    ----------
    calls : int
        Number of calls in the watched folder.
    hit : int
        Number of those that failed.
    name, path : str
        Name and path of the first that failed.
    """

    calls: int
    hit: int
    name: str
    path: str


class Shim:
    """The library, and the file that sets which call fails.

    Parameters
    ----------
    folder : pathlib.Path
        Folder in which both are created.
    """

    def __init__(self, folder: Path) -> None:
        self.library, self.file = folder / "shim.so", folder / "control"
        how = ("-shared", "-fPIC", "-O2", "-Wall", "-Wextra", "-Werror")
        subprocess.run(["cc", *how, "-o", self.library, SOURCE, "-ldl"], check=True)
        self.file.write_bytes(bytes(FIELDS.size))
        with self.file.open("r+b") as file:
            self._shared = mmap.mmap(file.fileno(), FIELDS.size)

    def environment(self) -> dict[str, str]:
        """Return the environment variables with which a process loads the library."""
        return {"LD_PRELOAD": str(self.library), "LOADSHARE_FAULTS": str(self.file)}

    def arm(
        self, root: Path, target: int = 0, fault: str = "kill", log: Path | None = None
    ) -> None:
        """Count calls below a folder, and make one fail.

        Parameters
        ----------
        root : pathlib.Path
        target : int
            Number of the call to fail, from 1; 0 for none.
        fault : str
            A key of `FAULTS`.
        log : pathlib.Path, optional
            File to which every call is written.
        """
        error, lasting = FAULTS[fault]
        log_name = os.fsencode(log) if log is not None else b""
        fields = (1, 0, target, error, lasting, 0, os.fsencode(root), b"", b"", log_name)
        self._shared[:] = FIELDS.pack(*fields)

    def disarm(self) -> Seen:
        """Stop counting; return the counts."""
        _, calls, _, _, _, hit, _, name, path, _ = FIELDS.unpack(self._shared[:])
        self._shared[:] = bytes(FIELDS.size)
        return Seen(calls, hit, _text(name), _text(path))


def _text(field: bytes) -> str:
    return os.fsdecode(field.partition(b"\0")[0])
