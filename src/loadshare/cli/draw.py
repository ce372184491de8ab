"""`loadshare draw`: a drawing of a case's train."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from loadshare.cli.cases import open_case, read_changes
from loadshare.cli.exits import fail_of, reporting_problems
from loadshare.cli.forms import Output, outputs, write_all
from loadshare.cli.options import CaseFile, Changes
from loadshare.errors import CaseError, Problem

if TYPE_CHECKING:
    from loadshare.report.figure import Figure


FORMS = ("svg", "png", "pdf", "html", "json")


def draw(
    case: CaseFile,
    file: Annotated[
        list[Output] | None,
        outputs(*FORMS, what="Drawing to write, drawing.svg by default; .json is Vega-Lite"),
    ] = None,
    change: Changes = None,
) -> None:
    """Draw the train of a case to scale, and mark what does not fit.

    A case that cannot be used is drawn as far as it can be read.
    """
    with reporting_problems():
        figure, problems = _drawn(case, change or ())
    makers = {form: partial(figure.content, form) for form in FORMS}
    write_all(file or [Output("svg", Path("drawing.svg"))], makers, err=False)
    if problems:
        fail_of(problems, "; the drawing shows what could be read.")


def _drawn(file: Path, settings: Sequence[str]) -> tuple[Figure, list[Problem]]:
    """Return the drawing of a case, and the problems of the case.

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
        # If the draft has no problem of its own, a file could not be read at that moment.
        if not (draft.gears and draft.problems):
            raise
        return train(draft), list(error.problems)
    problems: list[Problem] = []
    try:
        build_train(case)
    except CaseError as error:
        problems = list(error.problems)
    return train(case), problems
