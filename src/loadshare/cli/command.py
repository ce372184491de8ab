"""How every command reads its arguments, and how it ends when it is stopped."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextvars import copy_context
from functools import cache
from pathlib import Path
from typing import Any

import typer
from typer._click.exceptions import NoSuchOption, UsageError
from typer.core import TyperCommand, TyperGroup

from loadshare.cli.console import begin, print_note, under_way
from loadshare.cli.exits import fail
from loadshare.cli.files import ask_for, kept
from loadshare.cli.forms import Output
from loadshare.cli.old_words import renewed
from loadshare.cli.options import OUTPUT
from loadshare.cli.stop import Stop
from loadshare.cli.waiting import hush, waiting
from loadshare.output import STANDARD, clear

PREFIX = "Value error, "
"""Prefix of messages from pydantic, which reads options for typer."""


class Command(TyperCommand):
    """A command that reports what is wrong with an option in plain words."""

    def main(self, *args: Any, **kwargs: Any) -> Any:
        """Run a command in its own context: what it notes (outputs, ``--quiet``) ends with it."""
        return copy_context().run(super().main, *args, **kwargs)

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
            # The parser empties its list.
            left = super().parse_args(ctx, list(words))
        except typer.BadParameter as error:
            error.message = error.message.removeprefix(PREFIX)
            raise
        except NoSuchOption as error:
            _tell_takers(ctx, error)
            raise
        if ctx.resilient_parsing:
            # The shell asks for completions: nothing is done.
            return left
        self._refuse_empty(ctx, words)
        machine = bool(ctx.params.get("json"))
        if machine and "file" in ctx.params:
            _add_json(ctx)
        hush(machine or bool(ctx.params.get("quiet")))
        for note in notes:
            print_note(note)
        outputs = [
            (p.opts[-1], file)
            for p in self.params
            if p.metavar == OUTPUT
            for file in _files(ctx.params.get(p.name))
        ]
        ask_for(outputs)
        clear(file for _, file in outputs if file != STANDARD)
        return left

    def _refuse_empty(self, ctx: Any, words: list[str]) -> None:
        """Refuse an empty text for a file or folder, which would mean the current folder.

        Raises
        ------
        typer.BadParameter
            For the first one.
        """
        given, _, _ = self.make_parser(ctx).parse_args(args=list(words))
        for param in ctx.command.params:
            texts, paths = given.get(param.name), _files(ctx.params.get(param.name))
            if any(isinstance(path, Path) for path in paths) and "" in _several(texts):
                message = "an empty text is not a file name; is a shell variable not set?"
                raise typer.BadParameter(message, ctx, param)

    def invoke(self, ctx: Any) -> Any:
        """Do what was asked; if it is stopped, say what is kept and how to continue.

        Raises
        ------
        typer.Exit
            With 130 after Ctrl-C and 143 after SIGTERM.
        """
        begin()
        stop = Stop()
        try:
            with stop, waiting():
                return super().invoke(ctx)
        except KeyboardInterrupt:
            fail([f"Interrupted{under_way()}. {kept()}"], stop.code)


class Commands(Mapping[str, Any]):
    """Commands by their names, each built when it is needed.

    Building all of them takes longer than printing the help.

    Parameters
    ----------
    make : callable
        Returns a command.
    helps : mapping of str to str
        Help text of each.
    """

    def __init__(self, make: Callable[[str], Any], helps: Mapping[str, str]) -> None:
        self._made, self.helps = cache(make), helps

    def __getitem__(self, name: str) -> Any:
        if name not in self.helps:
            raise KeyError(name)
        return self._made(name)

    def __iter__(self) -> Iterator[str]:
        return iter(self.helps)

    def __len__(self) -> int:
        return len(self.helps)


class Group(TyperGroup):
    """The group of all commands; for an unknown word it suggests the intended one."""

    commands: Commands  # type: ignore[assignment]

    def main(self, *args: Any, **kwargs: Any) -> Any:
        """Run a command in its own context: what it notes (outputs, ``--quiet``) ends with it."""
        return copy_context().run(super().main, *args, **kwargs)

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the names of all commands, in the order of the help."""
        return list(self.commands)

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the commands' names and what they do, without building any."""
        limit = formatter.width - 6 - max(map(len, self.commands))
        helps = self.commands.helps.items()
        rows = [(n, TyperCommand(n, help=h).get_short_help_str(limit)) for n, h in helps]
        with formatter.section("Commands"):
            formatter.write_dl(rows)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Find the command that the first word names.

        Raises
        ------
        UsageError
            If there is none; the message names one that is similar or does what the word says.
        """
        word = args[0]
        if self.get_command(ctx, word) is not None or word.startswith("-"):
            return super().resolve_command(ctx, args)
        from loadshare.case.words import did_you_mean

        hint = did_you_mean(word, [*self.commands, *OTHER_NAMES])
        for other, name in OTHER_NAMES.items():
            hint = hint.replace(f" {other}?", f" {name}?")
        if not hint and Path(word).suffix == ".toml":
            hint = f"To solve a case: loadshare run {word}"
        raise UsageError(f"No such command {word!r}. {hint}".strip(), ctx)


OTHER_NAMES = {
    **dict.fromkeys(("solve", "simulate", "calculate"), "run"),
    **dict.fromkeys(("validate", "verify", "lint"), "check"),
    **dict.fromkeys(("init", "create"), "new"),
    **dict.fromkeys(("optimize", "optimise", "vary"), "sweep"),
    "plot": "draw",
    "convert": "import",
    "montecarlo": "tolerance",
    "help": "--help",
}
"""Names by which users may look for commands that have another name."""


def _tell_takers(ctx: Any, error: NoSuchOption) -> None:
    """Add to the error of an unknown option which commands take it, or a similar option."""
    from loadshare.case.words import did_you_mean

    commands = ctx.parent.command.commands.values() if ctx.parent else ()
    takers = [one.name for one in commands for p in one.params if error.option_name in p.opts]
    own = [name for p in ctx.command.params for name in p.opts if name.startswith("--")]
    near = did_you_mean(error.option_name, own)
    error.possibilities = ()
    more = f"It is an option of {', '.join(takers)}." if takers else near
    error.message = f"{error.message}. {more}".strip()


def _add_json(ctx: Any) -> None:
    """Add JSON on standard output to the files that are asked for.

    Raises
    ------
    typer.BadParameter
        If another file goes to standard output.
    """
    others = ctx.params["file"] or []
    if any(output.file == STANDARD for output in others):
        raise typer.BadParameter("only one file can go to standard output", param_hint="--json")
    ctx.params["file"] = [*others, Output("json", STANDARD)]


def _files(given: Any) -> list[Any]:
    """Return the paths of an option for files: none, one or several."""
    return [getattr(one, "file", one) for one in _several(given) if one is not None]


def _several(given: Any) -> list[Any]:
    return list(given) if isinstance(given, list | tuple) else [given]
