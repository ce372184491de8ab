"""Verdicts on numbered problems, kept as lines of a file so that a stopped run can continue."""

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
    """Return a parser of the options of every run: how many, from which number, and the folder.

    Parameters
    ----------
    description : str
    what : str
        Name of the things that are counted.
    count : int
        Default number.
    folder : str
        Default folder in ``build``.
    """
    found = argparse.ArgumentParser(
        description=description, formatter_class=argparse.RawTextHelpFormatter
    )
    found.add_argument("--count", type=int, default=count, help=what)
    found.add_argument("--first", type=int, default=0, help="number of the first one")
    found.add_argument("--processes", type=int, default=1)
    found.add_argument(
        "--out", type=Path, default=Path("build") / folder, help="folder for what is found"
    )
    found.add_argument("--page", type=Path, help="Markdown file to write")
    return found


def publish(page: Path | None, about: str, command: str, found: str) -> None:
    """Print the results, and write them to a page if one is given.

    Parameters
    ----------
    page : Path or None
    about : str
        Title and a description of the measurement, as Markdown.
    command : str
        Module and options after ``python -m`` that give the results.
    found : str
        Tables.
    """
    print(found)  # noqa: T201
    if page is not None:
        today = datetime.now(tz=UTC).date().isoformat()
        by = f"Printed by `python -m {command}`, version {loadshare.__version__}, {today}."
        page.write_text(f"{about.strip()}\n\n{by}\n\n{found.strip()}\n", encoding="utf-8")


def numbers(options: argparse.Namespace) -> range:
    """Return the numbers of the problems that a run should solve."""
    return range(options.first, options.first + options.count)


def known(path: Path, of: Mapping[str, Any]) -> dict[int, Row]:
    """Return the rows of one kind that are on file, by number, without a truncated last line.

    Parameters
    ----------
    path : Path
    of : mapping
        Items that all rows of the kind have in common, such as their seed.
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
        Items that distinguish these verdicts from others in the file.
    path : Path
        File of verdicts; problems that it contains are not judged again.
    judge : callable
        Function from the number of a problem to plain data.
    processes : int
    warm : callable
        Called once in every process, so that first imports do not count for any problem.
    tell : callable, optional
        Called with the numbers of problems done and in total; by default they are written to
        standard error.

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
    """Write the progress to standard error."""
    print(f"\r{done} of {total}", end="" if done < total else "\n", file=sys.stderr, flush=True)  # noqa: T201


class _Judge:
    """A judge that also returns the number."""

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
