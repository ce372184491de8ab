"""Verdict on one path: its events against a scan and a path with another end."""

from __future__ import annotations

import time
import traceback
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

import loadshare as ls
from benchmarks.critical_paths.compare import apart, between, compared
from benchmarks.critical_paths.draw import Path, random_path, text
from benchmarks.critical_paths.scan import scanned
from loadshare.errors import Refused
from loadshare.study.critical import Critical
from loadshare.study.follow.line import Line

Array = NDArray[np.float64]
StatesByName = NDArray[np.str_]
EVERY = 3
"""One path in this many is also followed to another end."""


@dataclass(slots=True)
class Outcome:
    """The result for one path.

    Attributes
    ----------
    keys, unit, start, stop
        Those of the path.
    seconds, scanning : float
        Processor time to find its events, and of the scan.
    events, unproved, unconfirmed : int
        Numbers of events, unproved intervals and unconfirmed events.
    width : float
        Width of the unproved intervals, over the range.
    asked : int
        Number of samples of the scan with a certified answer.
    missed, invented : list of str
        Changes that only the scan, or only the events show.
    moved : list of str
        Events that differ on a path with another end.
    refused, raised : str
        Why there are no events.
    """

    keys: tuple[str, ...]
    unit: str
    start: float
    stop: float
    seconds: float = 0.0
    scanning: float = 0.0
    events: int = 0
    unproved: int = 0
    width: float = 0.0
    unconfirmed: int = 0
    asked: int = 0
    missed: list[str] = field(default_factory=list)
    invented: list[str] = field(default_factory=list)
    moved: list[str] = field(default_factory=list)
    refused: str = ""
    raised: str = ""


def judged(path: Path, points: int, engine: str) -> Outcome:
    """Find a path's events, and compare them with a scan and with a path of another end."""
    outcome = Outcome(path.keys, path.unit, path.start, path.stop)
    try:
        start = time.process_time()
        found = followed(path, path.stop)
        outcome.seconds = time.process_time() - start
        again = followed(path, path.other) if path.number % EVERY == 0 else found
        start = time.process_time()
        values, seen = shown(path, found, min(points, 1000) if path.machines else points, engine)
        outcome.scanning = time.process_time() - start
        outcome.asked = _answered(seen, len(values))
    except Refused as refusal:
        outcome.refused = str(refusal).splitlines()[0]
        return outcome
    except Exception:  # noqa: BLE001 -- whatever escapes is what is counted
        outcome.raised = traceback.format_exc(limit=-4)
        return outcome
    outcome.events = len(found.events)
    outcome.unproved = len(found.unproved)
    outcome.width = sum(u.stop - u.start for u in found.unproved) / (path.stop - path.start)
    outcome.unconfirmed = sum(not e.confirmed for e in found.events)
    outcome.missed, outcome.invented = compared(found, values, seen)
    outcome.moved = apart(found, again)
    return outcome


def followed(path: Path, stop: float) -> Critical:
    """Return a path's events up to an end."""
    ends = [text(v, path.unit) for v in (path.start, stop)]
    return ls.critical(path.case, path.keys, *ends, positions=[1])


def shown(
    path: Path, found: Critical, points: int, engine: str
) -> tuple[Array, dict[str, StatesByName]]:
    """Scan a path at `points` values and between its events; return the values and states."""
    line = Line(path.case, found.parameter, path.start, path.stop)
    values = np.union1d(np.linspace(path.start, path.stop, points), between(found))
    return values, scanned(path, line, values, engine)


def _answered(seen: Mapping[str, StatesByName], count: int) -> int:
    """Return the number of samples in which any state is known."""
    answered = np.zeros(count, dtype=bool)
    for states_by_name in seen.values():
        answered |= states_by_name != ""
    return int(answered.sum())


def one(points: int, engine: str, number: int) -> dict[str, Any]:
    """Judge one path; return plain data."""
    return asdict(judged(random_path(number), points, engine))
