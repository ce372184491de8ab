"""The JSON Schema of a case file, for editors, and for the case reference."""

from __future__ import annotations

from typing import Any

from loadshare.case.content import Content
from loadshare.case.described import schema_of

DIALECT = "https://json-schema.org/draft/2020-12/schema"

# What else a file may say: it is gone once the file is read.
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


def case_schema() -> dict[str, Any]:
    """Return the JSON Schema of a case file.

    A file that extends another may leave out what it inherits; the merged content must hold all.

    Returns
    -------
    dict
        A schema of draft 2020-12; every key has a one-line description with its unit.
    """
    schema: dict[str, Any] = _without_null(schema_of(Content, by_alias=True))
    schema["properties"] = {**FILE_KEYS, **schema["properties"]}
    required = schema.pop("required")
    inherits = {"required": ["extends"]}
    return {
        "$schema": DIALECT,
        **schema,
        "title": "Case",
        "if": {"not": inherits},
        "then": {"required": required},
    }


def _without_null(schema: Any) -> Any:
    """Return a schema without null, which TOML cannot say, and titles that repeat the key."""
    if isinstance(schema, list):
        return [_without_null(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    if set(schema) == {"text", "si"}:
        # A default, which pydantic shows as the value object that it is.
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
        # The field's own description goes before that of its type.
        return {**options[0], **kept}
    return {**kept, "anyOf": options} if options else kept
