"""The elements of a train in any arithmetic: contacts, arcs, radial graphs.

Everything is dimensionless: lengths are divided by a length unit, forces by a force unit, both
doubles, so that no digit is lost in 50-digit arithmetic.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

Gradient = dict[int, Any]
Curvature = dict[tuple[int, int], Any]

ONSET = 1e-9
"""Distance beyond the reach, in length units of the train, at which a wall without initial slope is
evaluated instead."""


@dataclass(frozen=True, slots=True)
class Yield:
    """Compression of a contact under a force: b f + c f^(2/3), or linear between points."""

    arithmetic: Any
    b: Any
    c: Any
    points: tuple[tuple[Any, Any], ...] = ()

    def at(self, force: Any) -> tuple[Any, Any]:
        """Return the compression and its slope; at zero force, the slope at a minute force."""
        if self.points:
            pairs = zip(self.points[:-1], self.points[1:], strict=True)
            (f0, d0), (f1, d1) = next(
                (p for p in pairs if force <= p[1][0]), (self.points[-2], self.points[-1])
            )
            slope = (d1 - d0) / (f1 - f0)
            return d0 + slope * (force - f0), slope
        if not self.c:
            return self.b * force, self.b
        root = self.arithmetic.cbrt(max(force, self.arithmetic.mpf(10) ** -60))
        return self.b * force + self.c * root**2, self.b + 2 * self.c / (3 * root)


class Contact(Protocol):
    """A unilateral contact: its approach is positive in compression, and its force pushes."""

    @property
    def name(self) -> str:
        """Name of the contact."""

    @property
    def law(self) -> Yield:
        """Law of its compression."""

    def approach(self, x: list[Any]) -> tuple[Any, Gradient, Curvature]:
        """Return the approach at the coordinates, its gradient and its second derivatives."""


@dataclass(frozen=True, slots=True)
class Row:
    """A contact whose approach is linear: a flank or a stop."""

    name: str
    law: Yield
    gradient: Gradient
    constant: Any

    def approach(self, x: list[Any]) -> tuple[Any, Gradient, Curvature]:
        """See `Contact`."""
        return self.constant + sum(v * x[i] for i, v in self.gradient.items()), self.gradient, {}


@dataclass(frozen=True, slots=True)
class ExactArc:
    """The exclusion arc of two rings, exact: |d₀ + Δ(x)| ≥ a − c_x."""

    name: str
    law: Yield
    arithmetic: Any
    start: tuple[Any, Any, Any]
    allowed: Any
    moves: dict[int, tuple[Any, Any, Any]]

    def approach(self, x: list[Any]) -> tuple[Any, Gradient, Curvature]:
        """See `Contact`."""
        d = [
            self.start[k] + sum(move[k] * x[i] for i, move in self.moves.items()) for k in range(3)
        ]
        distance = self.arithmetic.sqrt(sum(v * v for v in d))
        n = [v / distance for v in d]
        along = {i: sum(n[k] * m[k] for k in range(3)) for i, m in self.moves.items()}
        curvature = {
            (i, j): -(sum(a * b for a, b in zip(m, o, strict=True)) - along[i] * along[j])
            / distance
            for i, m in self.moves.items()
            for j, o in self.moves.items()
        }
        return self.allowed - distance, {i: -v for i, v in along.items()}, curvature


@dataclass(frozen=True, slots=True)
class Graph:
    """A radial graph: a spline (stick, slip, stop) or a round ring, described by its places.

    Attributes
    ----------
    name, gear : str
    indices : tuple of int
        Coordinates of the gear's centre.
    centre : tuple
    stiffness : number or None
        Slope of the rising pieces; None for a rigid wall.
    stick : number or None
        Radius up to which a spline sticks; None takes bound/stiffness. A ring's is 0.
    reach : number
        Radius at which the clearance is used up.
    bound : number
        Friction bound, if it is fixed.
    per_torque : number
        Friction bound over the force that the spline transmits; 0 if the bound is fixed.
    torque_of : dict of contact name to number
        Coefficients of the transmitted force in terms of contact forces.
    root : callable or None
        If the force grows with a power of the distance beyond the reach: function that returns the
        factor, besides the stiffness, on that distance.
    power : number
        That power.
    """

    name: str
    gear: str
    indices: tuple[int, int]
    centre: tuple[Any, Any]
    stiffness: Any
    stick: Any
    reach: Any
    bound: Any
    per_torque: Any
    torque_of: dict[str, Any]
    root: Callable[[Any], Any] | None = None
    power: Any = 1

    def wall(self, radius: Any) -> tuple[Any, Any]:
        """Return the force beyond the reach, without that of the level piece, and its slope."""
        gap = radius - self.reach
        if self.root is None:
            return self.stiffness * gap, self.stiffness
        gap = gap if gap > 0 else (0 * gap + 1) * ONSET
        slope = self.stiffness * self.root(gap)
        return slope * gap, self.power * slope

    def stick_end(self, bound: Any) -> Any:
        """Return the radius at which sticking ends."""
        continuous = bound / self.stiffness if self.stiffness is not None else bound * 0
        if self.stick is None:
            return continuous
        return min(self.stick, continuous)

    def place(self, radius: Any, force: Any, bound: Any) -> str:
        """Return the place on the graph that is nearest to a radius and a force."""
        if (
            self.stick is None
            and self.stiffness is not None
            and self.reach < bound / self.stiffness
        ):
            return "stick"
        end = self.stick_end(bound)
        low = self.stiffness * end if self.stiffness is not None else bound * 0
        options = []
        if end > 0:
            inner = min(radius, end)
            options.append((abs(radius - inner) + abs(force - self.stiffness * inner), "stick"))
        if bound > low:
            options.append((abs(radius - end) + abs(force - min(max(force, low), bound)), "step"))
        if self.reach > end:
            inner = min(max(radius, end), self.reach)
            options.append((abs(radius - inner) + abs(force - bound), "slip"))
        if self.stiffness is None:
            options.append((abs(radius - self.reach) + max(bound - force, 0), "wall"))
        else:
            beyond = max(radius, self.reach)
            excess = bound + (self.wall(beyond)[0] if beyond > self.reach else 0)
            options.append((abs(radius - beyond) + abs(force - excess), "stop"))
        return min(options, key=lambda o: float(o[0]))[1]
