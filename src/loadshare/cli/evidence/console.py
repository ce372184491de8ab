"""What the commands of the evidence share: a line per step, and their packages."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec

import typer

from loadshare.cli.exits import UNUSABLE, fail

DRAWING = ("altair", "vl_convert")


def teller(quiet: bool) -> Callable[[str], None]:
    """Return what tells each step on stderr, or nothing."""
    return (lambda _: None) if quiet else (lambda step: typer.echo(step, err=True))


def need(packages: tuple[str, ...], command: str) -> None:
    """End with a message where packages are missing."""
    missing = [p for p in packages if find_spec(p) is None]
    if missing:
        extra = "pip install 'loadshare[bench]'"
        fail([f"loadshare {command} needs {', '.join(missing)}: {extra}"], UNUSABLE)
