"""`loadshare schema`: the JSON Schema of a case file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from loadshare.cli.files import save_text, tell_written
from loadshare.cli.options import output
from loadshare.cli.waiting import echo


def schema(
    file: Annotated[Path | None, output(what="Write it to a file instead of stdout.")] = None,
) -> None:
    """Print the JSON Schema of a case file, for editors."""
    import json

    from loadshare.case import case_schema

    text = json.dumps(case_schema(), indent=2, ensure_ascii=False)
    if file is None:
        echo(text)
        return
    save_text(file, text + "\n")
    tell_written(file, err=True)
