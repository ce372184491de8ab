"""A train at one position, as coordinates and elements in any arithmetic."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.reference.elements import Contact, ExactArc, Graph, Row, Yield
from loadshare.contact.law import Law, PowerLaw, TableLaw
from loadshare.train.ring import DrumRing
from loadshare.train.situations import Situations
from loadshare.train.train import Train

POWERS = {1.0: (1, 1), 1.5: (3, 2), 10.0 / 9.0: (10, 9)}
"""Exponents of walls, as fractions."""


@dataclass(frozen=True, slots=True, eq=False)
class Machine:
    """All elements and loads, dimensionless.

    Attributes
    ----------
    size : int
        Number of coordinates: r_b φ of every gear but the output, p of every gear that moves.
    names : tuple of str
        Names of the coordinates.
    turns, moves : dict of gear to int
        First coordinate of the rotation and of the displacement.
    springs : list of (dict, number, number)
        Direction, stiffness and preset: ½ k (d·x − preset)².
    ties : list of (dict, number)
        d·x = preset: rigid shafts.
    load : dict of int to number
    contacts : dict of str to Contact
    graphs : dict of str to Graph
    force, length : float
        Units [N], [m].
    """

    arithmetic: Any
    size: int
    names: tuple[str, ...]
    turns: dict[str, int]
    moves: dict[str, int]
    springs: list[tuple[dict[int, Any], Any, Any]]
    ties: list[tuple[dict[int, Any], Any]]
    load: dict[int, Any]
    contacts: dict[str, Contact]
    graphs: dict[str, Graph]
    force: float
    length: float


def machine(
    train: Train, situation: Situations, arithmetic: Any, softening: float = 0.0
) -> Machine:
    """Return a train at one position in an arithmetic; the train's doubles are taken as exact.

    Parameters
    ----------
    train : Train
    situation : Situations
    arithmetic : mpmath context
    softening : float
        Dimensionless stiffness added to every coordinate and compliance added to every wall, which
        make it easier to find an active set.
    """
    return _Writer(train, situation, arithmetic, softening).machine()


class _Writer:
    def __init__(
        self, train: Train, situation: Situations, arithmetic: Any, softening: float
    ) -> None:
        self.train, self.situation, self.of = train, situation, arithmetic.mpf
        self.arithmetic, self.softening = arithmetic, arithmetic.mpf(softening)
        self.turns: dict[str, int] = {}
        self.moves: dict[str, int] = {}
        names: list[str] = []
        for name, gear in train.gears.items():
            if name not in train.held:
                self.turns[name] = len(names)
                names.append(f"gear {name} rotation")
            if gear.moves:
                self.moves[name] = len(names)
                names += [f"gear {name} x", f"gear {name} y"]
        self.names = tuple(names)
        pushes = [abs(t) / train.gears[g].base_radius for g, t in situation.torques.items()]
        self.force = max(*pushes, float(np.abs(situation.push).max())) or 1.0
        self.positions = train.flank_positions(situation.position)
        yields = [
            m.law(self.positions[m.name]).compression(self.force) for m in train.meshes.values()
        ]
        self.length = float(np.median(yields))

    def machine(self) -> Machine:
        contacts: dict[str, Contact] = {}
        for contact in (*self._flanks(), *self._ring_contacts()):
            contacts[contact.name] = contact
        springs, ties = self._shafts()
        return Machine(
            self.arithmetic,
            len(self.names),
            self.names,
            self.turns,
            self.moves,
            springs + self._supports(),
            ties,
            self._load(),
            contacts,
            {g.name: g for g in self._graphs()},
            self.force,
            self.length,
        )

    def _lengths(self, value: float) -> Any:
        return self.of(value) / self.of(self.length)

    def _stiffness(self, value: float) -> Any:
        return self.of(value) * self.of(self.length) / self.of(self.force)

    def _law(self, law: Law) -> Yield:
        force, length = self.of(self.force), self.of(self.length)
        if isinstance(law, TableLaw):
            points = zip(law.forces, law.compressions, strict=True)
            scaled = tuple((self.of(f) / force, self.of(d) / length) for f, d in points)
            return Yield(self.arithmetic, self.of(0), self.of(0), scaled)
        if not isinstance(law, PowerLaw):
            raise TypeError(f"no reference for a law of kind {type(law).__name__}")
        b, c = self.of(law.b) * force / length, self.of(law.c) / length
        return Yield(self.arithmetic, b, c * self.arithmetic.cbrt(force) ** 2 if law.c else c)

    def _wall(self, stiffness: float) -> Yield:
        rigid = Yield(self.arithmetic, self.softening, self.of(0))
        return rigid if math.isinf(stiffness) else self._law(PowerLaw(1.0 / stiffness))

    def _shift(self, gear: str, direction: np.ndarray, sign: int = 1) -> dict[int, Any]:
        """Return the coefficients of direction · p_gear."""
        if gear not in self.moves:
            return {}
        frame, first = self.train.gears[gear].frame, self.moves[gear]
        return {first + axis: sign * self._dot(frame[axis], direction) for axis in (0, 1)}

    def _dot(self, one: np.ndarray, other: np.ndarray) -> Any:
        pairs = zip(one.tolist(), other.tolist(), strict=True)
        return sum((self.of(a) * self.of(b) for a, b in pairs), self.of(0))

    def _load(self) -> dict[int, Any]:
        load: dict[int, Any] = {}
        for gear, torque in self.situation.torques.items():
            if gear in self.turns:
                radius = self.of(self.train.gears[gear].base_radius)
                load[self.turns[gear]] = self.of(torque) / radius / self.of(self.force)
        for push, body in zip(self.situation.push[0], self.train.gears.values(), strict=True):
            parts = self._shift(body.name, push)
            if body.carrier is not None:
                parts |= self._shift(body.carrier, push)
                if body.carrier in self.turns:
                    radius = self.of(self.train.gears[body.carrier].base_radius)
                    parts[self.turns[body.carrier]] = self._dot(body.pin_motion, push) / radius
            for at, part in parts.items():
                load[at] = load.get(at, self.of(0)) + part / self.of(self.force)
        return load

    def _shafts(self) -> tuple[list[tuple[dict[int, Any], Any, Any]], list[Any]]:
        springs, ties = [], []
        for shaft in self.train.shafts.values():
            # The unit is angle times length unit: u/r_b is an angle over the length unit.
            wind = {
                self.turns[g]: sign / self.of(self.train.gears[g].base_radius)
                for g, sign in ((shaft.first, 1), (shaft.second, -1))
                if g in self.turns
            }
            preset = self.of(shaft.clocking) / self.of(self.length)
            if math.isinf(shaft.stiffness):
                ties.append((wind, preset))
            else:
                springs.append((wind, self._stiffness(shaft.stiffness), preset))
        return springs, ties

    def _supports(self) -> list[tuple[dict[int, Any], Any, Any]]:
        springs = []
        for name, first in self.moves.items():
            support = self.train.gears[name].support
            for axis in (0, 1):
                if support is not None and support[axis] > 0.0:
                    stiffness = self._stiffness(float(support[axis]))
                    springs.append(({first + axis: self.of(1)}, stiffness, self.of(0)))
        if self.softening:
            springs += [
                ({i: self.of(1)}, self.softening, self.of(0)) for i in range(len(self.names))
            ]
        return springs

    def _flanks(self) -> list[Contact]:
        rows: list[Contact] = []
        for mesh in self.train.meshes.values():
            for drive in mesh.flanks:
                position = self.positions[mesh.flank_name(drive)]
                law = self._law(mesh.law(position))
                to = self.train.approaches[mesh.flank_name(drive)]
                gradient: dict[int, Any] = {}
                for gear, arm in to.turning.items():
                    if gear in self.turns:
                        radius = self.of(self.train.gears[gear].base_radius)
                        gradient[self.turns[gear]] = self.of(arm) / radius
                constant = -self.of(mesh.gap(position, drive))
                for gear, along in to.shifting.items():
                    gradient |= self._shift(gear, along)
                    constant += self._dot(along, self.situation.offset_of(gear))
                rows.append(
                    Row(mesh.flank_name(drive), law, gradient, constant / self.of(self.length))
                )
        return rows

    def _ring_contacts(self) -> list[Contact]:
        found: list[Contact] = []
        for ring in self.train.drums:
            wall = self._wall(ring.stiffness)
            for side, neighbour in enumerate(ring.neighbours):
                found.append(self._arc(ring, side, neighbour, wall))
            for name, sign, limit in zip(
                ring.stop_names, (1, -1), (ring.up, ring.down), strict=True
            ):
                gradient = self._shift(ring.gear, ring.across, sign)
                found.append(Row(name, wall, gradient, -self._lengths(limit)))
        return found

    def _arc(self, ring: DrumRing, side: int, neighbour: str, wall: Yield) -> ExactArc:
        """Return an arc whose nominal distance is exactly that of the two centres."""
        gears = self.train.gears
        axis = [self.of(v) for v in gears[ring.gear].axis.tolist()]
        ends = zip(gears[ring.gear].centre.tolist(), gears[neighbour].centre.tolist(), strict=True)
        between = self._across([self.of(a) - self.of(b) for a, b in ends], axis)
        nominal = self.arithmetic.sqrt(sum(v * v for v in between))
        if ring.with_errors:
            own, other = (self.situation.offset_of(g).tolist() for g in (ring.gear, neighbour))
            shift = [self.of(a) - self.of(b) for a, b in zip(own, other, strict=True)]
            between = [a + b for a, b in zip(between, self._across(shift, axis), strict=True)]
        length = self.of(self.length)
        moves: dict[int, tuple[Any, Any, Any]] = {}
        for gear, sign in ((ring.gear, 1), (neighbour, -1)):
            if gear in self.moves:
                for k in (0, 1):
                    x, y, z = gears[gear].frame[k].tolist()
                    moves[self.moves[gear] + k] = (
                        sign * self.of(x),
                        sign * self.of(y),
                        sign * self.of(z),
                    )
        allowed = (nominal - self.of(ring.clearances[side])) / length
        x, y, z = (v / length for v in between)
        return ExactArc(ring.arc_name(neighbour), wall, self.arithmetic, (x, y, z), allowed, moves)

    @staticmethod
    def _across(vector: list[Any], axis: list[Any]) -> list[Any]:
        along = sum(a * b for a, b in zip(vector, axis, strict=True))
        return [v - along * a for v, a in zip(vector, axis, strict=True)]

    def _graphs(self) -> list[Graph]:
        found = []
        for gear, spline in self.train.splines.items():
            fixed = spline.friction_force is not None
            found.append(
                Graph(
                    name=spline.name,
                    gear=gear,
                    indices=(self.moves[gear], self.moves[gear] + 1),
                    centre=(self.of(0), self.of(0)),
                    stiffness=self._stiffness(spline.bending_stiffness),
                    stick=None if spline.stick_limit is None else self._lengths(spline.stick_limit),
                    reach=self._lengths(spline.clearance),
                    bound=self.of(spline.friction_force or 0.0) / self.of(self.force),
                    per_torque=self.of(0 if fixed else spline.friction_per_torque),
                    torque_of={} if fixed else self._transmitted(gear),
                )
            )
        for ring in self.train.rounds:
            frame, at = self.train.gears[ring.gear].frame, self.moves[ring.gear]
            middle = [self._dot(frame[k], ring.offset) / self.of(self.length) for k in (0, 1)]
            rigid, power = math.isinf(ring.stiffness), ring.power
            found.append(
                Graph(
                    name=ring.name,
                    gear=ring.gear,
                    indices=(at, at + 1),
                    centre=(middle[0], middle[1]),
                    stiffness=None if rigid else self._wall_of(ring.stiffness, power),
                    stick=None if rigid else self.of(0),
                    reach=self._lengths(ring.radius),
                    bound=self.of(0),
                    per_torque=self.of(0),
                    torque_of={},
                    root=None if power == 1.0 else self._root(power),
                    power=self.of(POWERS[power][0]) / self.of(POWERS[power][1]),
                )
            )
        return found

    def _root(self, power: float) -> Callable[[Any], Any]:
        """Return the function x^(power − 1)."""
        sqrt, cbrt = self.arithmetic.sqrt, self.arithmetic.cbrt
        return sqrt if power == 1.5 else lambda x: cbrt(cbrt(x))

    def _wall_of(self, stiffness: float, power: float) -> Any:
        linear = self._stiffness(stiffness)
        return linear if power == 1.0 else linear * self._root(power)(self.of(self.length))

    def _transmitted(self, gear: str) -> dict[str, Any]:
        """Return the arms [m] of the contact forces whose moments are a spline's torque."""
        arms: dict[str, Any] = {}
        for name, to in self.train.approaches.items():
            if gear in to.turning:
                arms[name] = self.of(to.turning[gear])
        return arms
