"""Drives written once for two purposes: as a case, and as rigid bodies in contact."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from tests.physics.rigid_bodies import Machine

import loadshare as ls

ANGLE = math.radians(20.0)
MODULE = 4e-3


class Drive:
    """A drive of gears by tooth numbers, all with one module and a pressure angle of 20 deg.

    Parameters
    ----------
    backlash : float or None
        Normal backlash of all meshes [m]; if None, only the pressed flank exists.
    """

    def __init__(self, backlash: float | None = None) -> None:
        self.backlash = backlash
        self.gears: dict[str, dict[str, Any]] = {}
        self.teeth: dict[str, int] = {}
        self.places: dict[str, np.ndarray] = {}
        self.meshes: dict[str, tuple[str, str, float]] = {}
        self.shafts: dict[str, tuple[str, str, float]] = {}
        self.floats: dict[str, float] = {}

    def gear(
        self, name: str, teeth: int, at: tuple[float, float] = (0.0, 0.0), **keys: Any
    ) -> None:
        """Add a gear; a negative number of teeth means an internal gear."""
        self.teeth[name], self.places[name] = teeth, np.array(at, float)
        radius = 0.5 * MODULE * abs(teeth) * math.cos(ANGLE)
        kind = {"type": "internal"} if teeth < 0 else {}
        centre = [f"{v:.17g} m" for v in at]
        self.gears[name] = {"base_radius": f"{radius:.17g} m", "centre": centre} | kind | keys

    def carrier(self, name: str, at: tuple[float, float] = (0.0, 0.0), **keys: Any) -> None:
        """Add a carrier."""
        self.places[name] = np.array(at, float)
        centre = [f"{v:.17g} m" for v in at]
        self.gears[name] = {"type": "carrier", "centre": centre} | keys

    def planets(
        self, carrier: str, teeth: dict[str, int], distance: float, count: int = 3
    ) -> list[list[str]]:
        """Add evenly spaced planets, several on every pin, and return their names by pin."""
        found = []
        for k in range(count):
            turn = 2.0 * math.pi * k / count
            at = self.places[carrier] + distance * np.array([math.cos(turn), math.sin(turn)])
            for name, number in teeth.items():
                self.gear(f"{name}{k}", number, tuple(at), carrier=carrier)
            found.append([f"{name}{k}" for name in teeth])
        return found

    def mesh(self, first: str, second: str, stiffness: float = 4e8) -> None:
        """Add a mesh with a stiffness [N/m]."""
        self.meshes[f"{first}-{second}"] = first, second, stiffness

    def shaft(self, first: str, second: str, stiffness: float = 3e6) -> None:
        """Add a shaft with a stiffness [N·m/rad]."""
        self.shafts[f"{first}-{second}"] = first, second, stiffness

    def support(self, name: str, stiffness: float) -> None:
        """Support a gear by a bearing of some stiffness [N/m]."""
        self.floats[name] = stiffness
        self.gears[name]["support"] = f"{stiffness:.17g} N/m"

    def case(self, driving: str, output: str, torque: float, **operating: Any) -> ls.Case:
        """Return the drive as a case."""
        meshes: dict[str, Any] = {}
        for name, (first, _, stiffness) in self.meshes.items():
            radius = 0.5 * MODULE * abs(self.teeth[first]) * math.cos(ANGLE)
            meshes[name] = {"stiffness": f"{stiffness * radius**2:.17g} N*m/rad"}
            if self.backlash is not None:
                meshes[name]["normal_backlash"] = f"{self.backlash:.17g} m"
        return ls.Case(
            operating={"input": driving, "output": output, "torque": f"{torque:.17g} N*m"}
            | operating,
            gears=self.gears,
            meshes=meshes,
            shafts={n: {"stiffness": f"{k:.17g} N*m/rad"} for n, (_, _, k) in self.shafts.items()},
        )

    def machine(self, ways: dict[str, int] | None = None) -> Machine:
        """Return the drive as rigid bodies.

        Parameters
        ----------
        ways : dict of mesh to int, optional
            1 if the flank with which the first gear pushes counter-clockwise touches at rest, −1 if
            the other one does; otherwise both do.
        """
        rides = {n: g["carrier"] for n, g in self.gears.items() if g.get("carrier")}
        made = Machine(self.places, rides, self.floats)
        for name, (first, second, stiffness) in self.meshes.items():
            reach = 0.5 * MODULE * abs(self.teeth[first])
            ring = next((n for n in (first, second) if self.teeth[n] < 0), None)
            play = math.inf if self.backlash is None else self.backlash
            # A large play instead of an infinite one, which would be multiplied by zero.
            play = min(play, 1.0)
            plays = {None: (0.0, 0.0), 1: (0.0, play), -1: (play, 0.0)}[(ways or {}).get(name)]
            made.mesh(name, first, second, ring, reach, ANGLE, stiffness, plays)
        for first, second, stiffness in self.shafts.values():
            made.shaft(first, second, stiffness)
        return made
