"""What the commands of studies share: how they begin, and how they end."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from loadshare.cli.changes import open_case
from loadshare.cli.console import Tick, progress
from loadshare.cli.exits import REFUSED, UNUSABLE, fail, reporting_problems
from loadshare.cli.files import tell_written
from loadshare.cli.forms import FOLDER, Output, write_all
from loadshare.cli.refusal import refusal_lines
from loadshare.cli.study.answers import KINDS
from loadshare.errors import LoadshareError, Refused

if TYPE_CHECKING:
    from loadshare.case import Case


@contextmanager
def running_study(
    file: Path,
    change: list[str] | None,
    what: str,
    total: int | None = 1,
    *,
    rated: bool = False,
) -> Iterator[tuple[Case, Tick]]:
    """Open the case of a study and a progress bar; what cannot be answered becomes a message.

    Parameters
    ----------
    file : Path
    change : list of str or None
        Of ``--set``.
    what, total, rated
        Of the bar, as far as known beforehand.
    """
    with answered():
        case = open_case(file, change)
        with progress(what, total, rated=rated) as tick:
            yield case, tick


@contextmanager
def answered() -> Iterator[None]:
    """Turn an unusable case, wrong positions and a refused answer into messages and exit codes."""
    try:
        with reporting_problems():
            yield
    except Refused as refusal:
        fail([f"REFUSED  {line}" for line in refusal_lines(refusal)], REFUSED)
    except LoadshareError as error:
        fail([str(error)], UNUSABLE)
    except ValueError as error:
        if not str(error).startswith("position"):
            raise
        fail([str(error)], UNUSABLE)


def conclude(kind: str, found: Any, files: list[Output] | None) -> None:
    """Print the answer of a study, and write its files but a folder of samples, which is there.

    Raises
    ------
    typer.Exit
        With the code of a refusal where the study lacks an answer; says which.
    """
    KINDS[kind].show(found)
    for output in files or ():
        if output.form == FOLDER:
            tell_written(output.file, err=True)
    write_all([o for o in files or () if o.form != FOLDER], KINDS[kind].makers(found))
    if lines := found._left_open():
        fail(lines, REFUSED)
