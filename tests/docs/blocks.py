"""Code blocks of Markdown pages: found, run as a reader would, compared with what the page shows.

``python tests/docs/blocks.py docs/tutorial.md …`` runs the blocks of the pages and writes what they
print into them.

Output is compared word by word, ignoring white space. Numbers must agree to a relative 1e-6.
Figures below 1e-9 are round-off: any two of them are equal, and the text after one in its line (the
place where it was found) is not compared. A line of the page that is a single … stands for any
number of lines, a word … for the rest of its line.
"""

from __future__ import annotations

import contextlib
import io
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
RELATIVE = 1e-6
ROUND_OFF = 1e-9
_FENCE = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_NUMBER = re.compile(r"[+\-−]?(?:\d+\.?\d*|\.\d+)(?:[eE][+\-]?\d+)?")


@dataclass(frozen=True)
class Block:
    """A fenced block: its language, its text, and the position of the text in the page."""

    language: str
    text: str
    start: int
    end: int


def blocks_of(page: str) -> list[Block]:
    return [Block(m[1], m[2], m.start(2), m.end(2)) for m in _FENCE.finditer(page)]


@contextlib.contextmanager
def workplace() -> Iterator[Path]:
    """Work in a temporary folder with a copy of the cases, in which `loadshare` is a command."""
    here = Path.cwd()
    path, width = os.environ["PATH"], os.environ.get("COLUMNS")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        shutil.copytree(ROOT / "cases", folder / "cases")
        commands = folder / ".bin"
        commands.mkdir()
        source = Path(__import__("loadshare").__file__).parents[1]
        for command, words in (("loadshare", "-m loadshare.cli.main"), ("python3", "")):
            shim = commands / command
            shim.write_text(
                f'#!/bin/sh\nPYTHONPATH="{source}" exec "{sys.executable}" {words} "$@"\n'
            )
            shim.chmod(0o755)
        os.environ["PATH"] = f"{commands}{os.pathsep}{path}"
        os.environ["COLUMNS"] = "90"
        os.chdir(folder)
        try:
            yield folder
        finally:
            os.chdir(here)
            os.environ["PATH"] = path
            os.environ.pop("COLUMNS")
            if width is not None:
                os.environ["COLUMNS"] = width


def run_console(text: str) -> str:
    """Run the commands of a console block and return the block as it should be."""
    parts = []
    for line in text.splitlines():
        if line.startswith("$ "):
            done = subprocess.run(
                line[2:],
                shell=True,
                text=True,
                encoding="utf-8",
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                timeout=120,
                check=False,
            )
            rows = [row.rstrip() for row in done.stdout.rstrip().splitlines()]
            # This is printed once in an installation, by whichever command comes first.
            parts += [line, *(row for row in rows if not row.startswith("Compiling: "))]
    return "\n".join(parts) + "\n"


def run_python(text: str, names: dict[str, Any], place: str) -> str:
    """Run a Python block in `names` and return what it prints."""
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(text, place, "exec"), names)
    return printed.getvalue()


def differences(shown: str, real: str) -> list[str]:
    """Compare what a page shows with what was printed; return what differs, line by line."""
    wanted = [line for line in shown.splitlines() if line.strip()]
    found = [line for line in real.splitlines() if line.strip()]
    while wanted:
        line = wanted.pop(0)
        if line.strip() == "…":
            if not wanted:
                return []
            while found and not same_line(wanted[0], found[0]):
                found.pop(0)
            continue
        if not found:
            return [f"shown, not printed: {line}"]
        actual = found.pop(0)
        if not same_line(line, actual):
            return [f"shown:   {line}", f"printed: {actual}"]
    return [f"printed, not shown: {line}" for line in found]


def same_line(shown: str, real: str) -> bool:
    """Tell whether two lines agree by the rules of this module."""
    # A rule is as long as its table, whose widest word may be the place of round-off.
    wanted, found = (re.sub("─+", "─", line).split() for line in (shown, real))
    for number, word in enumerate(wanted):
        if word == "…":
            return True
        if number >= len(found):
            return False
        other = found[number]
        if _round_off(word) and _round_off(other):
            return True  # where round-off is largest also depends on the computer
        if not _same_word(word, other):
            return False
    return len(wanted) == len(found)


def _round_off(word: str) -> bool:
    value = _value(word.rstrip(","))
    return value is not None and abs(value) < ROUND_OFF and ("e" in word.lower() or word == "0")


def _value(word: str) -> float | None:
    match = _NUMBER.fullmatch(word)
    return float(match[0].replace("−", "-")) if match else None


def _same_word(shown: str, real: str) -> bool:
    if shown == real:
        return True
    if _NUMBER.sub("#", shown) != _NUMBER.sub("#", real):
        return False
    pairs = zip(_NUMBER.findall(shown), _NUMBER.findall(real), strict=True)
    return all(
        math.isclose(
            float(a.replace("−", "-")), float(b.replace("−", "-")), rel_tol=RELATIVE, abs_tol=0.0
        )
        for a, b in pairs
    )


def outcomes(page: str, place: str) -> Iterator[tuple[Block, str]]:
    """Run all blocks of a page in order; yield each block that shows output, and what was printed.

    Python blocks share one namespace. A ``text`` block directly after one contains its output.
    """
    names: dict[str, Any] = {"__name__": "page"}
    printed: str | None = None
    for block in blocks_of(page):
        if block.language == "console":
            yield block, run_console(block.text)
        elif block.language == "python":
            printed = run_python(block.text, names, place)
            continue
        elif block.language == "text" and printed is not None:
            yield block, printed
        printed = None


def rewrite(file: Path) -> None:
    """Write what the blocks print into a page; blocks with a … are left as they are."""
    page = file.read_text(encoding="utf-8")
    parts, at = [], 0
    for block, real in outcomes(page, str(file)):
        text = block.text if "…" in block.text and not differences(block.text, real) else real
        parts += [page[at : block.start], text]
        at = block.end
    file.write_text("".join(parts) + page[at:], encoding="utf-8")


if __name__ == "__main__":
    for argument in [Path(a).resolve() for a in sys.argv[1:]]:
        with workplace():
            rewrite(argument)
