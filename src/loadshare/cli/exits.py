"""How a command ends when it cannot do what was asked."""

from __future__ import annotations

import errno
import math
import os
import re
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, NoReturn

import typer

from loadshare._version import __version__
from loadshare.cli.waiting import echo
from loadshare.errors import CaseError, Problem, Refused
from loadshare.numbers import counted, runs
from loadshare.output import NotWritten

REFUSED = 1
"""An answer was refused, or one case of many failed."""
UNUSABLE = 2
"""The case is invalid, the command was used wrongly, a file cannot be read or written, or memory
does not suffice."""
INTERRUPTED = 130
"""Stopped from the keyboard; the code is that of shells."""
TERMINATED = 143
"""Stopped by SIGTERM; the code is that of shells."""


def fail(lines: Iterable[str], code: int) -> NoReturn:
    """Write lines to stderr and leave with an exit code.

    Raises
    ------
    typer.Exit
        Always.
    """
    for line in lines:
        echo(line, err=True)
    raise typer.Exit(code)


def fail_of(problems: Iterable[Problem], more: str) -> NoReturn:
    """Write problems to stderr, one per line, then their count followed by `more`.

    Raises
    ------
    typer.Exit
        Always.
    """
    lines = list(map(str, problems))
    fail([*lines, f"{counted(len(lines), 'problem')}{more}"], UNUSABLE)


_PLACED = re.compile(r"position (\d+): (.*)")


def refusal_lines(refusal: Refused) -> list[str]:
    """Return the lines of a refusal, positions that were refused for the same reason together."""
    positions: dict[str, list[int]] = {}
    for line in str(refusal).splitlines():
        placed = _PLACED.fullmatch(line)
        reason = placed[2] if placed else line
        positions.setdefault(reason, []).extend([int(placed[1])] if placed else [])
    return [f"{places(at)}: {reason}" if at else reason for reason, at in positions.items()]


def places(positions: list[int]) -> str:
    """Return positions in short: ``positions 1-3, 7``."""
    return f"position{'s' * (len(positions) > 1)} {ranges(positions)}"


def ranges(numbers: list[int]) -> str:
    """Return whole numbers in short: ``1-3, 7``."""
    # A plain hyphen: terminals and logs may know no other dash.
    return ", ".join(runs(numbers, "-"))


def fail_refused(refusal: Refused) -> NoReturn:
    """Write the lines of a refusal to stderr and leave with its code.

    Raises
    ------
    typer.Exit
        Always.
    """
    fail(marked_lines(refusal), REFUSED)


def marked_lines(refusal: Refused) -> list[str]:
    """Return the lines of a refusal, each marked as such."""
    return [f"REFUSED  {line}" for line in refusal_lines(refusal)]


def refused_document(refusal: Refused, case: str) -> dict[str, Any]:
    """Return the JSON form of a refusal: the certified positions, and what was refused and why.

    Parameters
    ----------
    refusal : Refused
    case : str
        Name of the case, for a refusal without any certified position.
    """
    none: dict[str, Any] = {"case": case, "version": __version__, "positions": [], "omega": {}}
    document = none if refusal.partial is None else refusal.partial.to_dict()
    # JSON has no infinity and no NaN; such a figure is written as null.
    figures = {n: v if math.isfinite(v) else None for n, v in refusal.figures.items()}
    return document | {"refused": {"message": str(refusal), "figures": figures}}


@contextmanager
def reporting_problems(done: str = "solved") -> Iterator[None]:
    """Turn problems of a case into lines on stderr, their count and what was not done last."""
    try:
        yield
    except CaseError as error:
        fail_of(error.problems, f"; nothing was {done}.")


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Turn the failure to write a file into a message."""
    try:
        yield
    except OSError as error:
        fail([unwritten_line(path, error)], UNUSABLE)


def unwritten_line(path: Path, error: OSError) -> str:
    """Return the message for a file that could not be written, with its name."""
    # For a folder, the file in it.
    file = error.filename if isinstance(error, NotWritten) else path
    return f"{file}: {unwritten(error)}"


def unwritten(error: OSError) -> str:
    """Return the message for a file that could not be written."""
    return f"cannot be written: {error.strerror or error}"


def out_of_memory(what: str) -> str:
    """Return the message that memory did not suffice, and for what if that is known."""
    more = f" ({what})" if what else ""
    return (
        f"There is not enough memory{more}. Give the process more, or ask for less at a time: "
        "fewer points, samples or processes."
    )


@contextmanager
def reporting_lack_of_room() -> Iterator[None]:
    """Turn a lack of room, on a disk or in memory, into a message and an exit code.

    Raises
    ------
    SystemExit
        With 2, if a file or standard output cannot be written, or memory does not suffice.
    """
    try:
        yield
    except (MemoryError, OSError, ImportError) as error:
        message = _want_of_room(error)
        if message is None:
            raise
        with suppress(OSError):
            echo(message, err=True)
        raise SystemExit(UNUSABLE) from None


NO_ROOM = {"ENOSPC", "EDQUOT", "EFBIG"}
"""Errors of disks, quotas and limits on the size of files; not every system has all of them."""


NOT_MAPPED = ("failed to map segment", "annot allocate memory")
"""Messages of the system about a library that does not fit into memory."""


def _want_of_room(error: MemoryError | OSError | ImportError) -> str | None:
    """Return the message for a lack of room or a failing file, or None for any other error."""
    if isinstance(error, MemoryError):
        return out_of_memory(str(error))
    if isinstance(error, ImportError):
        unmapped = any(text in str(error) for text in NOT_MAPPED)
        return out_of_memory("a library could not be loaded") if unmapped else None
    if error.errno == errno.ENOMEM:
        return out_of_memory(str(error))
    if isinstance(error, NotWritten):
        return f"{error.filename}: {unwritten(error)}"
    if error.filename is not None:
        why = (error.strerror or str(error)).lower()
        return f"{error.filename}: cannot be read or written: {why}"
    if errno.errorcode.get(error.errno or 0) not in NO_ROOM:
        return None
    _let_go()
    return f"{error.filename or 'standard output'}: {unwritten(error)}"


def _let_go() -> None:
    """Discard what waits to be printed: on exit, Python would try again and report a failure."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
