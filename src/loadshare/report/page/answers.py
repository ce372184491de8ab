"""What was found, as tables."""

from __future__ import annotations

import math
from collections.abc import Sequence

from loadshare.report.figures.rest import places_told, rest_told
from loadshare.report.numbers import NONE, decimals, fixed, micrometres, omega, small
from loadshare.report.page.table import Cell, Table, columns
from loadshare.report.reached import reached
from loadshare.report.undetermined import undetermined_told
from loadshare.results import Position, Result

FOLDED = 24
"""Rows from which a table is shown only when asked for."""


def omega_table(result: Result) -> Table:
    """Largest Ω of every stage and of the system, and where it is reached."""
    stage = [(p.position, p.share) for p in result.positions]
    pair = [(p.position, p.pair_share) for p in result.positions]
    rows = [
        [
            Cell(name),
            Cell(reached(stage, result.stages.get(name, ())) or NONE),
            Cell(reached(pair, result.stages.get(name, ())) or NONE),
            Cell(omega(value), value),
            Cell(omega(result.pair_omega[name]), result.pair_omega[name]),
        ]
        for name, value in result.omega.items()
    ]
    words = ("stage", "reached at", "reached at, group mean")
    return Table(
        "Load-sharing coefficient Ω, largest over branches and positions",
        columns(words, ("Ω over stage mean", "Ω over group mean")),
        rows,
    )


def alike(result: Result) -> bool:
    """Whether every mesh carries the same at all positions, as far as it is printed."""
    return all(len(set(texts)) == 1 for texts in _torque_texts(result).values())


def torque_table(result: Result) -> Table:
    """Torque of every mesh, summed up over the positions, and its largest Ω."""
    places = _places(result)
    level = alike(result)
    rows = []
    for mesh in result.positions[0].torque:
        torques = [p.torque[mesh] for p in result.positions]
        mean = math.fsum(torques) / len(torques)
        summary = (mean,) if level else (min(torques), mean, max(torques))
        rows.append(
            [
                Cell(mesh),
                Cell(_stages(result, mesh) or NONE),
                *(Cell(fixed(v, places), v) for v in summary),
                *_largest([p.share.get(mesh) for p in result.positions]),
                *_largest([p.pair_share.get(mesh) for p in result.positions]),
            ]
        )
    torque = ("torque [N·m]",) if level else ("least [N·m]", "mean [N·m]", "most [N·m]")
    notes = []
    if level and len(result.positions) > 1:
        notes.append("The same at all positions.")
    elif not level:
        notes.append("Ω is the largest over the positions.")
    if any(cell.text == NONE for row in rows for cell in row):
        notes.append(f"{NONE}: not in a stage, or without load.")
    if not result.positions[0].floats:
        notes += _undetermined(result)
    return Table(
        "Torque on the driver of every mesh",
        columns(("mesh", "stage"), (*torque, "Ω over stage mean", "Ω over group mean")),
        rows,
        notes,
    )


def _places(result: Result) -> int:
    return decimals(t for p in result.positions for t in p.torque.values())


def _torque_texts(result: Result) -> dict[str, list[str]]:
    """Torques of every mesh as they are printed."""
    places = _places(result)
    meshes = result.positions[0].torque
    return {mesh: [fixed(p.torque[mesh], places) for p in result.positions] for mesh in meshes}


def position_table(result: Result) -> Table:
    """Torque and coefficients of every mesh at every position."""
    places = _places(result)
    rows = [
        [
            Cell(mesh),
            Cell(str(p.position), p.position),
            Cell(fixed(torque, places), torque),
            Cell(fixed(p.coast_torque[mesh], places), p.coast_torque[mesh]),
            *_largest([p.share.get(mesh)]),
            *_largest([p.pair_share.get(mesh)]),
        ]
        for p in result.positions
        for mesh, torque in p.torque.items()
    ]
    figures = ("position", "torque [N·m]", "coast flank [N·m]", "Ω stage", "Ω group")
    return Table("Every position", columns(("mesh",), figures), rows, folded=len(rows) > FOLDED)


def float_table(result: Result) -> Table:
    """Where every float rests; positions at which nothing differs stand in one row."""
    forces = [math.hypot(*f.reaction) for p in result.positions for f in p.floats.values()]
    places = decimals(forces)
    rows = []
    for gear in result.positions[0].floats:
        alike: dict[tuple[str, ...], list[Position]] = {}
        for p in result.positions:
            alike.setdefault(_rest(p, gear, places), []).append(p)
        for (rests, *texts, spline), where in alike.items():
            numbers = [p.position for p in where]
            rest = where[0].floats[gear]
            x, y = where[0].displacement[gear]
            values = (x, y, rest.margin, math.hypot(*rest.reaction))
            rows.append(
                [
                    Cell(gear),
                    Cell(rests),
                    Cell(spline),
                    Cell(places_told(numbers), numbers[0]),
                    *(Cell(t, v) for t, v in zip(texts, values, strict=True)),
                ]
            )
    figures = ("position", "x [µm]", "y [µm]", "margin [µm]", "reaction [N]")
    return Table(
        "Floating gears",
        columns(("gear", "rests", "spline"), figures),
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


def certificate_table(result: Result) -> Table:
    """Worst value of every residual over the positions."""
    rows = []
    for name in result.positions[0].certificate.residuals:
        worst = max(result.positions, key=lambda p: p.certificate.residuals[name].scaled)
        residual = worst.certificate.residuals[name]
        nowhere = residual.scaled == 0.0
        rows.append(
            [
                Cell(name.replace("_", " ")),
                Cell(NONE if nowhere else residual.where or NONE),
                Cell(residual.unit),
                Cell(small(residual.value), residual.value),
                Cell(small(residual.scaled), residual.scaled),
                Cell(NONE if nowhere else str(worst.position), worst.position),
            ]
        )
    return Table(
        "Certificate: the worst residuals",
        columns(("figure", "where", "unit"), ("value", "scaled", "position")),
        rows,
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


def _rest(position: Position, gear: str, places: int) -> tuple[str, ...]:
    rest = position.floats[gear]
    x, y = position.displacement[gear]
    return (
        rest_told([rest], [position.position])[0],
        micrometres(x),
        micrometres(y),
        micrometres(rest.margin),
        fixed(math.hypot(*rest.reaction), places),
        rest.spline or NONE,
    )


def _stages(result: Result, mesh: str) -> str:
    return ", ".join(stage for stage, meshes in result.stages.items() if mesh in meshes)


def _largest(shares: Sequence[float | None]) -> list[Cell]:
    value = max((s for s in shares if s is not None), default=None)
    return [Cell(omega(value), value)]
