"""Archives of REXS files: unpacking, and repacking with another text."""

from __future__ import annotations

import lzma
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from copy import copy
from io import BytesIO
from pathlib import Path

from loadshare.exchange.imported import refuse
from loadshare.input import Unreadable
from loadshare.settings import ALLOWED

DAMAGED = (
    zipfile.BadZipFile,
    zlib.error,
    lzma.LZMAError,
    NotImplementedError,
    EOFError,
    ValueError,
)
"""Exceptions raised by an archive that is damaged or packed by a method unknown to Python."""
ENDINGS = (".rexs", ".rexsj")
ENCRYPTED = 1
"""Flag of a file in an archive."""
START = b"PK\x03\x04"
"""First bytes of an archive."""


def unpacked(path: Path, content: bytes) -> bytes:
    """Return the one REXS file of an archive; return any other content unchanged.

    Raises
    ------
    CaseError
        If the archive cannot be read or does not hold one such file.
    Unreadable
        If the file is too large.
    """
    if content[:4] != START:
        return content
    with _opened(path, content) as archive:
        return _read(path, archive, _unit(path, archive))


def repacked(path: Path, content: bytes, text: str) -> bytes:
    """Return `content` with another text for its REXS file: an archive, or the text alone.

    Everything else in an archive stays, with names and dates.

    Raises
    ------
    CaseError
        If the archive cannot be read.
    Unreadable
        If what it holds is too large.
    """
    # A lone surrogate, which XML cannot hold, is written as in JSON.
    packed = text.encode(errors="backslashreplace")
    if content[:4] != START:
        return packed
    held = BytesIO()
    with _opened(path, content) as archive, zipfile.ZipFile(held, "w") as made:
        unit = _unit(path, archive)
        if sum(info.file_size for info in archive.infolist()) > ALLOWED.other_bytes:
            raise _too_large()
        for info in archive.infolist():
            inside = packed if info is unit else _read(path, archive, info)
            # Copied, because writing changes its sizes and offsets, which belong to the old
            # archive.
            made.writestr(copy(info), inside)
        made.comment = archive.comment
    return held.getvalue()


@contextmanager
def _opened(path: Path, content: bytes) -> Iterator[zipfile.ZipFile]:
    """Open an archive; one that cannot be read is refused."""
    try:
        with zipfile.ZipFile(BytesIO(content)) as archive:
            yield archive
    except DAMAGED:
        refuse(path, "is a damaged archive")


def _unit(path: Path, archive: zipfile.ZipFile) -> zipfile.ZipInfo:
    """Find the one REXS file."""
    inside = [i for i in archive.infolist() if i.filename.lower().endswith(ENDINGS)]
    if len(inside) != 1:
        refuse(path, f"is an archive with {len(inside)} REXS files, not 1")
    return inside[0]


def _read(path: Path, archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> bytes:
    if info.flag_bits & ENCRYPTED:
        refuse(path, "is an encrypted archive")
    if info.file_size > ALLOWED.other_bytes:
        raise _too_large()
    with archive.open(info) as file:
        return file.read(ALLOWED.other_bytes)


def _too_large() -> Unreadable:
    return Unreadable(f"is larger than {ALLOWED.other_bytes // 2**20} MiB")
