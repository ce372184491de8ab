"""Where the floating gears came to rest."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator

from loadshare.certify import FloatState
from loadshare.cli.console import say_all
from loadshare.cli.tables.sharing import MOST
from loadshare.cli.tables.table import show, table
from loadshare.report import records
from loadshare.report.numbers import NONE, decimals, fixed
from loadshare.report.undetermined import undetermined_told
from loadshare.results import Position, Result

TITLE = "Floating gears: displacement x, y and margin [µm], reaction of the ring [N]"


def print_floats(result: Result) -> None:
    """Print where the floats rest, and what the forces leave open of that and of rotations."""
    if result.positions[0].floats:
        _print_rests(result.positions)
    told = undetermined_told(result.positions)
    note = "Of what is not determined, the least displacement is given."
    say_all([*told, *([note] if told else [])])


def _print_rests(positions: tuple[Position, ...]) -> None:
    """Print the rest of every float: alike everywhere, position by position, or summed up."""
    places = records.reaction_places(positions)
    each = {g: [_rest(p, g, places) for p in positions] for g in positions[0].floats}
    alike = all(rests.count(rests[0]) == len(rests) for rests in each.values())
    heads = ["gear", "rests", "x", "y", "margin", "reaction", "spline"]
    rows: list[tuple[str, ...]]
    if alike:
        rows = [(gear, *rests[0]) for gear, rests in each.items()]
    elif len(positions) <= MOST:
        heads.insert(1, "at")
        rows = [
            (gear, str(p.position), *rest)
            for gear, rests in each.items()
            for p, rest in zip(positions, rests, strict=True)
        ]
    else:
        heads[2:4] = ["displacement"]
        rows = [(gear, *_summed(positions, gear)) for gear in each]
    if not any(f.spline for p in positions for f in p.floats.values()):
        heads, rows = heads[:-1], [row[:-1] for row in rows]
    show(TITLE, table(heads, rows, words=("gear", "rests", "spline")))
    say_all(["The same at all positions."] if alike and len(positions) > 1 else [])


def _rest(position: Position, gear: str, places: int) -> tuple[str, ...]:
    cells = records.rest(position, gear, places).values()
    return _state(position.floats[gear]), *(cell.text for cell in cells)


def _state(rest: FloatState) -> str:
    return f"{rest.state}: {rest.boundary}" if rest.boundary else rest.state


def _summed(positions: tuple[Position, ...], gear: str) -> Iterator[str]:
    rests = [p.floats[gear] for p in positions]
    yield _shares(_state(r) for r in rests)
    yield _span([1e6 * math.hypot(*p.displacement[gear]) for p in positions])
    yield _span([1e6 * r.margin for r in rests if r.margin is not None])
    yield _span([math.hypot(*r.reaction) for r in rests])
    yield _shares(r.spline or NONE for r in rests)


def _span(values: list[float]) -> str:
    if not values:
        return NONE
    places = min(decimals(values), 3)
    low, high = fixed(min(values), places), fixed(max(values), places)
    return low if low == high else f"{low} … {high}"


def _shares(states: Iterable[str]) -> str:
    """Return states, each with at how many positions it is found if there are several."""
    counts = Counter(states)
    if len(counts) == 1:
        return next(iter(counts))
    return "\n".join(f"{state} ({count}×)" for state, count in counts.most_common())
