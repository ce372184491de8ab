"""Results on disk: JSON and netCDF, written whole or not at all."""

from __future__ import annotations

import json
import os
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from loadshare.errors import LoadshareError
from loadshare.results.document import from_document, to_document

if TYPE_CHECKING:
    from collections.abc import Callable

    from loadshare.results.result import Result

DOCUMENT = "loadshare_result"
"""Attribute of a netCDF file that holds the whole result."""


def write_atomically(path: Path, write: Callable[[Path], None]) -> None:
    """Let `write` fill a temporary file beside `path`, then put it in place in one step.

    Parameters
    ----------
    path : Path
        Where the file shall stand; its folder is made.
    write : callable
        Writes to the path that it is given.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    os.close(handle)
    temporary = Path(name)
    try:
        write(temporary)
        temporary.chmod(0o644)
        temporary.replace(path)
    finally:
        with suppress(FileNotFoundError):
            temporary.unlink()


def write_json(result: Result, path: str | Path | None = None) -> str:
    """Return the JSON text of a result, and write it to `path` if given."""
    text = json.dumps(to_document(result), indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    if path is not None:
        write_atomically(Path(path), lambda file: _write_text(file, text))
    return text


def _write_text(file: Path, text: str) -> None:
    file.write_text(text, encoding="utf-8")


def write_netcdf(result: Result, path: str | Path) -> None:
    """Write labelled arrays for any reader of netCDF, and the whole result as an attribute."""
    arrays = result.dataset.assign_attrs({DOCUMENT: write_json(result)})
    write_atomically(Path(path), lambda file: _write_arrays(arrays, file))


def _write_arrays(arrays: object, file: Path) -> None:
    arrays.to_netcdf(file, engine="h5netcdf")  # type: ignore[attr-defined]


def load_result(path: str | Path) -> Result:
    """Load a result written by ``to_json`` or ``to_netcdf``.

    Parameters
    ----------
    path : path-like
        A file ending in ``.json``, or a netCDF file.

    Returns
    -------
    Result
        Equal to the one that was saved, bit for bit.

    Raises
    ------
    LoadshareError
        If the file is missing or holds no result of loadshare.
    """
    path = Path(path)
    try:
        if path.suffix == ".json":
            text = path.read_text(encoding="utf-8")
        else:
            import xarray as xr

            with xr.open_dataset(path, engine="h5netcdf") as arrays:
                text = arrays.attrs[DOCUMENT]
        return from_document(json.loads(text))
    except (OSError, KeyError, TypeError, ValueError) as error:
        raise LoadshareError(f"{path}: holds no result of loadshare ({error})") from error
