"""The JSON Schema of a case file, for editors, and for the case reference."""

from __future__ import annotations

from typing import Any

from loadshare.case.content import Content
from loadshare.case.described import schema_of

DIALECT = "https://json-schema.org/draft/2020-12/schema"

# Keys that only files have: they are resolved when the file is read.
FILE_KEYS: dict[str, Any] = {
    "extends": {
        "type": "string",
        "description": "Case file to inherit from, relative to this one.",
        "examples": ["base.toml"],
    },
    "remove": {
        "type": "array",
        "items": {"type": "string"},
        "description": "Key paths to drop from what is inherited.",
        "examples": [["errors.6"]],
    },
}


WHOLE = "whole"
"""Definition, within that of a table, of what the table must have if it inherits nothing."""


def case_schema() -> dict[str, Any]:
    """Return the JSON Schema of a case file.

    A file that extends another may leave out what it inherits, and a single copy of an element
    what all copies share; the merged content must hold all.

    Returns
    -------
    dict
        A schema of draft 2020-12; every key has a one-line description with its unit. What a table
        must have is in its ``$defs``, under ``whole``.
    """
    schema: dict[str, Any] = _without_null(schema_of(Content, by_alias=True))
    schema["properties"] = {**FILE_KEYS, **schema["properties"]}
    required = schema.pop("required")
    inherits = {"required": ["extends"]}
    one = {"additionalProperties": {"not": {"required": ["copies"]}}}
    return {
        "$schema": DIALECT,
        **schema,
        "title": "Case",
        "if": {"not": inherits},
        "then": {
            "required": required,
            "if": {"properties": {"gears": one}},
            "then": _demands(schema, schema["$defs"]),
        },
    }


def _demands(schema: dict[str, Any], tables: dict[str, Any]) -> dict[str, Any]:
    """Return the required keys of the tables in a value, moved out of their definitions.

    Lists are given whole, whatever is inherited: tables in them keep their required keys.
    """
    if "$ref" in schema:
        name = schema["$ref"].rpartition("/")[2]
        table = tables[name]
        if WHOLE not in table.get("$defs", {}):
            must = {"required": table.pop("required")} if "required" in table else {}
            must |= _demands(table, tables)
            if must:
                table["$defs"] = {WHOLE: must}
        return {"$ref": f"#/$defs/{name}/$defs/{WHOLE}"} if "$defs" in table else {}
    options = schema.get("oneOf") or schema.get("anyOf") or ()
    each = [_demands(option, tables) for option in options]
    if any(each):
        kinds = ({"type": option.get("type", "object")} for option in options)
        return {"anyOf": [own or kind for own, kind in zip(each, kinds, strict=True)]}
    below = schema.get("properties", {})
    found = {key: must for key, value in below.items() if (must := _demands(value, tables))}
    by_name = schema.get("additionalProperties")
    if isinstance(by_name, dict) and (must := _demands(by_name, tables)):
        return {"additionalProperties": must}
    return {"properties": found} if found else {}


def _without_null(schema: Any) -> Any:
    """Return a schema without null, which TOML does not have, and titles that repeat the key."""
    if isinstance(schema, list):
        return [_without_null(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    if set(schema) == {"text", "si"}:
        # A default: pydantic shows the value object with its attributes.
        return schema["text"]
    kept = {
        key: _without_null(value)
        for key, value in schema.items()
        if not (key == "title" and isinstance(value, str))
        and not (key == "default" and value is None)
    }
    options = [option for option in kept.get("anyOf", ()) if option != {"type": "null"}]
    if len(options) == 1:
        del kept["anyOf"]
        # The field's own description takes precedence over that of its type.
        return {**options[0], **kept}
    return {**kept, "anyOf": options} if options else kept
