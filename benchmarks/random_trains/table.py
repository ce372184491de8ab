"""The results of a run of random trains, as Markdown."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable
from typing import Any

import numpy as np

from benchmarks.random_trains.judge import NO_TORQUE

MEANING = {
    "agrees": "torques as the reference has them",
    "wrong": "certified torque off by more than 1e-9 of the largest",
    "unchecked": "certified, no reference found",
    "refused": "refused, has an answer",
    "open": "refused, an answer should exist, no reference found",
    "too far": "refused, as its displacements are too large for the geometry",
    "no answer": "refused, and known to have none",
    "crashed": "exception",
}


def text(rows: list[dict[str, Any]]) -> str:
    """Return tables of outcomes, reasons, times, rungs and bounds."""
    positions = [p for row in rows for p in row["positions"]]
    outcomes = Counter(p["outcome"] for p in positions)
    misplaced = [p for p in positions if p["misplaced"]]
    solvable = sum(outcomes[o] for o in MEANING if o not in ("no answer", "too far"))
    refused = outcomes["refused"] + outcomes["open"]
    lines = [f"{len(rows)} trains, {len(positions)} positions", ""]
    counts = [(o, str(outcomes[o]), m) for o, m in MEANING.items()]
    opened = sum(math.inf in p["misplaced"].values() for p in misplaced)
    counts.append(
        ("place is open", str(opened), "with a place that is given as determined and is not")
    )
    counts.append(
        ("place is elsewhere", str(len(misplaced) - opened), "with a determined place that is off")
    )
    lines += _table(("outcome", "positions", "meaning"), counts)
    part = refused / solvable if solvable else 0.0
    lines += [f"Refused of what has an answer: {100.0 * part:.2f} %.", ""]
    for outcome in ("refused", "open", "unchecked", "too far", "no answer"):
        lines += _reasons(outcome, [p for p in positions if p["outcome"] == outcome])
    lines += _times(rows)
    rungs = Counter(p["rung"] for p in positions if p["rung"])
    lines += _table(("rung", "positions"), [(r, str(n)) for r, n in rungs.most_common()])
    lines += _bounds([b for p in positions for b in p["bound"]])
    others, below = sum(p["others"] for p in positions), sum(len(p["below"]) for p in positions)
    lines += [f"Bounds on forces and places: {others}, below the true error: {below}.", ""]
    errors = [p["error"] for p in positions if p["error"] is not None]
    if errors:
        figures = f"median {np.median(errors):.1e}, worst {max(errors):.1e}"
        lines.append(f"Torque error over the largest torque: {figures}.")
    return "\n".join(lines)


def _table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> list[str]:
    cells = [list(head), *map(list, rows)]
    cells.insert(1, ["---"] * len(cells[0]))
    return [*(f"| {' | '.join(line)} |" for line in cells), ""]


def _reasons(outcome: str, positions: list[dict[str, Any]]) -> list[str]:
    """Return a table of messages without their figures and names, the most frequent first."""
    if not positions:
        return []
    key = "reference" if outcome == "unchecked" else "told"
    kinds = Counter(_kind(p[key]) for p in positions)
    head = (f"{outcome}: reason", "positions")
    return _table(head, [(k, str(n)) for k, n in kinds.most_common(12)])


def _kind(message: str) -> str:
    message = message.split(";")[0].removeprefix("position ").split(" (")[0]
    message = re.sub(r"[-+]?\d+\.?\d*(e[-+]?\d+)?", "…", message)
    return re.sub(r"gear \w+", "gear …", message)[:110].replace("|", "/")


def _times(rows: list[dict[str, Any]]) -> list[str]:
    seconds = np.array([row["seconds"] for row in rows])
    each = np.array([row["seconds"] / len(row["positions"]) for row in rows])
    lines = []
    for name, times in (("train, new to the process", seconds), ("position", each)):
        figures = [*np.percentile(times, [50.0, 99.0]), times.max()]
        lines.append((name, *(f"{1e3 * f:.1f}" for f in figures)))
    return _table(("processor time [ms] per", "median", "99 %", "worst"), lines)


def _bounds(pairs: list[list[float]]) -> list[str]:
    """Return a table that compares the claimed bounds with true errors."""
    if not pairs:
        return []
    claimed, true = np.array(pairs).T
    # The reference itself has only some 50 digits.
    true = np.where(true < NO_TORQUE, 0.0, true)
    held = int((claimed >= true).sum())
    ratio = claimed[true > 0.0] / true[true > 0.0]
    lines = [("torques", str(len(claimed))), ("bound holds", str(held))]
    if len(ratio):
        lines.append(("bound over true error, median", f"{np.median(ratio):.1f}"))
    return _table(("bound", ""), lines)
