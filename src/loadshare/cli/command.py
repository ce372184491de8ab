"""Commands whose messages speak of the command line, not of what checks it."""

from __future__ import annotations

from typing import Any

import typer
from typer.core import TyperCommand

from loadshare.cli.files import ask_for
from loadshare.cli.options import OUTPUT
from loadshare.output import clear

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
        try:
            left = super().parse_args(ctx, args)
        except typer.BadParameter as error:
            error.message = error.message.removeprefix(PREFIX)
            raise
        named = [(p.opts[-1], ctx.params.get(p.name)) for p in self.params if p.metavar == OUTPUT]
        asked = [(option, file) for option, file in named if file is not None]
        ask_for(asked)
        clear(file for _, file in asked)
        return left
