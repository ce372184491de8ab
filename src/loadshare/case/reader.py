"""Case files: read, inherited, merged, and turned into a case."""

from __future__ import annotations

import os
import re
import tomllib
from ast import literal_eval
from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from os import PathLike
from pathlib import Path as FilePath
from typing import Any

from loadshare.case.checks import check
from loadshare.case.copies import with_copies
from loadshare.case.draft import Draft, as_data, read_draft
from loadshare.case.keys import Path, dotted, merge, parse, walk
from loadshare.case.model import Case
from loadshare.case.origin import Origin
from loadshare.case.recognise import OTHER_FILES, near_names, what_folder_is, what_is
from loadshare.case.revise import change, revise, still_assumed
from loadshare.case.slips import slip_in
from loadshare.case.words import as_given
from loadshare.errors import CaseError, Problem
from loadshare.input import Unreadable, read_file, real, stem
from loadshare.outside import OUTSIDE
from loadshare.settings import ALLOWED

_PLACE = re.compile(r"(.*) \(at (.*)\)", re.DOTALL)
_LINE = re.compile(r"line (\d+),")
_NAMES = re.compile(r"\((?:'(?:\\.|[^'\\])*',? ?)+\)")
"""A key path as the TOML parser prints it in messages."""
NO_FILE = "no such file or directory"
_DEEP = f"is nested deeper than {ALLOWED.depth} tables and lists"
_STEP = r"""(?:[\w-]++|"(?:\\.|[^"\\\n])*+"|'[^'\n]*+')"""
_NEXT = rf"(?:[ \t]*+\.[ \t]*+{_STEP})"
_LONG_KEY = re.compile(
    r"""(?:[^\w'"#-]++|\#[^\n]*+"""
    r"""|"{3}(?s:\\.|[^"\\]|"(?!""))*+(?:"{3}|\Z)|'{3}(?:[^']|'(?!''))*+(?:'{3}|\Z)"""
    rf"""|(?!{_STEP}{_NEXT}{{{ALLOWED.depth}}}){_STEP}{_NEXT}*+|(?!{_STEP})["'])*+[\w"'-]"""
)
"""Matches text up to a key with more steps than tables may nest, past comments and strings."""


def opened(case: Case | str | FilePath) -> Case:
    """Return a case; if a path is given, read it from its file."""
    return case if isinstance(case, Case) else load_case(case)


def load_case(
    path: str | FilePath,
    allow_outside: bool = False,
    changes: Mapping[str, Any] | None = None,
) -> Case:
    """Read a case file, with all that it inherits.

    Parameters
    ----------
    path : str or pathlib.Path
        The file.
    allow_outside : bool
        Whether the case may name files outside its folder: what it extends, laws and teeth of
        meshes. All cases may if the environment variable ``LOADSHARE_ALLOW_OUTSIDE`` is set.
    changes : mapping of str to object, optional
        New values by dotted key path, as `Case.replace` takes them. They are applied before the
        case is checked, so they may add what the file lacks, or correct it.

    Returns
    -------
    Case
        The case, named after the file.

    Raises
    ------
    CaseError
        With all problems of the case at once.
    TypeError
        If `path` is not a path.
    """
    if not isinstance(path, str | PathLike):
        kind = type(path).__name__
        wanted = "a Case or the path of a case file is needed"
        raise TypeError(f"{wanted}, not {kind}; Case(data) makes a case from a dictionary")
    if path == "":
        # As a path it would be the folder in which the process is.
        raise CaseError([Problem('""', "", "", NO_FILE)])
    path = FilePath(path)
    data, origin, problems = _changed(path, _origin(path, allow_outside), changes)
    try:
        case = Case(data, name=stem(path), origin=origin)
    except CaseError as error:
        raise CaseError((*problems, *error.problems)) from None
    if problems:
        raise CaseError(problems)
    return case


