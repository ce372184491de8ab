"""Key paths: where in a case something stands, as a tuple of names and as dotted text."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, TypeAlias

Path: TypeAlias = tuple[str | int, ...]

BARE = re.compile(r"\w+")
_STEP = re.compile(r'"((?:[^"\\]|\\.)*)"|\'([^\']*)\'|([^.\'"]+)')
_INDEX = re.compile(r"\[(\d+)\]$")


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


def parse(text: str) -> Path:
    """Return the key path that dotted text names.

    Parameters
    ----------
    text : str
        Such as ``meshes."4-6".stiffness[0]``; a name without dots or quotes may stand bare.

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
    at = 0
    while True:
        match = _STEP.match(text, at)
        if match is None:
            raise ValueError(text)
        quoted, literal, bare = match.groups()
        at = match.end()
        if bare is None:
            path.append(literal if quoted is None else json.loads(f'"{quoted}"'))
            indices = re.match(r"(\[\d+\])*", text[at:])
            tail = indices[0] if indices else ""
            at += len(tail)
        else:
            name = bare.strip()
            tail = ""
            while found := _INDEX.search(name):
                name, tail = name[: found.start()], found[0] + tail
            path.append(name)
        path += [int(number) for number in re.findall(r"\d+", tail)]
        if at == len(text):
            return tuple(path)
        if text[at] != ".":
            raise ValueError(text)
        at += 1


def look_up(data: Any, path: Path) -> Any:
    """Return what stands at a path, or None where nothing does.

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
        if isinstance(data, Mapping):
            data = data.get(step)
        elif isinstance(data, Sequence) and not isinstance(data, str) and isinstance(step, int):
            data = data[step] if step < len(data) else None
        else:
            return None
    return data


def walk(data: Mapping[str, Any], above: Path = ()) -> Iterator[Path]:
    """Yield the path of every key, each table before what it holds.

    Parameters
    ----------
    data : mapping
        Nested tables; lists count as values.
    above : tuple of str or int
        Where `data` stands itself.

    Yields
    ------
    tuple of str or int
        The paths.
    """
    for key, value in data.items():
        yield (*above, key)
        if isinstance(value, Mapping):
            yield from walk(value, (*above, key))
