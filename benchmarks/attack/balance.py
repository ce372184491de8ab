"""Balance of forces and moments of a train, written from its data alone, and its null space.

Nothing of the solver, the scene or the certificate is used. The columns are force vectors on bodies
(formulation, sections 1, 2, 5, 6); self-stresses are the null space of these columns, from NumPy's
singular value decomposition.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from loadshare.train import Train
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.gear import Vector
from loadshare.train.situations import situation_of

Array = NDArray[np.float64]

RANK = 1e-11
"""Singular values below this fraction of the largest one count as zero."""


@dataclass(frozen=True, slots=True)
class Column:
    """A force of a claim.

    Attributes
    ----------
    field, name : str
        Field of the equilibrium that holds the force, and its key there.
    axis : int
        Of a vector: component along the gear's frame.
    unit : float
        Value of one newton along the column in the claim's unit.
    compliance : float
        [m/N] at the claimed force.
    acts : bool
        Whether the contact is closed in the claim, or cannot open.
    """

    field: str
    name: str
    axis: int
    unit: float
    compliance: float
    acts: bool


@dataclass(frozen=True)
class Balance:
    """Forces of a claim, and their effect on bodies.

    Attributes
    ----------
    train : Train
    claim : Equilibrium
    """

    train: Train
    claim: Equilibrium

    @cached_property
    def groups(self) -> list[list[str]]:
        """Groups of gears that turn as one, without the group of the output."""
        gears = self.train.gears
        groups = {name: [name] for name in gears}
        for shaft in self.train.shafts.values():
            one, other = groups[shaft.first], groups[shaft.second]
            if math.isinf(shaft.stiffness) and one is not other:
                one += other
                groups |= dict.fromkeys(other, one)
        found = list({id(g): g for g in groups.values()}.values())
        return [g for g in found if self.train.output not in g]

    @cached_property
    def rows(self) -> dict[tuple[str, str], int]:
        """Index of each coordinate by gear and "x", "y", or "turn"."""
        moving = [n for n, g in self.train.gears.items() if g.support is not None]
        found = {(gear, axis): 0 for gear in moving for axis in "xy"}
        found = {key: k for k, key in enumerate(found)}
        first = len(found)
        for k, group in enumerate(self.groups):
            found |= {(gear, "turn"): first + k for gear in group}
        return found

    @cached_property
    def lever(self) -> Array:
        """Radius [m] that converts each rotation into a length; 1 for displacements."""
        size = max(self.rows.values(), default=-1) + 1
        levers = np.ones(size)
        for group in self.groups:
            levers[self.rows[group[0], "turn"]] = max(
                self.train.gears[g].base_radius for g in group
            )
        return levers

    @cached_property
    def columns(self) -> tuple[tuple[Column, ...], Array]:
        """All forces, and the matrix (coordinates, forces) of their effect on the coordinates."""
        made: list[Column] = []
        parts: list[Array] = []

        def add(column: Column, pushes: Mapping[str, Vector], turns: Mapping[str, float]) -> None:
            part = np.zeros(len(self.lever))
            for gear, push in pushes.items():
                for axis, way in zip("xy", self.train.gears[gear].frame, strict=True):
                    if (gear, axis) in self.rows:
                        part[self.rows[gear, axis]] += float(way @ push)
            for gear, moment in turns.items():
                if (gear, "turn") in self.rows:
                    row = self.rows[gear, "turn"]
                    part[row] += moment / self.lever[row]
            made.append(column)
            parts.append(part)

        self._flanks(add)
        self._rings(add)
        self._springs(add)
        return tuple(made), np.array(parts).T.reshape(len(self.lever), len(made))

    def _flanks(self, add) -> None:  # type: ignore[no-untyped-def]
        positions = self.train.flank_positions(self.claim.index)
        for mesh in self.train.meshes.values():
            for drive in mesh.flanks:
                law = mesh.law(positions[mesh.flank_name(drive)])
                force = self.claim.flank_force[mesh.flank_name(drive)]
                push = mesh.drive_normal if drive else mesh.coast_normal
                along = 1.0 if drive else -1.0
                soft = law.tangent(max(force, 0.0))[0] if force > 0.0 else 0.0
                add(
                    Column("flank_force", mesh.flank_name(drive), 0, 1.0, soft, force > 0.0),
                    {mesh.driver: -push, mesh.driven: push},
                    {
                        mesh.driver: -along * mesh.senses[0] * mesh.radii[0],
                        mesh.driven: along * mesh.senses[1] * mesh.radii[1],
                    },
                )

    def _rings(self, add) -> None:  # type: ignore[no-untyped-def]
        situation = situation_of(self.train, self.claim.index)
        moved = self.claim.displacement
        for ring in self.train.drums:
            contacts = {
                ring.stop_names[0]: {ring.gear: -ring.across},
                ring.stop_names[1]: {ring.gear: ring.across},
            }
            for side, neighbour in enumerate(ring.neighbours):
                arc = situation.arc(ring, side)
                away = arc.normal(moved[ring.gear] - moved[neighbour])
                contacts[ring.arc_name(neighbour)] = {ring.gear: away, neighbour: -away}
            soft = 0.0 if math.isinf(ring.stiffness) else 1.0 / ring.stiffness
            for name, pushes in contacts.items():
                force = self.claim.ring_force[name]
                add(Column("ring_force", name, 0, 1.0, soft, force > 0.0), pushes, {})

    def _springs(self, add) -> None:  # type: ignore[no-untyped-def]
        train = self.train
        for name, reaction in self.claim.radial_reaction.items():
            gear = self._gear_of(name)
            soft = 0.0
            if gear in train.splines and name == train.splines[gear].name:
                soft = 1.0 / train.splines[gear].bending_stiffness
            acts = bool(np.linalg.norm(reaction) > 0.0)
            for axis in (0, 1):
                way = train.gears[gear].frame[axis]
                add(Column("radial_reaction", name, axis, 1.0, soft, acts), {gear: way}, {})
        for name, shaft in train.shafts.items():
            if not math.isinf(shaft.stiffness):
                radius = train.gears[shaft.first].base_radius
                soft = radius**2 / shaft.stiffness
                turns = {shaft.first: -radius, shaft.second: radius}
                add(Column("shaft_torque", name, 0, radius, soft, acts=True), {}, turns)
        for name, held in train.gears.items():
            for axis in (0, 1) if held.support is not None else ():
                if held.support is not None and held.support[axis] > 0.0:
                    soft = 1.0 / held.support[axis]
                    column = Column("support_force", name, axis, 1.0, soft, acts=True)
                    add(column, {name: -held.frame[axis]}, {})

    @cached_property
    def compliance(self) -> Array:
        """Compliance [m/N] of every force."""
        return np.array([c.compliance for c in self.columns[0]])

    @cached_property
    def acting(self) -> NDArray[np.intp]:
        """Indices of the forces that act."""
        return np.flatnonzero([c.acts for c in self.columns[0]])

    def null_space(self, some: NDArray[np.intp]) -> Array:
        """Return the self-stresses of some forces as columns, shape (forces, redundants)."""
        matrix = self.columns[1][:, some]
        _, sizes, right = np.linalg.svd(matrix, full_matrices=True)
        rank = int((sizes > RANK * max(sizes.max(initial=0.0), 1.0)).sum())
        found = np.zeros((len(self.columns[0]), len(some) - rank))
        found[some] = right[rank:].T
        return found

    def unbalance(self) -> float:
        """Return the largest unbalanced force over the largest force: a check of this module."""
        columns, matrix = self.columns
        load = np.zeros(len(self.lever))
        for gear, torque in situation_of(self.train, self.claim.index).torques.items():
            if (gear, "turn") in self.rows:
                row = self.rows[gear, "turn"]
                load[row] += torque / self.lever[row]
        forces = np.array([self._claimed(c) for c in columns])
        left = np.abs(matrix @ forces + load).max(initial=0.0)
        return float(left / np.abs(forces).max(initial=1e-300))

    def _claimed(self, column: Column) -> float:
        value = getattr(self.claim, column.field)[column.name]
        if column.field == "radial_reaction":
            return float(self.train.gears[self._gear_of(column.name)].frame[column.axis] @ value)
        return float(np.atleast_1d(value)[column.axis]) / column.unit

    def with_forces(self, more: Array) -> Equilibrium:
        """Return the claim with forces [N] added, column by column."""
        fields: dict[str, Any] = {}
        for column, value in zip(self.columns[0], more.tolist(), strict=True):
            if value == 0.0:
                continue
            there = fields.setdefault(column.field, dict(getattr(self.claim, column.field)))
            old = there[column.name]
            if column.field == "radial_reaction":
                gear = self._gear_of(column.name)
                there[column.name] = old + value * self.train.gears[gear].frame[column.axis]
            elif column.field == "support_force":
                there[column.name] = old + value * np.eye(2)[column.axis]
            else:
                there[column.name] = old + value * column.unit
        return replace(self.claim, **fields)

    def _gear_of(self, name: str) -> str:
        radials = {s.name: g for g, s in self.train.splines.items()}
        radials |= {r.name: r.gear for r in self.train.rounds}
        return radials[name]

    def followed(self, found: Equilibrium, more: Array) -> Equilibrium:
        """Return the claim with displacements that follow added forces, by least squares."""
        matrix = self.columns[1][:, self.acting]
        wanted = self.compliance[self.acting] * more[self.acting]
        moved = np.linalg.lstsq(-matrix.T, wanted, rcond=None)[0]
        rotation, displacement = dict(found.rotation), dict(found.displacement)
        for (gear, what), row in self.rows.items():
            if what == "turn":
                rotation[gear] = rotation[gear] + moved[row] / self.lever[row]
            else:
                way = self.train.gears[gear].frame["xy".index(what)]
                displacement[gear] = displacement[gear] + moved[row] * way
        return replace(found, rotation=rotation, displacement=displacement)
