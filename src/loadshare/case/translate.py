"""pydantic's findings in our own words."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pydantic_core import ErrorDetails

from loadshare.case.element import MARK, Element
from loadshare.case.keys import Path
from loadshare.case.words import choices, count, did_you_mean


@dataclass(frozen=True)
class Finding:
    """What is wrong at one key of an element."""

    path: Path
    message: str
    allowed: str = ""
    hint: str = ""


# What each kind of finding is called; the braces are filled from pydantic's context.
WANTED = {
    "string_type": "a text",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "float_type": "a number",
    "finite_number": "a finite number",
    "bool_type": "true or false",
    "dict_type": "a table",
    "model_type": "a table",
    "model_attributes_type": "a table",
    "tuple_type": "a list",
    "greater_than": "a number above {gt:g}",
    "greater_than_equal": "a number of at least {ge:g}",
    "less_than": "a number below {lt:g}",
    "less_than_equal": "a number of at most {le:g}",
    "too_short": "a list of at least {min_length}",
    "too_long": "a list of at most {max_length}",
}


def translate(error: ErrorDetails, model: type[Element]) -> Finding:
    """Return one of pydantic's findings in our own words.

    Parameters
    ----------
    error : pydantic_core.ErrorDetails
        The finding.
    model : type
        The element on which it was made.

    Returns
    -------
    Finding
        The same, for the user.
    """
    path = tuple(step for step in error["loc"] if not str(step).startswith(MARK))
    kind, context = error["type"], error.get("ctx", {})
    if kind == "said":
        return Finding(path, context["said"], context["allowed"], context["hint"])
    if kind == "extra_forbidden":
        keys = _keys(model, path[:-1])
        return Finding(path, "unknown key", choices(sorted(keys)), did_you_mean(path[-1], keys))
    if kind == "missing" and isinstance(path[-1], int):
        return Finding(path[:-1], f"has {count(path[-1])}, more are needed")
    if kind == "missing":
        described = _describe(model, path)
        return Finding(path, "is missing", hint=described)
    if kind == "literal_error":
        words = context["expected"].replace(" or ", ", ").replace("'", "").split(", ")
        hint = did_you_mean(error["input"], words)
        return Finding(path, "is not one of the words that can stand here", choices(words), hint)
    if kind == "shape":
        return Finding(path, "is not of a form that can stand here", error["msg"])
    wanted = WANTED.get(kind, "another value").format_map(context)
    return Finding(path, "cannot stand here", wanted)


def _keys(model: type[Element], path: Path) -> list[str]:
    properties = _table(model, path).get("properties", {})
    return list(properties)


def _describe(model: type[Element], path: Path) -> str:
    field = _table(model, path[:-1]).get("properties", {}).get(path[-1], {})
    return str(field.get("description", "")).split("\n")[0]


def _table(model: type[Element], path: Path) -> Mapping[str, Any]:
    """Return the part of an element's schema in which the last step of a path was looked for."""
    schema = model.model_json_schema()
    table: Mapping[str, Any] = schema
    for step in path:
        inner = table.get("properties", {}).get(step, {})
        table = next(
            (
                schema["$defs"][option["$ref"].rpartition("/")[2]]
                for option in _options(inner)
                if "$ref" in option
            ),
            {},
        )
    return table


def _options(schema: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    found = [schema]
    for key in ("anyOf", "oneOf"):
        for option in schema.get(key, ()):
            found += _options(option)
    return found
