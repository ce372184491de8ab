"""What a case says of two gears against what their pair file says."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from loadshare.case.keys import dotted
from loadshare.case.line_of_action import line_of_action
from loadshare.errors import Problem
from loadshare.settings import TEETH
from loadshare.tooth.face.pair import FaceGearPair
from loadshare.tooth.problems import degrees, millimetres

if TYPE_CHECKING:
    from loadshare.case import Case, Gear
    from loadshare.tooth.pair.file import PairFile


def disagreements(case: Case, name: str, pair: PairFile) -> Iterator[Problem]:
    """Yield what a case says otherwise of a mesh than the pair that it names.

    Parameters
    ----------
    case : Case
    name : str
        Name of the mesh.
    pair : PairFile
    """
    mesh, geometry = case.meshes[name], pair.geometry
    here = f"{pair.name} has"
    arm = geometry.arm / math.cos(_base_helix(pair))
    sides = (
        (mesh.driver, arm, pair.content.driver.teeth, _type(pair, "driver")),
        (mesh.driven, arm * geometry.ratio, pair.content.driven.teeth, _type(pair, "driven")),
    )
    for gear, radius, teeth, kind in sides:
        yield from _gear(case, gear, here, radius, teeth, kind)
    line = line_of_action(mesh, case.gears, case.centres())
    if line is None:
        return
    angles = [("pressure_angle", line.pressure_angle, geometry.working_angle)]
    if mesh.helix_angle is not None:
        # The helix is not needed for the law; a case that leaves it out says nothing of it.
        angles.append(("helix_angle", line.helix_angle, _base_helix(pair)))
    for key, own, wanted in angles:
        if abs(abs(own) - wanted) > TEETH.angle:
            given = getattr(mesh, key) is not None
            path = dotted(("meshes", name, key if given else "geometry"))
            message = f"{here} {degrees(wanted)}"
            if not given:
                message = f"{here} the {key} {degrees(wanted)}; by the centres it is {degrees(own)}"
            yield case.problem(path, message, degrees(wanted) if given else "")


def _gear(
    case: Case, name: str, here: str, radius: float, teeth: int, kind: str
) -> Iterator[Problem]:
    gear: Gear = case.gears[name]
    if gear.type != kind:
        yield case.problem(dotted(("gears", name, "type")), f"{here} a gear of type {kind}", kind)
    elif abs(gear.acting_radius - radius) > TEETH.radius * radius:
        keys = gear.given("base_radius", "inner_radius", "module")
        message = f"{here} the base radius {millimetres(radius)}"
        if keys == ["inner_radius"]:
            message += f", and (L1 + L2)/2 is {millimetres(gear.acting_radius)}"
        path = dotted(("gears", name, keys[0]))
        yield case.problem(path, message, f'base_radius = "{millimetres(radius)}"')
    if gear.teeth is not None and gear.teeth != teeth:
        yield case.problem(dotted(("gears", name, "teeth")), f"{here} {teeth} teeth", str(teeth))


def _base_helix(pair: PairFile) -> float:
    geometry = pair.geometry
    if isinstance(geometry, FaceGearPair):
        return 0.0
    return abs(geometry.driver_gear.base_helix_angle)


def _type(pair: PairFile, which: str) -> str:
    gear = getattr(pair.content, which)
    if isinstance(pair.geometry, FaceGearPair):
        return "external" if which == "driver" else "face"
    return "internal" if gear.internal else "external"
