"""Verdicts on many numbered problems, kept as lines of a file: a run that was stopped goes on."""

from __future__ import annotations

import argparse
import json
import multiprocessing
import sys
from collections.abc import Callable, Iterator, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import loadshare

Row = dict[str, Any]


def parser(description: str, what: str, count: int, folder: str) -> argparse.ArgumentParser:
    """Return a parser of the options of every run: how many, from which on, and where to keep them.

    Parameters
    ----------
    description : str
    what : str
        What is counted.
    count : int
        How many by default.
    folder : str
        Name of the folder in ``build`` by default.
    """
    found = argparse.ArgumentParser(
        description=description, formatter_class=argparse.RawTextHelpFormatter
    )
    found.add_argument("--count", type=int, default=count, help=what)
    found.add_argument("--first", type=int, default=0, help="number of the first one")
    found.add_argument("--processes", type=int, default=1)
    found.add_argument(
        "--out", type=Path, default=Path("build") / folder, help="folder of what is found"
    )
    found.add_argument("--page", type=Path, help="Markdown file to write")
    return found


def publish(page: Path | None, about: str, command: str, found: str) -> None:
    """Print what was found, and write it to a page if one is given.

    Parameters
    ----------
    page : Path or None
    about : str
        Title and what was measured, as Markdown.
    command : str
        Words after ``python -m`` by which it is measured.
    found : str
        Tables.
    """
    print(found)  # noqa: T201
    if page is not None:
        today = datetime.now(tz=UTC).date().isoformat()
        by = f"Printed by `python -m {command}`, version {loadshare.__version__}, {today}."
        page.write_text(f"{about.strip()}\n\n{by}\n\n{found.strip()}\n", encoding="utf-8")


def numbers(options: argparse.Namespace) -> range:
    """Return the numbers of the problems that a run is to solve."""
    return range(options.first, options.first + options.count)


def known(path: Path, of: Mapping[str, Any]) -> dict[int, Row]:
    """What is on file of one kind, by number; a last line that was cut off is left out.

    Parameters
    ----------
    path : Path
    of : mapping
        What all rows of the kind have in common, such as their seed.
    """
    found: dict[int, Row] = {}
    if path.exists():
        for line in path.read_text(encoding="utf-8").splitlines():
            try:
                row = json.loads(line)
            except json.JSONDecodeError:
                continue
            if all(row[name] == value for name, value in of.items()):
                found[row["number"]] = row
    return found


def run(
    numbers: range,
    of: Mapping[str, Any],
    path: Path,
    judge: Callable[[int], Row],
    *,
    processes: int = 1,
    warm: Callable[[], object] = lambda: None,
    tell: Callable[[int, int], None] | None = None,
) -> list[Row]:
    """Judge problems and keep every verdict as a line of a file.

    Parameters
    ----------
    numbers : range
    of : mapping
        What distinguishes these verdicts from others in the file.
    path : Path
        File of verdicts; those it holds already are not found again.
    judge : callable
        From the number of a problem to plain data.
    processes : int
    warm : callable
        Called once in every process, so that no problem pays for what it imports at first.
    tell : callable, optional
        Called with how many are done, of how many; written to standard error by default.

    Returns
    -------
    list of dict
        All verdicts of the kind that are on file, by number.
    """
    done = known(path, of)
    left = [k for k in numbers if k not in done]
    path.parent.mkdir(parents=True, exist_ok=True)
    cut_off = path.exists() and not path.read_text(encoding="utf-8").endswith("\n")
    with path.open("a", encoding="utf-8") as file:
        file.write("\n" if cut_off else "")
        for count, (number, found) in enumerate(_each(judge, left, processes, warm), start=1):
            done[number] = row = {**of, "number": number, **found}
            file.write(json.dumps(row) + "\n")
            file.flush()
            (tell or progress)(count, len(left))
    return [done[k] for k in sorted(done)]


def progress(done: int, total: int) -> None:
    """Write how far it has come to standard error."""
    print(f"\r{done} of {total}", end="" if done < total else "\n", file=sys.stderr, flush=True)  # noqa: T201


class _Judge:
    """A judge that returns the number as well."""

    def __init__(self, judge: Callable[[int], Row]) -> None:
        self.judge = judge

    def __call__(self, number: int) -> tuple[int, Row]:
        return number, self.judge(number)


def _each(
    judge: Callable[[int], Row], numbers: list[int], processes: int, warm: Callable[[], object]
) -> Iterator[tuple[int, Row]]:
    if processes == 1:
        if numbers:
            warm()
        yield from map(_Judge(judge), numbers)
        return
    with multiprocessing.get_context("spawn").Pool(processes, warm) as pool:
        yield from pool.imap_unordered(_Judge(judge), numbers)
