"""`loadshare report`: cases, results and pictures on one page."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from loadshare.cli.changes import read_changes
from loadshare.cli.console import progress
from loadshare.cli.exits import REFUSED, UNUSABLE, fail
from loadshare.cli.find import find_cases
from loadshare.cli.forms import Output, outputs, write_all
from loadshare.cli.options import CasePaths, Changes


def report(
    cases: CasePaths,
    file: Annotated[
        list[Output] | None, outputs("html", what="Page to write; report.html by default")
    ] = None,
    change: Changes = None,
) -> None:
    """Solve cases and write one page with tables, pictures and certificates.

    The page is a single file that needs no network. Cases that cannot be used and answers that
    are refused are reported on it.
    """
    from loadshare.report.page import chapter_of_file, report_page
    from loadshare.report.page.chapter import CERTIFIED
    from loadshare.report.page.chapter import UNUSABLE as NOT_USABLE

    changes = read_changes(change or ())
    found = find_cases(cases)
    chapters = []
    with progress("cases", len(found)) as tick:
        for done, path in enumerate(found, start=1):
            chapters.append(chapter_of_file(path, changes=changes))
            tick(done, len(found))
    written = file or [Output("html", Path("report.html"))]
    write_all(written, {"html": lambda: report_page(chapters)}, err=False)
    bad = [one for one in chapters if one.outcome != CERTIFIED]
    if bad:
        code = UNUSABLE if any(one.outcome == NOT_USABLE for one in bad) else REFUSED
        fail([line for one in bad for line in (f"{one.file}: {one.outcome}", *one.problems)], code)
