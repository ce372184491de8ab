"""Unintended inputs: shipped files with some values, keys, units or bytes changed."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

Random = np.random.Generator
_QUANTITY = re.compile(r"[-+]?\d[\d.]*(e[-+]?\d+)?( .*)?")
Step = str | int

NUMBERS = (
    *("0", "-0", "-1", "1", "2", "1e-308", "5e-324", "1e-41", "1e-40", "1e-20", "1e-12", "1e-9"),
    *("1e9", "1e12", "1e20", "1e40", "1e41", "1.7e308", "1e309", "nan", "inf", "-inf", "0x10"),
    *("1_000", "", "−5", "1e", ".", "9" * 400, "1e-99999", "３", "½"),
)
UNITS = (
    *("", "um", "µm", "mm", "m", "km", "N", "kN", "N*m", "N·m", "Nm", "rad", "mrad", "deg", "N/m"),
    *("N*m/rad", "m/N", "m/N^(2/3)", "kW", "rpm", "1/min", "kg", "s", "%", "degC", "GPa", "in"),
    *("N^1e9", "9^9^9^9", "m^-12", "m**m", "((m", "m/0", "m" * 61, "\u200bm", "N\x00", "°"),
)
NAMES = (
    *("", " ", "-", ".", "..", "../x", "/dev/zero", "a" * 201, "a" * 5000, "\x00", "\n", "=1+1"),
    *("__class__", "4", "*", "a.b", "a b", "Ω", "\U0001f9ff", "\u202e", "nan", "true", "a-b"),
)
WHOLES = (0, 1, -1, 2, 3, 7, 2**31, 2**63, 10**9, 10**18, 10**300)
VALUES = (
    *(True, False, 0, 1, -1, 0.5, 1e308, "", "rigid", "iso", [], {}, [[]], [0], ["0 um"], "x"),
    *([1, 2, 3], {"a": 1}, {"b": "1e-9 m/N"}, ["0 um", "0 um"], "base.toml", "1 um", "0 um:1 um:3"),
)


def places(data: Any, above: tuple[Step, ...] = ()) -> Iterator[tuple[Step, ...]]:
    """Yield the path of every item in nested data."""
    items = data.items() if isinstance(data, dict) else enumerate(data)
    for step, value in items:
        yield (*above, step)
        if isinstance(value, dict | list):
            yield from places(value, (*above, step))


def at(data: Any, path: tuple[Step, ...]) -> Any:
    """Return the value at a path."""
    for step in path:
        data = data[step]
    return data


def copied(data: Any) -> Any:
    """Return a deep copy of data."""
    return json.loads(json.dumps(data))


def pick(random: Random, some: Any) -> Any:
    """Return a random one of several items."""
    return some[int(random.integers(len(some)))]


def number(random: Random, value: Any) -> Any:
    """Return a number to replace another."""
    text = str(value)
    figure, _, unit = text.partition(" ")
    match int(random.integers(7)):
        case 0:
            figure = pick(random, NUMBERS)
        case 4 | 5 | 6:
            # A number that one might mean.
            try:
                figure = repr(float(figure) * float(random.uniform(0.1, 3.0)))
            except ValueError:
                figure = "0"
        case 1:
            try:
                figure = repr(float(figure) * 10.0 ** float(random.integers(-12, 13)))
            except ValueError:
                figure = "1"
        case 2:
            figure = f"-{figure}"
        case _:
            unit = pick(random, UNITS)
    if isinstance(value, str):
        return f"{figure} {unit}".strip()
    try:
        return float(figure)
    except ValueError:
        return figure


def whole(random: Random, value: Any) -> Any:
    """Return another whole number."""
    return pick(random, WHOLES)


def other(random: Random, value: Any) -> Any:
    """Return a value of any kind."""
    return copied(pick(random, VALUES))


def named(random: Random, value: Any) -> Any:
    """Return a text that is not a valid name."""
    return pick(random, NAMES)


def nested(random: Random, value: Any) -> Any:
    """Return the value nested in tables and lists."""
    for _ in range(pick(random, (1, 2, 19, 25, 60))):
        value = [value] if random.integers(2) else {"a": value}
    return value


CHANGES: tuple[Callable[[Random, Any], Any], ...] = (
    *(number, number, number, number),
    *(whole, other, named, nested),
)


def mutated(random: Random, data: dict[str, Any]) -> dict[str, Any]:
    """Return data with one to three changes."""
    made: dict[str, Any] = copied(data)
    for _ in range(int(random.integers(1, 4))):
        every = list(places(made))
        if not every:
            break
        path = pick(random, every)
        holder, step = at(made, path[:-1]), path[-1]
        match int(random.integers(10)):
            case 0:
                del holder[step]
            case 1 if isinstance(holder, dict):
                holder[pick(random, NAMES)] = holder.pop(step)
            case 2:
                # A value from another place, or from here in another place.
                holder[step] = copied(at(made, pick(random, every)))
            case 3 if isinstance(holder, list):
                holder.extend(copied(holder[: 1 + int(random.integers(3))]))
            case 4 if isinstance(holder, dict):
                holder[pick(random, ("law", "float", "support", "extends", "about", "x"))] = other(
                    random, None
                )
            case _:
                holder[step] = pick(random, CHANGES)(random, holder[step])
    return made


def rescaled(random: Random, data: dict[str, Any]) -> dict[str, Any]:
    """Return data with some numbers scaled, up or down by a factor of up to a thousand."""
    made: dict[str, Any] = copied(data)
    every = [path for path in places(made) if _QUANTITY.fullmatch(str(at(made, path)))]
    for _ in range(int(random.integers(1, 6))):
        path = pick(random, every)
        holder, step = at(made, path[:-1]), path[-1]
        figure, _, unit = str(holder[step]).partition(" ")
        scaled = float(figure) * 10.0 ** float(random.uniform(-3.0, 3.0))
        scaled = float(pick(random, (scaled, -scaled, 0.0, scaled, scaled, scaled)))
        if not isinstance(holder[step], int):
            holder[step] = f"{scaled!r} {unit}" if unit else scaled
    return made


def garbled(random: Random, text: bytes) -> bytes:
    """Return text with some bytes changed, removed, inserted or repeated."""
    made = bytearray(text)
    for _ in range(int(random.integers(1, 6))):
        where = int(random.integers(len(made) + 1))
        match int(random.integers(5)):
            case 0:
                made[where : where + 1] = bytes([int(random.integers(256))])
            case 1:
                del made[where : where + int(random.integers(1, 40))]
            case 2:
                made[where:where] = bytes(random.integers(32, 127, 3).astype(np.uint8))
            case 3:
                made[where:where] = made[where : where + int(random.integers(1, 200))]
            case _:
                made[where : where + 1] = pick(random, (b'"', b"[", b"]", b"=", b"\n", b"{", b"}"))
    return bytes(made)


def toml(data: dict[str, Any]) -> str:
    """Return data as TOML, each top-level key with its value on one line."""
    return "".join(f"{json.dumps(key)} = {_inline(value)}\n" for key, value in data.items())


def _inline(value: Any) -> str:
    if isinstance(value, dict):
        inner = (f"{json.dumps(key)} = {_inline(item)}" for key, item in value.items())
        return "{" + ", ".join(inner) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_inline, value)) + "]"
    if isinstance(value, float):
        return repr(value)
    return json.dumps(value, ensure_ascii=True)


def seeds(folder: Path) -> list[tuple[Path, dict[str, Any]]]:
    """Return the files to be changed, with their contents."""
    return [
        (file, tomllib.loads(file.read_text(encoding="utf-8")))
        for file in sorted(folder.rglob("*.toml"))
    ]
