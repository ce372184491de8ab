"""Whether displacements are small enough for the geometry, as a table."""

from __future__ import annotations

from loadshare.certify.validity import TOLD
from loadshare.report.numbers import NONE, runs, significant, small
from loadshare.report.page.table import Cell, Table, columns
from loadshare.results import Result


def validity_table(result: Result) -> Table:
    """Largest figures of the displacements over the positions, and their bounds."""
    rows = []
    for name, m, position in result.validity:
        nowhere = m.value == 0.0
        bounds = [Cell(NONE if b is None else significant(b, 3), b) for b in (m.warning, m.refusal)]
        rows.append(
            [
                Cell(TOLD[name]),
                Cell(NONE if nowhere else m.where),
                Cell(small(m.value), m.value),
                *bounds,
                Cell(NONE if nowhere else str(position), position),
            ]
        )
    told = advice(result)
    notes = [
        "Lines of action and stops are taken where they stand before anything moves; this is how "
        "far that holds."
    ]
    return Table(
        "Displacements: the largest, and the bounds of the geometry",
        columns(("figure", "where"), ("value", "warning above", "refused from", "position")),
        rows,
        [*notes, f"Warning: {told}"] if told else notes,
    )


def advice(result: Result) -> str:
    """What to think of displacements above the bound of a warning; empty if there are none."""
    names = dict.fromkeys(n for p in result.positions for n in p.validity.warned)
    if not names:
        return ""
    where = ", ".join(runs(p.position for p in result.positions if p.validity.warned))
    told = "; ".join(TOLD[name] for name in names)
    noun = "positions" if len(result.positions) > 1 else "position"
    return (
        f"displacements are large for the geometry in which they were found ({noun} {where}: "
        f"{told}); figures may be off by some per cent"
    )
