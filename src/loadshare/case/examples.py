"""The cases that come with the package."""

from __future__ import annotations

from collections.abc import Iterator
from difflib import get_close_matches
from os import PathLike
from pathlib import Path, PurePath
from typing import overload

from loadshare.case.meshes import SOURCES
from loadshare.case.model import Case
from loadshare.case.reader import load_case
from loadshare.errors import CaseError, Problem

_PACKAGE = Path(__file__).parents[1]
FOLDERS = (_PACKAGE / "cases", _PACKAGE.parents[1] / "cases")
"""The folders of the cases in an installation and in a clone."""
NO_CASES = ("pairs",)
"""Folders with files that cases read, which are not cases themselves."""


@overload
def examples() -> tuple[str, ...]: ...
@overload
def examples(name: str | PathLike[str]) -> Case: ...
def examples(name: str | PathLike[str] | None = None) -> tuple[str, ...] | Case:
    """List the cases that come with the package, or open one.

    Parameters
    ----------
    name : str or path-like, optional
        As listed, such as ``"fgfbstts/limit_ring"``.

    Returns
    -------
    tuple of str, or Case
        All names if `name` is left out, else the case.

    Raises
    ------
    CaseError
        If there is no such case; the message has similar names.

    Examples
    --------
    >>> import loadshare as ls
    >>> [name for name in ls.examples() if name.startswith("two_path/")]
    ['two_path/clocking_error', 'two_path/from_teeth', 'two_path/nasa']
    >>> ls.solve(ls.examples("star/floating_sun_4")).omega["I"]
    1.306...
    """
    if name is None:
        return tuple(_names())
    return load_case(example_file(name if isinstance(name, str) else PurePath(name).as_posix()))


def example_file(name: str) -> Path:
    """Return the file of a case that comes with the package.

    Raises
    ------
    CaseError
        If there is no such case.
    """
    wanted = name.removesuffix(".toml")
    known = list(_names())
    if wanted not in known:
        near = get_close_matches(wanted, known, n=3) or [
            other for other in known if wanted.rpartition("/")[2] == other.rpartition("/")[2]
        ]
        hint = f"Similar names: {', '.join(near)}." if near else f"There are {', '.join(known)}."
        message = "is not a case of the package"
        raise CaseError([Problem("examples", "", name, message, hint=hint)])
    return _folder() / f"{wanted}.toml"


def example_text(name: str) -> str:
    """Return a shipped case as a case file that needs no other.

    A case that extends no other and reads no other file is returned as its file, comments included.

    Raises
    ------
    CaseError
        If there is no such case, or it reads files that would have to come with it.
    """
    file = example_file(name)
    case = load_case(file)
    if len(case.files) == 1:
        return file.read_text(encoding="utf-8")
    for mesh, law in case.meshes.items():
        for key in law.given(*SOURCES):
            message = "reads another file, so it cannot be copied alone"
            hint = "Copy its folder from the source, or open it with ls.examples()."
            at = f'meshes."{mesh}".{key}'
            raise CaseError([Problem(name, at, "", message, hint=hint)])
    return case.to_toml()


def _folder() -> Path:
    return next((folder for folder in FOLDERS if folder.is_dir()), FOLDERS[0])


def _names() -> Iterator[str]:
    folder = _folder()
    for file in sorted(folder.rglob("*.toml")):
        if file.parent.name not in NO_CASES:
            yield file.relative_to(folder).with_suffix("").as_posix()
