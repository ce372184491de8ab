"""What a study could not answer, in lines for a console and a page."""

from __future__ import annotations

from functools import singledispatch

from loadshare.report.numbers import counted
from loadshare.study.critical import Critical
from loadshare.study.sweep import Sweep
from loadshare.study.tolerance.result import Tolerance

SHOWN = 5
"""Intervals that are named one by one."""


@singledispatch
def left_open(_: object) -> list[str]:
    """Return what a study could not answer; nothing if it answered everything."""
    return []


@left_open.register
def _(found: Sweep) -> list[str]:
    failed = [p for p in found.points if p.status != "certified"]
    if not failed:
        return []
    reasons = dict.fromkeys(f"{p.status}: {p.message.splitlines()[0]}" for p in failed)
    return [*reasons, f"{counted(len(failed), 'point')} of {len(found.points)} not certified."]


@left_open.register
def _(found: Critical) -> list[str]:
    count = sum(not event.confirmed for event in found.events)
    lines = [f"{counted(count, 'event')} of {len(found.events)} not confirmed."] if count else []
    named = sorted({(u.start, u.stop, u.why) for u in found.unproved})
    unit = f" {found.parameter.unit}" if found.parameter.unit else ""
    lines += [
        f"Not proved to be free of other events: {start:.12g} to {stop:.12g}{unit} ({why})."
        for start, stop, why in named[:SHOWN]
    ]
    if len(named) > SHOWN:
        lines.append(f"{counted(len(named) - SHOWN, 'further interval')} not proved.")
    return lines


@left_open.register
def _(found: Tolerance) -> list[str]:
    if not found.refused:
        return []
    return [f"{counted(found.refused, 'sample')} of {found.samples} not certified."]
