"""A small disk with a given amount of free space."""

import os
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

SIZE = 4 * 2**20
PAGE = 4096


@contextmanager
def mounted(place: Path) -> Iterator[Path]:
    """Mount a disk of its own at a folder; skip if that is not possible."""
    place.mkdir()
    if shutil.which("mount") is None or not hasattr(os, "geteuid") or os.geteuid() != 0:
        pytest.skip("a disk can be mounted by root only")
    words = ["mount", "-t", "tmpfs", "-o", f"size={SIZE}", "tmpfs", str(place)]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode:
        pytest.skip(f"no disk can be mounted here: {done.stderr.strip()}")
    try:
        yield place
    finally:
        subprocess.run(["umount", "--lazy", str(place)], check=True)


def fill(disk: Path, left: int) -> None:
    """Fill a disk except for `left` bytes."""
    free = os.statvfs(disk).f_bavail * PAGE
    with (disk / "ballast").open("wb") as file:
        os.posix_fallocate(file.fileno(), 0, free - left)
    assert os.statvfs(disk).f_bavail * PAGE == left


def files(disk: Path) -> dict[str, bytes]:
    """Return the files on a disk, including hidden ones, except the one that fills it."""
    return {
        file.relative_to(disk).as_posix(): file.read_bytes()
        for file in disk.rglob("*")
        if file.is_file() and file.name != "ballast"
    }
