"""`loadshare critical`: the exact values at which contacts, floats and splines change."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from loadshare.cli.console import say
from loadshare.cli.exits import counted
from loadshare.cli.options import CaseFile
from loadshare.cli.refusal import ranges
from loadshare.cli.study.common import Changes, CsvFile, Positions, asked, end, write_table
from loadshare.cli.tables.table import show, table

if TYPE_CHECKING:
    import pandas as pd

    from loadshare.study.critical import Critical

SHOWN = 5
"""Intervals that are named one by one."""


def critical(
    case: CaseFile,
    key: Annotated[
        list[str],
        typer.Argument(metavar="KEY", help="Input to vary; several take the same value."),
    ],
    start: Annotated[str, typer.Option("--from", metavar="VALUE", help="Where it starts.")],
    stop: Annotated[str, typer.Option("--to", metavar="VALUE", help="Where it stops.")],
    file: CsvFile = None,
    position: Positions = None,
    change: Changes = None,
) -> None:
    """Find where contacts, floats and splines change along an input, exactly."""
    from loadshare.study.critical import critical as found_along

    with asked(case, change, "positions") as (loaded, tick):
        found = found_along(loaded, key, start, stop, positions=position, progress=tick)
    show_critical(found)
    write_table(file, lambda: events_frame(found))
    end(unconfirmed(found))


def unconfirmed(found: Critical) -> list[str]:
    """Return what is to be said of what was not proved; nothing if all was."""
    count = sum(not event.confirmed for event in found.events)
    lines = [f"{counted(count, 'event')} of {len(found.events)} not confirmed."] if count else []
    named = sorted({(u.start, u.stop, u.why) for u in found.unproved})
    unit = f" {found.parameter.unit}" if found.parameter.unit else ""
    lines += [
        f"Not proved to hold no other event: {start:.12g} to {stop:.12g}{unit} ({why})."
        for start, stop, why in named[:SHOWN]
    ]
    if len(named) > SHOWN:
        lines.append(f"{counted(len(named) - SHOWN, 'further interval')} not proved.")
    return lines


def events_frame(found: Critical) -> pd.DataFrame:
    """Return the events as a table."""
    import pandas as pd

    from loadshare.study.event import Event

    columns = Event.__slots__
    return pd.DataFrame([[getattr(e, c) for c in columns] for e in found.events], columns=columns)


def show_critical(found: Critical) -> None:
    """Print every event, and the positions at which it is found alike."""
    unit = f" [{found.parameter.unit}]" if found.parameter.unit else ""
    doubtful = not all(e.confirmed for e in found.events)
    alike: dict[tuple[str, ...], list[int]] = {}
    for e in found.events:
        confirmed = ["yes" if e.confirmed else "NO"] if doubtful else []
        row = (f"{e.value:.9g}", e.element, e.kind, e.before, e.after, *confirmed)
        alike.setdefault(row, []).append(e.position)
    words = ("element", "event", "below", "above", *(["confirmed"] if doubtful else []), "at")
    ordered = sorted(alike.items(), key=lambda item: float(item[0][0]))
    rows = ((*row, ranges(positions)) for row, positions in ordered)
    made = table((f"{found.parameter.name}{unit}", *words), rows, words)
    made.columns[0].no_wrap = False
    title = f"Events from {found.start:g} to {found.stop:g}{unit}"
    if alike:
        show(title, made)
    else:
        say(f"\n{title}: none")
    if not doubtful and not found.unproved:
        say("Proved between certified solves: there are no others.")
