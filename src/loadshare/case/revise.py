"""Changes to a case by key path."""

from __future__ import annotations

import copy
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from loadshare.arguments import check_mapping
from loadshare.case.content import Content
from loadshare.case.draft import as_data
from loadshare.case.keys import Path, covers, dotted, look_up, parse, walk
from loadshare.case.origin import CHANGES, Origin
from loadshare.case.words import DIGITS, as_given, choices, did_you_mean
from loadshare.errors import CaseError, Problem

BY_GEAR = (("operating", "external"), ("operating", "forces"))
"""Tables with gears as keys; a change creates them where a case has none."""


def revise(
    data: Mapping[str, Any], origin: Origin, changes: Mapping[str, Any]
) -> tuple[dict[str, Any], Origin]:
    """Return plain data with some keys changed, and the file of each.

    Parameters
    ----------
    data : mapping
        A case as plain data; not modified, and shared with the result except for what changes.
    origin : Origin
        Where its keys are.
    changes : mapping of str to object
        New values by dotted key path; None removes the key.

    Returns
    -------
    tuple of dict and Origin
        The changed data and its origin.

    Raises
    ------
    CaseError
        If a path does not exist.
    TypeError
        If the changes are not a mapping.
    """
    check_mapping("changes by key path", "{'operating.torque': '100 N*m'}", changes)
    changed = dict(data)
    owned: set[int] = set()
    moved = set()
    problems = []
    for key, given in changes.items():
        try:
            path = parse(key)
        except (TypeError, ValueError):
            problems.append(Problem(CHANGES, str(key), as_given(given), "is not a key path"))
            continue
        value = as_data(given, CHANGES, path)
        _own(changed, path, owned)
        lost = change(changed, path, value)
        if lost is None:
            moved.add(path)
        else:
            problems.append(Problem(CHANGES, key, as_given(value), "does not exist", "", lost))
    if problems:
        raise CaseError(problems)
    lengths = {len(path) for path in moved}
    gone = {known for known in origin.files for length in lengths if known[:length] in moved}
    files = {known: file for known, file in origin.files.items() if known not in gone}
    files |= dict.fromkeys(moved, CHANGES)
    patterns = changed.get("assumed")
    if isinstance(patterns, list) and any(value is None for value in changes.values()):
        kept = still_assumed(patterns, walk(data), walk(changed))
        if len(kept) < len(patterns):
            changed["assumed"] = [patterns[number] for number in kept]
            own = {n: files.pop(("assumed", n), None) for n in range(len(patterns))}
            files |= {("assumed", k): file for k, n in enumerate(kept) if (file := own[n])}
    return changed, replace(origin, files=files)


def still_assumed(
    patterns: Sequence[Any], before: Iterable[Path], after: Iterable[Path]
) -> list[int]:
    """Return the indices of the patterns that stay when keys are removed.

    A pattern that covered only removed keys goes with them; one that never covered a key stays, to
    be reported.

    Parameters
    ----------
    patterns : sequence
        Patterns of ``assumed``, as written.
    before, after : iterable of Path
        The keys.
    """
    left = set(after)
    gone = [key for key in before if key not in left]

    def covered(pattern: object, keys: Iterable[Path]) -> bool:
        try:
            wanted = parse(str(pattern))
        except ValueError:
            return False
        return any(covers(wanted, key) for key in keys)

    return [
        number
        for number, pattern in enumerate(patterns)
        if not covered(pattern, gone) or covered(pattern, left)
    ]


def _own(data: dict[str, Any], path: Path, owned: set[int]) -> None:
    """Replace the tables and lists above a key by copies, unless they are copies already."""
    holder: Any = data
    for step in path[:-1]:
        below = look_up(holder, (step,))
        if not isinstance(below, dict | list):
            return
        if id(below) not in owned:
            below = holder[step] = copy.copy(below)
            owned.add(id(below))
        holder = below


def change(data: dict[str, Any], path: Path, value: Any) -> str | None:
    """Set the value at a key path, or remove the key, in place.

    Parameters
    ----------
    data : dict
        A case as plain data.
    path : tuple of str or int
        The key; the table that holds it must exist, or be a section of a case file, the table of
        a gear's errors, or one of torques or forces by gear.
    value : object
        The new value; None removes the key.

    Returns
    -------
    str or None
        None, or a hint where the path does not exist.
    """
    if value is not None and len(path) > 1 and path[0] in Content.model_fields:
        section = data.setdefault(str(path[0]), {})
        if path[0] == "errors" and len(path) > 2:
            # A gear without errors has no table of them, nor of its pin; their keys are optional.
            errors = section.setdefault(path[1], {})
            if path[2] == "pin" and isinstance(errors, dict):
                errors.setdefault("pin", {})
        if path[:2] in BY_GEAR and len(path) == 3 and isinstance(section, dict):
            section.setdefault(path[1], {})
    holder: Any = look_up(data, path[:-1])
    step: Any = path[-1]
    if value is None:
        if isinstance(holder, dict) and step in holder:
            del holder[step]
            return None
    elif (isinstance(holder, dict) and isinstance(step, str)) or (
        isinstance(holder, list) and step in range(len(holder))
    ):
        holder[step] = value
        return None
    return nearest(data, path)


def differing(before: Any, after: Any, above: Path = ()) -> list[tuple[Path, Any, Any]]:
    """Return the keys in which plain data differ, with both values; None for a missing one."""
    if before == after:
        return []
    if isinstance(before, dict) and isinstance(after, dict):
        pairs: Iterable[tuple[Any, Any, Any]] = (
            (key, before.get(key), after.get(key)) for key in {**before, **after}
        )
    elif isinstance(before, list) and isinstance(after, list) and len(before) == len(after):
        pairs = zip(range(len(before)), before, after, strict=True)
    else:
        return [(above, before, after)]
    return [found for key, one, other in pairs for found in differing(one, other, (*above, key))]


def nearest(data: Mapping[str, Any], path: Path) -> str:
    """Return a hint at the path that was meant by one that does not exist.

    Parameters
    ----------
    data : mapping
        A case as plain data.
    path : tuple of str or int
        The path.

    Returns
    -------
    str
        A did-you-mean at the first step that fails, or what is missing there.
    """
    for length in range(len(path)):
        above = look_up(data, path[:length])
        if isinstance(above, Mapping) and path[length] not in above:
            if "*" in str(path[length]):
                return "A star is not allowed here: give one key for each."
            copies = [key for key in above if DIGITS.sub("", str(key)) == path[length]]
            if copies:
                names = choices(dotted((*path[:length], key)) for key in copies)
                return f"Each copy has its own name: {names}."
            options = {dotted((*path[:length], key)): key for key in above}
            wrong = dotted(path[: length + 1])
            near = did_you_mean(wrong, options)
            if not near and not length:
                whole = [dotted((section, *path)) for section in data]
                there = [key for key in whole if look_up(data, parse(key)) is not None][:1]
                near = f"Did you mean {there[0]}?" if there else ""
            return near or f"There is no {wrong}."
        if isinstance(above, str):
            at = dotted(path[:length])
            return f'{at} = "{above}" has no parts: change {at} itself.'
    return f"There is no {dotted(path)}."
