"""Several cases side by side: the inputs and the figures that differ."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from loadshare.case import Case
from loadshare.case.content import ABOUT
from loadshare.case.keys import dotted, values_in
from loadshare.numbers import NONE, counted, engineering, omega, significant
from loadshare.report.page.inputs import written
from loadshare.report.words import rest_lines
from loadshare.results import Result
from loadshare.table import FOLDED, Cell, Column, Table

SAME = 1e-9
"""Difference of two figures that is round-off, as a part of the largest figure in their unit."""

Figures = dict[tuple[str, str], tuple[float, str]]


def comparison(names: Sequence[str], results: Sequence[Result]) -> list[Table]:
    """Return the tables of what differs between results: figures, rests of floats, inputs.

    Parameters
    ----------
    names : sequence of str
        Names of the results, for the titles of columns.
    results : sequence of Result
        Two or more; differences are against the first.
    """
    return [
        _differing_inputs(names, [result.solved for result in results]),
        _differing_figures(names, results),
        *_differing_rests(names, results),
    ]


def _differing_inputs(names: Sequence[str], cases: Sequence[Case]) -> Table:
    found = [
        {key: written(v) for key, v in values_in(case.to_dict()) if key[0] not in ABOUT}
        for case in cases
    ]
    keys = dict.fromkeys(key for one in found for key in one)
    rows = [
        [Cell(dotted(key)), *(Cell(one.get(key, NONE)) for one in found)]
        for key in keys
        if len({one.get(key) for one in found}) > 1
    ]
    columns = [Column("input"), *map(Column, names)]
    alike = len(keys) - len(rows)
    notes = [f"The same in all cases: {counted(alike, 'other input')}."] if alike else []
    if not rows:
        notes = [f"All {len(keys)} inputs are the same."]
    return Table("Inputs that differ", columns, rows, notes, folded=len(rows) > FOLDED)


def _differing_figures(names: Sequence[str], results: Sequence[Result]) -> Table:
    """Return the figures that differ: Ω, then all others, those that change most first."""
    found = [_figures(result) for result in results]
    shared = [key for key in found[0] if any(key in other for other in found[1:])]
    largest: dict[str, float] = {}
    for value, unit in (figure for one in found for figure in one.values()):
        largest[unit] = max(largest.get(unit, 0.0), abs(value))
    rows: list[tuple[bool, float, list[Cell]]] = []
    for key in shared:
        values = [one[key][0] if key in one else None for one in found]
        base = values[0] or 0.0
        changes = [None if v is None else v - base for v in values[1:]]
        scale = max(abs(v) for v in values if v is not None)
        most = max(abs(c) for c in changes if c is not None)
        unit = found[0][key][1]
        if most <= SAME * largest[unit]:
            continue
        relative = most / abs(base) if base else math.inf
        cells = [Cell(key[0]), Cell(key[1])]
        cells += [Cell(_figure(v, unit, scale), v) for v in values]
        cells += [_change(c, base) for c in changes]
        rows.append((bool(unit), -relative, cells))
    rows.sort(key=lambda row: row[:2])
    against = "change" if len(names) == 2 else "change to {}"
    columns = [Column("figure"), Column("of")]
    columns += [Column(name, True) for name in names]
    columns += [Column(against.format(name), True) for name in names[1:]]
    alike = len(shared) - len(rows)
    notes = [
        "The largest over the positions; changes are relative to the first case's figure.",
        *([f"Equal within round-off: {counted(alike, 'other figure')}."] if alike else []),
    ]
    return Table("Figures that differ", columns, [cells for _, _, cells in rows], notes)


def _figure(value: float | None, unit: str, scale: float) -> str:
    if value is None:
        return NONE
    if not unit:
        return omega(value)
    read = engineering([scale], unit)
    return f"{significant(read.of(value), 5)} {read.name}"


def _change(change: float | None, base: float) -> Cell:
    if change is None:
        return Cell(NONE)
    if not base:
        return Cell("from 0" if change else "0 %")
    percent = 100.0 * change / base
    return Cell(f"{significant(percent, 3).replace('-', '−')} %", percent)


def _figures(result: Result) -> Figures:
    """Return every figure that can be compared: its value and its SI unit."""
    found: Figures = {}
    for means, name in ((result.omega, "Ω over stage"), (result.pair_omega, "Ω over group")):
        for stage, value in means.items():
            of = "the system" if stage == "system" else f"stage {stage}"
            if value is not None:
                found[name, of] = (value, "")
    for p in result.positions:
        torques = {("torque on the driver", f"mesh {m}"): t for m, t in p.torque.items()}
        bearings = {
            ("force on the bearing or pin", f"gear {g}"): math.hypot(*f)
            for g, f in p.loads.bearings.items()
        }
        shafts = {("torque", f"shaft {s}"): abs(t) for s, t in p.loads.shafts.items()}
        rings = {
            ("reaction of the ring", f"gear {g}"): math.hypot(*f.reaction)
            for g, f in p.floats.items()
        }
        for values, unit in ((torques | shafts, "N·m"), (bearings | rings, "N")):
            for key, value in values.items():
                if key not in found or abs(value) > abs(found[key][0]):
                    found[key] = (value, unit)
    errors = [p.elastic.transmission_error["input"] for p in result.positions]
    found["transmission error, largest", "input"] = (max(errors, key=abs), "rad")
    least = min(p.elastic.torsional_stiffness["input"] for p in result.positions)
    found["stiffness, least", "input"] = (least, "N·m/rad")
    return found


def _differing_rests(names: Sequence[str], results: Sequence[Result]) -> Iterator[Table]:
    """Yield where floats rest, if this differs between results."""
    gears = dict.fromkeys(g for result in results for g in result.positions[0].floats)
    rows = []
    for gear in gears:
        texts = [_rests(result, gear) for result in results]
        if len(set(texts)) > 1:
            rows.append([Cell(gear), *map(Cell, texts)])
    if rows:
        yield Table(
            "Floats that rest in different places", [Column("gear"), *map(Column, names)], rows
        )


def _rests(result: Result, gear: str) -> str:
    if gear not in result.positions[0].floats:
        return NONE
    rests = [p.floats[gear] for p in result.positions]
    return rest_lines(rests, [p.position for p in result.positions])[0]
