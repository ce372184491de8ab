"""Documents as readable JSON text."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

_HOLDING = dict, list, tuple


def json_text(document: Mapping[str, Any]) -> str:
    """Return a document of plain data as text, with every innermost list or table on one line.

    Raises
    ------
    ValueError
        If a number is infinite or NaN, which JSON cannot represent.
    """
    import json

    on_one_line = json.JSONEncoder(ensure_ascii=False, allow_nan=False).encode
    return _laid_out(document, "\n", on_one_line, cache(on_one_line)) + "\n"


def _laid_out(
    value: Any, line: str, on_one_line: Callable[[Any], str], quoted: Callable[[str], str]
) -> str:
    """Return the text of a list or table; `line` is the line end and indent before its lines."""
    inner = value.values() if isinstance(value, dict) else value
    for part in inner:
        if isinstance(part, _HOLDING):
            break
    else:
        return on_one_line(value)
    inside = line + " "
    texts = [
        _laid_out(part, inside, on_one_line, quoted)
        if isinstance(part, _HOLDING)
        else on_one_line(part)
        for part in inner
    ]
    begin, end = "[]"
    if isinstance(value, dict):
        texts = [f"{quoted(str(key))}: {text}" for key, text in zip(value, texts, strict=True)]
        begin, end = "{}"
    return begin + inside + f",{inside}".join(texts) + line + end
