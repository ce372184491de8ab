"""The answer seen as mechanics: approaches, margins and forces, computed body by body.

Nothing here knows of programmes or rows. Forces are vectors that act on centres, moments are force
times base radius, and each contact is judged at the displaced position.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from loadshare.certify.rigid import RigidShafts, rigid_shafts
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.gear import Vector
from loadshare.train.law import RIGID, Law, PowerLaw
from loadshare.train.memory import SlipFriction, SlipStop
from loadshare.train.radial import RadialLaw, round_ring_law
from loadshare.train.ring import Arc
from loadshare.train.train import Situation, Spline, Train

EPS = float(np.finfo(float).eps)
"""Round-off of a length, relative to it."""
Scalars = TypeVar("Scalars", float, NDArray[np.float64])


def turned(wedge: Scalars, band: Scalars, distance: float) -> Scalars:
    """Angle [rad] within which a band [m] leaves the direction between two arcs (see `squeezes`).

    Parameters
    ----------
    wedge : float or ndarray
        ε [rad].
    band : float or ndarray
        [m].
    distance : float
        a [m].
    """
    across = 2.0 * band / distance
    return across / (wedge + (wedge * wedge + across) ** 0.5)  # type: ignore[no-any-return]


@dataclass(frozen=True, slots=True, eq=False)
class Push:
    """A unilateral contact at the answer.

    Attributes
    ----------
    name : str
    gear : str or None
        The gear whose float it limits, for a ring's contact.
    force : float
        [N], as claimed.
    approach : float
        [m], positive when compressed.
    at_rest : float
        Approach [m] that remains when all coordinates of its tangent plane are zero (minus the
        gap).
    law : Law
    normal : ndarray, shape (3,)
        Direction of the force on the pushed gear.
    pushed, pushing : str or None
        Gears that receive +F n and −F n; None is the housing.
    """

    name: str
    gear: str | None
    force: float
    approach: float
    at_rest: float
    law: Law
    normal: Vector
    pushed: str | None
    pushing: str | None


@dataclass(frozen=True, slots=True, eq=False)
class Pull:
    """A radial element at the answer.

    Attributes
    ----------
    name, gear : str
    law : RadialLaw
    offset : ndarray, shape (3,)
        Displacement of the gear's centre from the element's [m].
    centre : ndarray, shape (3,)
        The element's centre [m].
    reaction : ndarray, shape (3,)
        Force on the gear [N], as claimed.
    is_ring : bool
    """

    name: str
    gear: str
    law: RadialLaw
    offset: Vector
    centre: Vector
    reaction: Vector
    is_ring: bool


@dataclass(frozen=True)
class State:
    """A train, a position and an answer to be judged."""

    train: Train
    answer: Equilibrium

    @cached_property
    def situation(self) -> Situation:
        """What the position brings."""
        return self.train.situation(self.answer.index)

    def moved(self, gear: str) -> Vector:
        """Displacement p (3,) [m]."""
        return np.asarray(self.answer.displacement[gear])

    @cached_property
    def pushes(self) -> tuple[Push, ...]:
        """All unilateral contacts: flanks, arcs, stops."""
        return (*self._flanks(), *self._ring_contacts())

    def _flanks(self) -> Iterator[Push]:
        phi, offset = self.answer.rotation, self.situation.offset
        for mesh in self.train.meshes.values():
            errors = offset[mesh.driver] - offset[mesh.driven]
            relative = self.moved(mesh.driver) - self.moved(mesh.driven) + errors
            turned = (phi[mesh.driver], phi[mesh.driven])
            position = self.situation.mesh_position[mesh.name]
            for drive in mesh.flanks:
                name = mesh.flank_name(drive)
                yield Push(
                    name=name,
                    gear=None,
                    force=self.answer.flank_force[name],
                    approach=mesh.approach(drive, position, turned, relative),
                    at_rest=mesh.approach(drive, position, (0.0, 0.0), errors),
                    law=mesh.law(position),
                    normal=mesh.direction(drive)[2],
                    pushed=mesh.driven,
                    pushing=mesh.driver,
                )

    def _ring_contacts(self) -> Iterator[Push]:
        for ring in self.train.drums:
            law = RIGID if math.isinf(ring.stiffness) else PowerLaw(1.0 / ring.stiffness)
            for side, neighbour in enumerate(ring.neighbours):
                arc = self.train.arc(ring, side, self.situation)
                relative = self.moved(ring.gear) - self.moved(neighbour)
                normal, margin = arc.normal(relative), arc.margin(relative)
                name = ring.arc_name(neighbour)
                yield Push(
                    name=name,
                    gear=ring.gear,
                    force=self.answer.ring_force[name],
                    approach=-margin,
                    at_rest=float(normal @ relative) - margin,
                    law=law,
                    normal=normal,
                    pushed=ring.gear,
                    pushing=neighbour,
                )
            across = float(ring.across @ self.moved(ring.gear))
            for name, sign, limit in zip(
                ring.stop_names, (1.0, -1.0), (ring.up, ring.down), strict=True
            ):
                yield Push(
                    name=name,
                    gear=ring.gear,
                    force=self.answer.ring_force[name],
                    approach=sign * across - limit,
                    at_rest=-limit,
                    law=law,
                    normal=-sign * ring.across,
                    pushed=ring.gear,
                    pushing=None,
                )

    def _arcs(self) -> Iterator[tuple[str, Arc, Vector]]:
        """Every exclusion arc: its name, itself, and the relative displacement of its gears [m]."""
        for ring in self.train.drums:
            for side, neighbour in enumerate(ring.neighbours):
                arc = self.train.arc(ring, side, self.situation)
                yield ring.arc_name(neighbour), arc, self.moved(ring.gear) - self.moved(neighbour)

    def squeezes(self, band: float) -> dict[str, float]:
        """Force [N] across the two rigid arcs of a ring that a squeeze between them leaves open.

        A centre in touch with both, up to a length, lies anywhere within y across them, where
        ε y + y²/2a is that length and ε the angle of the wedge; the directions of the two forces
        are known no better than y/a. The length is what the two arcs overlap or stand open; where
        the narrowest place of the wedge, ε²a/8 past its mouth, overlaps by less than the band [m],
        it is the band: through there a float would roll away that a large squeeze seems to hold.
        Neighbours that give way follow the float instead.
        """
        forces = self.answer.ring_force
        found = {}
        for ring in self.train.drums:
            gives_way = any(self.train.gears[n].moves for n in ring.neighbours)
            if gives_way or not math.isinf(ring.stiffness):
                continue
            arcs = [self.train.arc(ring, side, self.situation) for side in (0, 1)]
            wedge = float(np.linalg.norm(sum(a.normal(np.zeros(3)) for a in arcs)))
            squeeze = min(forces[ring.arc_name(n)] for n in ring.neighbours)
            distance = min(a.distance for a in arcs)
            moved = self.moved(ring.gear)
            apart = max(abs(a.margin(moved)) for a in arcs) + EPS * float(np.linalg.norm(moved))
            known = apart if wedge**2 * distance > 8.0 * band else band
            found[f"ring {ring.gear}: arcs"] = squeeze * turned(wedge, known, distance)
        return found

    @cached_property
    def pulls(self) -> tuple[Pull, ...]:
        """All radial elements: splines and round rings."""
        found = []
        before = self.train.slip
        for gear, spline in self.train.splines.items():
            if before is not None:
                found += self._slipping(spline, np.asarray(before[gear]))
                continue
            law = spline.law(self.transmitted(gear))
            reaction = np.asarray(self.answer.radial_reaction[spline.name])
            moved = self.moved(gear)
            found.append(Pull(spline.name, gear, law, moved, np.zeros(3), reaction, False))
        for ring in self.train.rounds:
            law = round_ring_law(ring.radius, ring.stiffness)
            reaction = np.asarray(self.answer.radial_reaction[ring.name])
            offset = self.moved(ring.gear) - ring.offset
            found.append(Pull(ring.name, ring.gear, law, offset, ring.offset, reaction, True))
        return tuple(found)

    def _slipping(self, spline: Spline, before: Vector) -> list[Pull]:
        """Friction and clearance of a spline that remembers its slip."""
        gear, torque = spline.gear, self.transmitted(spline.gear)
        slip = self.slip(spline)
        friction, stop = (
            np.asarray(self.answer.radial_reaction[name])
            for name in (spline.name, spline.stop_name)
        )
        resisted, room = SlipFriction(spline).law(torque), SlipStop(spline).law(torque)
        return [
            Pull(spline.name, gear, resisted, slip - before, before, friction, False),
            Pull(spline.stop_name, gear, room, slip, np.zeros(3), stop, False),
        ]

    def slip(self, spline: Spline) -> Vector:
        """Slip s (3,) [m] of a spline with memory: what the bending of its shaft leaves of p."""
        return np.asarray(self.moved(spline.gear) - self.bending(spline))

    def bending(self, spline: Spline) -> Vector:
        """Bending p − s (3,) [m] of a spline's shaft under its claimed force, with memory."""
        names = (spline.name, spline.stop_name)
        force = sum(np.asarray(self.answer.radial_reaction[name]) for name in names)
        return np.asarray(-force / spline.bending_stiffness)

    def winds(self) -> Iterator[tuple[str, float, float]]:
        """Every shaft with its wind-up φ_a − φ_b − clocking [rad] and its torque [N·m].

        The torque of a rigid shaft is nobody's claim: it is what balances the gears beyond it.
        """
        phi, claimed = self.answer.rotation, self.answer.shaft_torque
        for name, shaft in self.train.shafts.items():
            wind = phi[shaft.first] - phi[shaft.second] - shaft.clocking
            if math.isinf(shaft.stiffness):
                beyond = self.rigid.beyond[name].items()
                yield name, wind, math.fsum(sign * self.moment[g] for g, sign in beyond)
            else:
                yield name, wind, claimed.get(name, shaft.stiffness * wind)

    @cached_property
    def rigid(self) -> RigidShafts:
        """The rigid shafts, and what lies beyond each."""
        return rigid_shafts(self.train)

    @cached_property
    def moment(self) -> dict[str, float]:
        """Moment [N·m] on every gear of the load, its flanks and elastic shafts."""
        train, answer = self.train, self.answer
        moment = {g: self.situation.torque.get(g, 0.0) for g in train.gears}
        for mesh in train.meshes.values():
            for drive in mesh.flanks:
                force = answer.flank_force[mesh.flank_name(drive)]
                along = 1.0 if drive else -1.0
                moment[mesh.driver] -= along * mesh.radii[0] * force
                moment[mesh.driven] += along * mesh.radii[1] * force
        for name, shaft in train.shafts.items():
            if not math.isinf(shaft.stiffness):
                wind = answer.rotation[shaft.first] - answer.rotation[shaft.second]
                torque = answer.shaft_torque.get(name, shaft.stiffness * (wind - shaft.clocking))
                moment[shaft.first] -= torque
                moment[shaft.second] += torque
        return moment

    def bearings(self) -> Iterator[tuple[str, Vector, Vector, Vector]]:
        """Every gear that can be displaced: p [m], stiffness [N/m] and bearing force [N], (2,)."""
        for name, gear in self.train.gears.items():
            if gear.support is not None:
                moved = gear.frame @ self.moved(name)
                force = self.answer.support_force.get(name, gear.support * moved)
                yield name, moved, gear.support, np.asarray(force)

    def transmitted(self, gear: str) -> float:
        """Torque [N·m] that a gear takes over its shaft or spline."""
        return self.train.transmitted(gear, self.answer.flank_force)

    @cached_property
    def finite(self) -> bool:
        """Whether every claimed figure is a number."""
        a = self.answer
        figures = [*a.rotation.values(), *a.flank_force.values(), *a.ring_force.values()]
        figures += a.shaft_torque.values()
        vectors = [
            *a.displacement.values(),
            *a.radial_reaction.values(),
            *a.support_force.values(),
        ]
        return bool(np.isfinite(figures).all() and all(np.isfinite(v).all() for v in vectors))

    @cached_property
    def fault(self) -> str:
        """Why the claim cannot be judged, else empty.

        A figure is not a number, a spline has no law, or a gear stands beyond the neighbour on
        whose ring its own rolls: there the arc's inequality holds, and no gear can be.
        """
        if not self.finite:
            return "a figure that is not a number"
        try:
            _ = self.pulls
        except ValueError as error:
            return str(error)
        beyond = [name for name, arc, relative in self._arcs() if arc.beyond(relative)]
        return f"a place beyond the neighbour, {', '.join(beyond)}" if beyond else ""

    @cached_property
    def force_scale(self) -> float:
        """Load of the case [N]: largest flank force or external push; 1 N when nothing acts.

        Reactions of rigid limits do not count: any preload of two opposite stops would be in
        balance and would hide what is not.
        """
        gears = self.train.gears
        forces = [abs(f) for f in self.answer.flank_force.values()]
        forces += [abs(t) / gears[g].base_radius for g, t in self.situation.torque.items()]
        return max(forces, default=0.0) or 1.0

    @cached_property
    def length_scale(self) -> float:
        """Deflection of the case [m]: largest compression, gap taken up, or error; 1 µm when none.

        Displacements do not count: a free one could be claimed as large as one likes.
        """
        closed = [p for p in self._flanks() if p.force > 0.0]
        lengths = [p.law.compression(p.force) for p in closed]
        lengths += [abs(p.at_rest) for p in closed]
        lengths += [float(np.linalg.norm(c)) for c in self.situation.offset.values()]
        return max(lengths, default=0.0) or 1e-6
