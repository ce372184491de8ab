"""The phases of the meshes of a case, and problems of teeth that do not meet."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from loadshare import case as spec
from loadshare.case.power_flow import nearest_first
from loadshare.errors import CaseError, Problem
from loadshare.train.gear import Gear
from loadshare.train.phases import MEETS, Meeting, PhaseMisfit, is_whole, phases
from loadshare.train.ring import transverse

if TYPE_CHECKING:
    from loadshare.case.line_of_action import LineOfAction
    from loadshare.train.geometry import Pair


def in_phase(case: spec.Case, pairs: Mapping[str, Pair]) -> dict[str, Pair]:
    """Return the meshes with their phases.

    Raises
    ------
    CaseError
        If fully specified teeth do not meet, a given phase contradicts the layout, or a phase that
        matters does not follow from it.
    """
    meetings = {
        name: Meeting(
            p.driver,
            p.driven,
            _halves(case, p, pairs),
            p.senses,
            _twists(case, p.driver, p.driven),
        )
        for name, p in pairs.items()
    }
    links = [mesh.ends for mesh in case.meshes.values()]
    links += [shaft.ends for shaft in case.shafts.values()]
    carriers = {name: gear.carrier for name, gear in case.gears.items()}
    found, misfits = phases(meetings, nearest_first(carriers, links, case.operating.input))
    problems = [
        _misfit_problem(case, pairs, m)
        for m in misfits
        if all(_is_complete(case, gear) for gear in case.meshes[m.mesh].ends)
    ]
    problems += _phases_against(case, found)
    problems += _phases_unknown(case, pairs, found)
    if problems:
        raise CaseError(problems)
    return {n: replace(p, phases=found.get(n, p.phases)) for n, p in pairs.items()}


def _is_complete(case: spec.Case, name: str) -> bool:
    """Return whether the case says where a gear's teeth are; a face gear's follow from its pinions.

    A gear that is given by a few figures may be meant as an example only.
    """
    gear = case.gears[name]
    return gear.tooth is not None or (gear.type == "face" and gear.teeth is not None)


def _halves(case: spec.Case, pair: Pair, pairs: Mapping[str, Pair]) -> tuple[float, float]:
    """Return half the angle of a tooth of driver and driven gear at the pitch circle [rad]."""

    def of(gear: Gear, line: LineOfAction) -> float:
        tooth, count = case.gears[gear.name].tooth, gear.teeth or math.inf
        return (
            math.pi / (2.0 * count) if tooth is None else tooth.half_angle_at(line.pressure_angle)
        )

    def of_face(face: Gear) -> float:
        # Its teeth fill the spaces of its pinions; of several, the one with the thickest teeth
        # counts.
        pinions = [
            (p.driven if p.driver is face else p.driver, p.line)
            for p in pairs.values()
            if face in (p.driver, p.driven)
        ]
        thickest = max(of(pinion, line) * (pinion.teeth or 0.0) for pinion, line in pinions)
        return (math.pi - thickest) / (face.teeth or math.inf)

    first, second = (
        of_face(end) if end.kind == "face" else of(end, pair.line)
        for end in (pair.driver, pair.driven)
    )
    return first, second


def _twists(case: spec.Case, driver: Gear, driven: Gear) -> tuple[float, float]:
    """Return by how much teeth are ahead in the middle of the common face [rad] (see `Meeting`).

    If one gear has no face width, the other's face is the common one; if neither has, its middle is
    halfway between the two gears. With a face gear it is the pinion's face.
    """
    ends = driver, driven
    if "face" in (driver.kind, driven.kind):
        return 0.0, 0.0
    heights = [float(g.centre @ driver.axis) for g in ends]
    widths = [case.gears[g.name].face_width for g in ends]
    halves = [math.inf if w is None else 0.5 * w.si for w in widths]
    low, high = (
        pick(h + way * b for h, b in zip(heights, halves, strict=True))
        for pick, way in ((max, -1.0), (min, 1.0))
    )
    middle = 0.5 * (low + high) if math.isfinite(high - low) else 0.5 * sum(heights)

    def twist(gear: Gear, height: float) -> float:
        tooth = case.gears[gear.name].tooth
        up = float(gear.axis @ driver.axis) * (middle - height)
        return 0.0 if tooth is None else math.tan(tooth.helix_angle) / tooth.radius * up

    return twist(driver, heights[0]), twist(driven, heights[1])


def _phases_against(case: spec.Case, found: Mapping[str, tuple[float, float]]) -> Iterator[Problem]:
    """Yield problems of given phases that contradict those of the layout."""
    if case.operating.phases != "layout":
        return
    for name, (layout, _) in found.items():
        given = case.meshes[name].phase
        if given is not None and abs((given - layout + 0.5) % 1.0 - 0.5) > MEETS:
            path, allowed = ("meshes", name, "phase"), f"{round(layout, 4) % 1.0:g}, or left out"
            hint = 'With operating.phases = "together" any phases may be given.'
            yield case.problem(path, "contradicts the teeth and their positions", allowed, hint)


def _phases_unknown(
    case: spec.Case, pairs: Mapping[str, Pair], found: Mapping[str, tuple[float, float]]
) -> Iterator[Problem]:
    """Yield problems of meshes whose phase matters but does not follow from the layout."""
    if case.operating.phases != "layout":
        return
    for name, pair in pairs.items():
        mesh = case.meshes[name]
        varies = any(isinstance(v, tuple) and len(v) > 1 for _, v in mesh.per_position())
        if name in found or mesh.phase is not None or not varies:
            continue
        bare = {g.name: g.teeth for g in (pair.driver, pair.driven) if not is_whole(g.teeth)}
        by_radii = [f"{z:.5g} of {n}" for n, z in bare.items() if z is not None]
        message = f"the teeth of {' and '.join(bare)} are not known"
        if by_radii:
            message += f" (by their radii {' and '.join(by_radii)})"
        hint = f"Give gears.{next(iter(bare))}.teeth, or the phase of the mesh."
        path = ("meshes", name, "phase")
        yield case.problem(path, f"does not follow: {message}", "0 to below 1", hint)


def _misfit_problem(case: spec.Case, pairs: Mapping[str, Pair], misfit: PhaseMisfit) -> Problem:
    """Return the problem of teeth that miss each other, with a hint where planets would fit."""
    pair = pairs[misfit.mesh]
    message = (
        f"cannot be put together: its teeth miss each other by {abs(misfit.pitches):.2g} of a "
        "pitch where all others meet"
    )
    return case.problem(("meshes", misfit.mesh), message, hint=_spacing_hint(case, pairs, pair))


def _spacing_hint(case: spec.Case, pairs: Mapping[str, Pair], pair: Pair) -> str:
    """Return a hint at which angles planets fit between gears about the same axis.

    Between two gears they fit at multiples of a revolution divided by z₁ + z₂ if the two run in
    opposite senses as seen from the carrier, by their difference if they run in the same sense. A
    planet that meshes with several, by itself or through its partner, has to fit between them all.
    """
    gears = {g.name: g for p in pairs.values() for g in (p.driver, p.driven)}
    meshing: dict[str, list[str]] = {name: [] for name in gears}
    for mesh in case.meshes.values():
        for one, other in (mesh.ends, mesh.ends[::-1]):
            meshing[one].append(other)

    def about(one: str, other: str) -> bool:
        between = transverse(gears[one].centre - gears[other].centre, gears[other].axis)
        return bool(np.linalg.norm(between) <= MEETS * gears[other].base_radius)

    for planet, last in ((pair.driver, pair.driven), (pair.driven, pair.driver)):
        near = [n for n in meshing[planet.name] if n != last.name]
        through = [n for n in near if not about(n, last.name)]
        beyond = [n for other in through for n in meshing[other] if n != planet.name]
        firsts = [gears[n] for n in (*near, *beyond) if about(n, last.name)]
        if about(planet.name, last.name):
            continue
        wholes = sorted({_whole(first, last) for first in firsts} - {0})
        if wholes:
            common = math.gcd(*wholes)
            apart = f"{360.0 / common:.6g} deg apart or at multiples of this, and "
            return (
                f"Gears about the same axis fit {apart if common > 1 else ''}evenly spaced if "
                f"their number divides {' and '.join(map(str, wholes))}."
            )
    return ""


def _whole(first: Gear, last: Gear) -> int:
    """Return into how many equal angles the places divide at which a planet fits between two."""
    teeth = [round(g.teeth or 0) for g in (first, last)]
    ways = [g.sense * g.relative * g.axis for g in (first, last)]
    return abs(teeth[0] - teeth[1]) if float(ways[0] @ ways[1]) > 0.0 else sum(teeth)
