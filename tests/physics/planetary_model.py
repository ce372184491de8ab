"""An independent model of a planetary set: bodies in the housing and springs, nothing else.

All angles are counter-clockwise, all displacements relative to the housing; a planet's is its own,
not relative to its pin. The equilibrium is the minimum of the energy, found by Newton's method with
a line search on the acting elements. Nothing of the library is used.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Row = dict[int, float]


@dataclass
class Set:
    """A sun, a ring, a carrier and planets.

    Attributes
    ----------
    sun, planet, ring : float
        Base radii [m].
    arm : float
        Distance of the pins from the axis [m].
    angles : ndarray, shape (n,)
        Angles of the pins [rad].
    with_sun, with_ring : ndarray, shape (n,)
        Stiffnesses of the meshes along their lines of action [N/m].
    gaps : ndarray, shape (2, n)
        Gaps of the meshes with sun and ring [m].
    supports : dict of str to float
        Stiffness [N/m] that supports sun, ring and carrier in the housing, and every planet on its
        pin; a missing body is rigid.
    clearance : float
        Clearance of the planets on their pins [m].
    pins : ndarray, shape (n, 2)
        Position errors of the pins [m].
    torsion : float
        Torsional stiffness of the ring's mount [N·m/rad].
    driven : int
        Sense in which the sun pushes the planets: 1 counter-clockwise, −1 clockwise.
    """

    sun: float
    planet: float
    ring: float
    arm: float
    angles: Array
    with_sun: Array
    with_ring: Array
    gaps: Array
    supports: dict[str, float]
    clearance: float
    pins: Array
    torsion: float = 0.0
    driven: int = 1
    names: dict[str, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        bodies = ["sun", "ring", "carrier", *(f"p{k}" for k in range(len(self.angles)))]
        for body in bodies:
            for axis in "txy":
                self.names[body + axis] = len(self.names)

    def flanks(self) -> list[tuple[Row, float, float]]:
        """Return the approach of every loaded flank per coordinate, its constant [m], its stiffness
        [N/m].
        """
        to = self.names
        sun_angle = np.arccos((self.sun + self.planet) / self.arm)
        ring_angle = np.arccos((self.ring - self.planet) / self.arm)
        found = []
        for k, angle in enumerate(self.angles):
            outward = np.array([np.cos(angle), np.sin(angle)])
            aside = self.driven * np.array([-outward[1], outward[0]])
            push = np.cos(sun_angle) * aside + np.sin(sun_angle) * outward
            row = {to["sunt"]: self.driven * self.sun, to[f"p{k}t"]: self.driven * self.planet}
            for axis, value in zip("xy", push, strict=True):
                row[to["sun" + axis]], row[to[f"p{k}{axis}"]] = value, -value
            found.append((row, -self.gaps[0, k], self.with_sun[k]))
        for k, angle in enumerate(self.angles):
            outward = np.array([np.cos(angle), np.sin(angle)])
            aside = self.driven * np.array([-outward[1], outward[0]])
            push = -np.cos(ring_angle) * aside + np.sin(ring_angle) * outward
            row = {to[f"p{k}t"]: -self.driven * self.planet, to["ringt"]: self.driven * self.ring}
            for axis, value in zip("xy", push, strict=True):
                row[to[f"p{k}{axis}"]], row[to["ring" + axis]] = value, -value
            found.append((row, -self.gaps[1, k], self.with_ring[k]))
        return found

    def solve(self, member: str, torque: float, held: set[str]) -> tuple[Array, Array]:
        """Return the coordinates and the flank forces [N].

        Parameters
        ----------
        member : str
            Member on which the torque acts.
        torque : float
            Counter-clockwise [N·m].
        held : set of str
            Members that cannot turn.
        """
        size, to = len(self.names), self.names
        # With soft bearings beside stiff teeth, a flank's approach in double precision is not
        # accurate enough for the comparison.
        stiff, load = np.zeros((size, size), np.longdouble), np.zeros(size, np.longdouble)
        load[to[member + "t"]] = torque
        fixed = {to[name + "t"] for name in held}
        stiff[to["ringt"], to["ringt"]] += self.torsion
        for body in ("sun", "ring", "carrier"):
            for axis in "xy":
                at = to[body + axis]
                if body in self.supports:
                    stiff[at, at] += self.supports[body]
                else:
                    fixed.add(at)
        flanks = self.flanks()
        rows = np.zeros((len(flanks), size), np.longdouble)
        for e, (row, _, _) in enumerate(flanks):
            for at, value in row.items():
                rows[e, at] = value
        start = np.array([constant for _, constant, _ in flanks])
        springs = np.array([stiffness for *_, stiffness in flanks])
        seats = [self._seat(k) for k in range(len(self.angles))]
        free = np.array([k for k in range(size) if k not in fixed])
        x = np.zeros(size, np.longdouble)

        def energy(x: Array) -> tuple[float, Array, Array]:
            near = rows @ x + start
            force = springs * np.maximum(near, 0.0)
            value = 0.5 * x @ stiff @ x - load @ x + 0.5 * force @ np.maximum(near, 0.0)
            slope = stiff @ x - load + rows.T @ force
            second = stiff + (rows * np.where(near > 0.0, springs, 0.0)[:, None]).T @ rows
            for matrix, error in seats:
                away = matrix @ x - error
                far = np.hypot(*away)
                beyond = far - self.clearance
                if beyond > 0.0:
                    k, unit = self.supports["planet"], away / far
                    value += 0.5 * k * beyond**2
                    slope = slope + matrix.T @ (k * beyond * unit)
                    across = (beyond / far) * (np.eye(2) - np.outer(unit, unit))
                    second = second + k * matrix.T @ (np.outer(unit, unit) + across) @ matrix
            return value, slope, second

        near, left = False, 400
        while left:
            left -= 1
            value, slope, second = energy(x)
            here = second[np.ix_(free, free)].astype(float)
            scale = (0.0 if near else 1e-13) * np.trace(here) / len(free)
            move = np.zeros(size)
            move[free] = -np.linalg.lstsq(
                here + scale * np.eye(len(free)), slope[free].astype(float), rcond=1e-15
            )[0]
            length = 1.0
            while length > 1e-12:
                if energy(x + length * move)[0] <= value + 1e-4 * length * float(slope @ move):
                    break
                length *= 0.5
            else:
                length = 1.0
            x = x + length * move
            if np.abs(slope[free]).max() <= 1e-9 * abs(torque):
                # A few more steps reduce the remaining rounding.
                near, left = True, min(left, 6)
        force = springs * np.maximum(rows @ x + start, 0.0)
        return x.astype(float), force.astype(float)

    def _seat(self, k: int) -> tuple[Array, Array]:
        """Return a planet's displacement from its pin per coordinate, and the pin's error."""
        to, angle = self.names, self.angles[k]
        matrix = np.zeros((2, len(to)))
        for row, axis in enumerate("xy"):
            matrix[row, to[f"p{k}{axis}"]] = 1.0
            matrix[row, to["carrier" + axis]] = -1.0
        matrix[0, to["carriert"]] = self.arm * np.sin(angle)
        matrix[1, to["carriert"]] = -self.arm * np.cos(angle)
        return matrix, self.pins[k]
