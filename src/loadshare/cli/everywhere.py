"""Options that commands take without a word of their own about them."""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from typing import Annotated, Any

import typer

from loadshare.outside import OUTSIDE

Command = Callable[..., None]

Json = Annotated[
    bool,
    typer.Option(
        "--json", help="Print the answer as JSON, for scripts, and nothing else on stdout."
    ),
]
OPTIONS: dict[str, Any] = {
    "json": Json,
    "allow_outside": Annotated[
        bool,
        typer.Option("--allow-outside", help="Allow cases to name files outside their folder."),
    ],
    "quiet": Annotated[
        bool,
        typer.Option("-q", "--quiet", help="Print errors only; files are still written."),
    ],
}
"""By the names of their parameters. `Command` heeds "json" and "quiet"."""


def taking(command: Command, *names: str) -> Command:
    """Return a command with some of the options of this module.

    Parameters
    ----------
    command : callable
    *names : str
        Keys of `OPTIONS`, in the order of the help.
    """

    @wraps(command)
    def with_options(*given: Any, **named: Any) -> None:
        options = {name: named.pop(name, False) for name in names}
        with _outside(options.get("allow_outside", False)):
            command(*given, **named)

    own = inspect.signature(command, eval_str=True)
    more = [
        inspect.Parameter(
            name, inspect.Parameter.KEYWORD_ONLY, default=False, annotation=OPTIONS[name]
        )
        for name in names
    ]
    with_options.__signature__ = own.replace(  # type: ignore[attr-defined]
        parameters=[*own.parameters.values(), *more]
    )
    return with_options


@contextmanager
def _outside(allowed: bool) -> Iterator[None]:
    before = os.environ.get(OUTSIDE)
    if allowed:
        # Worker processes inherit it.
        os.environ[OUTSIDE] = "1"
    try:
        yield
    finally:
        if allowed:
            os.environ.pop(OUTSIDE)
            os.environ |= {} if before is None else {OUTSIDE: before}
