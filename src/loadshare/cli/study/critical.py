"""`loadshare critical`: the exact values at which contacts, floats and splines change."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from loadshare.cli.console import say, tell_note
from loadshare.cli.forms import (
    FIGURES,
    TABLES,
    Makers,
    Output,
    figure_of,
    outputs,
    tables_of,
    write_all,
)
from loadshare.cli.options import OVER, CaseFile, Changes, Positions, over, ranges_of
from loadshare.cli.refusal import ranges as numbers_text
from loadshare.cli.study.common import end, running_study
from loadshare.cli.tables.table import show, table

if TYPE_CHECKING:
    from loadshare.study.critical import Critical


def critical(
    case: CaseFile,
    key: Annotated[list[str] | None, typer.Argument(metavar="KEY", hidden=True)] = None,
    ranges: Annotated[
        list[str] | None,
        over(
            "FROM:TO",
            "Input to vary and its ends, as in rings.4.float='0 um:12 um'; KEY=KEY=FROM:TO ties "
            "keys; a star matches any name.",
        ),
    ] = None,
    start: Annotated[str | None, typer.Option("--from", metavar="VALUE", hidden=True)] = None,
    stop: Annotated[str | None, typer.Option("--to", metavar="VALUE", hidden=True)] = None,
    file: Annotated[list[Output] | None, outputs(*TABLES, *FIGURES)] = None,
    position: Positions = None,
    change: Changes = None,
) -> None:
    """Find where contacts, floats and splines change along an input, exactly."""
    from loadshare.study.critical import critical as found_along

    along, low, high = _range(ranges, key, start, stop)
    with running_study(case, change, "positions") as (loaded, tick):
        found = found_along(loaded, along, low, high, positions=position, progress=tick)
    show_critical(found)
    write_all(file, made_of_critical(found))
    end(found)


FORM = "KEY=FROM:TO, as in rings.4.float='0 um:12 um'"


def _range(
    given: list[str] | None, key: list[str] | None, start: str | None, stop: str | None
) -> tuple[list[str], str, str]:
    """Return the keys to vary and the ends, in the words of today or those of before."""
    if given:
        if key or start or stop:
            raise typer.BadParameter(
                "says it all: no other key, no --from, no --to", param_hint=OVER
            )
        if len(given) > 1:
            hint = "takes one range; tied keys are written KEY=KEY=FROM:TO"
            raise typer.BadParameter(hint, param_hint=OVER)
        ((keys, ends),) = ranges_of(given, FORM).items()
        return list(keys), *ends
    if not key or start is None or stop is None:
        raise typer.BadParameter(f"is missing: {FORM}", param_hint=OVER)
    tell_note(f"KEY --from FROM --to TO is now {OVER} KEY=FROM:TO.")
    return key, start, stop


def made_of_critical(found: Critical) -> Makers:
    """Return what makes the files of critical values."""
    unproved = [{"position": u.position, "from": u.start, "to": u.stop} for u in found.unproved]
    about = {"parameter": found.parameter.name, "unit": found.parameter.unit}
    tables = tables_of("critical", found.to_dataframe, **about, unproved=unproved)
    return {**tables, **figure_of(found.plot)}


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
    rows = ((*row, numbers_text(positions)) for row, positions in ordered)
    made = table((f"{found.parameter.name}{unit}", *words), rows, words)
    made.columns[0].no_wrap = False
    title = f"Events from {found.start:g} to {found.stop:g}{unit}"
    if alike:
        show(title, made)
    else:
        say(f"\n{title}: none")
    if not doubtful and not found.unproved:
        say("Proved between certified solves: there are no others.")
