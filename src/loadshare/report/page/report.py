"""The page as a whole."""

from __future__ import annotations

import platform
from collections.abc import Iterable, Mapping
from dataclasses import replace
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from loadshare._version import __version__
from loadshare.case import Case
from loadshare.output import write_whole
from loadshare.report.page.chapter import Chapter, chapter, chapter_of_file, overview
from loadshare.report.page.offline import render
from loadshare.report.tables import effort_text
from loadshare.table import Table
from loadshare.view import Viewed

PACKAGES = ("numpy", "scipy", "clarabel", "altair", "vl-convert-python")
"""Packages on which figures and pictures depend."""


def report_page(chapters: Iterable[Chapter], made: datetime | None = None) -> str:
    """Return the page of some chapters as HTML.

    Parameters
    ----------
    chapters : iterable of Chapter
        Chapters from `chapter` or `chapter_of_file`.
    made : datetime, optional
        When the page was made; now by default.
    """
    found = list(chapters)
    made = made or datetime.now(UTC)
    return render(
        "report.html",
        title=f"{found[0].title if len(found) == 1 else f'{len(found)} cases'} – load sharing",
        chapters=found,
        overview=overview(found) if len(found) > 1 else None,
        differences=_differences(found),
        made=made.astimezone(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        versions=versions(),
        effort_text=effort_text,
    )


def _differences(chapters: list[Chapter]) -> list[Table]:
    """Return what differs between the cases that have an answer; empty for fewer than two."""
    solved = {n: one.result for n, one in enumerate(chapters, start=1) if one.result}
    if len(solved) < 2:
        return []
    from loadshare.report.page.comparison import comparison

    return comparison([f"case {number}" for number in solved], list(solved.values()))


def write_report(
    cases: Iterable[Case | str | Path],
    path: str | Path,
    studies: Mapping[str, Viewed] | None = None,
) -> list[Chapter]:
    """Solve cases and write them, with figures and certificates, into one page that works offline.

    The studies that a case holds are run and shown, except tolerance studies, which may take long:
    run those with `tolerance` and pass them in.

    Parameters
    ----------
    cases : iterable of Case or path
        Cases, or paths of case files.
    path : path-like
        The page to write.
    studies : mapping of str to study, optional
        Studies of the one case that were run already (a `Sweep`, a `Tolerance`, …), by the names
        under which the page shows them. Those that the case holds are then not run.

    Returns
    -------
    list of Chapter
        What the page shows of each case, such as its outcome. A case file that cannot be used and a
        refused position are part of the page.

    Raises
    ------
    CaseError
        If a `Case` cannot be solved at all.
    ValueError
        If studies are passed in for more than one case.
    OSError
        If the page cannot be written.
    """
    given = list(cases)
    if studies and len(given) > 1:
        raise ValueError(f"studies are shown with one case, not with {len(given)}")
    chapters = []
    for case in given:
        made = chapter(case) if isinstance(case, Case) else chapter_of_file(case)
        if made.case is not None and (studies or made.case.study):
            from loadshare.report.page.studies import quick_studies, run_part, study_part

            parts = (
                [study_part(name, found, made.case) for name, found in studies.items()]
                if studies
                else [run_part(made.case, name) for name in quick_studies(made.case)]
            )
            made = replace(made, studies=parts)
        chapters.append(made)
    save_report(chapters, path)
    return chapters


def save_report(chapters: Iterable[Chapter], path: str | Path) -> None:
    """Write the page of some chapters, whole or not at all."""
    write_whole(Path(path), report_page(chapters))


def versions() -> dict[str, str]:
    """Return the versions of the software that figures and pictures were made with."""
    found = {"loadshare": __version__, "Python": platform.python_version()}
    for package in PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            continue
    return found | {"machine": f"{platform.system()} {platform.machine()}"}
