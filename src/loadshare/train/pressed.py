"""Which flanks the load presses: meshes without a backlash have that flank only.

Loads may be arrays of samples, so that those that press the same flanks can be told from others.

Where several loads reach parallel branches, or power may go round a loop of sets and shafts,
statics of rigid gears cannot tell which flank carries. That of the even share is taken, and a mesh
of which stiffness may press either flank is marked as unsure (`Links.pressed`): if
it carries in the answer, the other flank would not touch whatever the play, and the choice was
right; if it is open there, the play decides, and the answer is warned of (`certify.validity`). To
refuse all such meshes would refuse most for nothing.

A force from outside turns a carrier if it acts on a planet. If it acts on what yields, it pushes
gears against their partners as well, where stiffness may press either flank again.
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
from loadshare.train.willis import NOISE, Links


class Pressed(NamedTuple):
    """Which flank loads press, each (1,) or (S,).

    Attributes
    ----------
    turned : ndarray of bool
        Whether the mesh has the one flank that its name does not.
    unsure : ndarray of bool
        Whether it may be its other flank, as stiffness shares the loads.
    """

    turned: Flags
    unsure: Flags


def pressed_flanks(
    case: spec.Case, gears: Mapping[str, Gear], period: Period | None = None
) -> dict[str, Pressed]:
    """Tell which flank the meshes without a backlash have.

    Parameters
    ----------
    case : Case
        Its loads may be arrays of S samples.
    gears : mapping of str to Gear
        With their speeds.
    period : Period, optional
        Common period of all meshes, where the positions go through it.

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
    # Elsewhere the torque of the input runs through all meshes alike.
    by_load = has_sets(case.gears) or case.operating.external
    pressed = _pressed(case, gears, torque, period) if names and by_load else {}
    pushed = _open_to_forces(case, gears) & names if names else set()
    problems = []
    # Where statics does not tell, the names do.
    none = np.zeros_like(against)
    found = {
        n: Pressed(against & (n in names), none | (n in pushed))
        for n in case.meshes
        if n not in pressed
    }
    for name, (signs, either) in pressed.items():
        coast, drive = (signs < 0).any(axis=0), (signs > 0).any(axis=0)
        if name in names and (coast & drive).any():
            message = "is missing: the load presses now one flank, now the other"
            hint = "How much play the mesh has decides when its other flank carries."
            problems.append(case.problem(("meshes", name, "backlash"), message, "a length", hint))
        # As where the load presses neither.
        turned = np.where(coast | drive, coast, against) & (name in names)
        unsure = either.any(axis=0) | (name in pushed)
        found[name] = Pressed(turned, np.asarray(unsure & (name in names)))
    if problems:
        raise CaseError(problems)
    return found


def _against_the_names(case: spec.Case, torque: Array) -> Flags:
    """Whether torques (positions, S) run against the names of the meshes: all that are not 0."""
    other_end = from_the_other_end(case)
    against = np.where(torque != 0.0, (torque < 0.0) != other_end, True)
    return np.asarray(against.all(axis=0) & (torque != 0.0).any(axis=0))


def _pressed(
    case: spec.Case, gears: Mapping[str, Gear], torque: Array, period: Period | None
) -> dict[str, tuple[Numbers, Flags]]:
    """Signs of the torques of meshes (positions, S), by statics (see `Links.pressed`)."""
    operating = case.operating
    torques: dict[str, Any] = {
        n: t.si * math.copysign(1.0, gears[n].ratio) for n, t in operating.external.items()
    }
    torques[operating.input] = torques.get(operating.input, 0.0) + torque
    for carrier, moment in _moments(case, gears, len(torque), period).items():
        torques[carrier] = torques.get(carrier, 0.0) + moment
    return _links(case, gears).pressed(torques, _turning(case, gears))


def _links(case: spec.Case, gears: Mapping[str, Gear]) -> Links:
    return Links.of(
        gears,
        {name: mesh.ends for name, mesh in case.meshes.items()},
        {name: shaft.ends for name, shaft in case.shafts.items()},
    )


def _turning(case: spec.Case, gears: Mapping[str, Gear]) -> list[str]:
    return [n for n, g in gears.items() if not g.held and n != case.operating.output]


def _open_to_forces(case: spec.Case, gears: Mapping[str, Gear]) -> set[str]:
    """Return the links that forces from outside may load either way, as stiffness shares them."""
    felt = {name for n in forces_of(case) for name in (n, gears[n].carrier) if name is not None}
    if not any(case.floats(n) or case.gears[n].support not in (None, "rigid") for n in felt):
        return set()
    left = _links(case, gears).open_to_stiffness(_turning(case, gears))
    return {name for name, is_open in left.items() if is_open}


def _moments(
    case: spec.Case, gears: Mapping[str, Gear], count: int, period: Period | None
) -> dict[str, Array]:
    """Moments of forces from outside about carriers [N·m], in their senses.

    At all positions where the torque has `count` of them; else where they are least and largest.
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
        # What is fixed in the housing turns backwards about the carrier.
        angle = (carrier.sense * carrier.ratio * turned)[:, None]
        moment = carrier.sense * (np.cos(angle) * across - np.sin(angle) * along)
        found[hub] = found.get(hub, 0.0) + moment
        size[hub] = size.get(hub, 0.0) + np.hypot(across, along)
    rows: Any = slice(None)
    if count == 1:
        ends = [end(m[:, 0]) for m in found.values() for end in (np.argmin, np.argmax)]
        rows = sorted(set(map(int, ends)))
    # Weights of planets that are evenly spaced leave round-off.
    return {n: np.where(np.abs(m) > NOISE * size[n], m, 0.0)[rows] for n, m in found.items()}
