"""Many random trains, or stress problems, in several processes; verdicts are kept."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import loadshare as ls
from benchmarks import kept
from benchmarks.random_trains.draw import draw
from benchmarks.random_trains.judge import NO_TORQUE, judged
from benchmarks.random_trains.planetary import LOOPS, PLANETARY
from benchmarks.stress.families import FAMILIES
from benchmarks.stress.problem import COUNT
from loadshare.case import Case

STRESS = -1
"""Stands in for a seed: the problems of the stability map, family after family."""
SETS = -2
"""Stands in for seed 0 of planetary sets; seed n is n less."""
LOOPED = -1000
"""Stands in for seed 0 of sets with a loop; seed n is n less."""
PROBLEMS = len(FAMILIES) * COUNT
"""Number of problems of the stability map."""
FAILURES = ("wrong", "refused", "open", "crashed")
"""Outcomes that need a closer look."""


def run(
    numbers: range,
    seed: int,
    path: Path,
    processes: int = 1,
    tell: Callable[[int, int], None] | None = None,
) -> list[dict[str, Any]]:
    """Judge trains of a seed, and return all verdicts on it that are on file (`kept.run`)."""
    judge = partial(one, seed)
    return kept.run(
        numbers, {"seed": seed}, path, judge, processes=processes, warm=_warm, tell=tell
    )


def one(seed: int, number: int) -> dict[str, Any]:
    """Judge one train; return plain data."""
    return judged(case_of(seed, number))


def case_of(seed: int, number: int) -> Case:
    """Return a train of a seed, or a problem of the stability map (`STRESS`)."""
    if seed == STRESS:
        return list(FAMILIES.values())[number // COUNT].problem(number % COUNT).case
    if seed <= LOOPED:
        return draw(LOOPED - seed, number, LOOPS)
    if seed <= SETS:
        return draw(SETS - seed, number, PLANETARY)
    return draw(seed, number)


def _warm() -> None:
    """Load the compiled kernel, so that times are those of a process that has solved before."""
    ls.solve(draw(0, 0), engine="compiled")
    judged(draw(0, 0))


def failures(row: dict[str, Any]) -> list[str]:
    """Return the faults of a train, one line each."""
    lines = []
    for p in row["positions"]:
        message = " ".join(p["told"].split())
        if p["outcome"] in FAILURES:
            error = f", torque off by {p['error']:.1e}" if p["error"] is not None else ""
            compared = f"reference: {p['reference']}"
            lines.append(f"position {p['position']}: {p['outcome']}{error}; {compared}; {message}")
        low = [pair for pair in p["bound"] if NO_TORQUE < pair[1] > pair[0]]
        if low or p["below"]:
            lines.append(f"position {p['position']}: bounds below the error: {low}, {p['below']}")
        if p["misplaced"]:
            places = ", ".join(f"{n} ({v:.1e})" for n, v in p["misplaced"].items())
            lines.append(f"position {p['position']}: not so determined: {places}; {p['rung']}")
    return lines


def write_failures(rows: list[dict[str, Any]], folder: Path) -> int:
    """Write the trains at fault as case files, with the faults in the first lines."""
    folder.mkdir(parents=True, exist_ok=True)
    count = 0
    for row in rows:
        lines = failures(row)
        if lines:
            case = case_of(row["seed"], row["number"])
            text = "".join(f"# {line[:400]}\n" for line in lines) + case.to_toml()
            (folder / f"{case.name.replace(' ', '_')}.toml").write_text(text, encoding="utf-8")
            count += 1
    return count
