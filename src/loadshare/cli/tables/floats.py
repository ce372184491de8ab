"""Where the floating gears came to rest."""

from __future__ import annotations

import math
from collections import Counter

from rich.console import Console
from rich.table import Table

from loadshare.certify import FloatState
from loadshare.cli.tables.sharing import MOST
from loadshare.cli.tables.table import show, table
from loadshare.report.numbers import NONE, decimals, fixed, micrometres
from loadshare.report.undetermined import undetermined_told
from loadshare.results import Position, Result

TITLE = "Floating gears: displacement x, y and margin [µm], reaction of the ring [N]"


def print_floats(console: Console, result: Result) -> None:
    """Print where the floats rest, and what the forces leave open of that and of rotations."""
    if result.positions[0].floats:
        _print_rests(console, result.positions)
    told = undetermined_told(result.positions)
    for line in told:
        console.print(line)
    if told:
        console.print("Of what is not determined, the least displacement is given.")


def _print_rests(console: Console, positions: tuple[Position, ...]) -> None:
    """Print the rest of every float: alike everywhere, position by position, or summed up."""
    gears = list(positions[0].floats)
    forces = [math.hypot(*f.reaction) for p in positions for f in p.floats.values()]
    places = decimals(forces)
    splines = any(f.spline for p in positions for f in p.floats.values())
    each = {g: [_rest(p, g, places) for p in positions] for g in gears}
    alike = all(rests.count(rests[0]) == len(rests) for rests in each.values())
    if alike or len(positions) <= MOST:
        shown = _by_position(positions, each, splines, alike=alike)
    else:
        shown = _summed(positions, gears, splines)
    show(console, TITLE, shown)
    if alike and len(positions) > 1:
        console.print("The same at all positions.")


def _rest(position: Position, gear: str, places: int) -> tuple[str, ...]:
    rest = position.floats[gear]
    x, y = position.displacement[gear]
    reaction = fixed(math.hypot(*rest.reaction), places)
    state = _state(rest)
    cells = (state, micrometres(x), micrometres(y), micrometres(rest.margin), reaction)
    return (*cells, rest.spline or NONE)


def _state(rest: FloatState) -> str:
    return f"{rest.state}: {rest.boundary}" if rest.boundary else rest.state


def _by_position(
    positions: tuple[Position, ...],
    each: dict[str, list[tuple[str, ...]]],
    splines: bool,
    *,
    alike: bool,
) -> Table:
    made = table(
        (
            "gear",
            *(() if alike else ("at",)),
            *("rests", "x", "y", "margin", "reaction"),
            *(("spline",) if splines else ()),
        ),
        words=("gear", "rests", "spline"),
    )
    last = None if splines else -1
    for gear, rests in each.items():
        if alike:
            made.add_row(gear, *rests[0][:last])
            continue
        for position, rest in zip(positions, rests, strict=True):
            made.add_row(gear, str(position.position), *rest[:last])
    return made


def _summed(positions: tuple[Position, ...], gears: list[str], splines: bool) -> Table:
    made = table(
        (
            *("gear", "rests", "displacement", "margin", "reaction"),
            *(("spline",) if splines else ()),
        ),
        words=("gear", "rests", "spline"),
    )
    for gear in gears:
        rests = [p.floats[gear] for p in positions]
        moved = [1e6 * math.hypot(*p.displacement[gear]) for p in positions]
        margins = [1e6 * r.margin for r in rests if r.margin is not None]
        forces = [math.hypot(*r.reaction) for r in rests]
        cells = [
            gear,
            _shares(Counter(_state(r) for r in rests)),
            _span(moved),
            _span(margins),
            _span(forces),
        ]
        if splines:
            cells.append(_shares(Counter(r.spline or NONE for r in rests)))
        made.add_row(*cells)
    return made


def _span(values: list[float]) -> str:
    if not values:
        return NONE
    places = min(decimals(values), 3)
    low, high = fixed(min(values), places), fixed(max(values), places)
    return low if low == high else f"{low} … {high}"


def _shares(states: Counter[str]) -> str:
    """Return states, each with at how many positions it is found if there are several."""
    if len(states) == 1:
        return next(iter(states))
    return "\n".join(f"{state} ({count}×)" for state, count in states.most_common())
