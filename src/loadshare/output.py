"""Writing of files: whole or not at all, and never replacing a device or a pipe."""

from __future__ import annotations

import errno
import os
import re
import stat
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from io import BytesIO, TextIOWrapper
from pathlib import Path

from loadshare.libraries import pd, xr

STANDARD = Path("-")
"""Path that means standard output."""

LONG = 100
"""Bytes of a name that the temporary file's name repeats; file systems allow some 250."""


class Closed(TextIOWrapper):
    """Stand-in for a standard stream that is closed: what is printed there is discarded."""


class NotWritten(OSError):  # noqa: N818 -- what became of a file
    """A file that could not be written; what was there before is left as it was.

    Its attributes are those of every `OSError`: `filename` is the file that was to be written.
    """


def write_whole(path: Path, content: str | bytes) -> None:
    """Write a file, whole or not at all.

    It is written next to its place, synced to the disk, and put in place in one step. A link is
    followed; the mode of an existing file is kept, and its owner where that is allowed. A device or
    a pipe is written to directly.

    Parameters
    ----------
    path : Path
        The file; its folder is made if it does not exist. "-" means standard output.
    content : str or bytes
        Text is written as UTF-8.

    Raises
    ------
    NotWritten
        If it cannot be written; what was there before is left as it was.
    """
    held = _encoded(content) if isinstance(content, str) else content
    with _naming(path):
        if path == STANDARD:
            _print(held)
            return
        with _staged(path, held) as put:
            put()


def _encoded(text: str) -> bytes:
    # Names of files may contain what is not UTF-8: it becomes a question mark, as on the screen.
    return text.encode(errors="replace")


def write_together(contents: Mapping[Path, str], without: Iterable[Path], last: Path) -> None:
    """Write files of one folder that belong together, replacing those of an earlier time.

    All are written next to their places before the first is put in place. While they are put in
    place, the folder lacks one file without which the others mean nothing, so that no interruption
    leaves a mixture of old and new.

    Parameters
    ----------
    contents : mapping of Path to str
        None of the paths is "-".
    without : iterable of Path
        Files to remove.
    last : Path
        The file, one of `contents`, that is removed first and put in place last.

    Raises
    ------
    NotWritten
        If one of them cannot be written. If that happens before the first is put in place, all that
        was there before is left as it was.
    """
    with ExitStack() as stack:
        puts = {}
        for path, content in contents.items():
            with _naming(path):
                puts[path] = stack.enter_context(_staged(path, _encoded(content)))
        with _naming(last):
            _remove(Path(os.path.realpath(last)))
        for path in without:
            remove(path)
        for path in (*(one for one in contents if one != last), last):
            with _naming(path):
                puts[path]()


def remove(path: Path) -> None:
    """Remove a file or a link, and sync its folder; anything else stays.

    Parameters
    ----------
    path : Path

    Raises
    ------
    NotWritten
        If it cannot be removed.
    """
    with _naming(path):
        _remove(path)


def _remove(path: Path) -> None:
    if path.is_symlink() or path.is_file():
        path.unlink()
        _sync_folder(path.parent)


@contextmanager
def _naming(path: Path) -> Iterator[None]:
    """Raise an `OSError` as one that names the file that could not be written."""
    try:
        yield
    except OSError as error:
        raise NotWritten(error.errno, error.strerror or str(error), str(path)) from error


def _print(content: bytes) -> None:
    if sys.stdout is None or isinstance(sys.stdout, Closed):
        raise OSError(errno.EBADF, "standard output is closed")
    sys.stdout.flush()
    sys.stdout.buffer.write(content)
    sys.stdout.buffer.flush()


@contextmanager
def _staged(path: Path, content: bytes) -> Iterator[Callable[[], None]]:
    """Write a file next to its place; yield a function that puts it there in one step."""
    try:
        known = path.stat()
    except FileNotFoundError:
        known = None
    if known is not None and not stat.S_ISREG(known.st_mode):

        def pour() -> None:
            with path.open("wb") as stream:
                stream.write(content)

        yield pour
        return
    # The target of a link; the link itself stays.
    place = Path(os.path.realpath(path))
    make_folder(place.parent)
    with _held(place.parent):
        temporary = place.with_name(f".{_begin(place.name)}.{os.urandom(8).hex()}")

        def put() -> None:
            temporary.replace(place)
            _sync_folder(place.parent)

        try:
            temporary.write_bytes(content)
            if known is not None:
                temporary.chmod(stat.S_IMODE(known.st_mode))
                _give(temporary, known)
            _sync(temporary)
            yield put
        except BaseException:
            with suppress(OSError):
                temporary.unlink(missing_ok=True)
            raise


def _begin(name: str) -> str:
    """Return the part of a name that the temporary file's name repeats, in whole letters."""
    return name.encode(errors="replace")[:LONG].decode(errors="ignore")


def make_folder(folder: Path) -> None:
    """Make a folder and those above it, and sync their names to the disk."""
    above = [one for one in (folder, *folder.parents) if not one.exists()]
    folder.mkdir(parents=True, exist_ok=True)
    for made in reversed(above):
        _sync_folder(made.parent)


