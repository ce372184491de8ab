"""Cells: what a key takes decides how the text of a cell is read and a value is written.

``;`` separates the entries of a list, ``|`` the lists of a list; at the end of a single entry they
make it a list of one. A unit in the head of a column belongs to every number below it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from typing import Any

from loadshare.case.keys import Path, parse
from loadshare.case.schema import case_schema
from loadshare.output import FORMULA
from loadshare.settings import ALLOWED

Schema = Mapping[str, Any]

NUMBER = re.compile(r"[+\-−]?(?:\d+\.?\d*|\.\d+)(?:[eE][+\-−]?\d+)?")
WHOLE = re.compile(r"([+-]?\d+)(\.0*)?")
"""Some programs write every number with decimals."""
QUANTITY = re.compile(rf"({NUMBER.pattern}) (\S.*)")
HEAD = re.compile(r"(.*?)\s*\[((?:1\s*/|[^\d\[\]])[^\[\]]*)\]\s*", re.DOTALL)
NO_UNIT = "-"
"""How heads say that the numbers below have no unit."""
LONG = 40
"""Largest number of characters of a number."""


@cache
def _schema() -> Schema:
    return case_schema()


def _options(schema: Schema) -> Iterator[Schema]:
    """Yield the forms that a value may have."""
    several = schema.get("oneOf") or schema.get("anyOf")
    if several:
        for one in several:
            yield from _options(one)
    elif "$ref" in schema:
        yield from _options(_schema()["$defs"][schema["$ref"].rpartition("/")[2]])
    else:
        yield schema


def taken(path: Path) -> list[Schema]:
    """Return the forms that the value of a key may have; none for an unknown key."""
    options: list[Schema] = [_schema()]
    for step in path:
        below = []
        for option in options:
            inner = option.get("properties", {}).get(step, option.get("additionalProperties"))
            if isinstance(inner, Mapping):
                below += list(_options(inner))
        options = below
    return options


def head_of(text: str, above: Path) -> tuple[Path, str]:
    """Return the key that a head names, below that of its section, and its unit.

    A space in a key means ``_``, as nobody writes ``face_width`` in a spreadsheet.

    Raises
    ------
    ValueError
        If it names no key.
    """
    found = HEAD.fullmatch(text)
    name, unit = (found[1], found[2].strip()) if found else (text, "")
    unit = "" if unit == NO_UNIT else unit
    path = parse(name.strip())
    if len(path) > ALLOWED.depth or not all(isinstance(step, str) for step in path):
        raise ValueError(text)
    for step in path:
        plain = "_".join(str(step).split()).lower()
        known = any(plain in option.get("properties", {}) for option in taken(above))
        above = (*above, plain if known else step)
    return above, unit


def value_of(text: str, unit: str, options: Sequence[Schema]) -> Any:
    """Return the value of a cell that is not empty."""
    lists = [option for option in options if option.get("type") == "array"]
    others = [option for option in options if option.get("type") != "array"]
    if lists and (not others or ";" in text or "|" in text):
        inner = [
            one
            for option in lists
            for part in (option.get("items"), *option.get("prefixItems", ()))
            if part is not None
            for one in _options(part)
        ]
        nested = [option for option in inner if option.get("type") == "array"]
        if nested and ("|" in text or len(nested) == len(inner)):
            return [value_of(part, unit, nested) for part in _entries(text, "|")]
        flat = [option for option in inner if option.get("type") != "array"]
        return [value_of(part, unit, flat) for part in _entries(text, ";")]
    text = text.strip()
    kinds = {option.get("type") for option in others}
    is_number = NUMBER.fullmatch(text) is not None
    if unit and is_number:
        return f"{text} {unit}"
    if "boolean" in kinds and text.lower() in ("true", "false"):
        return text.lower() == "true"
    if kinds & {"integer", "number"} and is_number and len(text) <= LONG:
        number = text.replace("−", "-")
        whole = WHOLE.fullmatch(number)
        is_int = whole is not None and (not whole[2] or "number" not in kinds)
        return int(whole[1]) if whole and is_int else float(number)
    return text[1:] if text.startswith("'") and FORMULA.match(text[1:]) else text


def _entries(text: str, separator: str) -> list[str]:
    """Return the entries of a list; a single one may end with the separator."""
    first, *others = text.split(separator)
    return [first] if [other.strip() for other in others] == [""] else [first, *others]


def text_of(value: Any, options: Sequence[Schema]) -> str:
    """Return a value as the text of a cell of a key that takes these forms."""
    if isinstance(value, list):
        separator = " |" if any(isinstance(item, list) for item in value) else ";"
        text = f"{separator} ".join(text_of(item, options) for item in value)
        alone = len(value) == 1 and value_of(text, "", options) != value
        return text + separator if alone else text
    if isinstance(value, bool):
        return str(value).lower()
    return value if isinstance(value, str) else repr(value)


def with_common_unit(values: Sequence[Any]) -> tuple[str, list[Any]]:
    """Return the unit that all values share, and the values without it; else no unit."""
    units = {unit for value in values for unit in _units(value)}
    if len(units) != 1 or units & {"", NO_UNIT}:
        return "", list(values)
    (unit,) = units
    if HEAD.fullmatch(f"x [{unit}]") is None:
        return "", list(values)
    return unit, [_without(value) for value in values]


def _units(value: Any) -> Iterator[str]:
    if isinstance(value, list):
        for item in value:
            yield from _units(item)
    else:
        found = QUANTITY.fullmatch(value) if isinstance(value, str) else None
        yield found[2] if found else ""


def _without(value: Any) -> Any:
    if isinstance(value, list):
        return [_without(item) for item in value]
    found = QUANTITY.fullmatch(value)
    return found[1] if found else value
