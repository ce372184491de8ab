"""Cases from the command line: files, folders and patterns, and the changes asked for."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from loadshare.cli.exits import UNUSABLE, fail
from loadshare.cli.files import keep_inputs
from loadshare.cli.waiting import echo
from loadshare.input import real

if TYPE_CHECKING:
    from loadshare.case import Case


def open_case(file: Path, settings: Iterable[str] | None) -> Case:
    """Return the case of a file, changed as the command line asks.

    Parameters
    ----------
    file : Path
    settings : iterable of str or None
        As for `read_changes`.

    Raises
    ------
    CaseError
        With all problems of the case.
    typer.BadParameter
        If the command is asked to write over a file of the case.
    """
    from loadshare.case import load_case

    changes = read_changes(settings or ())
    keep_inputs([file])
    case = load_case(file, changes=changes)
    keep_inputs(case.files)
    return case


def read_changes(settings: Iterable[str]) -> dict[str, Any]:
    """Return the changes that ``--set`` asks for, as `Case.replace` takes them.

    Parameters
    ----------
    settings : iterable of str
        ``KEY=VALUE`` each. A value is read as TOML; what is not TOML is a text, so that quantities
        need no quotes. An empty value removes the key.

    Raises
    ------
    typer.BadParameter
        For a setting without a key or without an equals sign, or a key that is given twice.
    """
    changes: dict[str, Any] = {}
    texts: dict[Any, str] = {}
    for setting in settings:
        key, equals, value = map(str.strip, setting.partition("="))
        wrong = ""
        if not key or not equals:
            wrong = f"{setting!r} is not of the form KEY=VALUE, as in operating.torque='100 N*m'"
        elif (path := _path(key)) in texts:
            wrong = f"{key}: is given twice, as {texts[path]!r} and {value!r}; give it once"
        if wrong:
            raise typer.BadParameter(wrong, param_hint="--set")
        texts[path], changes[key] = value, _value(value)
    return changes


def _path(key: str) -> object:
    """Return the path that a key names, however it is written; the key itself if it is no path."""
    from loadshare.case.keys import parse

    try:
        return parse(key)
    except ValueError:
        return key


def _value(text: str) -> Any:
    import tomllib

    if not text:
        return None
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except (ValueError, RecursionError):
        # Not TOML, a number with thousands of digits, or nested too deeply.
        return text


def find_cases(given: Iterable[Path]) -> list[Path]:
    """Return the case files in what is given, each once, in the order given.

    Parameters
    ----------
    given : iterable of Path
        Files; folders, searched with their subfolders for ``*.toml`` except pair and law files;
        patterns, for shells that do not expand them.

    Returns
    -------
    list of Path
        Files that do not exist are included, so that they are reported like any other bad case.

    Raises
    ------
    typer.Exit
        If there is no case at all.
    typer.BadParameter
        If the command is asked to write over one of them.
    """
    found: dict[Path, Path] = {}
    for path in given:
        here = _files_of(path)
        if not here:
            echo(f"{path}: {_no_case_text(path)}", err=True)
        for file in here:
            found.setdefault(real(file), file)
    if not found:
        fail(["No case found. A case is a .toml file."], UNUSABLE)
    keep_inputs(found.values())
    return list(found.values())


def _files_of(path: Path) -> list[Path]:
    try:
        if path.is_dir():
            files = (file for file in sorted(path.rglob("*.toml")) if not _hidden(file, path))
            return [file for file in files if not _of_another_kind(file)]
        pattern = not path.exists() and any(sign in str(path) for sign in "*?[")
    except OSError:
        # A name that is too long, a folder that went away: to be reported when it is read.
        return [path]
    if pattern:
        matches = sorted(Path(path.anchor).glob(str(path.relative_to(path.anchor))))
        return [file for match in matches for file in _files_of(match)]
    return [path]


def _no_case_text(path: Path) -> str:
    """Return the message for a folder or pattern without a case."""
    from loadshare.case.recognise import what_folder_is

    wrong = "no case file found"
    if path.is_dir() and any(path.glob("*.csv")):
        return f"{wrong}: it {what_folder_is(path)}"
    if path.is_dir() and any(path.glob("*.json")):
        return f"{wrong}; to check results, name their files: {path / '*.json'}"
    return wrong


def _of_another_kind(file: Path) -> bool:
    """Return whether a file says that it is a pair or a law, which cases name but which is none."""
    from loadshare.case.reader import read_toml
    from loadshare.case.recognise import OTHER_FILES
    from loadshare.errors import CaseError

    try:
        kind = read_toml(file).get("kind")
    except CaseError:
        return False  # to be reported like any other bad case
    return isinstance(kind, str) and kind in OTHER_FILES


def _hidden(file: Path, folder: Path) -> bool:
    """Return whether a file is in a folder that starts with a dot, as virtual environments do."""
    return any(part.startswith(".") for part in file.relative_to(folder).parts)
