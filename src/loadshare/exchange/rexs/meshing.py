"""Meshes of a REXS unit: which gear drives, the law, and where load is shared."""

from __future__ import annotations

import math
from collections import Counter, deque

from loadshare.case.gears import YOUNG
from loadshare.case.place import dot, minus
from loadshare.exchange.imported import Data
from loadshare.exchange.rexs.gearing import Gearing
from loadshare.exchange.rexs.links import Links
from loadshare.exchange.rexs.model import Component
from loadshare.exchange.rexs.shafts import material_of

LIKE_STEEL = 0.05
"""Relative difference between a modulus of elasticity and that of steel that is not reported."""
ALIKE = 1e-3
"""Relative difference of widths, or distances, that is not reported."""


def meshes_of(of: Gearing, first: str, links: Links, assumed: list[str]) -> Data:
    """Return the meshes, named driver first as the torque comes from the input.

    Where both gears are equally far from the input, a central gear comes before a planet, so that
    all its meshes have one sense.
    """
    reached = _reached(of, first, links)
    made: Data = {}
    for stage, one, other in of.stages:
        driver, driven = sorted(
            (one, other), key=lambda gear: (reached[of.names[gear.id]], gear.id in of.carrier_of)
        )
        name = f"{of.names[driver.id]}-{of.names[driven.id]}"
        made[name] = _law(of, stage, driver, driven)
        assumed += _width_assumed(name, made[name], stage, driver, driven)
        assumed += _distance_assumed(of, name, stage, driver, driven)
    if any("law" in law for law in made.values()):
        assumed.append('meshes: their law is "iso", ISO 6336-1 method B')
        assumed += _not_of_steel(of)
    return made


def stages_of(of: Gearing, meshes: Data) -> Data:
    """Return the stages: the meshes of each gear that drives, or is driven by, several others.

    Planets have none: what sun and ring take from one follows from their numbers of teeth.
    """
    planets = {of.names[planet] for planet in of.carrier_of}
    made: Data = {}
    for side, what in ((0, "from"), (1, "to")):
        ends = Counter(name.split("-")[side] for name in meshes)
        for gear, count in ends.items():
            if count > 1 and gear not in planets:
                branches = [name for name in meshes if name.split("-")[side] == gear]
                made[f"{what}_{gear}"] = {"meshes": branches}
    return made


def first_number(components: list[Component], *names: str) -> float | None:
    """Return the first of some numbers, from the first of some components that gives any."""
    found = (component.number(*names) for component in components)
    return next((value for value in found if value is not None), None)


def _reached(of: Gearing, first: str, links: Links) -> dict[str, int]:
    """Return the number of steps from the input to every body, as seen from carriers.

    Seen from there, the torque of a carrier comes from, or goes to, the held gear of its set: a
    driven carrier turns its planets on it. No step goes from one held gear to another.
    """
    names = of.names
    pairs = [(names[a.id], names[b.id]) for _, a, b in of.stages]
    shafts = [(one, other) for one, other in (name.split("-") for name in links.shafts)]
    held = set(links.held)
    while more := {end for pair in shafts if held & set(pair) for end in pair} - held:
        held |= more
    for carrier in of.carriers:
        planets = {names[p] for p, c in of.carrier_of.items() if c is carrier}
        meet = {end for pair in pairs if planets & set(pair) for end in pair}
        pairs += [(names[carrier.id], end) for end in sorted(meet & held or planets)]
    pairs += [pair for pair in shafts if not held & set(pair)]
    steps, queue = {first: 0}, deque([first])
    while queue:
        here = queue.popleft()
        for pair in pairs:
            if here in pair:
                other = pair[1] if here == pair[0] else pair[0]
                if other not in steps:
                    steps[other] = steps[here] + 1
                    queue.append(other)
    return {name: steps.get(name, len(names)) for name in names.values()}


def _law(of: Gearing, stage: Component, driver: Component, driven: Component) -> Data:
    density = stage.number("mesh_stiffness_for_load_distribution_along_face_width")
    width = stage.number("common_face_width") or _narrower(driver, driven)
    angle = first_number([*of.flanks(driver), driver], "normal_pressure_angle")
    radius = _base_radius(driver, angle or math.radians(20.0))
    if density and width and radius:
        return {"stiffness": f"{density * width * radius**2:.12g} N*m/rad"}
    return {"law": "iso"}


def _narrower(one: Component, other: Component) -> float:
    """Return the width of the narrower of two faces [m]; 0 where a file does not give both."""
    return min(one.number("face_width") or 0.0, other.number("face_width") or 0.0)


def _width_assumed(
    name: str, law: Data, stage: Component, driver: Component, driven: Component
) -> list[str]:
    """Return what is assumed about the width over which a mesh carries load."""
    given, narrower = stage.number("common_face_width"), _narrower(driver, driven)
    if "stiffness" in law and not given:
        return [f"mesh {name}: carries load over all of the narrower face, {1e3 * narrower:g} mm"]
    if "law" in law and given and abs(given - narrower) > ALIKE * given:
        return [
            f"mesh {name}: carries load where its faces overlap, not over the common_face_width of "
            f"{1e3 * given:g} mm"
        ]
    return []


def _distance_assumed(
    of: Gearing, name: str, stage: Component, driver: Component, driven: Component
) -> list[str]:
    """Say if a stage gives a centre distance other than that of the places of its gears."""
    given, places = stage.number("center_distance"), (of.middle(driver), of.middle(driven))
    if given is None or None in places:
        return []
    apart, axis = minus(*filter(None, places)), of.axis(driver)
    found = math.dist(apart, tuple(dot(apart, axis) * a for a in axis))
    if abs(abs(given) - found) <= ALIKE * found:
        return []
    return [
        f"mesh {name}: the axes of its gears are {1e3 * found:.6g} mm apart, not the "
        f"center_distance of {1e3 * given:g} mm"
    ]


def _not_of_steel(of: Gearing) -> list[str]:
    """Return remarks on gears that are not of steel, for which the law "iso" is."""
    found = []
    for gear in of.gears:
        material = material_of(of.model, gear)
        young = material.number("elastic_modulus") if material is not None else None
        if young is not None and abs(young / YOUNG - 1.0) > LIKE_STEEL:
            found.append(f"{of.names[gear.id]}: treated as steel, not with E = {young / 1e9:g} GPa")
    return found


def _base_radius(gear: Component, angle: float) -> float | None:
    """Return the base radius that follows from a gear's teeth [m]."""
    teeth, module = gear.number("number_of_teeth"), gear.number("normal_module")
    helix = gear.number("helix_angle_reference_diameter") or 0.0
    if not teeth or not module or abs(helix) >= 0.5 * math.pi:
        return None
    transverse = math.atan(math.tan(angle) / math.cos(helix))
    return abs(teeth) * module / (2.0 * math.cos(helix)) * math.cos(transverse)
