"""`loadshare draw`: a drawing of a case's train."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from loadshare.cli.changes import open_case, read_changes
from loadshare.cli.exits import UNUSABLE, counted, fail, problems_told, writing
from loadshare.cli.files import tell_written, write_text
from loadshare.cli.options import CaseFile, changes, output
from loadshare.errors import CaseError, LoadshareError, Problem
from loadshare.output import STANDARD

if TYPE_CHECKING:
    from loadshare.report.figure import Figure


def draw(
    case: CaseFile,
    file: Annotated[
        Path,
        output(
            "-o",
            "--output",
            what="Drawing to write: .svg, .png, .pdf, .html or .json; - for SVG on stdout.",
        ),
    ] = Path("drawing.svg"),
    change: Annotated[
        list[str] | None,
        changes(
            "--set",
            "Change the case, as in gears.6.centre.angle='41 deg'; may be repeated. "
            "No value removes the key.",
        ),
    ] = None,
) -> None:
    """Draw the train of a case to scale, with what does not fit marked.

    A case that cannot be used is drawn as far as it can be read.
    """
    with problems_told():
        figure, problems = _drawn(case, change or ())
    with writing(file):
        try:
            if file == STANDARD:
                write_text(file, figure.to_svg())
            else:
                figure.save(file)
        except LoadshareError as error:
            raise typer.BadParameter(str(error), param_hint="--output") from None
    tell_written(file, ".")
    if problems:
        told = f"{counted(len(problems), 'problem')}; the drawing shows what could be read."
        fail([*map(str, problems), told], UNUSABLE)


def _drawn(file: Path, settings: Sequence[str]) -> tuple[Figure, list[Problem]]:
    """Return the drawing of a case, and what is wrong with the case.

    Raises
    ------
    CaseError
        If nothing of it can be drawn.
    """
    from loadshare.case.reader import load_draft
    from loadshare.report.figures.train import train
    from loadshare.train import build_train

    try:
        case = open_case(file, settings)
    except CaseError as error:
        draft = load_draft(file, read_changes(settings))
        if not draft.gears:
            raise
        return train(draft), list(error.problems)
    problems: list[Problem] = []
    try:
        build_train(case)
    except CaseError as error:
        problems = list(error.problems)
    return train(case), problems
