"""The command `loadshare`.

Only what the help needs is imported here; everything else is imported by the command that needs it,
so that the help appears at once and no command waits for what it does not use.
"""

from __future__ import annotations

import inspect
import os
import sys
from collections.abc import Callable, Sequence
from functools import cache
from io import TextIOWrapper
from typing import Annotated, Any

import typer
from typer.main import get_command

from loadshare._version import __version__
from loadshare.cli.batch.command import batch
from loadshare.cli.check import check
from loadshare.cli.command import Command, Commands, Group
from loadshare.cli.draw import draw
from loadshare.cli.exchange import export, import_machine
from loadshare.cli.exits import reporting_lack_of_room
from loadshare.cli.explore import explore
from loadshare.cli.ltca import ltca
from loadshare.cli.new import new, schema
from loadshare.cli.options import taking
from loadshare.cli.page import report
from loadshare.cli.run import run
from loadshare.cli.study.commands import (
    compare,
    critical,
    fit,
    march,
    sensitivity,
    study,
    sweep,
    tolerance,
)
from loadshare.cli.waiting import echo
from loadshare.cli.warm import warm
from loadshare.output import Closed

STUDIES = (sweep, critical, sensitivity, tolerance, march, compare, fit, study)
CASES = (run, batch, report, draw, check, export, explore, *STUDIES)
SCRIPTED = (run, *STUDIES)
"""Commands that can write JSON, and so print it with ``--json``."""
COMMANDS = {
    command.__name__: command
    for command in (
        *(run, batch, report, draw, explore, check, schema, new, ltca, export, warm),
        *STUDIES,
    )
} | {"import": import_machine}


def _made(name: str) -> Any:
    """Return a command, with the shared options added that it does not define itself."""
    command = COMMANDS[name]
    has = {"json": command in SCRIPTED, "allow_outside": command in CASES, "quiet": True}
    alone = typer.Typer(rich_markup_mode=None, add_completion=False)
    options = (option for option, wanted in has.items() if wanted)
    alone.command(name, cls=Command)(taking(command, *options))
    return get_command(alone)


class _Loadshare(Group):
    def __init__(self, **how: Any) -> None:
        super().__init__(**how)
        self.commands = Commands(_made, {n: inspect.getdoc(c) or "" for n, c in COMMANDS.items()})


app = typer.Typer(
    name="loadshare",
    cls=_Loadshare,
    # Plain words survive a pipe, a log and a narrow terminal; boxes do not.
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _tell_version(wanted: bool) -> None:
    if wanted:
        echo(f"loadshare {__version__}")
        raise typer.Exit


@app.callback()
def root(
    version: Annotated[
        bool,
        typer.Option(
            "--version", is_eager=True, callback=_tell_version, help="Show the version and exit."
        ),
    ] = False,
) -> None:
    """Certified load sharing in multi-branch gear transmissions."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command and leave with its exit code.

    Parameters
    ----------
    arguments : sequence of str, optional
        Words after ``loadshare``; those of the process by default.

    Raises
    ------
    SystemExit
        Always: 0 for success, 1 for an answer that is refused, 2 for an invalid case, wrong usage,
        a file that cannot be read or written or too little memory, 130 for an interruption.
    """
    # The matrices are far too small to share among threads, and a batch has its own processes.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    open_streams()
    with reporting_lack_of_room():
        _built()(arguments, prog_name="loadshare")


@cache
def _built() -> Callable[..., object]:
    """Put the commands together, once for all calls of `main`."""
    return get_command(app)


def open_streams() -> None:
    """Replace closed streams by the null device, as after ``2>&-`` or under some daemons.

    Otherwise files and pipes opened later would get their numbers, and so what libraries and
    workers print. A file asked for on a closed output is reported when it is written.
    """
    for number, stream in enumerate((sys.stdin, sys.stdout, sys.stderr)):
        if stream is None and not _is_open(number):
            nowhere = os.open(os.devnull, os.O_RDWR)
            if nowhere != number:
                os.dup2(nowhere, number)
                os.close(nowhere)
            os.set_inheritable(number, True)
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            nowhere = os.open(os.devnull, os.O_WRONLY)
            setattr(sys, name, Closed(os.fdopen(nowhere, "wb"), encoding="utf-8"))
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            # A stream that cannot show Ω shows a question mark instead of failing.
            stream.reconfigure(errors="replace")


def _is_open(number: int) -> bool:
    try:
        os.fstat(number)
    except OSError:
        return False
    return True


if __name__ == "__main__":
    main()
