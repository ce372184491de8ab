"""How a command ends when it cannot do what was asked."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NoReturn

import typer

from loadshare.errors import CaseError

REFUSED = 1
"""An answer was refused, or one case of many failed."""
UNUSABLE = 2
"""The case is invalid, the command was used wrongly, or a file cannot be read or written."""
INTERRUPTED = 130
"""Stopped from the keyboard, as shells count it."""
TERMINATED = 143
"""Stopped by SIGTERM, as shells count it."""


def fail(lines: Iterable[str], code: int) -> NoReturn:
    """Write lines to stderr and leave with an exit code.

    Raises
    ------
    typer.Exit
        Always.
    """
    for line in lines:
        typer.echo(line, err=True)
    raise typer.Exit(code)


def counted(number: int, noun: str) -> str:
    """Return a number of things in words: ``1 problem``, ``2 problems``."""
    return f"{number} {noun}" + ("" if number == 1 else "s")


@contextmanager
def problems_told() -> Iterator[None]:
    """Turn an invalid case into its list of problems, one per line and their count last."""
    try:
        yield
    except CaseError as error:
        told = [str(problem) for problem in error.problems]
        fail([*told, f"{counted(len(told), 'problem')}; nothing was solved."], UNUSABLE)


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Turn a file that cannot be written into a message."""
    try:
        yield
    except OSError as error:
        fail([f"{path}: cannot be written: {error.strerror or error}"], UNUSABLE)
