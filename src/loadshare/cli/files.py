"""Texts on disk."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from loadshare.cli.exits import writing


def write_text(path: Path, text: str) -> None:
    """Write a text file, whole or not at all.

    Parameters
    ----------
    path : Path
        Its folder is made.
    text : str
    """
    # Imported late: results bring numpy with them, which --help does not need.
    from loadshare.results.writing import write_atomically

    write_atomically(path, text)


def save_text(path: Path, text: str) -> None:
    """Write a text file that was asked for; one that cannot be written becomes a message."""
    with writing(path):
        write_text(path, text)


def write_document(path: Path, document: dict[str, Any]) -> None:
    """Write plain data as a JSON file, whole or not at all."""
    text = json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False)
    write_text(path, text + "\n")
