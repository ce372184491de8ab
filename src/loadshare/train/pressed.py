"""Which flanks the load presses: meshes without a backlash have that flank only.

Loads may be arrays of samples, so that samples that press the same flanks can be grouped.

Where several loads reach parallel branches, or power may circulate in a loop of sets and shafts,
the statics of rigid gears cannot determine which flank carries. The flank that an even sharing
presses is taken, and a mesh in which stiffness may press either flank is marked as unsure
(`SpeedLinks.pressed`). If it carries in the answer, the other flank would not touch whatever the
backlash, and the choice was right; if it is open in the answer, the backlash decides, and the
answer comes with a warning (`certify.validity`). Refusing all such meshes would refuse most of them
needlessly.

An external force on a planet turns the carrier. If it acts on a gear that can yield, it also pushes
gears against their partners, where again stiffness may press either flank.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from loadshare import case as spec
from loadshare.array_types import Array, Flags, Numbers
from loadshare.case.power_flow import from_the_other_end, has_sets
from loadshare.errors import CaseError
from loadshare.train.gear import Gear
from loadshare.train.operation import forces_of, operation_of
from loadshare.train.period import Period
from loadshare.train.turning import turning_of
from loadshare.train.willis import NOISE, SpeedLinks


class Pressed(NamedTuple):
    """Which flank the loads press, in arrays of shape (1,) or (S,).

    Attributes
    ----------
    named_backwards : ndarray of bool
        Whether the one flank of the mesh is the opposite of the one that its name implies.
    flank_uncertain : ndarray of bool
        Whether it may be the other flank, depending on how stiffness shares the loads.
    """

    named_backwards: Flags
    flank_uncertain: Flags


def pressed_flanks(
    case: spec.Case, gears: Mapping[str, Gear], period: Period | None = None
) -> dict[str, Pressed]:
    """Return which flank each mesh without a backlash has.

    Parameters
    ----------
    case : Case
        Its loads may be arrays of S samples.
    gears : mapping of str to Gear
        With their speeds.
    period : Period, optional
        Common period of all meshes, if the positions run through it.

    Returns
    -------
    dict of mesh to Pressed

    Raises
    ------
    CaseError
        If a mesh without a backlash is pressed on one flank at some positions, and on the other at
        others.
    """
    torque = np.stack(np.broadcast_arrays(*map(np.atleast_1d, case.operating.input_torque)))
    names = {n for n, m in case.meshes.items() if not m.given("backlash", "normal_backlash")}
    against = _against_the_names(case, torque)
    # Otherwise the input torque alone runs through all meshes, in the order of their names or
    # against it.
    by_load = has_sets(case.gears) or case.operating.external
    pressed = _pressed(case, gears, torque, period) if names and by_load else {}
    pushed = _open_to_forces(case, gears) & names if names else set()
    problems = []
    # Meshes without an answer from statics go by their names.
    none = np.zeros_like(against)
    found = {
        n: Pressed(against & (n in names), none | (n in pushed))
        for n in case.meshes
        if n not in pressed
    }
    for name, (signs, either) in pressed.items():
        coast, drive = (signs < 0).any(axis=0), (signs > 0).any(axis=0)
        if name in names and (coast & drive).any():
            message = "is missing: the load presses both flanks in turn"
            hint = "The backlash determines when the other flank of the mesh carries load."
            problems.append(case.problem(("meshes", name, "backlash"), message, "a length", hint))
        # If the load presses neither flank, the name decides here too.
        named_backwards = np.where(coast | drive, coast, against) & (name in names)
        flank_uncertain = either.any(axis=0) | (name in pushed)
        found[name] = Pressed(named_backwards, np.asarray(flank_uncertain & (name in names)))
    if problems:
        raise CaseError(problems)
    return found


def _against_the_names(case: spec.Case, torque: Array) -> Flags:
    """Return whether all nonzero torques (positions, S) run against the names of the meshes."""
    other_end = from_the_other_end(case)
    against = np.where(torque != 0.0, (torque < 0.0) != other_end, True)
    return np.asarray(against.all(axis=0) & (torque != 0.0).any(axis=0))


def _pressed(
    case: spec.Case, gears: Mapping[str, Gear], torque: Array, period: Period | None
) -> dict[str, tuple[Numbers, Flags]]:
    """Return the signs of mesh torques (positions, S) by statics (see `SpeedLinks.pressed`)."""
    operating = case.operating
    torques: dict[str, Any] = {
        n: t.si * math.copysign(1.0, gears[n].ratio) for n, t in operating.external.items()
    }
    torques[operating.input] = torques.get(operating.input, 0.0) + torque
    for carrier, moment in _moments(case, gears, len(torque), period).items():
        torques[carrier] = torques.get(carrier, 0.0) + moment
    return _links(case, gears).pressed(torques, _turning(case, gears))


def _links(case: spec.Case, gears: Mapping[str, Gear]) -> SpeedLinks:
    return SpeedLinks.of(
        gears,
        {name: mesh.ends for name, mesh in case.meshes.items()},
        {name: shaft.ends for name, shaft in case.shafts.items()},
    )


def _turning(case: spec.Case, gears: Mapping[str, Gear]) -> list[str]:
    return [n for n, g in gears.items() if not g.held and n != case.operating.output]


def _open_to_forces(case: spec.Case, gears: Mapping[str, Gear]) -> set[str]:
    """Return the links that external forces may load either way, depending on stiffness."""
    felt = {name for n in forces_of(case) for name in (n, gears[n].carrier) if name is not None}
    if not any(case.floats(n) or case.gears[n].support not in (None, "rigid") for n in felt):
        return set()
    left = _links(case, gears).open_to_stiffness(_turning(case, gears))
    return {name for name, is_open in left.items() if is_open}


def _moments(
    case: spec.Case, gears: Mapping[str, Gear], count: int, period: Period | None
) -> dict[str, Array]:
    """Return the moments of external forces about carriers [N·m], in the carriers' senses.

    They are those at all positions if the torque varies over these (`count` > 1), or else only
    those at the positions at which a moment is least or largest.
    """
    forces = forces_of(case)
    if not forces:
        return {}
    found: dict[str, Any] = {}
    size: dict[str, Any] = {}
    asked = operation_of(case, gears)
    turns = turning_of(gears, asked["positions"], asked["rotating"], asked["march"], period)
    turned = turns.after(np.arange(turns.steps))
    for name, force in forces.items():
        if (hub := gears[name].carrier) is None:
            continue
        carrier = gears[hub]
        arm = gears[name].centre - carrier.centre
        across = np.atleast_1d(force @ np.cross(carrier.axis, arm))
        along = np.atleast_1d(force @ (arm - (arm @ carrier.axis) * carrier.axis))
        # Seen from the carrier, a force fixed in the housing turns backwards.
        angle = (carrier.sense * carrier.ratio * turned)[:, None]
        moment = carrier.sense * (np.cos(angle) * across - np.sin(angle) * along)
        found[hub] = found.get(hub, 0.0) + moment
        size[hub] = size.get(hub, 0.0) + np.hypot(across, along)
    rows: Any = slice(None)
    if count == 1:
        ends = [end(m[:, 0]) for m in found.values() for end in (np.argmin, np.argmax)]
        rows = sorted(set(map(int, ends)))
    # Weights of evenly spaced planets cancel up to round-off.
    return {n: np.where(np.abs(m) > NOISE * size[n], m, 0.0)[rows] for n, m in found.items()}
