"""Comparison of the gears of a case with those of the pair that their law was computed for."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, TypeAlias

from loadshare.case.line_of_action import facing, line_of_action
from loadshare.errors import Problem
from loadshare.settings import TEETH
from loadshare.tooth.problems import ANGLES, degrees, digits, millimetres, written

if TYPE_CHECKING:
    from loadshare.case import Case, Gear
    from loadshare.tooth.pair.gears import PairGear, PairGears

Tell: TypeAlias = Callable[[str, str, str], Problem]
"""Function from a gear's key, what the file has for it and what is allowed, to a problem."""
OF_RADIUS = {"module", "teeth", "pressure_angle", "helix_angle"}
"""Keys from which a base radius follows."""
OF_SHAPE = ("profile_shift", "dedendum", "tip_radius")
"""Keys of the shape of a tooth, in modules, with the same meaning in a case and a pair."""


def disagreements(case: Case, name: str, gears: PairGears, source: str) -> Iterator[Problem]:
    """Yield where a case differs about a mesh from the file that it names.

    Parameters
    ----------
    case : Case
    name : str
        Name of the mesh.
    gears : PairGears
        The gears that the law was computed for.
    source : str
        Name of the file in messages.
    """
    mesh = case.meshes[name]
    here = f"{source} has"
    source_of = ("meshes", name, "law_file" if mesh.geometry is None else "geometry")
    if gears.shaft_angle is not None:
        message = f"{here} axes {degrees(gears.shaft_angle.si)} apart"
        hint = "In a case, the axes of a face gear and its pinion must be at right angles."
        yield case.problem(source_of, message, "a pair of axes at 90 deg", hint)
    cut = facing(mesh, case.gears, case.centres())
    for end, facing_it, own in zip(mesh.ends, cut, (gears.driver, gears.driven), strict=True):

        def tell(key: str, message: str, allowed: str, end: str = end) -> Problem:
            return case.problem(("gears", end, key), f"{here} {message}", allowed)

        yield from _gear(case.gears[end], gears, own, tell)
        yield from _face_width(case.gears[end], facing_it, gears, own, tell)
    line = line_of_action(mesh, case.gears, case.centres())
    if line is None:
        return
    angles = [("pressure_angle", line.pressure_angle, gears.working_angle.si)]
    if mesh.helix_angle is not None:
        # The law does not need the helix; if a case leaves it out, there is nothing to compare.
        angles.append(("helix_angle", line.helix_angle, gears.base_helix_angle.si))
    for key, found, wanted in angles:
        if abs(abs(found) - wanted) <= TEETH.angle:
            continue
        if getattr(mesh, key) is not None:
            path, message = ("meshes", name, key), f"{here} {degrees(wanted)}"
            yield case.problem(path, message, degrees(wanted))
        else:
            message = f"{here} the {key} {degrees(wanted)}; by the centres it is {degrees(found)}"
            yield case.problem(source_of, message)


def _gear(gear: Gear, gears: PairGears, own: PairGear, tell: Tell) -> Iterator[Problem]:
    if gear.type != own.type:
        yield tell("type", f"a gear of type {own.type}", own.type)
        return
    found = set()
    if gear.teeth is not None and gear.teeth != own.teeth:
        found.add("teeth")
        yield tell("teeth", f"{own.teeth} teeth", str(own.teeth))
    for key, given, wanted in _dimensions(gear, gears, own):
        if abs(given - wanted) > _allowed(key, wanted):
            found.add(key)
            text = written(key, wanted)
            yield tell(key, f"the {key.replace('_', ' ')} {text}", text)
    yield from _tip(gear, own, tell)
    radius = own.base_radius.si
    keys = gear.given("base_radius", "inner_radius", "module")
    follows = keys == ["module"] and found & OF_RADIUS
    if not follows and abs(gear.acting_radius - radius) > TEETH.radius * radius:
        message = f"the base radius {millimetres(radius)}"
        if keys == ["inner_radius"]:
            message += f", and (L1 + L2)/2 is {millimetres(gear.acting_radius)}"
        yield tell(keys[0], message, f'base_radius = "{millimetres(radius)}"')


def _dimensions(gear: Gear, gears: PairGears, own: PairGear) -> Iterator[tuple[str, float, float]]:
    """Yield keys that the case gives, with its value and that of the pair [m, rad or 1]."""
    for key in gear.given("module", "pressure_angle", "helix_angle"):
        wanted = getattr(own, key)
        if wanted is not None:
            values = getattr(gear, key).si, wanted.si
            # The halves of a herringbone gear have opposite hands.
            yield key, *(map(abs, values) if gears.helices == 2 else values)
    for key in gear.given(*OF_SHAPE):
        wanted = getattr(own, key)
        if wanted is not None:
            yield key, getattr(gear, key), wanted


def _allowed(key: str, wanted: float) -> float:
    """Return how far apart two values of a key may be [m, rad or modules]."""
    if key in ANGLES:
        return TEETH.angle
    return TEETH.radius * (abs(wanted) if key == "module" else 1.0)


def _tip(gear: Gear, own: PairGear, tell: Tell) -> Iterator[Problem]:
    """Yield an addendum that, with the alteration of the tip, differs from that of the pair."""
    keys = gear.given("tip_alteration", "addendum")
    if not keys or gear.tooth is None or own.addendum is None:
        return
    if abs(gear.tooth.addendum - own.addendum) > TEETH.radius:
        message = f"the addendum {digits(own.addendum)}"
        if keys[0] == "tip_alteration":
            message += f"; with the alteration it is {digits(gear.tooth.addendum)}"
        yield tell(keys[0], message, digits(own.addendum) if keys[0] == "addendum" else "")


def _face_width(
    gear: Gear, facing_it: Gear, gears: PairGears, own: PairGear, tell: Tell
) -> Iterator[Problem]:
    """Yield a face width that is not the pair's, neither as given nor cut to the faces' overlap."""
    if gear.face_width is None or facing_it.face_width is None or own.face_width is None:
        return
    least = own.face_width.si
    most = least + (gears.helix_gap.si if gears.helix_gap else 0.0)
    slack = TEETH.radius * least
    widths = gear.face_width.si, facing_it.face_width.si
    if not any(least - slack <= width <= most + slack for width in widths):
        message = f"the face width {millimetres(least)}"
        if gears.helices == 2:
            message += f" in two halves, {millimetres(most)} with their gap"
        yield tell("face_width", message, millimetres(least))
