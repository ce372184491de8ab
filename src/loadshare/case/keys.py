"""Key paths: the place of a value in a case, as a tuple of names and as dotted text."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from fnmatch import fnmatchcase
from functools import lru_cache
from typing import Any, TypeAlias

Path: TypeAlias = tuple[str | int, ...]

BARE = re.compile(r"\w+")
_STEP = re.compile(r"""(?:"((?:[^"\\]|\\.)*)"|'([^']*)'|([^.'"]+?))((?:\[\d+\])*)\s*(\.|\Z)""")


def dotted(path: Path) -> str:
    """Return a key path as dotted text, quoted where a name holds more than word characters.

    Parameters
    ----------
    path : tuple of str or int
        Names of keys and positions in lists.

    Returns
    -------
    str
        Such as ``meshes."4-6".stiffness[0]``.
    """
    text = ""
    for step in path:
        if isinstance(step, int):
            text += f"[{step}]"
        else:
            name = step if BARE.fullmatch(step) else json.dumps(step, ensure_ascii=False)
            text += f".{name}" if text else name
    return text


def with_unit(name: str, unit: str) -> str:
    """Return a name with the unit of its values in brackets, where they have one."""
    return f"{name} [{unit}]" if unit else name


@lru_cache(maxsize=4096)
def parse(text: str) -> Path:
    """Return the key path that dotted text names.

    Parameters
    ----------
    text : str
        Such as ``meshes."4-6".stiffness[0]``; a name without dots or quotes may be bare.

    Returns
    -------
    tuple of str or int
        The path.

    Raises
    ------
    ValueError
        If the text is no key path.
    """
    path: list[str | int] = []
    at, dot = 0, "."
    while dot:
        step = _STEP.match(text, at)
        if step is None:
            raise ValueError(text)
        quoted, literal, bare, indices, dot = step.groups()
        if bare is not None:
            path.append(bare.strip())
        else:
            path.append(literal if quoted is None else json.loads(f'"{quoted}"'))
        path += map(int, re.findall(r"\d+", indices))
        at = step.end()
    return tuple(path)


def look_up(data: Any, path: Path) -> Any:
    """Return what is at a path, or None if nothing is.

    Parameters
    ----------
    data : object
        Nested mappings and sequences.
    path : tuple of str or int
        The path.

    Returns
    -------
    object
        The value.
    """
    for step in path:
        # `dict` comes first: testing a file's table against Mapping takes longer than the look-up.
        if isinstance(data, dict | Mapping):
            data = data.get(step)
        elif isinstance(data, Sequence) and not isinstance(data, str) and isinstance(step, int):
            data = data[step] if step < len(data) else None
        else:
            return None
    return data


def merge(data: dict[str, Any], over: Mapping[str, Any]) -> None:
    """Merge keys into nested tables, in place; values that are not tables are replaced."""
    for key, value in over.items():
        below = data.get(key)
        if isinstance(value, Mapping) and isinstance(below, dict):
            merge(below, value)
        else:
            data[key] = value


def walk(data: Mapping[str, Any], above: Path = ()) -> Iterator[Path]:
    """Yield the path of every key, each table before what it holds.

    Parameters
    ----------
    data : mapping
        Nested tables; lists count as values.
    above : tuple of str or int
        Path of `data` itself.

    Yields
    ------
    tuple of str or int
        The paths.
    """
    for key, value in data.items():
        yield (*above, key)
        if isinstance(value, dict):
            yield from walk(value, (*above, key))


def values_in(data: Mapping[str, Any], above: Path = ()) -> Iterator[tuple[Path, Any]]:
    """Yield the path and value of everything that is not a table."""
    for key, value in data.items():
        if isinstance(value, Mapping):
            yield from values_in(value, (*above, key))
        else:
            yield (*above, key), value


def covers(pattern: Path, path: Path) -> bool:
    """Tell whether a pattern names a key or a table above it.

    Parameters
    ----------
    pattern : tuple of str or int
        A key path in which a star matches any part of one name.
    path : tuple of str or int
        The key.

    Returns
    -------
    bool
        Whether it does.
    """
    return len(pattern) <= len(path) and all(
        fnmatchcase(str(step), str(wanted)) for wanted, step in zip(pattern, path, strict=False)
    )


@lru_cache(maxsize=16)
def unmatched(patterns: tuple[str, ...], known: tuple[Path, ...]) -> list[tuple[int, bool]]:
    """Return the indices of patterns that cover no key, and whether each is a key path at all."""
    found = []
    for number, pattern in enumerate(patterns):
        try:
            wanted = parse(pattern)
        except ValueError:
            found.append((number, False))
        else:
            if not any(covers(wanted, key) for key in known):
                found.append((number, True))
    return found


def ends_of(name: str, gears: Iterable[str]) -> tuple[str, str] | None:
    """Return the two gears that a name a-b stands for; names of gears may contain dashes.

    Parameters
    ----------
    name : str
        Name of a mesh or a shaft.
    gears : iterable of str
        The existing gears.

    Returns
    -------
    tuple of (str, str) or None
        None if the name does not split into two gears, or not in one way only.
    """
    at = [index for index, letter in enumerate(name) if letter == "-"]
    splits = [(name[:index], name[index + 1 :]) for index in at if 0 < index < len(name) - 1]
    known = [split for split in splits if set(split) <= set(gears)]
    candidates = known or splits
    return candidates[0] if len(candidates) == 1 else None