def load_draft(path: str | FilePath, changes: Mapping[str, Any] | None = None) -> Draft:
    """Read as much of a case file as possible, to draw a case that still has problems.

    Parameters
    ----------
    path : str or pathlib.Path
        The file.
    changes : mapping of str to object, optional
        New values by dotted key path, as `Case.replace` takes them.

    Returns
    -------
    Draft
        The valid elements, and all problems.

    Raises
    ------
    CaseError
        If the file, or one that it extends, cannot be read at all, or a changed key does not exist.
    """
    path = FilePath(path)
    data, origin, problems = _changed(path, _origin(path), changes)
    draft = read_draft(*with_copies(as_data(data, str(path)), origin))
    draft.problems[:] = [*problems, *draft.problems, *check(draft)]
    return draft


def _origin(path: FilePath, allow_outside: bool = False) -> Origin:
    return Origin(str(path), outside=allow_outside or bool(os.environ.get(OUTSIDE)))


def _changed(
    path: FilePath, origin: Origin, changes: Mapping[str, Any] | None
) -> tuple[dict[str, Any], Origin, list[Problem]]:
    """Return a file's data as changed, the origin of its keys, and non-fatal problems."""
    data, files, problems = _read(path, (), origin)
    origin = replace(origin, files=files)
    if changes:
        # Changes may name single copies.
        data, origin = with_copies(as_data(data, str(path)), origin)
        data, origin = revise(data, origin, changes)
    return data, origin, problems


def _read(
    path: FilePath, chain: tuple[FilePath, ...], origin: Origin
) -> tuple[dict[str, Any], dict[Path, str], list[Problem]]:
    """Return a file's merged data, the file of each key, and non-fatal problems."""
    own = read_toml(path)
    kind = own.get("kind")
    if isinstance(kind, str) and kind in OTHER_FILES:
        raise CaseError([Problem(str(path), "kind", as_given(kind), OTHER_FILES[kind])])
    base, removals = own.pop("extends", None), own.pop("remove", [])
    data: dict[str, Any] = {}
    files: dict[Path, str] = {}
    problems: list[Problem] = []
    if base is not None:
        data, files, problems = _read(
            _base_of(path, base, (*chain, path), origin), (*chain, path), origin
        )
    if not isinstance(removals, list):
        allowed = 'a list such as ["errors.6"]'
        problems.append(
            Problem(str(path), "remove", as_given(removals), "is not valid here", allowed)
        )
        removals = []
    before = [*walk(data)] if removals else []
    for number, key in enumerate(removals):
        wrong = _remove(data, files, key)
        if wrong:
            problems.append(Problem(str(path), f"remove[{number}]", as_given(key), *wrong))
    # What the base assumes stays assumed: a case may only add to it.
    inherited, added = data.get("assumed", []), own.get("assumed", [])
    merge(data, own)
    if isinstance(inherited, list) and isinstance(added, list) and "assumed" in data:
        kept = still_assumed(inherited, before, walk(data))
        inherited = [inherited[number] for number in kept]
        data["assumed"] = [*inherited, *(item for item in added if item not in inherited)]
        files |= {("assumed", number): files[("assumed",)] for number in range(len(inherited))}
    files.update(dict.fromkeys(walk(own), str(path)))
    return data, files, problems


def _remove(data: dict[str, Any], files: dict[Path, str], key: object) -> tuple[str, ...]:
    """Drop an inherited key; return what is wrong with it, what is allowed, and a hint."""
    try:
        path = parse(key) if isinstance(key, str) else ()
    except ValueError:
        path = ()
    if not path:
        return "is not a key path", 'a text such as "errors.6"'
    hint = change(data, path, None)
    if hint is not None:
        return "is not inherited", "", hint
    for known in [known for known in files if known[: len(path)] == path]:
        del files[known]
    return ()


