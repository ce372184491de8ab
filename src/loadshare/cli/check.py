"""`loadshare check`: whether cases can be used, without solving them."""

from __future__ import annotations

import typer

from loadshare.cli.exits import UNUSABLE, counted, fail
from loadshare.cli.find import find_cases
from loadshare.cli.options import CasePaths
from loadshare.errors import CaseError


def check(cases: CasePaths) -> None:
    """List all problems of case files without solving them."""
    from loadshare.case import load_case
    from loadshare.train import build_train

    found = find_cases(cases)
    problems = bad = 0
    for path in found:
        try:
            build_train(load_case(path))
        except CaseError as error:
            bad += 1
            problems += len(error.problems)
            for problem in error.problems:
                typer.echo(str(problem), err=True)
        else:
            typer.echo(f"OK  {path}")
    if bad:
        told = f"{counted(problems, 'problem')} in {bad} of {counted(len(found), 'case')}."
        fail([told], UNUSABLE)
