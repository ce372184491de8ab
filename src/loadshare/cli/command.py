"""How every command reads its words, and how it ends when it is stopped."""

from __future__ import annotations

from typing import Any

import typer
from typer.core import TyperCommand

from loadshare.cli.console import begin, tell_note, under_way
from loadshare.cli.exits import fail
from loadshare.cli.files import ask_for, kept
from loadshare.cli.forms import Output
from loadshare.cli.old_words import renewed
from loadshare.cli.options import OUTPUT
from loadshare.cli.quiet import hush
from loadshare.cli.stop import Stop
from loadshare.output import STANDARD, clear

PREFIX = "Value error, "
"""What pydantic, which reads options for typer, puts before a message."""


class Command(TyperCommand):
    """A command that tells what is wrong with an option in plain words."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Read the words of the command line.

        Raises
        ------
        typer.BadParameter
            If one of them cannot be used.
        """
        words, notes = renewed(self.name or "", args)
        if ctx.resilient_parsing and words and words[-1].startswith("-"):
            # The shell asks for the value of this option; without one, no argument would be read.
            words = words[:-1]
        try:
            left = super().parse_args(ctx, words)
        except typer.BadParameter as error:
            error.message = error.message.removeprefix(PREFIX)
            raise
        if ctx.resilient_parsing:
            # The shell asks what may follow: nothing is done.
            return left
        machine = bool(ctx.params.get("json"))
        if machine and "file" in ctx.params:
            _add_json(ctx)
        hush(machine or bool(ctx.params.get("quiet")))
        for note in notes:
            tell_note(note)
        asked = [
            (p.opts[-1], file)
            for p in self.params
            if p.metavar == OUTPUT
            for file in _files(ctx.params.get(p.name))
        ]
        ask_for(asked)
        clear(file for _, file in asked if file != STANDARD)
        return left

    def invoke(self, ctx: Any) -> Any:
        """Do what was asked; one who stops it is told what is kept, and how to go on.

        Raises
        ------
        typer.Exit
            With 130 after Ctrl-C and 143 after SIGTERM.
        """
        begin()
        stop = Stop()
        try:
            with stop:
                return super().invoke(ctx)
        except KeyboardInterrupt:
            fail([f"Interrupted{under_way()}. {kept()}"], stop.code)


def _add_json(ctx: Any) -> None:
    """Add JSON on standard output to the files that are asked for.

    Raises
    ------
    typer.BadParameter
        If another file goes there.
    """
    others = ctx.params["file"] or []
    if any(output.file == STANDARD for output in others):
        raise typer.BadParameter("standard output takes one file only", param_hint="--json")
    ctx.params["file"] = [*others, Output("json", STANDARD)]


def _files(given: Any) -> list[Any]:
    """Return the paths of an option for files: none, one or several."""
    several = given if isinstance(given, list) else [given]
    return [getattr(one, "file", one) for one in several if one is not None]
