"""Converts a picture: specification, form and settings on standard input, the file on output."""

from __future__ import annotations

import json
import sys
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, cast

if TYPE_CHECKING:
    from loadshare.report.figure import Figure


def _draw() -> None:
    from loadshare.report.figure import Figure

    spec, form, how = json.load(sys.stdin)
    drawn: Any = Figure._converted(cast("Figure", SimpleNamespace(spec=spec)), form, **how)
    sys.stdout.buffer.write(drawn.encode() if isinstance(drawn, str) else drawn)


if __name__ == "__main__":
    _draw()
