"""The contents of a result, row by row, from which page and screen choose their columns."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Literal

from loadshare.case import Case
from loadshare.certify.validity import LABELS
from loadshare.numbers import (
    ALIKE,
    NONE,
    decimals,
    fixed,
    micrometres,
    omega,
    significant,
    small,
)
from loadshare.results import Position, Result
from loadshare.results.laws import law_lines
from loadshare.settings import CERTIFY, JOB
from loadshare.table import Cell, Record

Shares = Sequence[tuple[int, Mapping[str, float | None]]]


def load_text(case: Case) -> str:
    """Return the load of a case, and where it enters and leaves, in words."""
    operating = case.operating
    low, high = min(operating.input_torque), max(operating.input_torque)
    load = f"{high:.7g}" if low == high else f"{low:.7g} to {high:.7g}"
    return f"Input torque {load} N·m on gear {operating.input}, output gear {operating.output}"


def omegas(result: Result) -> Iterator[Record]:
    """Yield the largest Ω of every stage and the system, over both means, and where it occurs."""
    for stage, value in result.omega.items():
        meshes = result.stages.get(stage, ())
        group = result.pair_omega[stage]
        yield {
            "stage": Cell(stage),
            "over stage": Cell(omega(value), value),
            "stage at": Cell(reached([(p.position, p.share) for p in result.positions], meshes)),
            "over group": Cell(omega(group), group),
            "group at": Cell(
                reached([(p.position, p.pair_share) for p in result.positions], meshes)
            ),
        }


def reached(shares: Shares, meshes: Sequence[str]) -> str:
    """Return the branch, and the position if it matters, at which Ω is largest.

    Parameters
    ----------
    shares : sequence of (position, mapping of mesh to float or None)
    meshes : sequence of str
        Meshes of the stage; empty for the whole system, for which no branch is named.
    """
    found = [(s[m], m, k) for k, s in shares for m in meshes]
    known = [(v, m, k) for v, m, k in found if v is not None]
    if not known:
        return "" if not meshes else NONE
    largest = omega(max(value for value, _, _ in known))
    top = [(m, k) for v, m, k in known if omega(v) == largest]
    # Among branches with equal shares, round-off decides which one is ahead.
    mesh, position = top[0]
    if len(top) == len(found):
        return "all alike"
    if sum(m == mesh for m, _ in top) == len(shares):
        return mesh
    return f"{mesh}, position {position}"


def torque_places(result: Result) -> int:
    """Return the number of decimals with which torques are printed."""
    return decimals(t for p in result.positions for t in p.torque.values())


def alike(result: Result) -> bool:
    """Return whether every mesh carries the same at all positions, to the printed decimals."""
    places = torque_places(result)
    texts = [[fixed(t, places) for t in p.torque.values()] for p in result.positions]
    return all(text == texts[0] for text in texts)


def torques(result: Result, columns: Literal["alike", "each", "summed"]) -> Iterator[Record]:
    """Yield the torque of every mesh and its largest Ω over the positions.

    Parameters
    ----------
    result : Result
    columns : {"alike", "each", "summed"}
        One torque; one at each position; least, mean and largest of them.
    """
    places = torque_places(result)
    for mesh in result.positions[0].torque:
        every = [p.torque[mesh] for p in result.positions]
        mean = math.fsum(every) / len(every)
        if columns == "each":
            values = {f"at {p.position}": p.torque[mesh] for p in result.positions}
        elif columns == "alike":
            values = {"torque": mean}
        else:
            values = {"least": min(every), "mean": mean, "most": max(every)}
        yield {
            "stage": Cell(", ".join(s for s, meshes in result.stages.items() if mesh in meshes)),
            "mesh": Cell(mesh),
            **{name: Cell(fixed(value, places), value) for name, value in values.items()},
            "Ω stage": largest(p.share.get(mesh) for p in result.positions),
            "Ω pair": largest(p.pair_share.get(mesh) for p in result.positions),
        }


def torque_notes(result: Result, rows: Iterable[Record]) -> list[str]:
    """Return the notes below the torques of the meshes."""
    notes = []
    if len(result.positions) > 1:
        sentences = "The same at all positions.", "Ω is the largest over the positions."
        notes.append(sentences[0] if alike(result) else sentences[1])
    if any(row["Ω pair"].text == NONE for row in rows):
        notes.append(f"{NONE}: not in a stage, or without load.")
    least = unloaded(result)
    if any(torque < -least for p in result.positions for torque in p.torque.values()):
        notes.append("Where the torque is negative, the gear named first is driven.")
    return notes + law_lines(result.laws)


def unloaded(result: Result) -> float:
    """Return the torque [N·m] up to which a flank carries nothing but round-off."""
    flanks = (
        max(coast, p.torque[mesh] + coast)
        for p in result.positions
        for mesh, coast in p.coast_torque.items()
    )
    return CERTIFY.carries * max(flanks, default=0.0)


def largest(shares: Iterable[float | None]) -> Cell:
    """Return the largest Ω of those that are known."""
    value = max((s for s in shares if s is not None), default=None)
    return Cell(omega(value), value)


def reaction_places(positions: Sequence[Position]) -> int:
    """Return the number of decimals with which reactions of rings are printed."""
    return decimals(math.hypot(*f.reaction) for p in positions for f in p.floats.values())


def rest(position: Position, gear: str, places: int) -> Record:
    """Return where a float is, its margin and its ring's reaction [N] to `places` decimals."""
    found = position.floats[gear]
    x, y = position.displacement[gear]
    reaction = math.hypot(*found.reaction)
    return {
        "x": Cell(micrometres(x), x),
        "y": Cell(micrometres(y), y),
        "margin": Cell(micrometres(found.margin), found.margin),
        "reaction": Cell(fixed(reaction, places), reaction),
        "spline": Cell(found.spline or NONE),
    }


