"""Files that are written: whole or not at all, and never in place of what is no file."""

from __future__ import annotations

import io
import os
import re
import secrets
import stat
import sys
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

STANDARD = Path("-")
"""Stands for standard output."""

LONG = 100
"""Letters of a name that the file beside it has as well; file systems allow some 250 bytes."""


class NotWritten(OSError):  # noqa: N818 -- what became of a file
    """A file that could not be written; what was there before is left as it was.

    Its attributes are those of every `OSError`: `filename` is the file that was asked for.
    """


def write_whole(path: Path, content: str | bytes) -> None:
    """Write a file, whole or not at all.

    It is filled beside its place, brought to the disk, and put in place in one step. A link is
    followed; the mode of a file that is there is kept, and its owner where that is allowed. What is
    no file, a device or a pipe, is written to.

    Parameters
    ----------
    path : Path
        Where the file shall stand; its folder is made. "-" stands for standard output.
    content : str or bytes
        Text is written as UTF-8.

    Raises
    ------
    NotWritten
        If it cannot be written; what was there before is left as it was.
    """
    try:
        _write(path, content.encode() if isinstance(content, str) else content)
    except OSError as error:
        raise NotWritten(error.errno, error.strerror or str(error), str(path)) from error


def _write(path: Path, content: bytes) -> None:
    if path == STANDARD:
        sys.stdout.flush()
        sys.stdout.buffer.write(content)
        sys.stdout.buffer.flush()
        return
    try:
        known = path.stat()
    except FileNotFoundError:
        known = None
    if known is not None and not stat.S_ISREG(known.st_mode):
        with path.open("wb") as stream:
            stream.write(content)
        return
    # Where a link leads; the link itself stays.
    place = Path(os.path.realpath(path))
    place.parent.mkdir(parents=True, exist_ok=True)
    temporary = place.with_name(f".{place.name[:LONG]}.{secrets.token_hex(8)}")
    try:
        temporary.write_bytes(content)
        if known is not None:
            temporary.chmod(stat.S_IMODE(known.st_mode))
            _give(temporary, known)
        _sync(temporary)
        temporary.replace(place)
        _sync(place.parent)
    finally:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)


def csv_of(frame: pd.DataFrame) -> str:
    """Return a table as CSV in which no text is a formula of a spreadsheet.

    Texts and heads that begin with =, +, -, @, a tab or a line end, and are no quantity, have an
    apostrophe before them: names are their user's to choose.
    """
    safe = frame.rename(columns=_plain)
    for name in safe.columns:
        if safe[name].dtype.kind not in "biuf":
            safe[name] = safe[name].map(_plain)
    return str(safe.to_csv(index=False, lineterminator="\n"))


def netcdf_of(arrays: xr.Dataset) -> bytes:
    """Return labelled arrays as a netCDF file.

    HDF5 that meets a full disk cannot close its file any more, and takes the process with it: it
    works in memory here, and others bring the bytes to the disk.
    """
    import h5netcdf
    from xarray.backends import H5NetCDFStore

    held = io.BytesIO()
    with h5netcdf.File(held, "w") as file:
        arrays.dump_to_store(H5NetCDFStore(file))
    return held.getvalue()


_FORMULA = re.compile(r"[=@\t\r\n]|[+-](?![\d.])")


def _plain(cell: object) -> object:
    return f"'{cell}" if isinstance(cell, str) and _FORMULA.match(cell) else cell


def _give(path: Path, known: os.stat_result) -> None:
    """Give a file the owner of another, as far as that is allowed."""
    own = path.stat()
    if hasattr(os, "chown") and (own.st_uid, own.st_gid) != (known.st_uid, known.st_gid):
        with suppress(OSError):
            os.chown(path, known.st_uid, known.st_gid)


def _sync(path: Path) -> None:
    """Bring a file or the names in a folder to the disk."""
    if os.name != "posix" and path.is_dir():
        return
    handle = os.open(path, os.O_RDONLY if os.name == "posix" else os.O_RDWR)
    try:
        os.fsync(handle)
    except OSError:
        # Some file systems have none for folders.
        if not path.is_dir():
            raise
    finally:
        os.close(handle)
