"""The first screen of a case: what an engineer asks before anything else."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from loadshare.numbers import NONE, engineering, read_best, significant, small
from loadshare.report import records
from loadshare.report.flanks import carrying, least_force, reaction_size
from loadshare.report.words import advice, rest_lines, spline_lines, undetermined_lines
from loadshare.results import Result
from loadshare.results.laws import law_lines
from loadshare.results.share import is_load_factor
from loadshare.table import Cell, Record, Table, table

K_GAMMA, OMEGA = "Kγ", "Ω"
DIGITS = 4
"""Significant digits of forces and torques on the first screen."""


def verdict_tables(result: Result) -> Iterator[Table]:
    """Yield the tables of the first screen: sharing, where floats rest, the largest forces.

    Parameters
    ----------
    result : Result
    """
    if result.stages:
        yield sharing(result)
    if result.positions[0].floats:
        yield resting(result)
    yield table(
        "Largest forces",
        largest_forces(result),
        ("what", "where", "value"),
        ("what", "where"),
        {"value": "most"},
    )


def measure_of(result: Result) -> str:
    """Return the symbol of the largest Ω of a result.

    It is K_γ only if all positions of the case are in the result, and the drivers of each stage are
    of one size.
    """
    count, found = result.positions[0].train.count, result.positions
    if len(found) >= count:
        return K_GAMMA if is_load_factor(found[0].train) else OMEGA
    return (
        f"Ω at position {found[0].position}"
        if len(found) == 1
        else (f"Ω at {len(found)} of {count}")
    )


def sharing(result: Result) -> Table:
    """Return the largest Ω of every stage.

    Over the mean of the stage and over all positions it is K_γ of ISO 6336-1, if drivers are of
    one size.
    """
    rows = list(records.omegas(result))
    alike = all(row["over stage"].text == row["over group"].text for row in rows)
    figures = ("over stage",) if alike else ("over stage", "over group")
    measure = measure_of(result)
    over_stage = f"{OMEGA} = {K_GAMMA}" if measure == K_GAMMA else measure
    heads = {"over stage": over_stage, "over group": "Ω over group", "stage at": "reached at"}
    words = ("stage", "stage at")
    return table("Load sharing by stage", rows, (*words, *figures), words, heads)


def resting(result: Result) -> Table:
    """Return where every float rests, in words."""
    numbers = [p.position for p in result.positions]
    least = max(map(least_force, result.positions))
    rows = []
    for gear in result.positions[0].floats:
        rests = [p.floats[gear] for p in result.positions]
        lines = [*rest_lines(rests, numbers, least), *spline_lines(rests, least)]
        most = max(reaction_size(p, gear) for p in result.positions)
        reaction = Cell(read_best(most, "N", DIGITS), most)
        rows.append({"gear": Cell(gear), "rests": Cell("; ".join(lines)), "reaction": reaction})
    heads = {"reaction": "reaction, most"}
    words = ("gear", "rests")
    return table("Where the floats rest", rows, (*words, "reaction"), words, heads)


def largest_forces(result: Result) -> Iterator[Record]:
    """Yield the largest force of a flank, force on a bearing, and torque of a shaft."""
    positions = result.positions
    force = max(map(least_force, positions))
    torque = force * max(gear.base_radius for gear in positions[0].train.gears.values())
    loads = [(p.position, p.loads) for p in positions]
    bearings = [(math.hypot(*f), f"gear {g}", k) for k, x in loads for g, f in x.bearings.items()]
    shafts = [(abs(t), f"shaft {s}", k) for k, x in loads for s, t in x.shafts.items()]
    flanks = [(f.force, f.where, p.position) for p in positions for f in carrying(p)]
    kinds = {
        "flank": ("N", force, flanks or [(0.0, NONE, 1)]),
        "bearing or pin": ("N", force, bearings),
        "shaft": ("N·m", torque, shafts),
    }
    for what, (of, least, found) in kinds.items():
        if not found:
            continue
        value, where, position = max(found, key=lambda f: f[0])
        # What the certificate does not distinguish from zero is shown as none.
        value = value if value > least else 0.0
        unit = engineering([value], of)
        texts = [significant(unit.of(v), DIGITS) for v, other, _ in found if other == where]
        if len(texts) < len(positions) or len({*texts}) > 1:
            where += f", position {position}"
        yield {
            "what": Cell(what),
            "where": Cell(where if value else NONE),
            "value": Cell(read_best(value, of, DIGITS), value),
        }


def trust(result: Result) -> Mapping[str, str]:
    """Return how far the answer can be trusted, and what it rests on, each in a sentence.

    Parameters
    ----------
    result : Result
    """
    bound = records.proved(result)
    worst = result.certificate.worst
    assumed = ", ".join(result.case.assumed)
    found = {
        "Residuals": f"at most {small(worst)} scaled; allowed {result.stamp.tolerance:.0e}",
        "Bound": f"every torque within {small(bound)} of that at the exact equilibrium, "
        "relative to the largest torque",
        "Uniqueness": result.uniqueness.text,
        "Displacements": advice(result) or "small for the geometry in which they were found",
        "Not determined": "; ".join(undetermined_lines(result.positions)),
        "Assumed": assumed or "nothing is marked as assumed",
        "Tooth laws": " ".join(law_lines(result.laws)),
    }
    return {name: text for name, text in found.items() if text}