def loads(result: Result) -> Iterator[Record]:
    """Yield the largest loads of gears and shafts over the positions, except those that are zero.

    For a gear they are the torque from outside, a load or what balances it, and the force on its
    bearing.
    """
    found = [(p.position, p.loads) for p in result.positions]
    gears = {g: [(x.gears[g], at) for at, x in found] for g in found[0][1].gears}
    shafts = {s: [(x.shafts[s], at) for at, x in found] for s in found[0][1].shafts}
    bearings = {g: [(math.hypot(*x.bearings[g]), at) for at, x in found] for g in gears}
    torque_of = _loads([*gears.values(), *shafts.values()])
    force_of = _loads(bearings.values())
    parts = [(f"gear {g}", torque_of(gears[g]), force_of(bearings[g])) for g in gears]
    parts += [(f"shaft {s}", torque_of(shafts[s]), force_of([])) for s in shafts]
    for part, torque, force in parts:
        if (torque[0].text, force[0].text) != (NONE, NONE):
            yield {
                "part": Cell(part),
                **dict(zip(("torque", "torque at"), torque, strict=True)),
                **dict(zip(("bearing", "bearing at"), force, strict=True)),
            }


def _loads(
    every: Iterable[Sequence[tuple[float, int]]],
) -> Callable[[Sequence[tuple[float, int]]], tuple[Cell, Cell]]:
    """Return a function that writes the largest of some loads, and where, in digits fit for all."""
    sizes = [abs(value) for values in every for value, _ in values]
    places, least = decimals(sizes), 1e-9 * max(sizes, default=0.0)

    def largest(values: Sequence[tuple[float, int]]) -> tuple[Cell, Cell]:
        most = max((abs(value) for value, _ in values), default=0.0)
        if most <= least:
            return Cell(NONE), Cell(NONE)
        # Among positions with equal loads, round-off decides which one is ahead.
        top = [(value, at) for value, at in values if abs(value) >= most * (1.0 - ALIKE)]
        value, at = top[0]
        # A load that is small beside the largest would lose its digits.
        text = fixed(value, places) if abs(value) >= 10.0 ** (3 - places) else significant(value)
        return Cell(text, value), Cell("all" if len(top) == len(values) > 1 else str(at), at)

    return largest


