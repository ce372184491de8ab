"""The results of a run of random paths, as Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np

from benchmarks.machine_facts import facts

Row = dict[str, Any]
FAULTS = ("missed", "invented", "moved")


def text(rows: Sequence[Row]) -> str:
    """Return a table of all paths, and a list of those that need a closer look."""
    faults = [line for row in rows for line in _fault_lines(row)]
    parts = [
        summary(rows),
        *(["", "Intervals that are not proved, and faults:", "", *faults] if faults else []),
    ]
    return "\n".join([*parts, "", "The machine:", "", _table(facts().items())])


def _fault_lines(row: Row) -> Iterator[str]:
    faults = [*(line for name in FAULTS for line in row[name]), row["refused"], row["raised"]]
    if any(faults) or row["unproved"]:
        ends = f"{row['start']:.6g} to {row['stop']:.6g} {row['unit']}"
        gaps = f"{row['unproved']} unproved, {row['width']:.1e} of the range"
        yield f"- {row['number']}: {', '.join(row['keys'])} {ends}: {gaps}"
        yield from (f"    - {line}" for line in faults if line)


def summary(every: Sequence[Row]) -> str:
    """Return a Markdown table of many paths."""
    answered = [o for o in every if not o["refused"] and not o["raised"]]
    seconds = np.array([o["seconds"] for o in answered] or [0.0])
    scans = [o["scanning"] for o in answered] or [0.0]
    rows = [
        ("paths", str(len(every))),
        ("refused at an end", str(sum(bool(o["refused"]) for o in every))),
        ("exceptions", str(sum(bool(o["raised"]) for o in every))),
        ("events", str(sum(o["events"] for o in answered))),
        ("certified samples of scans", str(sum(o["asked"] for o in answered))),
        *((name, str(sum(len(o[name]) for o in answered))) for name in FAULTS[:2]),
        ("other with another end", str(sum(len(o["moved"]) for o in answered))),
        ("paths with intervals named as not proved", str(sum(o["unproved"] > 0 for o in answered))),
        ("widest of them, of the range", f"{max((o['width'] for o in answered), default=0.0):.1e}"),
        ("events not confirmed", str(sum(o["unconfirmed"] for o in answered))),
        ("median processor time of a path [s]", f"{np.median(seconds):.2f}"),
        ("longest [s]", f"{seconds.max():.1f}"),
        ("mean [s]", f"{seconds.mean():.2f}"),
        ("mean processor time of a scan [s]", f"{np.mean(scans):.2f}"),
    ]
    return _table(rows)


def _table(rows: Iterable[tuple[str, object]]) -> str:
    return "\n".join(["| | |", "|---|---|", *(f"| {name} | {value} |" for name, value in rows)])
