"""Results in words."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence

from loadshare.certify import FloatState
from loadshare.certify.validity import APART, LABELS, NEITHER
from loadshare.numbers import counted, engineering, read_best, runs, significant
from loadshare.results import Position, Result
from loadshare.results.differences import ROUND_OFF
from loadshare.train.period import Period

ALONG = 1e-9
"""How far a direction may be from an axis and still be given the axis's name."""


def period_text(period: Period, driving: str) -> str:
    """Return how long the common period of all meshes is.

    Parameters
    ----------
    period : Period
    driving : str
        The input gear.
    """
    mesh = period.fastest
    return (
        f"Common period of all meshes: {counted(period.cycles[mesh], 'cycle')} of mesh {mesh}, "
        f"{significant(float(period.revolutions), 6)} revolutions of gear {driving}"
    )


def rest_lines(
    rests: Sequence[FloatState], positions: Sequence[int], least: float = 0.0
) -> list[str]:
    """Return where a float rests over the positions, its margin or reaction, in a line or two.

    Parameters
    ----------
    rests : sequence of FloatState
    positions : sequence of int
        Their numbers.
    least : float
        Reaction [N] up to which it counts as none.
    """
    where = Counter(_where(rest) for rest in rests)
    if len(where) == 1:
        lines = [next(iter(where))]
    else:
        lines = [f"{place} at {count} of {len(rests)}" for place, count in where.most_common(3)]
        if len(where) > 3:
            lines.append(f"and {len(where) - 3} other states")
    margins = [r.margin for r in rests if r.state == "inside" and r.margin is not None]
    if margins:
        lines.append(f"least margin inside {read_best(min(margins), 'm', 3)}")
    forces = [math.hypot(*rest.reaction) for rest in rests]
    most = max(forces)
    if most > least and len(rests) > 1 and most - min(forces) > 1e-6 * most:
        at = positions[forces.index(most)]
        lines.append(f"reaction up to {read_best(most, 'N')}, at position {at}")
    return lines


def _where(rest: FloatState) -> str:
    if rest.state == "undetermined":
        return "undetermined: no force determines it"
    if rest.margin is None:
        return "inside: no ring bounds it"
    if rest.state == "inside":
        nearest = min(rest.boundaries, key=lambda touch: touch.margin)
        return f"inside, nearest the {boundary_name(nearest.name)}"
    touched = (touch.name for touch in rest.boundaries if touch.touching)
    return "on boundary: " + " + ".join(boundary_name(name) for name in touched)


def boundary_name(name: str) -> str:
    """Return the name of a boundary without the name of its ring: ``upper stop``, ``ring``."""
    return name.rpartition(": ")[2] if ": " in name else "ring"


def spline_lines(rests: Sequence[FloatState], least: float = 0.0) -> list[str]:
    """Return the stage of a float's spline over the positions and its force; empty without one.

    A force up to `least` [N] counts as none.
    """
    stages = Counter(rest.spline for rest in rests if rest.spline)
    if not stages:
        return []
    most = max(rest.spline_force for rest in rests)
    text = ", ".join(
        stage if len(stages) == 1 else f"{stage} at {count}" for stage, count in stages.items()
    )
    force = read_best(most, "N") if most > least else "0 N"
    return [f"spline: {text}; force up to {force}"]


def places_text(numbers: Sequence[int]) -> str:
    """Return whole numbers in short: ``1–3, 7``; many runs are cut off with an ellipsis."""
    parts = runs(numbers)
    return ", ".join(parts[:3]) + (" …" if len(parts) > 3 else "")


def direction_name(vector: Iterable[float]) -> str:
    """Return a direction by the name of its axis, or by its components."""
    components = [float(v) for v in vector]
    for axis, component in zip("xyz", components, strict=True):
        if abs(abs(component) - 1.0) <= ALONG:
            return axis if component > 0.0 else f"−{axis}"
    return "(" + ", ".join(f"{round(v, 2) + 0.0:g}" for v in components) + ")"


DIGITS = 5
"""Significant digits of a range's ends."""
LEAST = 1e-15
"""End of a range that is round-off where no end is larger [m, rad]."""


def undetermined_lines(positions: Sequence[Position]) -> list[str]:
    """Return a line for every range, with the coordinates that have it; none if all is determined.

    Over several positions a coordinate is given from the least to the largest of all its values. An
    end that is round-off relative to the largest is 0; a range of which both ends are is left out.
    """
    groups: dict[str, list[str]] = {}
    every = {
        name: [p.undetermined[name] for p in positions if name in p.undetermined]
        for name in dict.fromkeys(name for p in positions for name in p.undetermined)
    }
    largest: dict[str, float] = {}
    kind = {name: name.rpartition(" ")[2] for name in every}
    for name, ranges in every.items():
        sizes = [abs(end) for both in ranges for end in both if math.isfinite(end)]
        largest[kind[name]] = max(largest.get(kind[name], 0.0), *sizes, 0.0)
    for name, ranges in every.items():
        least = max(ROUND_OFF * largest[kind[name]], LEAST)
        ends = min(r[0] for r in ranges), max(r[1] for r in ranges)
        low, high = (0.0 if abs(end) <= least else end for end in ends)
        if low == high == 0.0:
            continue
        text = range_text(name, low, high)
        if len(ranges) < len(positions):
            text += f", at {len(ranges)} of {len(positions)} positions"
        groups.setdefault(text, []).append(name)
    return [f"{', '.join(names)}: not determined, {text}" for text, names in groups.items()]


def range_text(name: str, low: float, high: float) -> str:
    """Return a coordinate's range: ``−50 … 50 µm``, ``from −12 µrad on``, ``without limit``."""
    unit = engineering((low, high), "rad" if name.endswith("rotation") else "m")
    least, largest = (significant(unit.of(end), DIGITS).replace("-", "−") for end in (low, high))
    if math.isinf(low) and math.isinf(high):
        return "without limit"
    if math.isinf(high):
        return f"from {least} {unit.name} on"
    if math.isinf(low):
        return f"up to {largest} {unit.name}"
    return f"{least} … {largest} {unit.name}"


def advice(result: Result) -> str:
    """Return warnings about large displacements and missing backlash; empty if there are none."""
    large: dict[int, list[str]] = {}
    neither: dict[str, list[int]] = {}
    apart: dict[str, list[int]] = {}
    for p in result.positions:
        if (open_ := p.validity.measures.get(APART)) is not None:
            apart.setdefault(open_.where, []).append(p.position)
        for name, measure in p.validity.warned.items():
            if name == NEITHER:
                neither.setdefault(measure.where, []).append(p.position)
            else:
                large.setdefault(p.position, []).append(name)
    noun = "positions" if len(result.positions) > 1 else "position"
    found = [
        f"{mesh} carries load on neither flank ({noun} {', '.join(runs(where))}): the loads may "
        "press either one, but without a backlash the mesh has only one; load shares may be wrong. "
        'Give the mesh its backlash, such as backlash = "0 um"'
        for mesh, where in neither.items()
    ]
    found += [
        f"{mesh} is open ({noun} {', '.join(runs(where))}) by as much as a usual backlash or more, "
        "but without a backlash its other flank is left out; torques may be wrong. Give the mesh "
        'its backlash, such as backlash = "0.1 mm"'
        for mesh, where in apart.items()
    ]
    if large:
        reasons = "; ".join(LABELS[n] for n in dict.fromkeys(n for s in large.values() for n in s))
        found.append(
            "displacements are large for the geometry in which they were found "
            f"({noun} {', '.join(runs(large))}: {reasons}); figures may be off by a few per cent"
        )
    return ". ".join(found)
