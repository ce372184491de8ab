"""Structures of random trains: which gears mesh, their positions, and which of them may float.

Every structure fits: base radii, pressure angles and centre distances are consistent, and all paths
turn a gear in the same sense.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from benchmarks.random_trains.dice import Dice, metres

COLLINEAR = 0.4
"""Fraction of the split pinions that are on the line of their idlers, so that lines of action
align."""


@dataclass
class Layout:
    """A structure without stiffnesses, supports or loads.

    Attributes
    ----------
    gears : dict
        By name, as they are written in a case.
    radius : dict of gear to float
        Base radius [m].
    meshes : dict of (driver, driven) to float
        Pressure angle [rad].
    shafts : list of (str, str)
    input, output : str
    floats : dict of gear to (str, str) or None
        Gears that may float, and the neighbours between which a drum may hold them.
    """

    gears: dict[str, dict[str, Any]] = field(default_factory=dict)
    radius: dict[str, float] = field(default_factory=dict)
    meshes: dict[tuple[str, str], float] = field(default_factory=dict)
    shafts: list[tuple[str, str]] = field(default_factory=list)
    input: str = ""
    output: str = ""
    floats: dict[str, tuple[str, str] | None] = field(default_factory=dict)

    def gear(
        self, name: str, radius: float, place: complex, height: float = 0.0, **more: Any
    ) -> None:
        """Add a gear; its place is x + iy [m]."""
        centre = [metres(place.real), metres(place.imag)] + ([metres(height)] if height else [])
        self.gears[name] = {"centre": centre, "base_radius": metres(radius), **more}
        self.radius[name] = radius

    def reversed(self) -> Layout:
        """Return the same train, driven from its other end."""
        meshes = {(b, a): angle for (a, b), angle in self.meshes.items()}
        return Layout(
            self.gears, self.radius, meshes, self.shafts, self.output, self.input, self.floats
        )


def polar(distance: float, angle: float) -> complex:
    """Return a place from distance [m] and angle [rad]."""
    return complex(distance * math.cos(angle), distance * math.sin(angle))


def angles(dice: Dice, count: int) -> list[float]:
    """Return directions of branches: even, even in pairs, or uneven."""
    first = dice.pick([0.0, dice.angle()])
    kind = dice.pick(["even", "even", "pairs", "uneven"])
    step = math.tau / count
    if kind == "even":
        return [first + k * step for k in range(count)]
    if kind == "pairs" and count % 2 == 0:
        turned = [dice.between(-0.1, 0.1) * step for _ in range(count // 2)]
        half = [first + k * step + t for k, t in enumerate(turned)]
        return half + [a + math.pi for a in half]
    return [first + k * step + dice.between(-0.2, 0.2) * step for k in range(count)]


def pressure(dice: Dice) -> float:
    """Return a transverse working pressure angle [rad]."""
    return math.radians(dice.pick([20.0, 18.75, 25.0, dice.between(14.0, 28.0)]))


def star(dice: Dice) -> Layout:
    """Return a sun, planets on fixed axes, and an internal gear."""
    layout, count, angle = Layout(), dice.count(2, 6), pressure(dice)
    sun, planet = dice.between(0.03, 0.09), dice.between(0.02, 0.07)
    reach = (sun + planet) / math.cos(angle)
    layout.gear("sun", sun, 0j)
    layout.gear("ring", sun + 2.0 * planet, 0j, type="internal")
    layout.input, layout.output = "sun", "ring"
    names = [f"p{k}" for k in range(1, count + 1)]
    for name, way in zip(names, angles(dice, count), strict=True):
        layout.gear(name, planet, polar(reach, way))
        layout.meshes["sun", name] = angle
        layout.meshes[name, "ring"] = angle
        layout.floats[name] = None
    layout.floats["sun"] = (names[0], names[count // 2])
    return layout


def stepped_star(dice: Dice) -> Layout:
    """Return a sun, stepped planets (two gears on a shaft), and an internal or external output."""
    layout, count, angle = Layout(), dice.count(2, 5), pressure(dice)
    sun, wheel, pinion = (
        dice.between(0.04, 0.08),
        dice.between(0.06, 0.15),
        dice.between(0.02, 0.05),
    )
    reach = (sun + wheel) / math.cos(angle)
    layout.gear("sun", sun, 0j)
    inside = dice.chance(0.7)
    if inside:
        layout.gear("out", reach * math.cos(angle) + pinion, 0j, type="internal")
    else:
        layout.gear("out", reach * math.cos(angle) - pinion, 0j)
    layout.input, layout.output = "sun", "out"
    for k, way in enumerate(angles(dice, count), start=1):
        layout.gear(f"w{k}", wheel, polar(reach, way))
        layout.gear(f"q{k}", pinion, polar(reach, way))
        layout.meshes["sun", f"w{k}"] = angle
        layout.meshes[f"q{k}", "out"] = angle
        layout.shafts.append((f"w{k}", f"q{k}"))
        layout.floats |= {f"w{k}": None, f"q{k}": None}
    layout.floats["sun"] = ("w1", f"w{1 + count // 2}")
    return layout


def double_star(dice: Dice) -> Layout:
    """Return a sun, inner and outer planets that mesh with one another, and an internal gear."""
    layout, count, angle = Layout(), dice.count(2, 5), pressure(dice)
    sun, inner, outer = dice.between(0.04, 0.09), dice.between(0.02, 0.04), dice.between(0.02, 0.04)
    first, second = (sun + inner) / math.cos(angle), (inner + outer) / math.cos(angle)
    bent = dice.between(0.2, 1.2)
    layout.gear("sun", sun, 0j)
    layout.input, layout.output = "sun", "ring"
    for k, way in enumerate(angles(dice, count), start=1):
        place = polar(first, way)
        beyond = place + polar(second, way + bent)
        layout.gear(f"p{k}", inner, place)
        layout.gear(f"r{k}", outer, beyond)
        layout.meshes["sun", f"p{k}"] = angle
        layout.meshes[f"p{k}", f"r{k}"] = angle
        layout.meshes[f"r{k}", "ring"] = angle
        layout.floats |= {f"p{k}": None, f"r{k}": None}
        reach = abs(beyond)
    layout.gear("ring", reach * math.cos(angle) + outer, 0j, type="internal")
    layout.floats["sun"] = ("p1", f"p{1 + count // 2}")
    return layout


def split_path(dice: Dice) -> Layout:
    """Return a pinion that drives two wheels, equal or nearly so, whose pinions drive one gear."""
    layout, one, two = Layout(), pressure(dice), pressure(dice)
    pinion, wheel = dice.between(0.02, 0.05), dice.between(0.06, 0.12)
    small, way = dice.between(0.02, 0.05), dice.between(0.4, 1.3)
    first = (pinion + wheel) / math.cos(one)
    axis = complex(first * dice.between(1.5, 3.0), 0.0)
    bull = abs(polar(first, way) - axis) * math.cos(two) - small
    layout.gear("in", pinion, 0j)
    layout.gear("out", bull, axis, 0.1)
    layout.input, layout.output = "in", "out"
    uneven = dice.pick([0.0, dice.between(-0.05, 0.0)])
    for k, turn in (1, way), (2, -way + uneven):
        place = polar(first, turn)
        layout.gear(f"w{k}", wheel, place)
        layout.gear(f"q{k}", small, place, 0.1)
        layout.meshes["in", f"w{k}"] = one
        layout.meshes[f"q{k}", "out"] = math.acos((small + bull) / abs(place - axis))
        layout.shafts.append((f"w{k}", f"q{k}"))
        layout.floats |= {f"w{k}": None, f"q{k}": None}
    layout.floats["in"] = ("w1", "w2")
    return layout


def four_branch(dice: Dice) -> Layout:
    """Return one to four pinions, each of which drives two idlers of the output gear.

    The pinions are driven by face gears, by wheels of one pinion, or through shafts from one gear.
    """
    layout, pairs = Layout(), dice.count(1, 4)
    angle, other = pressure(dice), pressure(dice)
    pinion, idler = dice.between(0.03, 0.06), dice.between(0.08, 0.12)
    near = (pinion + idler) / math.cos(angle)
    circle = max(dice.between(2.5, 5.0), 1.1 * pairs) * near
    out = circle * math.cos(other) - idler
    half = math.asin(near / circle)
    along = circle * math.cos(half)
    if not dice.chance(COLLINEAR):
        # With idlers closer together, the pinion is outside or inside their line.
        half *= dice.pick([dice.between(0.6, 0.95), 1.0 - 10.0 ** dice.between(-6.0, -2.0)])
        out_of_line = math.sqrt(near**2 - (circle * math.sin(half)) ** 2)
        along = circle * math.cos(half) + dice.pick([-1.0, 1.0]) * out_of_line
    layout.gear("out", out, 0j)
    layout.output = "out"
    ways = angles(dice, pairs) if pairs > 1 else [dice.angle()]
    for k, way in enumerate(ways, start=1):
        layout.gear(f"q{k}", pinion, polar(along, way))
        sides = {f"i{k}a": way - half, f"i{k}b": way + half}
        for name, there in sides.items():
            layout.gear(name, idler, polar(circle, there))
            layout.meshes[f"q{k}", name] = angle
            layout.meshes[name, "out"] = other
            layout.floats[name] = None
        layout.floats[f"q{k}"] = (f"i{k}b", f"i{k}a")
    _drive_pinions(layout, dice, ways)
    return layout


def _drive_pinions(layout: Layout, dice: Dice, ways: list[float]) -> None:
    """Add the gears that drive the pinions of a four-branch train."""
    pinions = [f"q{k}" for k in range(1, len(ways) + 1)]
    kind = dice.pick(["face", "face", "star"])
    if len(ways) == 1:
        layout.input = "q1"
        return
    layout.input = "in"
    radius, angle = dice.between(0.03, 0.06), pressure(dice)
    if kind == "star":
        wheel = dice.between(0.1, 0.2)
        reach = (radius + wheel) / math.cos(angle)
        layout.gear("in", radius, 0j, -0.5)
        for name, way in zip(pinions, ways, strict=True):
            layout.gear(f"w{name}", wheel, polar(reach, way), -0.5)
            layout.meshes["in", f"w{name}"] = angle
            layout.shafts.append((f"w{name}", name))
            layout.floats[f"w{name}"] = None
        layout.floats["in"] = None
        return
    acting = dice.between(0.15, 0.25)
    layout.gear("in", radius, 0j, -1.0)
    for name, way in zip(pinions, ways, strict=True):
        across = complex(math.cos(way), math.sin(way))
        place = across * radius / math.cos(angle)
        layout.gear(
            f"f{name}", acting, place, 2.0 * acting - 1.0, type="face",
            axis=[across.real, across.imag, 0.0],
        )  # fmt: skip
        layout.meshes["in", f"f{name}"] = angle
        layout.shafts.append((f"f{name}", name))
    layout.floats["in"] = None


def idler_chains(dice: Dice) -> Layout:
    """Return two to four parallel chains of one to three idlers between two gears on one axis."""
    layout, count, angle = Layout(), dice.count(2, 4), pressure(dice)
    middle, length = dice.between(0.05, 0.1), dice.pick([1, 2, 3])
    sizes = [dice.between(0.02, 0.06) for _ in range(length)]
    bends = [0.0] + [dice.between(-0.5, 0.5) for _ in range(length - 1)]
    layout.gear("in", middle, 0j)
    layout.input, layout.output = "in", "out"
    inside = length % 2 == 1 or dice.chance(0.5)
    for k, way in enumerate(angles(dice, count), start=1):
        place, before, size = 0j, "in", middle
        for n, (radius, bend) in enumerate(zip(sizes, bends, strict=True), start=1):
            name = f"c{k}{n}"
            place += polar((size + radius) / math.cos(angle), way + bend)
            layout.gear(name, radius, place)
            layout.meshes[before, name] = angle
            layout.floats[name] = None
            before, size = name, radius
        layout.meshes[before, "out"] = angle
    reach, last = abs(place) * math.cos(angle), sizes[-1]
    if inside:
        layout.gear("out", reach + last, 0j, type="internal")
    else:
        layout.gear("out", max(reach - last, 0.0), 0j)
    layout.floats["in"] = None
    return layout


LAYOUTS: dict[str, Callable[[Dice], Layout]] = {
    "star": star,
    "stepped star": stepped_star,
    "double star": double_star,
    "split path": split_path,
    "four branches": four_branch,
    "idler chains": idler_chains,
}
"""All structures by name."""
