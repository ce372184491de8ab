"""What was found, as tables."""

from __future__ import annotations

from collections.abc import Sequence

from loadshare.report import records
from loadshare.report.figures.rest import places_told, rest_told
from loadshare.report.numbers import NONE, fixed, small
from loadshare.report.table import Cell, Table, chosen, columns
from loadshare.report.undetermined import undetermined_told
from loadshare.report.validity import advice
from loadshare.results import Result

FOLDED = 24
"""Rows from which a table is shown only when asked for."""


def omega_table(result: Result) -> Table:
    """Largest Ω of every stage and of the system, and where it is reached."""
    words = ("stage", "reached at", "reached at, group mean")
    rows = chosen(
        records.omegas(result), "stage", "stage at", "group at", "over stage", "over group"
    )
    return Table(
        "Load-sharing coefficient Ω, largest over branches and positions",
        columns(words, ("Ω over stage mean", "Ω over group mean")),
        [[cell if cell.text else Cell(NONE) for cell in row] for row in rows],
    )


def torque_table(result: Result) -> Table:
    """Torque of every mesh, summed up over the positions, and its largest Ω."""
    level = records.alike(result)
    torques = ("torque",) if level else ("least", "mean", "most")
    fields = ("mesh", "stage", *torques, "Ω stage", "Ω pair")
    rows = chosen(records.torques(result, "alike" if level else "summed"), *fields)
    rows = [[cell if cell.text else Cell(NONE) for cell in row] for row in rows]
    notes = []
    if level and len(result.positions) > 1:
        notes.append("The same at all positions.")
    elif not level:
        notes.append("Ω is the largest over the positions.")
    if any(cell.text == NONE for row in rows for cell in row):
        notes.append(f"{NONE}: not in a stage, or without load.")
    if not result.positions[0].floats:
        notes += _undetermined(result)
    figures = (*(f"{t} [N·m]" for t in torques), "Ω over stage mean", "Ω over group mean")
    return Table(
        "Torque on the driver of every mesh", columns(("mesh", "stage"), figures), rows, notes
    )


def position_table(result: Result) -> Table:
    """Torque and coefficients of every mesh at every position."""
    places = records.torque_places(result)
    rows = [
        [
            Cell(mesh),
            Cell(str(p.position), p.position),
            Cell(fixed(torque, places), torque),
            Cell(fixed(p.coast_torque[mesh], places), p.coast_torque[mesh]),
            *(records.largest([shares.get(mesh)]) for shares in (p.share, p.pair_share)),
        ]
        for p in result.positions
        for mesh, torque in p.torque.items()
    ]
    figures = ("position", "torque [N·m]", "coast flank [N·m]", "Ω stage", "Ω group")
    return Table("Every position", columns(("mesh",), figures), rows, folded=len(rows) > FOLDED)


def float_table(result: Result) -> Table:
    """Where every float rests; positions at which nothing differs stand in one row."""
    places = records.reaction_places(result.positions)
    rows = []
    for gear in result.positions[0].floats:
        alike: dict[tuple[str, ...], list[tuple[int, records.Record]]] = {}
        for p in result.positions:
            here = records.rest(p, gear, places)
            (rests, *_) = rest_told([p.floats[gear]], [p.position])
            texts = (rests, *(cell.text for cell in here.values()))
            alike.setdefault(texts, []).append((p.position, here))
        for (rests, *_), where in alike.items():
            numbers = [position for position, _ in where]
            (figures,) = chosen([where[0][1]], "x", "y", "margin", "reaction")
            spline = where[0][1]["spline"]
            at = Cell(places_told(numbers), numbers[0])
            rows.append([Cell(gear), Cell(rests), spline, at, *figures])
    heads = ("position", "x [µm]", "y [µm]", "margin [µm]", "reaction [N]")
    return Table(
        "Floating gears",
        columns(("gear", "rests", "spline"), heads),
        rows,
        _undetermined(result),
        folded=len(rows) > FOLDED,
    )


def _undetermined(result: Result) -> list[str]:
    """Notes on what the forces leave open."""
    notes = [f"{told[0].upper()}{told[1:]}." for told in undetermined_told(result.positions)]
    return notes + (
        ["Of what is not determined, the least displacement is given."] if notes else []
    )


def validity_table(result: Result) -> Table:
    """Largest figures of the displacements over the positions, and their bounds."""
    told = advice(result)
    notes = [
        "Lines of action and stops are taken where they stand before anything moves; this is how "
        "far that holds.",
        *([f"Warning: {told}"] if told else []),
    ]
    return Table(
        "Displacements: the largest, and the bounds of the geometry",
        columns(("figure", "where"), ("value", "warning above", "refused from", "position")),
        chosen(
            records.measures(result), "figure", "where", "value", "warning", "refusal", "position"
        ),
        notes,
    )


def certificate_table(result: Result) -> Table:
    """Worst value of every residual over the positions."""
    return Table(
        "Certificate: the worst residuals",
        columns(("figure", "where", "unit"), ("value", "scaled", "position")),
        chosen(records.residuals(result), "figure", "where", "unit", "value", "scaled", "position"),
        [
            "Recomputed from the answer and the physics alone; a scaled residual is a part of the "
            f"case's load or deflection. Allowed: {result.stamp.tolerance:.0e}.",
            "Every torque lies within "
            f"{small(max(p.certificate.bound.relative for p in result.positions))} of the exact "
            "equilibrium's, as a part of the largest torque.",
            f"{result.uniqueness.told[0].upper()}{result.uniqueness.told[1:]}.",
        ],
    )


def effort_told(result: Result) -> str:
    """How the positions were solved, in a sentence."""
    efforts = [p.effort for p in result.positions]
    stamp = result.stamp
    kinds = ", ".join(dict.fromkeys(e.kind for e in efforts))
    ways = ", ".join(dict.fromkeys(e.rung for e in efforts))
    passes = _passes([e.iterations for e in efforts])
    return (
        f"Solver {stamp.solver}, outer loop {stamp.method}{passes}; programme: {kinds}; "
        f"rung of the ladder: {ways}."
    )


def _passes(iterations: Sequence[int]) -> str:
    low, high = min(iterations), max(iterations)
    if high == 0:
        return ""
    count = str(low) if low == high else f"{low} to {high}"
    return f" with {count} pass" + ("" if count == "1" else "es")
