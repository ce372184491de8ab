"""Options that several commands share."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias

import typer

from loadshare.output import STANDARD

# The words are repeated here because asking the solver room for them would import it for every
# --help; a test compares them.
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
    typer.Option(metavar="NAME", help="auto (hot path first), clarabel, osqp or cvxpy."),
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


def changes(name: str, help_: str) -> object:
    """Return the option for changes to a case."""
    return typer.Option(name, metavar="KEY=VALUE", help=help_)


OUTPUT = "FILE"
"""How an option for a file to write is told from others."""


def output(*names: str, what: str, callback: Callable[..., Any] | None = None) -> object:
    """Return the option for a file to write, which a callback may refuse."""
    return typer.Option(
        *names, metavar=OUTPUT, dir_okay=False, writable=True, help=what, callback=callback
    )


def ending(*endings: str) -> Callable[[Path | None], Path | None]:
    """Return a callback that refuses a file of another kind, before anything is solved.

    What goes to stdout is of the first kind.
    """

    def checked(file: Path | None) -> Path | None:
        if file is not None and file != STANDARD and file.suffix not in endings:
            raise typer.BadParameter(f"{file}: must end in {' or '.join(endings)}")
        return file

    return checked


def keys_and_value(text: str, form: str, name: str) -> tuple[tuple[str, ...], str]:
    """Split ``KEY=VALUE`` or ``KEY=KEY=VALUE`` at the equals signs outside of quotes.

    Raises
    ------
    typer.BadParameter
        If a key or the value is missing, naming the option and the form it has.
    """
    from loadshare.study.parameter import split_outside

    *keys, value = split_outside(text, "=")
    if not keys or not all(keys) or not value:
        raise typer.BadParameter(f"{text!r} is not of the form {form}", param_hint=name)
    return tuple(keys), value
