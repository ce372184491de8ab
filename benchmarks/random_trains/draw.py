"""Random trains: a structure with random laws, supports, limits, errors and loads.

Source: formulation, sections 1 to 7. Sizes are drawn where they change the answer: clearances of
zero, of a deflection and far beyond; loads from a millionth of the rated load to ten times it;
stiffnesses up to nine decades apart; clearances that end exactly where friction does.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from benchmarks.random_trains.dice import Dice, metres, radians
from benchmarks.random_trains.layouts import LAYOUTS, Layout
from loadshare.case import Case
from loadshare.errors import CaseError

RATED = 1e4
"""Approximate force on a flank under the rated load [N]."""
FLANK = 3e8
"""Approximate stiffness of a flank along its line of action [N/m]."""
DEFLECTION = RATED / FLANK
"""Compression of a flank under the rated load [m]."""
BACKLASHES = (0.0, 1e-6, 2e-5, 5e-5, 1e-4, 3e-4)
"""Backlashes [m], up to 0.3 mm."""
TRIES = 50
"""Number of structures drawn until one fits; a bent chain may leave no room for its last gear."""


def draw(seed: int, number: int, layouts: Mapping[str, Callable[[Dice], Layout]] = LAYOUTS) -> Case:
    """Return a random train.

    Parameters
    ----------
    seed, number : int
        With the layouts, they alone determine the train.
    layouts : mapping of str to callable
        Structures to draw from.
    """
    dice = Dice(seed, number)
    for _ in range(TRIES):
        name = dice.pick(tuple(layouts))
        layout = layouts[name](dice)
        if dice.chance(0.15):
            layout = layout.reversed()
        try:
            return Case(_Drawing(dice, layout).data, name=f"{name} {seed}-{number}")
        except CaseError:
            continue
    raise RuntimeError(f"train {number} of seed {seed}: no structure fits")


class _Drawing:
    """One train while it is drawn; `data` is the content of its case file."""

    def __init__(self, dice: Dice, layout: Layout) -> None:
        self.dice, self.layout = dice, layout
        self.positions = dice.pick([1, 1, 1, 1, 1, 2, 3, 5])
        self.range = dice.pick([0.0, 0.5, 0.5, 1.0, 1.0, 3.0, 4.5])
        self.offsets = DEFLECTION * dice.pick([0.0, 0.1, 1.0, 1.0, 3.0])
        self.data: dict[str, Any] = {
            "title": "random train",
            "operating": self._operating(),
            "gears": {n: dict(g) for n, g in layout.gears.items()},
            "meshes": self._meshes(),
            "shafts": {f"{a}-{b}": self._shaft() for a, b in layout.shafts},
        }
        for section, make in (("splines", self._splines), ("rings", self._rings)):
            if made := make():
                self.data[section] = made
        self._supports()
        if errors := self._errors():
            self.data["errors"] = errors
        if any(gear.get("carrier") for gear in layout.gears.values()):
            self._loosely_held()

    def _loosely_held(self) -> None:
        """Put members of a set in bearings with clearance of any law, and apply forces to them."""
        dice, data = self.dice, self.data
        other = {**data.get("splines", {}), **data.get("rings", {})}
        held = dice.some(tuple(data["gears"]), dice.pick([0.0, 0.0, 0.2, 0.5]))
        bearings = {gear: self._rolling() for gear in held if gear not in other}
        for gear in bearings:
            data["gears"][gear].pop("support", None)
        if bearings:
            data["bearings"] = bearings
        pushed = dice.some(tuple(data["gears"]), dice.pick([0.0, 0.0, 0.0, 0.4]))
        if pushed:
            largest = RATED * self.load * dice.pick([0.01, 0.1, 1.0])
            parts = {g: [dice.between(-largest, largest) for _ in "xy"] for g in pushed}
            data["operating"]["forces"] = {g: [f"{p!r} N" for p in f] for g, f in parts.items()}

    def _rolling(self) -> dict[str, Any]:
        """Return a ball bearing, a roller bearing, or a linear bearing."""
        dice = self.dice
        name, power = dice.pick([("ball_", 1.5), ("roller_", 10.0 / 9.0), ("", 1.0)])
        stiffness = RATED / DEFLECTION**power * dice.spread(1.0)
        unit = {1.5: "N/m^1.5", 1.0: "N/m"}.get(power, "N/m^(10/9)")
        bearing: dict[str, Any] = {
            "clearance": self._play(), f"{name}stiffness": f"{stiffness!r} {unit}"
        }  # fmt: skip
        if dice.chance(0.3):
            offset = 0.3 * DEFLECTION
            bearing["offset"] = [metres(dice.between(-offset, offset)) for _ in "xy"]
        return bearing

    def _spread(self) -> float:
        """Return a factor on a stiffness; the range of a train is zero, a decade, six or nine."""
        if self.range > 1.0 and self.dice.chance(0.7):
            return self.dice.spread(0.3)
        return self.dice.spread(self.range)

    def _operating(self) -> dict[str, Any]:
        dice, layout = self.dice, self.layout
        branches = sum(layout.input in ends for ends in layout.meshes)
        rated = RATED * layout.radius[layout.input] * max(branches, 1)
        self.load = dice.pick([1.0, 1.0, dice.spread(1.0), 10.0 ** dice.between(-6.0, 1.0)])
        torque = rated * self.load
        operating = {
            "input": layout.input,
            "output": layout.output,
            "running": dice.pick(["counter-clockwise", "clockwise"]),
            "torque": f"{torque!r} N*m",
            "positions": self.positions,
        }
        if dice.chance(0.1):
            # The train is driven from its output, so the coast flanks carry.
            operating |= {
                "torque": "0 N*m",
                "external": {layout.input: f"{-torque!r} N*m"},
            }
        elif dice.chance(0.08):
            held = [name for name, gear in layout.gears.items() if gear.get("held")]
            ends = (layout.input, layout.output, *held)
            gear = dice.pick([g for g in layout.gears if g not in ends])
            share = dice.between(-0.5, 0.5) * RATED * self.load * layout.radius[gear]
            operating["external"] = {gear: f"{share!r} N*m"}
        self.turned_back = operating["torque"] == "0 N*m"
        return operating

    def _each(self, draw: Callable[[], str]) -> str | list[str]:
        """Return one drawn value, or one per position."""
        if self.positions > 1 and self.dice.chance(0.5):
            return [draw() for _ in range(self.positions)]
        return draw()

    def _meshes(self) -> dict[str, dict[str, Any]]:
        dice = self.dice
        kind = dice.pick(["stiffness", "law", "table", "Hertz", "mixed", "mixed"])
        play = dice.pick(["none", "none", "some", "all", "all alike"])
        alike = dice.pick(BACKLASHES)
        made = {}
        for (driver, driven), angle in self.layout.meshes.items():
            mesh: dict[str, Any] = {"pressure_angle": radians(angle)}
            mesh |= self._law(kind, self.layout.radius[driver])
            if dice.chance(0.15) and "a" not in mesh.get("law", {}):
                widest = 3.0 * DEFLECTION / self.layout.radius[driver]
                mesh["gap"] = self._each(partial(self._gap, widest))
            if self.turned_back or play.startswith("all") or (play == "some" and dice.chance(0.4)):
                key = dice.pick(["backlash", "normal_backlash"])
                mesh[key] = metres(alike if play == "all alike" else dice.pick(BACKLASHES))
            made[f"{driver}-{driven}"] = mesh
        return made

    def _gap(self, widest: float) -> str:
        return radians(self.dice.between(0.0, widest))

    def _law(self, kind: str, radius: float) -> dict[str, Any]:
        """Return a random law of a mesh at its driver."""
        dice, stiffness = self.dice, FLANK * radius**2 * self._spread()
        rated = RATED * radius
        if kind == "mixed":
            kind = dice.pick(["stiffness", "law", "table", "Hertz"])
        if kind == "stiffness":
            return {kind: self._each(lambda: f"{stiffness * dice.between(0.9, 1.1)!r} N*m/rad")}
        if kind == "table":
            bend = rated / stiffness
            return {
                "table": {
                    "torque": [f"{p * rated!r} N*m" for p in (0.1, 0.5, 1.0)],
                    "deflection": [radians(p * bend) for p in (0.2, 0.7, 1.0)],
                }
            }
        part = 1.0 if kind == "Hertz" else dice.pick([0.01, 0.3, 0.3])
        unit = "rad/(N*m)"
        hertz = part * rated ** (1.0 / 3.0) / stiffness
        law: dict[str, Any] = {
            "c": self._each(lambda: f"{hertz * dice.between(0.9, 1.1)!r} {unit}^(2/3)")
        }
        if kind == "law":
            bend = (1.0 - part) / stiffness
            law["b"] = self._each(lambda: f"{bend * dice.between(0.9, 1.1)!r} {unit}")
            if dice.chance(0.2):
                widest = DEFLECTION / radius
                law["a"] = self._each(lambda: radians(dice.between(0.0, widest)))
        return {"law": law}

    def _shaft(self) -> dict[str, Any]:
        dice = self.dice
        stiffness = f"{5e5 * self._spread()!r} N*m/rad"
        shaft: dict[str, Any] = {"stiffness": "rigid" if dice.chance(0.25) else stiffness}
        if dice.chance(0.35):
            shaft["clocking"] = radians(1e-3 * dice.between(-1.0, 1.0) * dice.pick([0.1, 1.0]))
        return shaft

    def _splines(self) -> dict[str, dict[str, Any]]:
        part = self.dice.pick([0.0, 0.0, 0.3, 0.6])
        return {g: self._spline() for g in self.dice.some(tuple(self.layout.floats), part)}

    def _spline(self) -> dict[str, Any]:
        """Return a clearance spline; often the ends of its stages coincide."""
        dice, stiffness = self.dice, 2e7 * self._spread()
        clearance = DEFLECTION * dice.pick([0.0, 0.1, 1.0, 3.0, 10.0])
        spline = {"bending_stiffness": f"{stiffness!r} N/m", "clearance": metres(clearance)}
        kind = dice.pick(
            ["continuous", "jump", "no friction", "torque", "normal force", "no clearance", "met"]
        )
        stick = dice.pick([0.01, 0.1, 0.5, 0.9]) * max(clearance, 0.1 * DEFLECTION)
        bound = stiffness * stick
        if kind == "no friction":
            return spline | {"friction_force": "0 N"}
        if kind == "torque":
            friction = dice.pick([0.002, 0.02, 0.1])
            return spline | {"friction": friction, "radius": metres(dice.between(0.02, 0.06))}
        if kind == "normal force":
            return spline | {"friction": 0.1, "normal_force": f"{10.0 * bound!r} N"}
        if kind == "jump":
            end = min(stick, clearance)
            bound = stiffness * end * dice.pick([1.0, 1.5, 3.0]) + dice.pick([0.0, 10.0])
            return spline | {"stick_limit": metres(end), "friction_force": f"{bound!r} N"}
        if kind == "no clearance":
            return spline | {
                "clearance": "0 m", "stick_limit": "0 m", "friction_force": f"{bound!r} N"
            }  # fmt: skip
        if kind == "met":
            end = bound / stiffness * (1.0 + dice.pick([0.0, 0.0, 1e-12, 1e-7]))
            return spline | {"clearance": metres(end), "friction_force": f"{bound!r} N"}
        return spline | {"friction_force": f"{bound!r} N"}

    def _rings(self) -> dict[str, dict[str, Any]]:
        dice, part = self.dice, self.dice.pick([0.0, 0.0, 0.3, 0.6])
        made = {}
        for gear in dice.some(tuple(self.layout.floats), part):
            between = self.layout.floats[gear]
            if between is not None and dice.chance(0.7):
                made[gear] = self._drum(between)
            else:
                made[gear] = self._circle()
            if dice.chance(0.4):
                made[gear]["stiffness"] = f"{1e9 * self._spread()!r} N/m"
        return made

    def _play(self) -> str:
        return metres(DEFLECTION * self.dice.pick([0.0, 0.0, 0.1, 1.0, 3.0]))

    def _drum(self, between: tuple[str, str]) -> dict[str, Any]:
        dice = self.dice
        drum: dict[str, Any] = {"neighbours": list(dice.pick([between, between[::-1]]))}
        drum["clearance"] = self._play()
        drum["float"] = dice.pick([{"up": self._play(), "down": self._play()}, self._play()])
        if dice.chance(0.2):
            drum["measured"] = "nominal"
        return drum

    def _circle(self) -> dict[str, Any]:
        circle: dict[str, Any] = {"radius": self._play()}
        if self.dice.chance(0.4):
            offset = 0.3 * DEFLECTION
            circle["offset"] = [metres(self.dice.between(-offset, offset)) for _ in "xy"]
        return circle

    def _supports(self) -> None:
        """Draw bearings: rigid, elastic (equal or different in two directions), or none."""
        dice, data = self.dice, self.data
        part = dice.pick([0.0, 0.2, 0.5, 1.0])
        for name, gear in data["gears"].items():
            held = name in data.get("splines", {}) or name in data.get("rings", {})
            if held:
                if dice.chance(0.3):
                    gear["support"] = self._bearing()
            elif name == "sun" or (self.layout.floats.get(name)):
                # A float may be held by its meshes only, or not at all.
                kind = dice.pick(["rigid", "free", "elastic"])
                gear["support"] = self._bearing() if kind == "elastic" else kind
            elif dice.chance(0.6 * part):
                gear["support"] = self._bearing()
            elif name in self.layout.floats and dice.chance(0.03):
                gear["support"] = "free"

    def _bearing(self) -> str | list[str]:
        stiffness = [f"{5e8 * self.dice.pick([0.02, 1.0]) * self._spread()!r} N/m" for _ in "xy"]
        return stiffness if self.dice.chance(0.3) else stiffness[0]

    def _errors(self) -> dict[str, dict[str, Any]]:
        dice = self.dice
        chosen = dice.some(tuple(self.layout.gears), dice.pick([0.0, 0.3, 0.8]))
        return {g: self._error() for g in chosen} if self.offsets else {}

    def _error(self) -> dict[str, Any]:
        dice, error = self.dice, {}
        kind = dice.pick(["installation", "eccentricity", "both"])
        if kind != "eccentricity":
            size, way = self.offsets * dice.between(0.0, 1.0), dice.angle()
            parts = [metres(size * math.cos(way)), metres(size * math.sin(way))]
            polar = {"amount": metres(size), "direction": radians(way)}
            error["installation"] = dice.pick([parts, polar])
        if kind != "installation":
            size = self.offsets * dice.between(0.0, 1.0)
            error["eccentricity"] = {"amount": metres(size), "direction": radians(dice.angle())}
            self._count_teeth()
        return error

    def _count_teeth(self) -> None:
        """Give the input gear teeth, which define how far gears turn over the mesh cycle."""
        if self.positions > 1:
            gears = self.data["gears"]
            toothed = (n for n in (self.layout.input, *gears) if "base_radius" in gears[n])
            gears[next(toothed)]["teeth"] = 23
