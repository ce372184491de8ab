"""Inputs that led to a fault, kept and tried again in every run."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

from tests.fuzz.trial import CASES, tried

CORPUS = Path(__file__).with_name("corpus")
"""Folder with one subfolder for each input: its original files and `command.json`."""
COMMAND = "command.json"


def keep(name: str, kind: str, words: tuple[str, ...], folder: Path) -> Path:
    """Keep an input under a name; return its folder.

    Parameters
    ----------
    name : str
    kind : str
        A key of `tests.fuzz.trial.KINDS`.
    words : tuple of str
        The command.
    folder : pathlib.Path
        Folder with its files.
    """
    kept = CORPUS / name
    kept.mkdir(parents=True, exist_ok=True)
    for file in folder.rglob("*"):
        # Shipped files are not kept; they are copied next to it again.
        if file.is_file() and not _is_shipped(file):
            _copy(file, kept / file.relative_to(folder))
    marked = [w.replace(str(folder), "{folder}").replace(str(CASES), "{cases}") for w in words]
    command = {"kind": kind, "words": marked}
    (kept / COMMAND).write_text(json.dumps(command, indent=1) + "\n", encoding="utf-8")
    return kept


def _copy(file: Path, to: Path) -> None:
    to.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(file, to)


def _is_shipped(file: Path) -> bool:
    content = file.read_bytes()
    return any(one.read_bytes() == content for one in CASES.rglob(file.name))


def retried(kept: Path, folder: Path) -> str:
    """Try a kept input in an empty folder; return the fault."""
    for file in CASES.glob("*/*.toml"):
        _copy(file, folder / file.name)
    for file in kept.rglob("*"):
        if file.is_file():
            _copy(file, folder / file.relative_to(kept))
    command = json.loads((folder / COMMAND).read_text(encoding="utf-8"))
    # Not by format(), because arguments may contain braces of their own.
    words = (
        word.replace("{folder}", str(folder)).replace("{cases}", str(CASES))
        for word in command["words"]
    )
    return tried(command["kind"], tuple(words), folder)[1]
