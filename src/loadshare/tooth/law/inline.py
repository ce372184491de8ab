"""The gear pair of a mesh of a case, for a law from the gears' own teeth."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from loadshare.case.line_of_action import facing, mesh_distance
from loadshare.errors import CaseError, Problem
from loadshare.tooth.pair.file import PairFile, built
from loadshare.tooth.pair.model import HelicoidContent
from loadshare.tooth.problems import down, millimetres, refuse

if TYPE_CHECKING:
    from loadshare.case import Case, Gear

MODELS = {"ltca": "slices", "ltca elements": "finite elements"}
"""Model of the teeth by the keyword for the law."""
ROLE = re.compile(r"\bthe (driver|driven)\b(?: gear)?")
"""What a message on a pair calls one of its gears."""
LOAD = 50e6
"""Tooth force per face width and module for the rated torque if none is given [Pa]."""


def inline_pair(case: Case, name: str) -> PairFile:
    """Return the pair that two gears of a case form, as from a pair file.

    Parameters
    ----------
    case : Case
    name : str
        A mesh of two cylindrical gears with module, teeth and face width, whose law is "ltca" or
        "ltca elements".

    Raises
    ------
    CaseError
        If the gears or their mesh have problems; it lists all of them by the keys of the case.
    """
    mesh = case.meshes[name]
    centres = case.centres()
    driver, driven = facing(mesh, case.gears, centres)
    gears = dict(zip(mesh.ends, (driver, driven), strict=True))
    refuse(problem for end, gear in gears.items() for problem in _too_deep(case, end, gear))
    distance = mesh_distance(mesh, case.gears, centres)
    torque = mesh.rated_torque.si if mesh.rated_torque else _rated(driver, driven)
    content = HelicoidContent.model_validate(
        {
            "kind": "helicoid",
            "torque": f"{torque!r} N*m",
            "driver": _gear(driver),
            "driven": _gear(driven),
            # To a picometre, so that planets whose places differ by rounding share one pair.
            "centre_distance": f"{1e3 * distance:.9f} mm",
            "analysis": {
                "positions": case.operating.positions,
                "compliance": MODELS[str(mesh.law)],
                "sampling": "means",
            },
        }
    )
    try:
        return PairFile(name, content, built(content))
    except CaseError as error:
        raise CaseError([_in_case(case, name, problem) for problem in error.problems]) from None


def assumed_of(case: Case, name: str, pair: PairFile) -> tuple[str, ...]:
    """Return what the pair of a mesh assumes because the case does not say."""
    mesh = case.meshes[name]
    gears = dict(zip(("driver", "driven gear"), (case.gears[n] for n in mesh.ends), strict=True))
    bodies = pair.geometry.driver.gear, pair.geometry.driven.gear
    rims: dict[str, list[str]] = {}
    for (which, gear), body in zip(gears.items(), bodies, strict=True):
        if _rim(gear) is None:
            rims.setdefault(body.assumed_rim, []).append(which)
    found = [f"rim of {' and '.join(which)} {depth}" for depth, which in rims.items()]
    if mesh.rated_torque is None:
        found.append(f"rated for {LOAD * 1e-6:g} N per mm of face width and module")
    if facing(mesh, case.gears, case.centres())[0] is not gears["driver"]:
        found.append("faces cut to where they overlap")
    if any(gear.tip_radius is None for gear in gears.values()):
        found.append("tip radius of the rack 0.38")
    return (*found, "steel", "unmodified flanks")


def _rated(driver: Gear, driven: Gear) -> float:
    (tooth, width), (_, other) = driver.teeth_and_width, driven.teeth_and_width
    return LOAD * min(width, other) * tooth.module * tooth.radius


def _gear(gear: Gear) -> dict[str, Any]:
    tooth, width = gear.teeth_and_width
    content: dict[str, Any] = {
        "module": f"{tooth.module!r} m",
        "teeth": tooth.teeth,
        "pressure_angle": f"{tooth.pressure_angle!r} rad",
        "profile_shift": tooth.profile_shift,
        "addendum": tooth.addendum,
        "dedendum": tooth.dedendum,
        "internal": tooth.internal,
        "face_width": f"{width!r} m",
    }
    if gear.helix_angle is not None:
        content["helix_angle"] = f"{tooth.helix_angle!r} rad"
    if gear.tip_radius is not None:
        content["tip_radius"] = gear.tip_radius
    rim = _rim(gear)
    return content if rim is None else content | {"rim": f"{rim!r} m"}


def _too_deep(case: Case, name: str, gear: Gear) -> Iterator[Problem]:
    """Yield a problem if the rim of an external gear is deeper than the gear itself."""
    radius = _rim(gear)
    if gear.tooth is not None and radius is not None and radius <= 0.0:
        what = "leaves no bore in the body below the teeth"
        allowed = f"less than the root radius, {millimetres(gear.tooth.root, down)}"
        yield case.problem(("gears", name, "rim"), what, allowed)


def _rim(gear: Gear) -> float | None:
    """Return the radius at which the body ends [m], if given; the rim on a web takes precedence."""
    tooth = gear.tooth
    if gear.rim is not None and tooth is not None:
        return tooth.root - tooth.kind * gear.rim.si
    ends = gear.bore or gear.outside_diameter
    return 0.5 * ends.si if ends else None


def _in_case(case: Case, name: str, problem: Problem) -> Problem:
    """Return a problem of the pair with the keys of the case."""
    which, _, key = problem.key.partition(".")
    mesh = case.meshes[name]
    ends = {"driver": mesh.driver, "driven": mesh.driven}

    def named(text: str) -> str:
        return ROLE.sub(lambda role: f"gear {ends[role[1]]}", text)

    said = {key: named(getattr(problem, key)) for key in ("message", "allowed", "hint")}
    problem = replace(problem, **said)
    if which not in ends:
        message = (
            f"{problem.key} = {problem.given}: {problem.message}" if which else problem.message
        )
        return case.problem(("meshes", name, "law"), message, problem.allowed, problem.hint)
    gear = case.gears[ends[which]]
    if key == "rim":
        key = next(iter(gear.given("rim", "bore", "outside_diameter")), "module")
    path = ("gears", ends[which], key)
    found = case.problem(path, problem.message, problem.allowed, problem.hint)
    if key == "addendum" and gear.tip_alteration is not None:
        return replace(found, given=f"{problem.given} with its tip_alteration")
    return found if found.given else replace(found, given=problem.given)
