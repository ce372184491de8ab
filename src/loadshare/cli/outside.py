"""The option by which a command reads cases that name files outside of their folder."""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable
from functools import wraps
from typing import Annotated, Any

import typer

from loadshare.outside import OUTSIDE

AllowOutside = Annotated[
    bool, typer.Option("--allow-outside", help="Let cases name files outside of their folder.")
]
NAME = "allow_outside"


def reads_cases(command: Callable[..., None]) -> Callable[..., None]:
    """Return a command with the option ``--allow-outside``."""

    @wraps(command)
    def with_option(*given: Any, allow_outside: bool = False, **named: Any) -> None:
        before = os.environ.get(OUTSIDE)
        if allow_outside:
            # Worker processes inherit it.
            os.environ[OUTSIDE] = "1"
        try:
            command(*given, **named)
        finally:
            if allow_outside:
                os.environ.pop(OUTSIDE)
                os.environ |= {} if before is None else {OUTSIDE: before}

    own = inspect.signature(command, eval_str=True)
    option = inspect.Parameter(
        NAME, inspect.Parameter.KEYWORD_ONLY, default=False, annotation=AllowOutside
    )
    with_option.__signature__ = own.replace(  # type: ignore[attr-defined]
        parameters=[*own.parameters.values(), option]
    )
    return with_option
