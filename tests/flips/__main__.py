"""Flip bits of files of every kind: ``python -m tests.flips --count 10000``.

Prints how many flips were found and how many change nothing; ends with a traceback if a file was
read as something else than what was written.
"""

from __future__ import annotations

import argparse
import logging
from pathlib import Path
from tempfile import TemporaryDirectory

import typer
from tests.flips.flip import places, subjects


def _run() -> None:
    parser = argparse.ArgumentParser(prog="python -m tests.flips", description=__doc__)
    parser.add_argument("--count", type=int, default=1000, help="of each kind of file")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    logging.getLogger("loadshare").setLevel(logging.ERROR)
    with TemporaryDirectory() as folder:
        for subject in subjects(Path(folder)):
            found = sum(
                subject.flip(place) for place in places(subject, options.count, options.seed)
            )
            size, rest = len(subject.whole), options.count - found
            counts = f"{options.count} flips: {found} found, {rest} change nothing"
            typer.echo(f"{subject.kind} ({size} bytes): {counts}")


if __name__ == "__main__":
    _run()
