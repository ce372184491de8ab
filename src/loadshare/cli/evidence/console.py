"""What the commands of the evidence share: options, a line per step, and their packages."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

import typer

from loadshare.cli.exits import UNUSABLE, fail

DRAWING = ("altair", "vl_convert")
SHIPPED = Path("cases")
Folder = Annotated[
    Path,
    typer.Option("-o", "--output", metavar="DIR", file_okay=False, help="Folder to write to."),
]
Cases = Annotated[Path, typer.Option("--cases", metavar="DIR", help="Folder of the shipped cases.")]
Quiet = Annotated[bool, typer.Option("--quiet", help="Tell no steps.")]


def teller(quiet: bool) -> Callable[[str], None]:
    """Return what tells each step on stderr, or nothing."""
    return (lambda _: None) if quiet else (lambda step: typer.echo(step, err=True))


def need(packages: tuple[str, ...], command: str) -> None:
    """End with a message where packages are missing."""
    missing = [p for p in packages if find_spec(p) is None]
    if missing:
        extra = "pip install 'loadshare[bench]'"
        fail([f"loadshare {command} needs {', '.join(missing)}: {extra}"], UNUSABLE)
