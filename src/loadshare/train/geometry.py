"""The geometry of a case: where gears are, how they turn, which way their teeth push.

It is settled once for all samples that share a machine.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from loadshare import case as spec
from loadshare.case.line_of_action import LineOfAction, backlash_of_teeth, line_of_action
from loadshare.case.place import axis_of
from loadshare.case.teeth import tooth_counts
from loadshare.errors import CaseError
from loadshare.numbers import counted
from loadshare.settings import ALLOWED
from loadshare.train.gear import Gear, Vector, transverse_frame
from loadshare.train.kinematics import Kinematics, settle
from loadshare.train.layout import in_phase
from loadshare.train.mesh import running_contact
from loadshare.train.period import Period, period_of
from loadshare.train.phases import is_whole
from loadshare.train.pressed import pressed_flanks


@dataclass(frozen=True, slots=True, eq=False)
class Pair:
    """Geometry of a mesh.

    Attributes
    ----------
    driver, driven : Gear
    normals : (ndarray, ndarray)
        n and n'.
    named_backwards : bool
        See `Mesh`.
    line : LineOfAction
    phases : (float, float)
        Fractions of their cycle that drive and coast flank have passed at the first position, if
        they follow from the teeth [-].
    backlash : float
        Along the line of action, if the case derives it from the teeth [m].
    senses : (int, int)
        See `Mesh`.
    flank_uncertain : bool
        See `Mesh`.
    """

    driver: Gear
    driven: Gear
    normals: tuple[Vector, Vector]
    named_backwards: bool
    line: LineOfAction
    phases: tuple[float, float] = (0.0, 0.0)
    backlash: float = math.inf
    senses: tuple[int, int] = (1, 1)
    flank_uncertain: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Geometry:
    """What samples that share a machine have in common.

    Attributes
    ----------
    gears : mapping of str to Gear
    pairs : mapping of mesh to Pair
    period : Period or None
        Common period of all meshes, if the positions run through it.
    determined : bool
        Whether all speeds follow from the input's; in a differential they do not.
    """

    gears: Mapping[str, Gear]
    pairs: Mapping[str, Pair]
    period: Period | None = None
    determined: bool = True


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
        message = "does not determine the speeds of all gears: a differential has two speeds"
        hint = 'Hold a member, solve a single position, or give rotation = "neglected".'
        problems.append(case.problem("operating.input", message, hint=hint))
    march = case.march
    if march is not None and not problems and not kinematics.gears[march.gear].ratio:
        problems.append(case.problem("march.gear", "does not turn", "a gear that turns"))
    if problems:
        raise CaseError(problems)
    period = _period(case, kinematics.gears) if common else None
    pairs = _pairs(case, kinematics.gears, period)
    return Geometry(kinematics.gears, in_phase(case, pairs), period, kinematics.determined)


def _period(case: spec.Case, gears: Mapping[str, Gear]) -> Period:
    """Return the common period of all meshes.

    Raises
    ------
    CaseError
        If it does not follow from tooth numbers, or has more positions than are allowed.
    """
    meshes = {name: mesh.ends for name, mesh in case.meshes.items()}
    counts = {n: gears[n].teeth or 0.0 for ends in meshes.values() for n in ends}
    unknown = [n for n, z in counts.items() if round(z) < 1 or not is_whole(z)]
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
            f"all meshes complete whole cycles after {_number_text(cycles)} cycles of mesh "
            f"{found.fastest} ({_number_text(found.revolutions)} revolutions of gear "
            f"{operating.input}); with {counted(operating.positions, 'position')} in each "
            f"cycle, these are {_number_text(steps)} positions"
        )
        fewer = f" or operating.positions = {most // cycles}" if most >= cycles else ""
        hint = f"Give a march over part of it{fewer}."
        raise CaseError([case.problem(key, message, f"up to {most} positions", hint)])
    for name, measurement in case.measured.items():
        if measurement.position is not None and measurement.position > steps:
            path = f"measured.{name}.position"
            raise CaseError(
                [case.problem(path, f"the case has positions 1 to {steps}", f"1 to {steps}")]
            )
    return found


def _number_text(number: Fraction | int) -> str:
    """Return a number as text, to six digits; for a huge one, only that it is huge."""
    return f"{float(number):.6g}" if number < 10**300 else "more than 10^300"


def _kinematics(case: spec.Case) -> Kinematics:
    running = 1 if case.operating.running == "counter-clockwise" else -1
    centres = case.centres()
    # Counts that follow from given ones are used as well.
    teeth, _ = tooth_counts(case.gears, case.meshes)

    def unsettled(name: str, gear: spec.Gear) -> Gear:
        axis = np.array(axis_of(gear))
        return Gear(
            name=name,
            kind=gear.type,
            centre=np.array(centres[name]),
            axis=axis,
            frame=transverse_frame(axis),
            base_radius=0.0 if gear.is_carrier else gear.acting_radius,
            sense=running,
            teeth=teeth.get(name),
            support=None,
            ratio=1.0,
            held=gear.held,
            carrier=gear.carrier,
        )

    return settle(
        {name: unsettled(name, gear) for name, gear in case.gears.items()},
        {n: m.ends for n, m in case.meshes.items()},
        {n: s.ends for n, s in case.shafts.items()},
        case.operating.input,
    )


def _pairs(case: spec.Case, gears: Mapping[str, Gear], period: Period | None) -> dict[str, Pair]:
    """Return the meshes; one without a backlash has the flank that the torque presses."""
    every = pressed_flanks(case, gears, period)
    found, centres = {}, case.centres()
    for name, mesh in case.meshes.items():
        line = line_of_action(mesh, case.gears, centres)
        if line is None:
            raise ValueError(f"no line of action: {name}")
        driver, driven = gears[mesh.driver], gears[mesh.driven]
        named_backwards, flank_uncertain = (bool(flag) for flag in every[name])
        contact, senses = running_contact(gears, mesh.driver, mesh.driven)
        if named_backwards:
            # The other flank of the same two gears, whichever senses they are counted in.
            driver, driven = driven, driver
            contact, senses = running_contact(gears, mesh.driven, mesh.driver, senses[1])
        normals = [contact.normal(line.pressure_angle, drive) for drive in (True, False)]
        pair = Pair(
            driver,
            driven,
            (normals[0], normals[1]),
            named_backwards,
            line,
            senses=senses,
            flank_uncertain=flank_uncertain,
        )
        if mesh.backlash == "teeth":
            left = backlash_of_teeth(mesh, case.gears, centres)
            pair = replace(pair, backlash=math.inf if left is None else left)
        found[name] = pair
    return found
