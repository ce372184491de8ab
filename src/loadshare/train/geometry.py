"""The geometry of a case: where gears are, how they turn, which way their teeth push.

It is settled once for all samples that share a machine.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from loadshare import case as spec
from loadshare.case.line_of_action import LineOfAction, backlash_of_teeth, line_of_action
from loadshare.case.place import axis_of
from loadshare.case.power_flow import against_the_names, has_sets
from loadshare.case.teeth import tooth_counts
from loadshare.case.words import count
from loadshare.errors import CaseError, Problem
from loadshare.settings import ALLOWED
from loadshare.train.gear import Gear, Vector, transverse_frame
from loadshare.train.kinematics import Kinematics, settle
from loadshare.train.mesh import running_contact
from loadshare.train.period import Period, period_of
from loadshare.train.phases import MEETS, WHOLE, Meeting, Misfit, phases
from loadshare.train.ring import transverse
from loadshare.train.willis import Links


@dataclass(frozen=True, slots=True, eq=False)
class Pair:
    """Geometry of a mesh.

    Attributes
    ----------
    driver, driven : Gear
    normals : (ndarray, ndarray)
        n and n'.
    turned : bool
        See `Mesh`.
    line : LineOfAction
    phase : float
        Part of its cycle that has passed at the first position, where teeth tell it [-].
    backlash : float
        Along the line of action, where the mesh has it follow from its teeth [m].
    counted : (int, int)
        See `Mesh`.
    """

    driver: Gear
    driven: Gear
    normals: tuple[Vector, Vector]
    turned: bool
    line: LineOfAction
    phase: float = 0.0
    backlash: float = math.inf
    counted: tuple[int, int] = (1, 1)


@dataclass(frozen=True, slots=True, eq=False)
class Geometry:
    """What samples that share a machine have in common.

    Attributes
    ----------
    gears : mapping of str to Gear
    pairs : mapping of mesh to Pair
    period : Period or None
        Of all meshes, where the positions go through it.
    """

    gears: Mapping[str, Gear]
    pairs: Mapping[str, Pair]
    period: Period | None = None


def geometry_of(case: spec.Case) -> Geometry:
    """Settle the geometry of a case.

    Raises
    ------
    CaseError
        As `build_train`.
    """
    kinematics = _kinematics(case)
    problems = [case.problem(c.key, c.message) for c in kinematics.conflicts]
    operating = case.operating
    common = operating.cycle == "common" and case.march is None
    rotates = operating.positions > 1 and operating.rotation == "teeth"
    if not kinematics.determined and (rotates or common or case.march is not None):
        message = "does not tell how fast all gears turn: a differential has two speeds"
        hint = 'Hold a member, or solve one position, or give rotation = "neglected".'
        problems.append(case.problem("operating.input", message, hint=hint))
    march = case.march
    if march is not None and not problems and not kinematics.gears[march.gear].ratio:
        problems.append(case.problem("march.gear", "does not turn", "a gear that turns"))
    if problems:
        raise CaseError(problems)
    pairs = _pairs(case, kinematics.gears)
    period = _period(case, kinematics.gears) if common else None
    return Geometry(kinematics.gears, _in_phase(case, pairs), period)


def _period(case: spec.Case, gears: Mapping[str, Gear]) -> Period:
    """Return the common period of all meshes.

    Raises
    ------
    CaseError
        If tooth numbers do not tell it, or it has more positions than can be kept.
    """
    meshes = {name: mesh.ends for name, mesh in case.meshes.items()}
    counts = {n: gears[n].teeth or 0.0 for ends in meshes.values() for n in ends}
    unknown = [n for n, z in counts.items() if round(z) < 1 or abs(z - round(z)) > WHOLE * z]
    if unknown:
        hint = "The common period of all meshes follows from tooth numbers."
        raise CaseError(
            [case.problem(f"gears.{n}.teeth", "does not follow", "a number", hint) for n in unknown]
        )
    teeth = {name: round(z) for name, z in counts.items()}
    shafts = {name: shaft.ends for name, shaft in case.shafts.items()}
    key, operating = "operating.cycle", case.operating
    try:
        found = period_of(gears, meshes, shafts, teeth, operating.input)
    except ValueError as error:
        raise CaseError([case.problem(key, f"there is no common period: {error}")]) from None
    steps, most = found.steps(operating.positions), ALLOWED.common
    if steps > most:
        cycles = found.cycles[found.fastest]
        message = (
            f"the meshes come round together after {_number_text(cycles)} cycles of mesh "
            f"{found.fastest} ({_number_text(found.revolutions)} revolutions of gear "
            f"{operating.input}), with {count(operating.positions, 'position')} in each "
            f"{_number_text(steps)} positions"
        )
        fewer = f" or operating.positions = {most // cycles}" if most >= cycles else ""
        hint = f"Give a march over a part of it{fewer}."
        raise CaseError([case.problem(key, message, f"up to {most} positions", hint)])
    for name, measurement in case.measured.items():
        if measurement.position is not None and measurement.position > steps:
            path = f"measured.{name}.position"
            raise CaseError([case.problem(path, f"the case has {steps}", f"1 to {steps}")])
    return found


def _number_text(number: Fraction | int) -> str:
    """A number of which only the size matters where it is large."""
    return f"{float(number):.6g}" if number < 10**300 else "more than 10^300"


def _in_phase(case: spec.Case, pairs: Mapping[str, Pair]) -> dict[str, Pair]:
    """Return the meshes with their phases.

    Raises
    ------
    CaseError
        If teeth that are given completely do not meet.
    """

    def half(gear: Gear, pair: Pair) -> float:
        tooth = case.gears[gear.name].tooth
        if tooth is None:
            return math.pi / (2.0 * (gear.teeth or math.inf))
        return tooth.half_angle_at(pair.line.pressure_angle)

    meetings = {
        name: Meeting(p.driver, p.driven, (half(p.driver, p), half(p.driven, p)), p.counted)
        for name, p in pairs.items()
    }
    found, misfits = phases(meetings)
    problems = [
        _misfit_problem(case, pairs, m)
        for m in misfits
        if all(case.gears[g].tooth is not None for g in case.meshes[m.mesh].ends)
    ]
    problems += _phases_against(case, found)
    if problems:
        raise CaseError(problems)
    return {name: replace(pair, phase=found.get(name, 0.0)) for name, pair in pairs.items()}


def _phases_against(case: spec.Case, found: Mapping[str, float]) -> Iterator[Problem]:
    """Yield phases that are given although there is a layout from which others follow."""
    if case.operating.phases != "layout":
        return
    for name, layout in found.items():
        given = case.meshes[name].phase
        if given is not None and abs((given - layout + 0.5) % 1.0 - 0.5) > MEETS:
            path, allowed = ("meshes", name, "phase"), f"{layout:.4g}, or left out"
            hint = 'With operating.phases = "together" any phases may be given.'
            yield case.problem(path, "contradicts the teeth and their places", allowed, hint)


def _misfit_problem(case: spec.Case, pairs: Mapping[str, Pair], misfit: Misfit) -> Problem:
    """Say by how much teeth miss each other, and where a planet between two gears would fit."""
    pair = pairs[misfit.mesh]
    message = (
        f"cannot be put together: its teeth miss each other by {abs(misfit.pitches):.2g} of a "
        "pitch where all others meet"
    )
    return case.problem(("meshes", misfit.mesh), message, hint=_spacing_hint(case, pairs, pair))


def _spacing_hint(case: spec.Case, pairs: Mapping[str, Pair], pair: Pair) -> str:
    """Say how far apart planets fit that lead from one gear to another about the same axis.

    A planet that is turned on from one to the next by its pitch shifts the two gears against each
    other by z₁ + z₂ parts of a revolution where they run against each other as seen from it, by
    their difference where they run alike.
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
        first = next((gears[n] for n in (*near, *beyond) if about(n, last.name)), None)
        if first is None or about(planet.name, last.name):
            continue
        teeth = [round(g.teeth or 0) for g in (first, last)]
        alike = first.sense * last.sense * float(first.axis @ last.axis) > 0.0
        whole = abs(teeth[0] - teeth[1]) if alike else sum(teeth)
        if whole:
            return (
                f"Gears about the same axis fit at angles {360.0 / whole:.6g} deg "
                f"apart, and evenly spaced if their number divides {whole}."
            )
    return ""


