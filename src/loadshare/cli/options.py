"""The options that commands share, each described once, and those added to every command."""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import wraps
from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias

import typer

from loadshare.cli.completion import gear_names, key_names, setting_names
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
"""Options by the names of their parameters. `Command` acts on "json" and "quiet"."""


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


# The words are repeated here because taking them from the solver would import it for every --help;
# a test compares them.
SolverName: TypeAlias = Literal["auto", "clarabel", "osqp", "cvxpy"]
MethodName: TypeAlias = Literal["newton", "picard", "power"]


def _tolerance(value: float) -> float:
    # Imported late: it brings numpy with it, which --help does not need.
    from loadshare.certify.tolerance import checked_tolerance

    try:
        return checked_tolerance(value)
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None


Solver = Annotated[
    SolverName,
    typer.Option(metavar="NAME", help="auto (fast method first), clarabel, osqp or cvxpy."),
]
Method = Annotated[
    MethodName,
    typer.Option(metavar="NAME", help="Loop for nonlinear mesh laws: newton, picard or power."),
]
Tolerance = Annotated[
    float,
    typer.Option(
        metavar="X",
        callback=_tolerance,
        help="Largest scaled residual of a certified answer, up to 1e-3.",
    ),
]
CaseFile = Annotated[Path, typer.Argument(metavar="CASE", help="Case file.")]
CasePaths = Annotated[
    list[Path],
    typer.Argument(
        metavar="CASES", help="Case files, folders of them, or patterns.", show_default=False
    ),
]
Changes = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help="Change the case, as in operating.torque='100 N*m'; may be repeated. An empty value "
        "removes the key.",
        autocompletion=setting_names,
    ),
]
Positions = Annotated[
    list[int] | None,
    typer.Option("--position", metavar="K", help="Only this position, from 1; may be repeated."),
]
Gear = Annotated[
    str | None,
    typer.Option(
        metavar="NAME", help="Gear whose revolutions are counted.", autocompletion=gear_names
    ),
]
Force = Annotated[bool, typer.Option("--force", help="Overwrite an existing file.")]
OVER = "--over"


def over(form: str, help_: str) -> Any:
    """Return the option for the inputs that a study varies, ``KEY=`` and what `form` names."""
    return typer.Option(
        OVER, metavar=f"KEY={form}", help=help_, autocompletion=setting_names, show_default=False
    )


def keys(help_: str) -> Any:
    """Return the argument for keys of a case."""
    return typer.Argument(metavar="KEY", help=help_, autocompletion=key_names)


OUTPUT = "FILE"
"""Metavariable of options for a file to write, by which they are recognised."""


def output(what: str) -> Any:
    """Return the option for the one file that a command writes."""
    return typer.Option("-o", "--output", metavar=OUTPUT, dir_okay=False, writable=True, help=what)


def settings_of(given: Iterable[str], form: str) -> dict[tuple[str, ...], str]:
    """Return the value of every ``KEY=VALUE`` or ``KEY=KEY=VALUE``, by its keys.

    Raises
    ------
    typer.BadParameter
        For a text of another form, or if the same keys are given twice: the first would be lost.
    """
    from loadshare.study.parameter import split_outside

    found: dict[tuple[str, ...], str] = {}
    for text in given:
        *names, value = split_outside(text, "=")
        if not names or not all((*names, value)):
            raise typer.BadParameter(f"{text!r} is not of the form {form}", param_hint=OVER)
        if (tied := tuple(names)) in found:
            twice = "=".join(tied)
            raise typer.BadParameter(f"{twice}: is given twice; give it once", param_hint=OVER)
        found[tied] = value
    return found


def ranges_of(given: Iterable[str] | None, form: str) -> dict[tuple[str, ...], tuple[str, str]]:
    """Return the two ends of every range ``KEY=FROM:TO``, by its keys.

    Raises
    ------
    typer.BadParameter
        For a text of another form.
    """
    found = {}
    for names, ends in settings_of(given or (), form).items():
        start, colon, stop = ends.partition(":")
        if not colon or not start.strip() or not stop.strip() or ":" in stop:
            text = "=".join((*names, ends))
            raise typer.BadParameter(f"{text!r} is not of the form {form}", param_hint=OVER)
        found[names] = start.strip(), stop.strip()
    return found
