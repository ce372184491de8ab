"""Results to disk, written whole or not at all."""

from __future__ import annotations

import json
import os
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from loadshare.results.document import to_document

if TYPE_CHECKING:
    from collections.abc import Callable

    from loadshare.results.result import Result

DOCUMENT = "loadshare_result"
"""Attribute of a netCDF file that holds the whole result."""


def write_atomically(path: Path, content: str | bytes | Callable[[Path], object]) -> None:
    """Fill a temporary file beside `path`, then put it in place in one step.

    Parameters
    ----------
    path : Path
        Where the file shall stand; its folder is made.
    content : str, bytes or callable
        What is written, or what writes to the path that it is given.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    os.close(handle)
    temporary = Path(name)
    try:
        if callable(content):
            content(temporary)
        else:
            temporary.write_bytes(content.encode() if isinstance(content, str) else content)
        temporary.chmod(0o644)
        temporary.replace(path)
    finally:
        with suppress(FileNotFoundError):
            temporary.unlink()


def write_json(result: Result, path: str | Path | None = None) -> str:
    """Return the JSON text of a result, and write it to `path` if given."""
    text = json.dumps(to_document(result), indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    if path is not None:
        write_atomically(Path(path), text)
    return text


def write_netcdf(result: Result, path: str | Path) -> None:
    """Write labelled arrays for any reader of netCDF, and the whole result as an attribute."""
    arrays = result.dataset.assign_attrs({DOCUMENT: write_json(result)})
    write_atomically(Path(path), lambda file: arrays.to_netcdf(file, engine="h5netcdf"))
