"""Results loaded from JSON and netCDF files, and certified again."""

from __future__ import annotations

from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from loadshare.case.reader import NO_FILE
from loadshare.errors import Problem, ResultError
from loadshare.input import Unreadable, read_file
from loadshare.libraries import xr
from loadshare.results.dataset import array_differences
from loadshare.results.digest import is_sealed
from loadshare.results.document import DOCUMENT
from loadshare.results.reading import AGAIN, read_document
from loadshare.settings import ALLOWED

if TYPE_CHECKING:
    from loadshare.results.result import Result


def load_result(path: str | Path) -> Result:
    """Load a result written by ``to_json`` or ``to_netcdf``, and certify it again.

    The case in the file is built again, every position's claimed displacements and forces
    are certified against it, and all other figures are computed from them. The file must agree with
    what was computed except for round-off.

    Parameters
    ----------
    path : path-like
        A file ending in ``.json``, or a netCDF file.

    Returns
    -------
    Result
        Equal to the one that was saved, bit for bit, if the same machine loads it.

    Raises
    ------
    ResultError
        If the file is missing, holds no result of loadshare, or one that does not pass; all
        problems are listed.
    TypeError
        If `path` is not a path.
    """
    if not isinstance(path, str | PathLike):
        raise TypeError(f"the path of a result file is needed, not {type(path).__name__}")
    if path == "":
        # As a path it would be the folder in which the process is.
        raise ResultError([Problem('""', "", "", NO_FILE)])
    path = Path(path)
    try:
        content = read_file(path, ALLOWED.result_bytes)
        if path.suffix == ".json":
            return read_document(content.decode("utf-8-sig"), str(path))[0]
        return _read_netcdf(path, content)
    except Unreadable as error:
        raise _unread(path, str(error)) from error
    except OSError as error:
        why = f"cannot be read: {(error.strerror or str(error)).lower()}"
        raise _unread(path, why) from error
    except UnicodeDecodeError as error:
        why = f"contains no loadshare result: it is not UTF-8 text at byte {error.start}"
        raise _unread(path, why) from error


def _unread(path: Path, why: str = "contains no loadshare result") -> ResultError:
    return ResultError([Problem(str(path), "", "", why)])


def _read_netcdf(path: Path, content: bytes) -> Result:
    """Load the result, and compare the file's arrays with those of the result."""
    if not is_sealed(content):
        why = "contains no loadshare result, or one that was changed: it lacks its digest"
        raise ResultError([Problem(str(path), "", "", why, hint=AGAIN)])
    try:
        with xr.open_dataset(BytesIO(content), engine="h5netcdf") as file:
            arrays = file.load()
    except (OSError, ValueError, KeyError, TypeError, RuntimeError) as error:
        why = "contains no loadshare result: it is not a netCDF file"
        raise _unread(path, why) from error
    text = arrays.attrs.pop(DOCUMENT, None)
    if not isinstance(text, str):
        raise _unread(path)
    result = read_document(text, f"{path}: {DOCUMENT}")[0]
    problems = [Problem(str(path), *words) for words in array_differences(result.dataset, arrays)]
    if problems:
        raise ResultError(problems)
    return result