def clear(files: Iterable[Path]) -> None:
    """Remove the temporary files that killed processes left next to files they were writing.

    A folder in which another process is writing is left as it is.

    Parameters
    ----------
    files : iterable of Path
        The files that were to be written.
    """
    names: dict[Path, set[str]] = {}
    for file in files:
        names.setdefault(file.parent, set()).add(_begin(file.name))
    for folder, known in names.items():
        with _held(folder, alone=True) as is_alone:
            if is_alone:
                _clear(folder, known)


_LEFT = re.compile(r"\.(.+)\.[0-9a-f]{16}", re.DOTALL)


def is_left(name: str) -> bool:
    """Return whether a name is one that a file has only while it is being written."""
    return _LEFT.fullmatch(name) is not None


def _clear(folder: Path, names: set[str]) -> None:
    # A folder that may be written to but not read cannot be listed.
    with suppress(OSError):
        for file in list(folder.iterdir()):
            left = _LEFT.fullmatch(file.name)
            if left is not None and left[1] in names:
                with suppress(OSError):
                    file.unlink()


@contextmanager
def _held(folder: Path, alone: bool = False) -> Iterator[bool]:
    """Lock a folder, shared by all who write in it or alone; yield whether it is locked.

    The lock ends with the process. Windows needs none: it does not remove open files.
    """
    if os.name != "posix":
        yield True
        return
    import fcntl

    how = fcntl.LOCK_EX | fcntl.LOCK_NB if alone else fcntl.LOCK_SH
    handle, held = -1, False
    # Without a lock, the files that others may be writing are left alone.
    with suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        fcntl.flock(handle, how)
        held = True
    try:
        yield held
    finally:
        if handle >= 0:
            with suppress(OSError):
                os.close(handle)


def csv_of(frame: pd.DataFrame) -> str:
    """Return a table as CSV in which no text is a formula of a spreadsheet."""
    return str(without_formulas(frame).to_csv(index=False, lineterminator="\n"))


def without_formulas(frame: pd.DataFrame) -> pd.DataFrame:
    """Return a table in which no text is a formula of a spreadsheet.

    Texts and column names that begin with =, +, -, @, a tab or a line end, and are not a quantity,
    get an apostrophe in front: users may choose any names.
    """
    safe = frame.rename(columns=_plain)
    for name in safe.columns:
        if safe[name].dtype.kind not in "biuf":
            safe[name] = safe[name].map(_plain)
    return safe


def netcdf_of(arrays: xr.Dataset) -> bytes:
    """Return labelled arrays as the content of a netCDF file.

    It is made in memory: on a full disk, HDF5 leaves a file that it cannot close, and crashes the
    process. As a slash in a name means a group in such a file, it is replaced by "|" in names of
    variables and dimensions, and a variable keeps its own name as ``long_name``.
    """
    import h5netcdf
    from xarray.backends import H5NetCDFStore

    held = BytesIO()
    with h5netcdf.File(held, "w") as file:
        _without_slashes(arrays).dump_to_store(H5NetCDFStore(file))
    return held.getvalue()


def _without_slashes(arrays: xr.Dataset) -> xr.Dataset:
    taken = {*map(str, arrays.variables), *map(str, arrays.dims)}
    found = arrays
    for name in sorted(name for name in taken if "/" in name):
        other = name.replace("/", "|")
        while other in taken:
            other += "|"
        taken.add(other)
        found = found.rename({name: other})
        if other in found.variables:
            about = found[other].attrs
            found[other] = found[other].assign_attrs({"long_name": name, **about})
    return found


FORMULA = re.compile(r"[=@\t\r\n]|[+-](?![\d.])")
"""Beginning of a text that a spreadsheet takes for a formula, and that is not a quantity."""


def _plain(cell: object) -> object:
    return f"'{cell}" if isinstance(cell, str) and FORMULA.match(cell) else cell


def _give(path: Path, known: os.stat_result) -> None:
    """Give a file the owner of another, as far as that is allowed."""
    own = path.stat()
    if hasattr(os, "chown") and (own.st_uid, own.st_gid) != (known.st_uid, known.st_gid):
        with suppress(OSError):
            os.chown(path, known.st_uid, known.st_gid)


def _sync(path: Path) -> None:
    """Sync a file to the disk."""
    handle = os.open(path, os.O_RDONLY if os.name == "posix" else os.O_RDWR)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


NO_SYNC = (errno.EINVAL, errno.ENOTSUP)
"""Error codes of file systems that cannot sync a folder."""


def _sync_folder(path: Path) -> None:
    """Sync the names in a folder to the disk."""
    if os.name != "posix":
        return
    try:
        handle = os.open(path, os.O_RDONLY)
    except PermissionError:
        return  # it may be written to but not read
    try:
        os.fsync(handle)
    except OSError as error:
        if error.errno not in NO_SYNC:
            raise
    finally:
        os.close(handle)
