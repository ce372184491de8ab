"""Documents as JSON text that people can read."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

_on_one_line = json.JSONEncoder(ensure_ascii=False, allow_nan=False).encode
_HOLDING = dict, list, tuple


def json_text(document: Mapping[str, Any]) -> str:
    """Return a document of plain data as text: what holds nothing that holds more is one line.

    Raises
    ------
    ValueError
        If a number is infinite or none, which JSON does not know.
    """
    return _laid_out(document, "\n") + "\n"


def _laid_out(value: Any, line: str) -> str:
    """Return the text of a value; `line` begins a line of it."""
    inner = value.values() if isinstance(value, dict) else value
    if not isinstance(value, _HOLDING) or not any(isinstance(v, _HOLDING) for v in inner):
        return _on_one_line(value)
    inside = line + " "
    if isinstance(value, dict):
        pairs = ((_on_one_line(str(key)), _laid_out(v, inside)) for key, v in value.items())
        return "{" + ",".join(f"{inside}{key}: {text}" for key, text in pairs) + line + "}"
    return "[" + ",".join(inside + _laid_out(v, inside) for v in value) + line + "]"
