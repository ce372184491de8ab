"""`loadshare new` and `loadshare schema`: a case to start from, and its schema."""

from __future__ import annotations

from pathlib import Path
from shlex import quote
from typing import Annotated

import typer

from loadshare.cli.completion import kind_names
from loadshare.cli.exits import UNUSABLE, fail
from loadshare.cli.files import print_written, save_text
from loadshare.cli.forms import check_case_file
from loadshare.cli.options import Force, output
from loadshare.cli.waiting import echo
from loadshare.errors import CaseError


def new(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of the case.")],
    file: Annotated[Path | None, output(what="File to write; NAME.toml by default.")] = None,
    kind: Annotated[
        str | None,
        typer.Option(
            metavar="KIND",
            help="split-path (by default), four-branch, star, planetary or two-stage-planetary.",
            autocompletion=kind_names,
        ),
    ] = None,
    example: Annotated[
        str | None,
        typer.Option(
            metavar="CASE",
            help="Copy a case that comes with the package instead, such as star/floating_sun_4.",
        ),
    ] = None,
    force: Force = False,
) -> None:
    """Write a commented case file that runs, as a start for your own."""
    from loadshare.case.examples import example_text
    from loadshare.case.starter import KINDS, starter_case
    from loadshare.case.words import did_you_mean

    if kind is not None and example is not None:
        raise typer.BadParameter("contradicts --kind", param_hint="--example")
    kind = kind or KINDS[0]
    if kind not in KINDS:
        message = f"{kind!r} is not one of {', '.join(KINDS)}. {did_you_mean(kind, KINDS)}"
        raise typer.BadParameter(message.strip(), param_hint="--kind")
    title = Path(name.removesuffix(".toml")).name
    if not title:
        raise typer.BadParameter("a case needs a name", param_hint="NAME")
    target = file or Path(name).with_name(f"{title}.toml")
    check_case_file(target, force)
    try:
        text = starter_case(title, kind) if example is None else example_text(example)
    except CaseError as error:
        fail(map(str, error.problems), UNUSABLE)
    save_text(target, text)
    print_written(target, f". Solve it with: loadshare run {quote(str(target))}")


def schema(
    file: Annotated[Path | None, output(what="File to write instead of stdout.")] = None,
) -> None:
    """Print the JSON Schema of a case file, for editors."""
    import json

    from loadshare.case import case_schema

    text = json.dumps(case_schema(), indent=2, ensure_ascii=False)
    if file is None:
        echo(text)
        return
    save_text(file, text + "\n")
    print_written(file, err=True)
