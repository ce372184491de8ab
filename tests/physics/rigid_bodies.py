"""A machine of gears and carriers as rigid bodies whose points touch.

Every body has a counter-clockwise angle and a displacement, both relative to the housing. A flank
is a point of two bodies and a direction; its approach follows from the motion of its points alone:
there is no base radius, no running sense, no rule for signs. Nothing of the library is used.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass
class Touch:
    """One flank: its row over the coordinates, its gap at rest [m], its stiffness."""

    name: str
    row: Array
    gap: float
    stiffness: float


@dataclass
class Machine:
    """Bodies in a plane.

    Attributes
    ----------
    places : dict of str to ndarray, shape (2,)
        Centres [m].
    rides : dict of str to str
        Carrier of every planet; its pin is rigid.
    floats : dict of str to float
        Stiffness of the elastic bearings [N/m]; all others are rigid.
    """

    places: dict[str, Array]
    rides: dict[str, str]
    floats: dict[str, float] = field(default_factory=dict)
    touches: list[Touch] = field(default_factory=list)
    springs: list[tuple[Array, float]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.order = {name: 3 * k for k, name in enumerate(self.places)}
        self.size = 3 * len(self.order)

    def velocity(self, body: str, point: Array) -> Array:
        """Return the motion of a point of a body per coordinate, shape (2, n)."""
        found = np.zeros((2, self.size))
        at, arm = self.order[body], point - self.places[body]
        found[:, at] = [-arm[1], arm[0]]
        found[0, at + 1] = found[1, at + 2] = 1.0
        carrier = self.rides.get(body)
        if carrier:
            # The pin moves with its carrier; the planet turns on the pin independently.
            pin = self.places[body] - self.places[carrier]
            found[:, self.order[carrier]] += [-pin[1], pin[0]]
            found[0, self.order[carrier] + 1] += 1.0
            found[1, self.order[carrier] + 2] += 1.0
        return found

    def mesh(
        self,
        name: str,
        first: str,
        second: str,
        ring: str | None,
        reach: float,
        angle: float,
        stiffness: float,
        plays: tuple[float, float],
    ) -> None:
        """Add a mesh with both flanks.

        Parameters
        ----------
        name, first, second : str
        ring : str or None
            The internal gear, if any.
        reach : float
            Pitch radius of the first gear [m].
        angle : float
            Pressure angle [rad].
        stiffness : float
            [N/m]
        plays : (float, float)
            Gaps at the flanks with which the first gear pushes the second when it turns
            counter-clockwise and clockwise [m].
        """
        between = self.places[second] - self.places[first]
        out = between / np.hypot(*between)
        if ring == second:
            out = -out
        point = self.places[first] + reach * out
        round_it = np.array([-out[1], out[0]])
        # Flanks push the bodies of the teeth apart.
        apart = -out if ring == first else out
        for way, play, what in zip((1.0, -1.0), plays, ("ccw", "cw"), strict=True):
            push = way * math.cos(angle) * round_it + math.sin(angle) * apart
            row = push @ (self.velocity(first, point) - self.velocity(second, point))
            self.touches.append(Touch(f"{name} {what}", row, play, stiffness))

    def shaft(self, first: str, second: str, stiffness: float) -> None:
        """Add a shaft between two bodies on one axis [N·m/rad]."""
        row = np.zeros(self.size)
        row[self.order[first]], row[self.order[second]] = 1.0, -1.0
        self.springs.append((row, stiffness))

    def speeds(self, driving: str, held: set[str]) -> dict[str, float]:
        """Return counter-clockwise speeds over that of the driving body, all flanks in contact."""
        angles = np.arange(0, self.size, 3)
        rows = [touch.row[angles] for touch in self.touches]
        rows += [row[angles] for row, _ in self.springs]
        unit, order = np.eye(len(angles)), list(self.order)
        rows += [unit[order.index(name)] for name in (*held, driving)]
        due = np.zeros(len(rows))
        due[-1] = 1.0
        matrix = np.array(rows)
        matrix /= np.linalg.norm(matrix, axis=1)[:, None]
        found, _, rank, _ = np.linalg.lstsq(matrix, due, rcond=1e-10)
        assert rank == len(angles)
        assert np.abs(matrix @ found - due).max() < 1e-6
        turning = dict(zip(order, found, strict=True))
        # A planet's coordinate is its rotation relative to the housing.
        return {name: float(speed) for name, speed in turning.items()}

    def solve(self, torque: dict[str, float], held: set[str]) -> tuple[Array, dict[str, float]]:
        """Return coordinates and flank forces [N] under torques counter-clockwise [N·m]."""
        # Soft bearings and shafts beside stiff teeth need more digits than double precision has.
        stiff, load = np.zeros((self.size, self.size), np.longdouble), np.zeros(self.size)
        fixed = {self.order[name] for name in held}
        for name, at in self.order.items():
            load[at] = torque.get(name, 0.0)
            if name in self.floats:
                stiff[at + 1, at + 1] = stiff[at + 2, at + 2] = self.floats[name]
            else:
                fixed |= {at + 1, at + 2}
        for row, stiffness in self.springs:
            stiff += stiffness * np.outer(row, row)
        rows = np.array([t.row for t in self.touches], np.longdouble)
        gaps = np.array([t.gap for t in self.touches])
        k = np.array([t.stiffness for t in self.touches])
        free = np.array([n for n in range(self.size) if n not in fixed])
        x = np.zeros(self.size, np.longdouble)

        def energy(x: Array) -> tuple[float, Array, Array]:
            near = np.maximum(rows @ x - gaps, 0.0)
            value = 0.5 * x @ stiff @ x - load @ x + 0.5 * (k * near) @ near
            slope = stiff @ x - load + rows.T @ (k * near)
            return value, slope, stiff + (rows * np.where(near > 0.0, k, 0.0)[:, None]).T @ rows

        left = 300
        while left:
            left -= 1
            value, slope, second = energy(x)
            here = second[np.ix_(free, free)].astype(float)
            # Loose bodies stay where they are, but move if they are pushed.
            scale = 1e-13 * np.trace(here) / len(free)
            move = np.zeros(self.size)
            move[free] = np.linalg.solve(
                here + scale * np.eye(len(free)), -slope[free].astype(float)
            )
            length = 1.0
            while energy(x + length * move)[0] > value + 1e-4 * length * (slope @ move):
                length *= 0.5
                if length < 1e-9:
                    length = 1.0
                    break
            x = x + length * move
            if np.abs(slope[free]).max() < 1e-10 * max(map(abs, torque.values())):
                # A few more steps reduce the remaining rounding.
                left = min(left, 5)
        forces = k * np.maximum(rows @ x - gaps, 0.0)
        return x.astype(float), {
            t.name: float(f) for t, f in zip(self.touches, forces, strict=True)
        }
