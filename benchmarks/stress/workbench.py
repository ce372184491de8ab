"""A case under construction: shorthand for the changes that the families make, in SI units."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from benchmarks import families
from loadshare.case import Case

Number = float | int


def written(value: Number, unit: str) -> str:
    """Return a value with its unit and all digits."""
    return f"{float(value)!r} {unit}"


class Workbench:
    """A case that is still being changed. Lengths in m, angles in rad, everything in SI.

    Parameters
    ----------
    case : Case
        Case to start from.
    """

    def __init__(self, case: Case) -> None:
        self.data: dict[str, Any] = case.to_dict()
        for key in ("assumed", "title", "source", "notes"):
            self.data.pop(key, None)
        self.centres = case.centres()
        if "power" in self.data["operating"]:
            self.torque(case.operating.input_torque[0])

    def case(self, name: str) -> Case:
        """Return the case, checked."""
        return Case(self.data, name=name)

    @property
    def gears(self) -> list[str]:
        """Names of the gears."""
        return list(self.data["gears"])

    @property
    def meshes(self) -> list[str]:
        """Names of the meshes."""
        return list(self.data["meshes"])

    @property
    def rated(self) -> float:
        """Input torque [N·m] that the case has now."""
        return float(self.data["operating"]["torque"].split()[0])

    def named(self, start: str) -> list[str]:
        """Return the gears whose names begin with `start`."""
        return [g for g in self.gears if g.startswith(start)]

    def torque(self, value: Number) -> None:
        """Set the input torque [N·m]."""
        operating = self.data["operating"]
        for key in ("power", "speed"):
            operating.pop(key, None)
        operating["torque"] = written(value, "N*m")

    def _mesh(self, mesh: str) -> dict[str, Any]:
        table: dict[str, Any] = self.data["meshes"][mesh]
        return table

    def stiffness(self, mesh: str, value: Number) -> None:
        """Give a mesh a constant stiffness [N·m/rad]."""
        self._lawless(mesh)["stiffness"] = written(value, "N*m/rad")

    def law(self, mesh: str, b: Number, c: Number) -> None:
        """Give a mesh the law bT + cT^(2/3) [rad/(N·m)], [rad/(N·m)^(2/3)]."""
        unit = "rad/(N*m)"
        self._lawless(mesh)["law"] = {"b": written(b, unit), "c": written(c, f"{unit}^(2/3)")}

    def hertz(self, share: Number = 0.3, meshes: Iterable[str] = ()) -> None:
        """Turn constant stiffnesses into b + c laws with the same deflection at the rated torque.

        Parameters
        ----------
        share : float
            Fraction of the deflection that is Hertz contact.
        meshes : iterable of str
            All by default.
        """
        for name in list(meshes) or self.meshes:
            stiffness = float(self._mesh(name)["stiffness"].split()[0])
            rated = 1e-3 * stiffness
            self.law(name, (1.0 - share) / stiffness, share * rated ** (1.0 / 3.0) / stiffness)

    def _lawless(self, mesh: str) -> dict[str, Any]:
        table = self._mesh(mesh)
        for key in ("stiffness", "law", "table"):
            table.pop(key, None)
        return table

    def gap(self, mesh: str, value: Number) -> None:
        """Open a mesh by an angle [rad] at the driver; a negative one closes it."""
        self._mesh(mesh)["gap"] = written(value, "rad")

    def backlash(self, value: Number, meshes: Iterable[str] = ()) -> None:
        """Give meshes (all by default) a normal backlash [m]."""
        for name in list(meshes) or self.meshes:
            self._mesh(name).pop("backlash", None)
            self._mesh(name)["normal_backlash"] = written(value, "m")

    def shafts(self, change: Callable[[str], Number | str]) -> None:
        """Give every shaft the stiffness [N·m/rad], or "rigid", that `change` returns for it."""
        for name, shaft in self.data.get("shafts", {}).items():
            value = change(name)
            shaft["stiffness"] = value if isinstance(value, str) else written(value, "N*m/rad")

    def support(self, gear: str, value: Number | str) -> None:
        """Hold a gear by a stiffness [N/m], or "rigid" or "free"."""
        held = value if isinstance(value, str) else written(value, "N/m")
        self.data["gears"][gear]["support"] = held

    def spline(
        self,
        gear: str,
        stiffness: Number,
        clearance: Number,
        friction: Number,
        stick: Number | None = None,
    ) -> None:
        """Hold a gear by a spline: K_w [N/m], S2 [m], F_m [N] and S1 [m]."""
        self.data["gears"][gear].pop("support", None)
        spline = {
            "bending_stiffness": written(stiffness, "N/m"),
            "clearance": written(clearance, "m"),
            "friction_force": written(friction, "N"),
        }
        if stick is not None:
            spline["stick_limit"] = written(stick, "m")
        self.data.setdefault("splines", {})[gear] = spline

    def spline_by_torque(
        self, gear: str, stiffness: Number, clearance: Number, friction: Number, radius: Number
    ) -> None:
        """Hold a gear by a spline whose friction follows the torque: coefficient and radius [m]."""
        self.data["gears"][gear].pop("support", None)
        self.data.setdefault("splines", {})[gear] = {
            "bending_stiffness": written(stiffness, "N/m"),
            "clearance": written(clearance, "m"),
            "friction": float(friction),
            "radius": written(radius, "m"),
        }

    def drum(
        self,
        gear: str,
        neighbours: tuple[str, str],
        clearance: Number,
        up: Number,
        down: Number,
        stiffness: Number | str = "rigid",
    ) -> None:
        """Limit a gear by a drum between two neighbours: clearance and float [m]."""
        wall = stiffness if isinstance(stiffness, str) else written(stiffness, "N/m")
        self.data.setdefault("rings", {})[gear] = {
            "neighbours": list(neighbours),
            "clearance": written(clearance, "m"),
            "float": {"up": written(up, "m"), "down": written(down, "m")},
            "stiffness": wall,
        }

    def circle(
        self,
        gear: str,
        radius: Number,
        offset: tuple[Number, Number] = (0.0, 0.0),
        stiffness: Number | str = "rigid",
    ) -> None:
        """Limit a gear by a round ring [m]."""
        wall = stiffness if isinstance(stiffness, str) else written(stiffness, "N/m")
        self.data.setdefault("rings", {})[gear] = {
            "radius": written(radius, "m"),
            "offset": [written(v, "m") for v in offset],
            "stiffness": wall,
        }

    def installation(self, gear: str, amount: Number, direction: Number) -> None:
        """Displace a gear by an installation error [m] in a direction [rad]."""
        self.data.setdefault("errors", {})[gear] = {
            "installation": {
                "amount": written(amount, "m"),
                "direction": written(direction, "rad"),
            }
        }

    def direction(self, first: str, second: str) -> float:
        """Return the direction [rad] from one gear's centre to another's, as first placed."""
        along = np.subtract(self.centres[second], self.centres[first])
        return math.atan2(along[1], along[0])

    def place(self, planet: str, angle: Number) -> None:
        """Move a planet of a star to an angle [rad] around the sun."""
        self.data["gears"][planet]["centre"]["angle"] = written(angle, "rad")

    def scale(self, size: Number, material: Number) -> None:
        """Scale all lengths by `size`, and stiffness and load also by `material`.

        Stresses and angles do not change: torques and angular stiffnesses grow with the cube of the
        size, forces with its square, linear stiffnesses with the size itself.
        """
        length = float(size)
        factors = {
            "mm": length,
            "m": length,
            "N/m": length * material,
            "N": length**2 * material,
            "N*m": length**3 * material,
            "N*m/rad": length**3 * material,
            "rad/(N*m)": 1.0 / (length**3 * material),
            "rad/(N*m)^(2/3)": 1.0 / (length**2 * material ** (2.0 / 3.0)),
        }

        def scaled(value: Any) -> Any:
            if isinstance(value, dict):
                return {key: scaled(inner) for key, inner in value.items()}
            if isinstance(value, list):
                return [scaled(inner) for inner in value]
            number, _, unit = value.partition(" ") if isinstance(value, str) else ("", "", "")
            return written(float(number) * factors[unit], unit) if unit in factors else value

        self.data = {key: scaled(value) for key, value in self.data.items()}

    def random_errors(
        self, amount: Number, generator: np.random.Generator, gears: Iterable[str] = ()
    ) -> None:
        """Displace gears (all by default) by half to all of `amount` [m], in random directions."""
        for gear in list(gears) or self.gears:
            size = amount * generator.uniform(0.5, 1.0)
            self.installation(gear, size, generator.uniform(0.0, 2.0 * np.pi))


def split_torque(branches: int) -> Workbench:
    """Return a split-torque train; its deflection is about 20 µm.

    The generator of cases writes nanometres. Here pinions are exactly on the line between their
    idlers, and face gears exactly square to each other; otherwise free pinions would be out of
    balance by 1e-9.
    """
    bench = Workbench(families.split_torque(branches))
    for gear, table in bench.data["gears"].items():
        if gear.startswith("pinion"):
            middle = np.mean([bench.centres[idler] for idler in pair_of(gear)], axis=0)
            table["centre"] = [written(v, "m") for v in middle]
        elif gear.startswith("face"):
            turn = 2.0 * math.pi * (int(gear.removeprefix("face")) - 1) / (branches // 2)
            table["axis"] = [math.cos(turn), math.sin(turn), 0.0]
    return bench


def star(planets: int, sun: str = "free") -> Workbench:
    """Return a star without its gap; its deflection is about 7 µm."""
    bench = Workbench(families.star(planets))
    for mesh in bench.data["meshes"].values():
        mesh.pop("gap", None)
    bench.support("sun", sun)
    return bench


def two_path() -> Workbench:
    """Return a split-path box without clocking."""
    return Workbench(families.two_path("0 rad"))


def pair_of(pinion: str) -> tuple[str, str]:
    """Return the idlers of a pinion of a split-torque train, which are a drum's neighbours."""
    number = pinion.removeprefix("pinion")
    return f"idler{number}b", f"idler{number}a"


DEFLECTION = 20e-6
"""Approximate deflection of the generated trains under their rated load [m]."""
SUPPORT = 5.5e8
"""Bearing stiffness of the seed [N/m]."""
BENDING = 1.78e7
"""Bending stiffness of the seed's spline shafts [N/m]."""
