"""`loadshare report`: cases, results and pictures on one page."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING, Annotated

import typer

from loadshare.cli.cases import find_cases, read_changes
from loadshare.cli.console import progress
from loadshare.cli.exits import REFUSED, UNUSABLE
from loadshare.cli.forms import Output, outputs, write_all
from loadshare.cli.options import CasePaths, Changes
from loadshare.report import converter

if TYPE_CHECKING:
    from loadshare.report.page import Chapter


def report(
    cases: CasePaths,
    file: Annotated[
        list[Output] | None, outputs("html", what="Page to write; report.html by default")
    ] = None,
    study: Annotated[
        list[str] | None,
        typer.Option(
            "--study",
            metavar="NAME",
            help="Study [study.NAME] to run and show; NAME=FOLDER takes the samples of a tolerance "
            "study from a folder. May be repeated. By default all but tolerance studies.",
        ),
    ] = None,
    no_studies: Annotated[
        bool, typer.Option("--no-studies", help="Run none of the studies that a case holds.")
    ] = False,
    change: Changes = None,
) -> None:
    """Solve cases and write one page with pictures, tables, studies and certificates.

    The page is a single file that needs no network. Cases that cannot be used and answers that
    are refused are reported on it. Tolerance studies may take long: they are shown when --study
    names them.
    """
    if study and no_studies:
        raise typer.BadParameter("contradicts --no-studies", param_hint="--study")
    named = dict(_named(text) for text in study or ())
    changes = read_changes(change or ())
    found = find_cases(cases)
    converter.start()
    from loadshare.report.page import chapter_of_file, report_page
    from loadshare.report.page.chapter import UNUSABLE as NOT_USABLE
    from loadshare.study.sweep import CERTIFIED

    chapters = []
    with progress("cases", len(found)) as tick:
        for done, path in enumerate(found, start=1):
            made = chapter_of_file(path, changes=changes)
            chapters.append(replace(made, changes=tuple(change or ())))
            tick(done, len(found))
    if not no_studies:
        chapters = _with_studies(chapters, named)
    written = file or [Output("html", Path("report.html"))]
    bad = [one for one in chapters if one.outcome != CERTIFIED or one.unanswered]
    write_all(
        written,
        {"html": lambda: report_page(chapters)},
        err=False,
        missing=[line for one in bad for line in (f"{one.file}: {one.outcome}", *one.unanswered)],
        code=UNUSABLE if any(one.outcome == NOT_USABLE for one in bad) else REFUSED,
    )


def _named(text: str) -> tuple[str, Path | None]:
    """Return the name of a study, and the folder of its samples if one is given."""
    name, equals, folder = text.partition("=")
    if not name or (equals and not folder):
        raise typer.BadParameter(f"{text!r} is neither NAME nor NAME=FOLDER", param_hint="--study")
    from loadshare.study.tolerance.folder import STUDY

    if equals and not (Path(folder) / STUDY).is_file():
        writes = f"loadshare tolerance CASE {quote(name)} -o {quote(folder)}"
        message = f"{folder}: contains no samples of a tolerance study. `{writes}` writes them."
        raise typer.BadParameter(message, param_hint="--study")
    return name, Path(folder) if equals else None


def _with_studies(chapters: list[Chapter], named: dict[str, Path | None]) -> list[Chapter]:
    """Run the studies that are asked for, or all that do not take long.

    Raises
    ------
    typer.BadParameter
        If no case holds a study of some name.
    """
    held = {name for one in chapters if one.case for name in one.case.study}
    unknown = [name for name in named if name not in held]
    # A case that cannot be read may hold it; its problems are reported in any case.
    if unknown and all(one.case for one in chapters):
        message = f"{', '.join(unknown)}: no such study"
        allowed = f"Allowed: {', '.join(sorted(held))}" if held else "The cases have none"
        raise typer.BadParameter(f"{message}. {allowed}.", param_hint="--study")
    if not held:
        return chapters
    from loadshare.report.page.studies import quick_studies, run_part

    made = []
    for one in chapters:
        case = one.case
        wanted = [n for n in named or quick_studies(case) if n in case.study] if case else []
        parts = []
        for name in wanted:
            assert case is not None
            rated = case.study[name].kind == "tolerance"
            with progress(f"study {name}", None if rated else 1, rated=rated) as tick:
                parts.append(run_part(case, name, kept=named.get(name), progress=tick))
        made.append(replace(one, studies=parts))
    return made
