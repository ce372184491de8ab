"""Files that commands write, and those that they must not write over."""

from __future__ import annotations

from collections.abc import Iterable
from contextvars import ContextVar
from pathlib import Path

import typer

from loadshare.cli.exits import writing
from loadshare.cli.waiting import echo, is_hushed
from loadshare.output import STANDARD, write_whole


def save_text(path: Path, text: str) -> None:
    """Write a text file that was asked for; one that cannot be written becomes a message."""
    with writing(path):
        write_whole(path, text)


def print_written(file: Path, more: str = "", *, err: bool = False) -> None:
    """Report which file was written, and more; nothing if it was stdout."""
    if file == STANDARD:
        return
    _written.set((*_written.get(), file))
    if not is_hushed():
        echo(f"Wrote {file}{more}", err=err)


_written: ContextVar[tuple[Path, ...]] = ContextVar("written", default=())


def kept() -> str:
    """Return a sentence on what a stopped command leaves behind, and how to go on."""
    files = ", ".join(map(str, _written.get()))
    what = f"Kept: {files}." if files else "Nothing is kept."
    return f"{what} The same command starts from the beginning."


_outputs: ContextVar[tuple[tuple[str, Path], ...]] = ContextVar("outputs", default=())


def ask_for(outputs: Iterable[tuple[str, Path]]) -> None:
    """Note which files the current command is to write, by the names of their options."""
    _outputs.set(tuple(outputs))
    _written.set(())


def is_stdout_taken() -> bool:
    """Return whether a file goes to stdout."""
    return any(file == STANDARD for _, file in _outputs.get())


def keep_inputs(read: Iterable[Path], written: Iterable[tuple[str, Path]] = ()) -> None:
    """Refuse to write over an input file, before any work is done.

    Parameters
    ----------
    read : iterable of Path
    written : iterable of (str, Path)
        Files to be written besides those that were asked for by name, with their options.

    Raises
    ------
    typer.BadParameter
        If a file would be written over; the message names the option and the file.
    """
    outputs = [(option, file) for option, file in (*_outputs.get(), *written) if file.exists()]
    for path in read if outputs else ():
        for option, file in outputs:
            if path.exists() and file.samefile(path):
                raise typer.BadParameter(
                    f"{file}: is read by this command; write to another file", param_hint=option
                )