def yielding(result: Result) -> Iterator[Record]:
    """Yield the transmission error of the train and its stiffness at every position."""
    for p in result.positions:
        error, stiffness = p.elastic.transmission_error, p.elastic.torsional_stiffness
        yield {
            "position": Cell(str(p.position), p.position),
            **{f"error {side}": Cell(significant(1e6 * e, 6), e) for side, e in error.items()},
            **{f"stiffness {side}": Cell(f"{k:.6g}", k) for side, k in stiffness.items()},
        }


def error_text(result: Result) -> str:
    """Return, in a sentence, how much the transmission error at the input varies."""
    errors = [p.elastic.transmission_error["input"] for p in result.positions]
    span = significant(1e6 * (max(errors) - min(errors)), 4)
    return f"The transmission error at the input varies by {span} µrad, peak to peak."


def meshes(result: Result) -> Iterator[Record]:
    """Yield every mesh at every position: its point of the cycle, its load and its deflection."""
    places = torque_places(result)
    for mesh in result.positions[0].torque:
        for p in result.positions:
            error, stiffness = (
                p.elastic.mesh_transmission_error[mesh],
                p.elastic.mesh_stiffness[mesh],
            )
            turning = p.elastic.mesh_torsional_stiffness[mesh]
            yield {
                "mesh": Cell(mesh),
                "position": Cell(str(p.position), p.position),
                "cycle point": Cell(str(p.mesh_position[mesh]), p.mesh_position[mesh]),
                "torque": Cell(fixed(p.torque[mesh], places), p.torque[mesh]),
                "coast flank": Cell(fixed(p.coast_torque[mesh], places), p.coast_torque[mesh]),
                "Ω stage": largest([p.share.get(mesh)]),
                "Ω group": largest([p.pair_share.get(mesh)]),
                "error": Cell(micrometres(error), error),
                "stiffness": Cell(f"{1e-6 * stiffness:.6g}", stiffness),
                "at the driver": Cell(f"{turning:.6g}", turning),
            }


def measures(result: Result) -> Iterator[Record]:
    """Yield the largest figures of the displacements over the positions, and their bounds."""
    for name, measure, position in result.validity:
        nowhere = measure.value == 0.0
        bounds = {"warning": measure.warning, "refusal": measure.refusal}
        yield {
            "figure": Cell(LABELS[name]),
            "value": Cell(_length(measure.value), measure.value),
            **{k: Cell(NONE if b is None else significant(b, 3), b) for k, b in bounds.items()},
            "where": Cell(NONE if nowhere else measure.where),
            "position": Cell(NONE if nowhere else str(position), position),
        }


def _length(value: float) -> str:
    """Return a relative displacement with three digits; a tiny one as its order of magnitude."""
    return significant(value, 3) if value >= 1e-4 or not value else small(value)


def residuals(result: Result) -> Iterator[Record]:
    """Yield the worst value of every residual over the positions."""
    for name in result.positions[0].certificate.residuals:
        worst = max(result.positions, key=lambda p: p.certificate.residuals[name].scaled)
        residual = worst.certificate.residuals[name]
        nowhere = residual.scaled == 0.0
        yield {
            "figure": Cell(name.replace("_", " ")),
            "value": Cell(small(residual.value), residual.value),
            "unit": Cell(residual.unit),
            "scaled": Cell(small(residual.scaled), residual.scaled),
            "where": Cell(NONE if nowhere else residual.where or NONE),
            "position": Cell(NONE if nowhere else str(worst.position), worst.position),
        }


def proved(result: Result) -> float:
    """Return the proved bound on a torque's distance from the exact one, over the largest torque.

    If there are few positions, each is bounded closely. For many, that would take ten times as long
    as solving them, and the bound that was proved for all together is enough.
    """
    closely = len(result.positions) <= JOB.each
    every = (p.certificate for p in result.positions)
    return max(c.bound.relative if closely else c.proved for c in every)
