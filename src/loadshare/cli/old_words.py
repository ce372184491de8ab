"""Options of earlier versions: each still works, and a note gives its new name."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from pathlib import Path

from loadshare.cli.options import OVER

SET = "--set"
OLD = {
    "--with": (SET, ""),
    "--unknown": (OVER, ""),
    "--netcdf": ("-o", "nc:"),
    "--csv": ("-o", "csv:"),
    "--json": ("-o", "json:"),
    "--tables": ("-o", "folder:"),
}
"""Options that have a new name, and the prefix that their values now take."""
OF = {"--unknown": ("fit",)} | dict.fromkeys(("--netcdf", "--csv", "--json", "--tables"), ("run",))
"""Commands that had these options; the options not named here belonged to all commands."""


def renewed(command: str, words: Sequence[str]) -> tuple[list[str], list[str]]:
    """Return the words of a command line in their present form, and a note on every old one.

    Parameters
    ----------
    command : str
        Name of the command.
    words : sequence of str
        The words after it.
    """
    grids = command == "sweep" and not any(_name(word) == OVER for word in words)
    has_case = bool(words) and not words[0].startswith("-")
    made: list[str] = []
    notes: dict[str, None] = {}
    left = deque(words)
    while left:
        word = left.popleft()
        if word == "--":
            return [*made, word, *left], list(notes)
        name, equals, value = word.partition("=")
        if grids and name == SET:
            new, before = OVER, ""
        elif name in OLD and command in OF.get(name, (command,)):
            new, before = OLD[name]
        else:
            made.append(word)
            continue
        if (
            not equals
            and name == "--json"
            and not _is_file(left[0] if left else None, has_case=has_case)
        ):
            # A switch: the result goes to standard output.
            made.append(word)
            continue
        if not equals and not left:
            return [*made, new], list(notes)
        value = value if equals else left.popleft()
        if before == "folder:" and value.lower().endswith(".xlsx"):
            before = "xlsx:"
        made += [new, before + value]
        notes[_note(name, new, before)] = None
    return made, list(notes)


def _note(name: str, new: str, before: str) -> str:
    if before == "folder:":
        return f"{name} FOLDER is now -o FOLDER/ or -o {before}FOLDER."
    if before:
        ending = before[:-1]
        return (
            f"{name} FILE is now -o FILE.{ending}, or -o {ending}:FILE for a file with another "
            "ending."
        )
    if name == SET:
        return (
            f"the grid of a sweep is now written {OVER} KEY=GRID, and {SET} changes the case as it "
            "does everywhere."
        )
    return f"{name} is now {new}."


def _name(word: str) -> str:
    return word.partition("=")[0]


def _is_file(word: str | None, *, has_case: bool) -> bool:
    """Return whether the word after ``--json`` names a file to write, as in earlier versions.

    If the case has not been named yet, an existing file is the case, unless it is JSON.
    """
    if word is None or (word.startswith("-") and word != "-"):
        return False
    if has_case or Path(word).suffix == ".json":
        return True
    return not Path(word).exists() and Path(word).suffix != ".toml"