def _base_of(path: FilePath, base: object, chain: tuple[FilePath, ...], origin: Origin) -> FilePath:
    """Return the file that `path` extends; `chain` lists the files up to and including `path`."""
    given = as_given(base)
    if not isinstance(base, str):
        allowed = 'a file such as "base.toml"'
        raise CaseError([Problem(str(path), "extends", given, "is not a file", allowed)])
    if len(chain) >= ALLOWED.files:
        why = f"is in the last of a chain of {len(chain)} files; no further ones are read"
        raise CaseError([Problem(str(path), "extends", given, why)])
    target = path.parent / base
    outside = origin.outside_problem(target, str(path), "extends", given)
    if outside is not None:
        raise CaseError([outside])
    if real(target) in map(real, chain):
        circle = " → ".join(str(file) for file in (*chain, target))
        raise CaseError([Problem(str(path), "extends", given, f"is circular: {circle}")])
    try:
        there = target.is_file()
    except OSError:
        return target  # to be reported when it is read
    if not there:
        raise CaseError([Problem(str(path), "extends", given, "there is no such file")])
    return target


def read_toml(path: FilePath) -> dict[str, Any]:
    """Return the content of one file, without what it extends.

    Parameters
    ----------
    path : pathlib.Path
        A TOML file.

    Raises
    ------
    CaseError
        If it cannot be read or is not TOML.
    """
    text = ""
    try:
        held = read_file(path, ALLOWED.bytes)
        known = what_is(held, path.name)
        if known is not None:
            raise CaseError([Problem(str(path), "", "", known)])
        text = held.decode("utf-8-sig").replace("\r\n", "\n")
        parsed = _parsed(text)
    except tomllib.TOMLDecodeError as error:
        raise CaseError([_not_toml(path, text, error)]) from None
    except UnicodeDecodeError as error:
        why = f"is not UTF-8 text at byte {error.start}"
    except FileNotFoundError:
        link = f"is a link to {real(path)}, where there is no file" if path.is_symlink() else ""
        problem = Problem(str(path), "", "", link or NO_FILE, hint=near_names(path))
        raise CaseError([problem]) from None
    except IsADirectoryError:
        why = what_folder_is(path)
    except OSError as error:
        why = (error.strerror or "cannot be read").lower()
    except Unreadable as error:
        why = str(error)
    except RecursionError:
        why = _DEEP
    except ValueError:
        # Python refuses whole numbers with thousands of digits.
        why = "contains a number that cannot be read"
    else:
        if _depth(parsed) <= ALLOWED.depth:
            data: dict[str, Any] = _copied(parsed)
            return data
        why = _DEEP
    raise CaseError([Problem(str(path), "", "", why)])


def _not_toml(path: FilePath, text: str, error: tomllib.TOMLDecodeError) -> Problem:
    match = _PLACE.fullmatch(str(error))
    what, where = match.groups() if match else (str(error), "an unknown place")
    what = _NAMES.sub(lambda names: dotted(literal_eval(names[0])), what[:1].lower() + what[1:])
    line = _LINE.match(where)
    hint = slip_in(text.split("\n")[int(line[1]) - 1]) if line else ""
    return Problem(str(path), "", "", f"is not valid TOML at {where}: {what}", hint=hint)


@lru_cache(maxsize=8)
def _parsed(text: str) -> dict[str, Any]:
    """Return the data of a TOML text; not to be changed, as it is kept for other cases.

    Keys with too many steps are refused first: memory and time grow with the square of the steps,
    and 100 000 of them take 20 GB.

    Raises
    ------
    RecursionError
        If a key has more steps than tables may nest.
    """
    if _LONG_KEY.match(text):
        raise RecursionError
    return tomllib.loads(text)


def _copied(holder: Any) -> Any:
    """Return a copy of a table or a list and of all tables and lists in it."""
    if isinstance(holder, dict):
        return {k: _copied(v) if isinstance(v, dict | list) else v for k, v in holder.items()}
    return [_copied(v) if isinstance(v, dict | list) else v for v in holder]


def _depth(data: object) -> int:
    """Return the nesting depth, without recursion: dotted headers may outgrow any call stack."""
    depth, layer = 0, [data]
    while layer and depth <= ALLOWED.depth:
        inner = [v for v in layer if isinstance(v, dict | list)]
        layer = [v for part in inner for v in (part.values() if isinstance(part, dict) else part)]
        depth += bool(inner)
    return depth
