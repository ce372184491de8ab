"""Comparison of the events of a path with a scan, and with those of a path with another end."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from benchmarks.critical_paths.scan import StatesByName
from loadshare.study.critical import Critical
from loadshare.study.events import Event

Array = NDArray[np.float64]
NEAR = 2e-9
"""Relative distance from an event within which the state of a sample is not compared."""
SAME = 1e-11
"""Distance, over the largest value, within which two paths have the same event."""


def compared(found: Critical, values: Array, seen: StatesByName) -> tuple[list[str], list[str]]:
    """Return the changes that events miss, and those that they report but a scan does not show.

    Samples in intervals that are named as not proved are left out; beyond each of them the state is
    taken from the scan again.
    """
    missed: list[str] = []
    invented: list[str] = []
    edges = [found.start, *(v for u in found.unproved for v in (u.start, u.stop)), found.stop]
    for name, states in seen.items():
        events = [e for e in found.events if e.element == name]
        for low, high in zip(edges[::2], edges[1::2], strict=True):
            inner = [e for e in events if low <= e.value <= high and e.confirmed]
            rows = np.flatnonzero((values >= low) & (values <= high) & (states != ""))
            wrong = _disagreement(inner, values[rows], states[rows])
            if wrong is None:
                continue
            changes = int((states[rows][1:] != states[rows][:-1]).sum())
            where = f"{name} at {values[rows][wrong]:.12g}: {changes} changes, {len(inner)} events"
            (missed if changes >= len(inner) else invented).append(where)
    return missed, invented


def _disagreement(events: Sequence[Event], values: Array, states: NDArray[np.str_]) -> int | None:
    """Return the first sample whose state contradicts the events; None if all agree."""
    if not len(values):
        return None
    before = states[0] if not events else events[0].before
    expected = np.full(len(values), before, dtype=states.dtype)
    clear = np.ones(len(values), dtype=bool)
    for event in events:
        expected = np.where(values > event.value, event.after, expected)
        clear &= np.abs(values - event.value) > NEAR * max(abs(event.value), values[-1] - values[0])
    wrong = np.flatnonzero(clear & (expected != states))
    return int(wrong[0]) if len(wrong) else None


def between(found: Critical) -> Array:
    """Return values between neighbouring events, where the steps of a scan may be too wide."""
    ends = sorted({found.start, found.stop, *(e.value for e in found.events)})
    return np.array([0.5 * (a + b) for a, b in pairwise(ends)])


def apart(found: Critical, other: Critical) -> list[str]:
    """Return the events that differ between two ranges, where both contain them."""
    largest = max(abs(found.stop), abs(found.start))
    size = 1e-9 * largest
    top = other.stop - size
    sets = []
    for one in (found, other):
        named = [(u.start, u.stop) for u in (*found.unproved, *other.unproved)]
        sets.append(
            [
                e
                for e in one.events
                if e.value <= top and not any(a - size <= e.value <= b + size for a, b in named)
            ]
        )
    here, there = sets
    if len(here) != len(there):
        return [f"{len(here)} events up to {other.stop:.12g}, {len(there)} in the shorter range"]
    return [
        f"{a.element} at {a.value:.15g} or {b.value:.15g}"
        for a, b in zip(here, there, strict=True)
        if abs(a.value - b.value) > SAME * largest or (a.element, a.after) != (b.element, b.after)
    ]