def _kinematics(case: spec.Case) -> Kinematics:
    running = 1 if case.operating.running == "counter-clockwise" else -1
    centres = case.centres()
    pairs = {n: m.ends for n, m in case.meshes.items()}
    # What follows from the counts that are given is a count as well.
    toothed = {n: g for n, g in case.gears.items() if not g.is_carrier}
    teeth, _ = tooth_counts(
        {n: g.teeth for n, g in toothed.items()},
        {n: g.acting_radius for n, g in toothed.items()},
        pairs.values(),
    )
    return settle(
        {n: _gear(n, g, centres[n], running, teeth.get(n)) for n, g in case.gears.items()},
        pairs,
        {n: s.ends for n, s in case.shafts.items()},
        case.operating.input,
    )


def _gear(
    name: str,
    gear: spec.Gear,
    centre: tuple[float, float, float],
    running: int,
    teeth: float | None,
) -> Gear:
    axis = np.array(axis_of(gear))
    return Gear(
        name=name,
        kind=gear.type,
        centre=np.array(centre),
        axis=axis,
        frame=transverse_frame(axis),
        base_radius=0.0 if gear.is_carrier else gear.acting_radius,
        sense=running,
        teeth=teeth,
        support=None,
        ratio=1.0,
        held=gear.held,
        carrier=gear.carrier,
    )


