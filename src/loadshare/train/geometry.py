"""The geometry of a case: where gears stand, how they turn, which way their teeth push.

It is settled once for all samples that share a machine.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from loadshare import case as spec
from loadshare.case.line_of_action import LineOfAction, backlash_of_teeth, line_of_action
from loadshare.case.place import axis_of
from loadshare.case.power_flow import against_the_names, rides_on
from loadshare.case.teeth import tooth_counts
from loadshare.errors import CaseError, Problem
from loadshare.train.gear import Gear, Vector, transverse_frame
from loadshare.train.kinematics import Kinematics, settle
from loadshare.train.mesh import Contact, contact_of
from loadshare.train.phases import Meeting, Misfit, phases
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
        Part of its cycle at which it stands at the first position, where teeth tell it [-].
    backlash : float
        Along the line of action, where the mesh has it follow from its teeth [m].
    """

    driver: Gear
    driven: Gear
    normals: tuple[Vector, Vector]
    turned: bool
    line: LineOfAction
    phase: float = 0.0
    backlash: float = math.inf


@dataclass(frozen=True, slots=True, eq=False)
class Geometry:
    """What samples that share a machine have in common.

    Attributes
    ----------
    gears : mapping of str to Gear
    pairs : mapping of mesh to Pair
    """

    gears: Mapping[str, Gear]
    pairs: Mapping[str, Pair]


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
    rotates = operating.positions > 1 and operating.rotation == "teeth"
    if not kinematics.determined and (rotates or case.march is not None):
        message = "does not tell how fast all gears turn: a differential has two speeds"
        hint = 'Hold a member, or solve one position, or give rotation = "neglected".'
        problems.append(case.problem("operating.input", message, hint=hint))
    march = case.march
    if march is not None and not problems and not kinematics.gears[march.gear].ratio:
        problems.append(case.problem("march.gear", "does not turn", "a gear that turns"))
    if problems:
        raise CaseError(problems)
    pairs = _pairs(case, kinematics.gears, kinematics.contacts)
    return Geometry(kinematics.gears, _in_phase(case, pairs))


def _in_phase(case: spec.Case, pairs: Mapping[str, Pair]) -> dict[str, Pair]:
    """Return the meshes with their phases.

    Raises
    ------
    CaseError
        If teeth that are told whole do not meet.
    """

    def half(gear: Gear, pair: Pair) -> float:
        tooth = case.gears[gear.name].tooth
        if tooth is None:
            return math.pi / (2.0 * (gear.teeth or math.inf))
        return tooth.half_angle_at(pair.line.pressure_angle)

    meetings = {
        name: Meeting(p.driver, p.driven, (half(p.driver, p), half(p.driven, p)))
        for name, p in pairs.items()
    }
    found, misfits = phases(meetings)
    told = [
        _misfit_told(case, pairs[m.mesh], m)
        for m in misfits
        if all(case.gears[g].tooth is not None for g in case.meshes[m.mesh].ends)
    ]
    if told:
        raise CaseError(told)
    return {name: replace(pair, phase=found.get(name, 0.0)) for name, pair in pairs.items()}


def _misfit_told(case: spec.Case, pair: Pair, misfit: Misfit) -> Problem:
    """Say by how much teeth miss each other, and where a planet between two gears would fit."""
    message = (
        f"cannot be put together: its teeth miss each other by {abs(misfit.pitches):.2g} of a "
        "pitch where all others meet"
    )
    ends = {pair.driver.name, pair.driven.name}
    hint = ""
    for planet in (pair.driver, pair.driven):
        others = {n for m in case.meshes.values() if planet.name in m.ends for n in m.ends}
        teeth = [case.gears[n].teeth or 0 for n in sorted(others - {planet.name})]
        kinds = sorted(case.gears[n].type for n in others - {planet.name})
        if planet.kind == "external" and kinds == ["external", "internal"] and ends <= others:
            step = 360.0 / sum(teeth)
            hint = (
                f"Gears that stand about the same axis fit at angles {step:.6g} deg apart, and "
                f"evenly spaced if their number divides {sum(teeth)}."
            )
    return case.problem(("meshes", misfit.mesh), message, hint=hint)


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
    """Which flanks of planets the load presses (see `Links.pressed`)."""
    if not any(gear.carrier for gear in gears.values()):
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


def _pairs(
    case: spec.Case, gears: Mapping[str, Gear], contacts: Mapping[str, Contact]
) -> dict[str, Pair]:
    """Meshes with the flanks that the torque presses, whichever way it runs through them."""
    flows = against_the_names(case.operating, case.gears, case.meshes, case.shafts)
    against = all(flows or (False,))
    pressed = _pressed(case, gears)
    found, centres = {}, case.centres()
    for name, mesh in case.meshes.items():
        line = line_of_action(mesh, case.gears, centres)
        if line is None:
            raise ValueError(f"no line of action: {name}")
        driver, driven, contact = gears[mesh.driver], gears[mesh.driven], contacts[name]
        coast = pressed[name] < 0 if rides_on(case.gears, *mesh.ends) else against
        turned = coast and not mesh.given("backlash", "normal_backlash")
        if turned:
            driver, driven = driven, driver
            contact = contact_of(driver, driven)
        normals = [contact.normal(line.pressure_angle, drive) for drive in (True, False)]
        pair = Pair(driver, driven, (normals[0], normals[1]), turned, line)
        if mesh.backlash == "teeth":
            left = backlash_of_teeth(mesh, case.gears, centres)
            pair = replace(pair, backlash=math.inf if left is None else left)
        found[name] = pair
    return found
