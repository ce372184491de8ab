"""The geometry of a case: where gears stand, how they turn, which way their teeth push.

It is settled once for all samples that share a machine.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from loadshare import case as spec
from loadshare.case.line_of_action import LineOfAction, line_of_action
from loadshare.case.place import axis_of, centres_of
from loadshare.case.power_flow import against_the_names, rides_on
from loadshare.case.teeth import tooth_counts
from loadshare.errors import CaseError
from loadshare.train.gear import Gear, Vector, transverse_frame
from loadshare.train.kinematics import Kinematics, settle
from loadshare.train.mesh import Contact, contact_of
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
    """

    driver: Gear
    driven: Gear
    normals: tuple[Vector, Vector]
    turned: bool
    line: LineOfAction


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
    if problems:
        raise CaseError(problems)
    return Geometry(kinematics.gears, _pairs(case, kinematics.gears, kinematics.contacts))


def _kinematics(case: spec.Case) -> Kinematics:
    running = 1 if case.operating.running == "counter-clockwise" else -1
    centres = centres_of(case.gears)
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
    found, centres = {}, centres_of(case.gears)
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
        found[name] = Pair(driver, driven, (normals[0], normals[1]), turned, line)
    return found
