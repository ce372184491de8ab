"""Which flanks the load presses: meshes without a backlash have that flank only.

Loads may be arrays of samples, so that those that press the same flanks can be told from others.

Where several loads reach parallel branches, or power may go round a loop of sets and shafts,
statics of rigid gears cannot tell which flank carries. That of the even share is taken, and a mesh
of which stiffness may press either flank is marked as unsure (`Links.pressed`): if
it carries in the answer, the other flank would not touch whatever the play, and the choice was
right; if it is open there, the play decides, and the answer is warned of (`certify.validity`). To
refuse all such meshes would refuse most for nothing.
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
from loadshare.train.willis import Links


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


def pressed_flanks(case: spec.Case, gears: Mapping[str, Gear]) -> dict[str, Pressed]:
    """Tell which flank the meshes without a backlash have.

    Parameters
    ----------
    case : Case
        Its loads may be arrays of S samples.
    gears : mapping of str to Gear
        With their speeds.

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
    pressed = _pressed(case, gears, torque) if names and by_load else {}
    problems = []
    # Where statics does not tell, the names do.
    none = np.zeros_like(against)
    found = {n: Pressed(against & (n in names), none) for n in case.meshes if n not in pressed}
    for name, (signs, either) in pressed.items():
        coast, drive = (signs < 0).any(axis=0), (signs > 0).any(axis=0)
        if name in names and (coast & drive).any():
            message = "is missing: the load presses now one flank, now the other"
            hint = "How much play the mesh has decides when its other flank carries."
            problems.append(case.problem(("meshes", name, "backlash"), message, "a length", hint))
        # As where the load presses neither.
        turned = np.where(coast | drive, coast, against) & (name in names)
        found[name] = Pressed(turned, np.asarray(either.any(axis=0) & (name in names)))
    if problems:
        raise CaseError(problems)
    return found


def _against_the_names(case: spec.Case, torque: Array) -> Flags:
    """Whether torques (positions, S) run against the names of the meshes: all that are not 0."""
    other_end = from_the_other_end(case.operating, case.gears, case.meshes, case.shafts)
    against = np.where(torque != 0.0, (torque < 0.0) != other_end, True)
    return np.asarray(against.all(axis=0) & (torque != 0.0).any(axis=0))


def _pressed(
    case: spec.Case, gears: Mapping[str, Gear], torque: Array
) -> dict[str, tuple[Numbers, Flags]]:
    """Signs of the torques of meshes (positions, S), by statics (see `Links.pressed`)."""
    links = Links.of(
        gears,
        {name: mesh.ends for name, mesh in case.meshes.items()},
        {name: shaft.ends for name, shaft in case.shafts.items()},
    )
    operating = case.operating
    torques: dict[str, Any] = {
        n: t.si * math.copysign(1.0, gears[n].ratio) for n, t in operating.external.items()
    }
    torques[operating.input] = torques.get(operating.input, 0.0) + torque
    free = [n for n, g in gears.items() if not g.held and n != operating.output]
    return links.pressed(torques, free)
