"""`loadshare report`: cases, results and pictures on one page."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from loadshare.cli.console import progress
from loadshare.cli.exits import REFUSED, UNUSABLE, fail, writing
from loadshare.cli.files import tell_written
from loadshare.cli.find import find_cases
from loadshare.cli.options import CasePaths, ending, output


def report(
    cases: CasePaths,
    file: Annotated[
        Path,
        output("-o", "--output", what="Page to write, .html.", callback=ending(".html", ".htm")),
    ] = Path("report.html"),
) -> None:
    """Solve cases and write one page with tables, pictures and certificates.

    The page is a single file that needs no network. Cases that cannot be used and answers that
    are refused are reported on it.
    """
    from loadshare.report.page import chapter_of_file, save_report
    from loadshare.report.page.chapter import CERTIFIED
    from loadshare.report.page.chapter import UNUSABLE as NOT_USABLE

    found = find_cases(cases)
    chapters = []
    with progress("cases", len(found)) as tick:
        for done, path in enumerate(found, start=1):
            chapters.append(chapter_of_file(path))
            if tick is not None:
                tick(done, len(found))
    with writing(file):
        save_report(chapters, file)
    tell_written(file, ".")
    bad = [one for one in chapters if one.outcome != CERTIFIED]
    if bad:
        code = UNUSABLE if any(one.outcome == NOT_USABLE for one in bad) else REFUSED
        fail([line for one in bad for line in (f"{one.file}: {one.outcome}", *one.problems)], code)
