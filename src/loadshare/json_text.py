"""Documents as JSON text that people can read."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

_HOLDING = dict, list, tuple


def json_text(document: Mapping[str, Any]) -> str:
    """Return a document of plain data as text: what holds nothing that holds more is one line.

    Raises
    ------
    ValueError
        If a number is infinite or none, which JSON does not know.
    """
    import json

    on_one_line = json.JSONEncoder(ensure_ascii=False, allow_nan=False).encode
    return _laid_out(document, "\n", on_one_line) + "\n"


def _laid_out(value: Any, line: str, on_one_line: Callable[[Any], str]) -> str:
    """Return the text of a value; `line` begins a line of it."""
    inner = value.values() if isinstance(value, dict) else value
    if not isinstance(value, _HOLDING) or not any(isinstance(v, _HOLDING) for v in inner):
        return on_one_line(value)
    inside = line + " "
    texts = [_laid_out(v, inside, on_one_line) for v in inner]
    begin, end = "[]"
    if isinstance(value, dict):
        keys = [on_one_line(str(key)) for key in value]
        texts = [f"{key}: {text}" for key, text in zip(keys, texts, strict=True)]
        begin, end = "{}"
    return begin + ",".join(inside + text for text in texts) + line + end
