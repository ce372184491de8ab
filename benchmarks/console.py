"""Shared parts of the commands that publish: their options, and a line per step."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from loadshare.cli.command import Command

EVIDENCE = Path("docs/evidence")
SHIPPED = Path("cases")
Folder = Annotated[
    Path,
    typer.Option("-o", "--output", metavar="DIR", file_okay=False, help="Folder to write to."),
]
Cases = Annotated[Path, typer.Option("--cases", metavar="DIR", help="Folder of the shipped cases.")]
Quiet = Annotated[bool, typer.Option("--quiet", help="Do not report steps.")]


def application(command: Callable[..., Any]) -> typer.Typer:
    """Return an application with one command."""
    app = typer.Typer(
        rich_markup_mode=None,
        pretty_exceptions_enable=False,
        add_completion=False,
        context_settings={"help_option_names": ["-h", "--help"]},
    )
    app.command(cls=Command)(command)
    return app


def teller(quiet: bool) -> Callable[[str], None]:
    """Return a function that reports each step on stderr, or does nothing."""
    return (lambda _: None) if quiet else (lambda step: typer.echo(step, err=True))
