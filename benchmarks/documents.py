"""Reading and writing the evidence: figures as JSON, reports as Markdown."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any


def write_figures(path: Path, content: dict[str, Any]) -> None:
    """Write figures as JSON; non-finite numbers become null."""
    text = json.dumps(_plain(content), indent=1, ensure_ascii=False, allow_nan=False)
    path.write_text(text + "\n", encoding="utf-8")


def read_figures(path: Path) -> dict[str, Any]:
    """Read figures that `write_figures` wrote."""
    found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return found


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {k: _plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(v) for v in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