def _pressed(case: spec.Case, gears: Mapping[str, Gear]) -> dict[str, int]:
    """Which flanks of a train with planetary sets the load presses (see `Links.pressed`)."""
    if not has_sets(case.gears):
        return {}
    links = Links.of(
        gears,
        {name: mesh.ends for name, mesh in case.meshes.items()},
        {name: shaft.ends for name, shaft in case.shafts.items()},
    )
    operating = case.operating
    torques = {n: t.si * math.copysign(1.0, gears[n].ratio) for n, t in operating.external.items()}
    driving = next((t for t in operating.input_torque if t), 0.0)
    torques[operating.input] = torques.get(operating.input, 0.0) + driving
    free = [n for n, g in gears.items() if not g.held and n != operating.output]
    return links.pressed(torques, free)


def _pairs(case: spec.Case, gears: Mapping[str, Gear]) -> dict[str, Pair]:
    """Meshes with the flanks that the torque presses, whichever way it runs through them."""
    flows = against_the_names(case.operating, case.gears, case.meshes, case.shafts)
    against = all(flows or (False,))
    pressed = _pressed(case, gears)
    found, centres = {}, case.centres()
    for name, mesh in case.meshes.items():
        line = line_of_action(mesh, case.gears, centres)
        if line is None:
            raise ValueError(f"no line of action: {name}")
        driver, driven = gears[mesh.driver], gears[mesh.driven]
        # Where the load presses neither, the names tell.
        coast = pressed[name] < 0 if pressed.get(name) else against
        turned = coast and not mesh.given("backlash", "normal_backlash")
        contact, counted = running_contact(driver, driven)
        if turned:
            # The other flank of the same two gears, whichever senses they are counted in.
            driver, driven = driven, driver
            contact, counted = running_contact(driver, driven, counted[1])
        normals = [contact.normal(line.pressure_angle, drive) for drive in (True, False)]
        pair = Pair(driver, driven, (normals[0], normals[1]), turned, line, counted=counted)
        if mesh.backlash == "teeth":
            left = backlash_of_teeth(mesh, case.gears, centres)
            pair = replace(pair, backlash=math.inf if left is None else left)
        found[name] = pair
    return found
