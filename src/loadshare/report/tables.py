"""Results as tables, for screen and page; a screen leaves out their notes."""

from __future__ import annotations

from collections.abc import Sequence

from loadshare.numbers import small
from loadshare.report import records
from loadshare.report.words import advice, places_text, rest_lines, undetermined_lines
from loadshare.results import Result
from loadshare.table import FOLDED, Cell, Record, Table, table

OMEGAS = {"Ω stage": "Ω over stage mean", "Ω pair": "Ω over group mean"}
WORDS = ("figure", "unit", "where")
MESHES = {
    "torque": "torque [N·m]",
    "coast flank": "coast flank [N·m]",
    "error": "error [µm]",
    "stiffness": "stiffness [N/µm]",
    "at the driver": "at the driver [N·m/rad]",
}


def omega_table(result: Result) -> Table:
    """Return the largest Ω of every stage and of the system, and where it is reached."""
    return table(
        "Load-sharing coefficient Ω: largest over branches and positions",
        records.omegas(result),
        ("stage", "over stage", "stage at", "over group", "group at"),
        ("stage", "stage at", "group at"),
        {
            "over stage": "over stage mean",
            "stage at": "reached at",
            "over group": "over group mean",
            "group at": "reached at",
        },
    )


def torque_table(result: Result) -> Table:
    """Return the torque of every mesh, summarised over the positions, and its largest Ω."""
    level = records.alike(result)
    torques = ("torque",) if level else ("least", "mean", "most")
    rows = list(records.torques(result, "alike" if level else "summed"))
    figures = (*torques, "Ω stage", "Ω pair")
    notes = records.torque_notes(result, rows)
    if not result.positions[0].floats:
        notes += _undetermined(result)
    heads = OMEGAS | {t: f"{t} [N·m]" for t in torques}
    title = "Torque on the driver of every mesh"
    words = ("mesh", "stage")
    return table(title, rows, (*words, *figures), words, heads, notes)


def position_table(result: Result) -> Table:
    """Return every mesh at every position: its point of the cycle, load, Ω and stiffness."""
    rows = list(records.meshes(result))
    notes = [
        "The error is the transmission error along the line of action; stiffnesses are tangents."
    ]
    title = "Meshes at every position"
    return table(title, rows, rows[0], ("mesh",), MESHES, notes, most=FOLDED)


def yield_table(result: Result) -> Table:
    """Return the transmission error of the train and its stiffness at every position."""
    rows = list(records.yielding(result))
    notes = [
        "The rotation of the input beyond that given by its ratio to the output, and the tangent "
        "of torque over rotation.",
        records.error_text(result),
    ]
    title = "Transmission error [µrad] and stiffness [N·m/rad] of the train"
    return table(title, rows, rows[0], (), notes=notes, most=FOLDED)


def float_table(result: Result) -> Table:
    """Return where every float rests; positions at which nothing differs share a row."""
    places = records.reaction_places(result.positions)
    rows: list[Record] = []
    for gear in result.positions[0].floats:
        alike: dict[tuple[str, ...], tuple[Record, list[int]]] = {}
        for p in result.positions:
            (rests, *_) = rest_lines([p.floats[gear]], [p.position])
            row = {"gear": Cell(gear), "rests": Cell(rests), **records.rest(p, gear, places)}
            same = alike.setdefault(tuple(cell.text for cell in row.values()), (row, []))
            same[1].append(p.position)
        rows += [row | {"position": Cell(places_text(k), k[0])} for row, k in alike.values()]
    units = {"x": "µm", "y": "µm", "margin": "µm", "reaction": "N"}
    return table(
        "Floating gears",
        rows,
        ("gear", "rests", "spline", "position", *units),
        ("gear", "rests", "spline"),
        {name: f"{name} [{unit}]" for name, unit in units.items()},
        _undetermined(result),
        FOLDED,
    )


def _undetermined(result: Result) -> list[str]:
    """Return notes on what the forces leave undetermined."""
    notes = [f"{line[0].upper()}{line[1:]}." for line in undetermined_lines(result.positions)]
    return notes + (
        ["Where displacements are not determined, the smallest are given."] if notes else []
    )


def load_table(result: Result) -> Table:
    """Return the largest torques from outside, forces on bearings and torques of shafts."""
    fields = ("part", "torque", "torque at", "bearing", "bearing at")
    return table(
        "Loads: torque from outside or of a shaft [N·m], force on a bearing or pin [N]",
        records.loads(result),
        [name for name in fields if len(result.positions) > 1 or not name.endswith(" at")],
        ("part",),
        notes=["The torque of a gear is that from outside, counter-clockwise about its axis."],
        most=FOLDED,
    )


def validity_table(result: Result) -> Table:
    """Return the largest figures of the displacements over the positions, and their bounds."""
    warning = advice(result)
    notes = [
        "Lines of action and stops are those before any displacement; these figures show how far "
        "that holds.",
        *([f"Warning: {warning}"] if warning else []),
    ]
    return table(
        "Displacements: the largest, and the limits of the geometry",
        records.measures(result),
        _placed(result, "figure", "value", "warning", "refusal", "where"),
        WORDS,
        notes=notes,
    )


def certificate_table(result: Result) -> Table:
    """Return the worst value of every residual over the positions."""
    return table(
        "Certificate: the worst residuals",
        records.residuals(result),
        _placed(result, "figure", "value", "unit", "scaled", "where"),
        WORDS,
        notes=[
            "Recomputed from the answer and the physics alone; a scaled residual is relative to "
            f"the load or deflection of the case. Allowed: {result.stamp.tolerance:.0e}.",
            "Every torque lies within "
            f"{small(records.proved(result))} of that at the exact "
            "equilibrium, relative to the largest torque.",
            f"{result.uniqueness.text[0].upper()}{result.uniqueness.text[1:]}.",
        ],
    )


def _placed(result: Result, *fields: str) -> tuple[str, ...]:
    """Return these fields, and the position if there are several."""
    return (*fields, "position") if len(result.positions) > 1 else fields


def effort_text(result: Result) -> str:
    """Return, in a sentence, how the positions were solved."""
    efforts = [p.effort for p in result.positions]
    stamp = result.stamp
    kinds = ", ".join(dict.fromkeys(e.kind for e in efforts))
    ways = ", ".join(dict.fromkeys(e.rung for e in efforts))
    passes = _passes([e.iterations for e in efforts])
    return (
        f"Solver {stamp.solver}, outer loop {stamp.method}{passes}; programme: {kinds}; "
        f"rung (method that answered): {ways}."
    )


def _passes(iterations: Sequence[int]) -> str:
    low, high = min(iterations), max(iterations)
    if high == 0:
        return ""
    count = str(low) if low == high else f"{low} to {high}"
    return f" with {count} pass" + ("" if count == "1" else "es")
