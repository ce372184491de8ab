"""Many random trains, over processes; what is done is kept, and not done again."""

from __future__ import annotations

import json
import multiprocessing
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

from benchmarks.random_trains.draw import draw
from benchmarks.random_trains.judge import judged

FAILURES = ("wrong", "refused", "open", "crashed")
"""Outcomes that are to be looked into."""


def one(seed: int, number: int) -> dict[str, Any]:
    """Judge one train; plain data."""
    return {"seed": seed, "number": number, **judged(draw(seed, number))}


def known(path: Path, seed: int) -> dict[int, dict[str, Any]]:
    """What is on file, by number; a last line that was cut off is left out."""
    found: dict[int, dict[str, Any]] = {}
    if path.exists():
        for line in path.read_text(encoding="utf-8").splitlines():
            try:
                row = json.loads(line)
            except json.JSONDecodeError:
                continue
            if row["seed"] == seed:
                found[row["number"]] = row
    return found


def run(
    numbers: range,
    seed: int,
    path: Path,
    processes: int,
    tell: Callable[[int, int], None],
) -> list[dict[str, Any]]:
    """Judge trains and keep every verdict as a line of a file.

    Parameters
    ----------
    numbers : range
    seed : int
    path : Path
        File of verdicts; those it holds already are not found again.
    processes : int
    tell : callable
        Called with how many are done, of how many.

    Returns
    -------
    list of dict
        All verdicts, by number.
    """
    done = known(path, seed)
    left = [k for k in numbers if k not in done]
    path.parent.mkdir(parents=True, exist_ok=True)
    cut_off = path.exists() and not path.read_text(encoding="utf-8").endswith("\n")
    with path.open("a", encoding="utf-8") as file:
        file.write("\n" if cut_off else "")
        for count, row in enumerate(_each(seed, left, processes), start=1):
            done[row["number"]] = row
            file.write(json.dumps(row) + "\n")
            file.flush()
            tell(count, len(left))
    return [done[k] for k in numbers]


def _each(seed: int, numbers: list[int], processes: int) -> Iterator[dict[str, Any]]:
    judge = partial(one, seed)
    if processes == 1:
        _warm()
        yield from map(judge, numbers)
        return
    with multiprocessing.get_context("spawn").Pool(processes, _warm) as pool:
        yield from pool.imap_unordered(judge, numbers)


def _warm() -> None:
    """Solve once, so that no train pays for what a process imports at first."""
    judged(draw(0, 0))


def failures(row: dict[str, Any]) -> list[str]:
    """What is wrong with a train, one line per position at fault."""
    lines = []
    for p in row["positions"]:
        told = " ".join(p["told"].split())
        if p["outcome"] in FAILURES:
            error = f", torque off by {p['error']:.1e}" if p["error"] is not None else ""
            compared = f"reference: {p['reference']}"
            lines.append(f"position {p['position']}: {p['outcome']}{error}; {compared}; {told}")
        if p["misplaced"]:
            places = ", ".join(f"{n} ({v:.1e})" for n, v in p["misplaced"].items())
            lines.append(f"position {p['position']}: not so determined: {places}; {p['rung']}")
    return lines


def write_failures(rows: list[dict[str, Any]], folder: Path) -> int:
    """Write the trains at fault as case files, each with what is wrong in its first lines."""
    folder.mkdir(parents=True, exist_ok=True)
    count = 0
    for row in rows:
        lines = failures(row)
        if lines:
            case = draw(row["seed"], row["number"])
            text = "".join(f"# {line[:400]}\n" for line in lines) + case.to_toml()
            (folder / f"{case.name.replace(' ', '_')}.toml").write_text(text, encoding="utf-8")
            count += 1
    return count
