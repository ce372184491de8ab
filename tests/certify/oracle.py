"""The certificate of one answer, element by element: a reference for the batched and compiled ones.

It is written with scalars, mappings and the laws of the train instead of arrays (formulation,
section 8); only the walk along rigid shafts is shared. Forces are vectors that act on centres,
moments are force times base radius, and each contact is judged at the displaced position.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from loadshare.certify.rigid import RigidShafts, rigid_shafts
from loadshare.contact.arc import Arc
from loadshare.contact.law import RIGID, Law, PowerLaw
from loadshare.contact.radial import RadialLaw, round_ring_law
from loadshare.settings import CERTIFY
from loadshare.train.elements import Spline
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.gear import Vector
from loadshare.train.memory import SlipFriction, SlipStop
from loadshare.train.mesh import Mesh
from loadshare.train.ring import RoundRing
from loadshare.train.situations import Situations, situation_of
from loadshare.train.train import Train

EPS = float(np.finfo(float).eps)
"""Round-off of a length, relative to the length."""


def turned(wedge: float, band: float, distance: float) -> float:
    """Return the angle [rad] within which a band [m] leaves the direction between two arcs
    (`squeezes`).
    """
    across = 2.0 * band / distance
    return across / (wedge + math.sqrt(wedge * wedge + across))


def approach(
    mesh: Mesh,
    drive: bool,
    position: int,
    rotations: tuple[float, float],
    apart: Vector,
) -> float:
    """Return the approach of a flank [m] from both gears' rotations and displacement apart."""
    on_driver, on_driven, normal = mesh.direction(drive)
    turned = on_driver * rotations[0] + on_driven * rotations[1]
    return turned + float(normal @ apart) - mesh.gap(position, drive)


@dataclass(frozen=True, slots=True, eq=False)
class Push:
    """A unilateral contact in the claimed answer.

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
    """A radial element in the claimed answer.

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
class ClaimedState:
    """A train, a position and an answer to be judged."""

    train: Train
    answer: Equilibrium

    @cached_property
    def situation(self) -> Situations:
        """The situation at the position."""
        return situation_of(self.train, self.answer.index)

    def moved(self, gear: str) -> Vector:
        """Return the displacement p (3,) [m], for a planet relative to its pin."""
        return np.asarray(self.answer.displacement[gear])

    def pin(self, gear: str) -> tuple[Vector, Vector]:
        """Return a planet's pin displacement, and its part from the carrier's rotation (3,) [m]."""
        planet = self.train.gears[gear]
        if planet.carrier is None:
            return np.zeros(3), np.zeros(3)
        carrier = self.train.gears[planet.carrier]
        angle = carrier.sense * self.answer.rotation[carrier.name]
        turned = np.cross(angle * carrier.axis, planet.centre - carrier.centre)
        return self.moved(carrier.name) + turned, turned

    def error(self, gear: str) -> Vector:
        """Return the centre offset (3,) [m], for a planet with that of its carrier."""
        offset, carrier = self.situation.offset_of(gear), self.train.gears[gear].carrier
        return offset if carrier is None else offset + self.situation.offset_of(carrier)

    @cached_property
    def pushes(self) -> tuple[Push, ...]:
        """All unilateral contacts: flanks, arcs, stops."""
        return (*self._flanks(), *self._ring_contacts())

    def _flanks(self) -> Iterator[Push]:
        phi = self.answer.rotation
        positions = self.train.flank_positions(self.answer.index)
        for mesh in self.train.meshes.values():
            errors = self.error(mesh.driver) - self.error(mesh.driven)
            pins = self.pin(mesh.driver)[0] - self.pin(mesh.driven)[0]
            relative = self.moved(mesh.driver) - self.moved(mesh.driven) + errors + pins
            turned = (phi[mesh.driver], phi[mesh.driven])
            for drive in mesh.flanks:
                name = mesh.flank_name(drive)
                position = positions[name]
                yield Push(
                    name=name,
                    gear=None,
                    force=self.answer.flank_force[name],
                    approach=approach(mesh, drive, position, turned, relative),
                    at_rest=approach(mesh, drive, position, (0.0, 0.0), errors),
                    law=mesh.law(position),
                    normal=mesh.direction(drive)[2],
                    pushed=mesh.driven,
                    pushing=mesh.driver,
                )

    def _ring_contacts(self) -> Iterator[Push]:
        for ring in self.train.drums:
            law = RIGID if math.isinf(ring.stiffness) else PowerLaw(1.0 / ring.stiffness)
            for side, neighbour in enumerate(ring.neighbours):
                arc = self.situation.arc(ring, side)
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
        """Yield every exclusion arc: name, arc, and the relative displacement of its gears [m]."""
        for ring in self.train.drums:
            for side, neighbour in enumerate(ring.neighbours):
                arc = self.situation.arc(ring, side)
                yield ring.arc_name(neighbour), arc, self.moved(ring.gear) - self.moved(neighbour)

    def squeezes(self, band: float) -> dict[str, float]:
        """Return the force [N] across two rigid arcs of a ring that a squeeze leaves undetermined.

        A centre in touch with both arcs, up to a length, may be anywhere within y across them,
        where ε y + y²/2a is that length and ε the angle of the wedge; so the directions of the two
        forces are known only to y/a. The length is the overlap or opening of the two arcs. If the
        narrowest place of the wedge, ε²a/8 past its mouth, overlaps by less than the band [m], the
        length is the band: a float that a large squeeze seems to hold would roll away through that
        place. Neighbours that give way follow the float instead.
        """
        forces = self.answer.ring_force
        found = {}
        for ring in self.train.drums:
            gives_way = any(self.train.gears[n].moves for n in ring.neighbours)
            if gives_way or not math.isinf(ring.stiffness):
                continue
            arcs = [self.situation.arc(ring, side) for side in (0, 1)]
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
            reaction = np.asarray(self.answer.radial_reaction[ring.name])
            offset = self.moved(ring.gear) - ring.offset
            law = round_ring_law(*_tangent(ring, float(np.linalg.norm(offset))))
            found.append(Pull(ring.name, ring.gear, law, offset, ring.offset, reaction, True))
        return tuple(found)

    def _slipping(self, spline: Spline, before: Vector) -> list[Pull]:
        """Return friction and clearance of a spline that remembers its slip."""
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
        """Return the slip s (3,) [m] of a spline with memory: p less the bending of its shaft."""
        return np.asarray(self.moved(spline.gear) - self.bending(spline))

    def bending(self, spline: Spline) -> Vector:
        """Return the bending p − s (3,) [m] of a shaft with memory at its claimed force."""
        names = (spline.name, spline.stop_name)
        force = sum(np.asarray(self.answer.radial_reaction[name]) for name in names)
        return np.asarray(-force / spline.bending_stiffness)

    def winds(self) -> Iterator[tuple[str, float, float]]:
        """Yield every shaft with its wind-up φ_a − φ_b − clocking [rad] and its torque [N·m].

        The torque of a rigid shaft is not claimed: it balances the gears beyond the shaft.
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
        """The rigid shafts, and the gears beyond each."""
        return rigid_shafts(self.train)

    def outside(self) -> Iterator[tuple[str, Vector, float]]:
        """Forces from outside: gear, force [N], moment [N·m]; a pin passes them to the carrier."""
        for (name, gear), force in zip(
            self.train.gears.items(), self.situation.push[0], strict=True
        ):
            yield name, force, 0.0
            if gear.carrier is not None:
                held = self.train.gears[gear.carrier]
                arm = np.cross(gear.centre - held.centre, force)
                yield gear.carrier, force, held.sense * float(held.axis @ arm)

    @cached_property
    def moment(self) -> dict[str, float]:
        """Moment [N·m] of the load, the flanks and the elastic shafts on every gear."""
        train, answer = self.train, self.answer
        moment = {g: self.situation.torques[g] for g in train.gears}
        for mesh in train.meshes.values():
            for drive in mesh.flanks:
                force = answer.flank_force[mesh.flank_name(drive)]
                along = 1.0 if drive else -1.0
                moment[mesh.driver] -= along * mesh.senses[0] * mesh.radii[0] * force
                moment[mesh.driven] += along * mesh.senses[1] * mesh.radii[1] * force
                push = force * mesh.direction(drive)[2]
                for end, on_it in ((mesh.driver, -push), (mesh.driven, push)):
                    if (carrier := train.gears[end].carrier) is not None:
                        held = train.gears[carrier]
                        arm = train.gears[end].centre - held.centre
                        moment[carrier] += held.sense * float(held.axis @ np.cross(arm, on_it))
        for name, shaft in train.shafts.items():
            if not math.isinf(shaft.stiffness):
                wind = answer.rotation[shaft.first] - answer.rotation[shaft.second]
                torque = answer.shaft_torque.get(name, shaft.stiffness * (wind - shaft.clocking))
                moment[shaft.first] -= torque
                moment[shaft.second] += torque
        for gear, _, due in self.outside():
            moment[gear] += due
        return moment

    def bearings(self) -> Iterator[tuple[str, Vector, Vector, Vector]]:
        """Yield gears that can be displaced: p [m], stiffness [N/m] and bearing force [N], (2,)."""
        for name, gear in self.train.gears.items():
            if gear.support is not None:
                moved = gear.frame @ self.moved(name)
                force = self.answer.support_force.get(name, gear.support * moved)
                yield name, moved, gear.support, np.asarray(force)

    def transmitted(self, gear: str) -> float:
        """Return the torque [N·m] that a gear transmits through its shaft or spline."""
        return self.train.transmitted(gear, self.answer.flank_force)

    @cached_property
    def finite(self) -> bool:
        """Whether every claimed figure is finite."""
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
        """Reason why the claim cannot be judged, else empty.

        A figure is not a number, a spline has no law, or a gear is beyond the neighbour on whose
        ring its own ring rolls: the arc's inequality holds there, but no gear can be there.
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
        balance, and would hide an imbalance elsewhere.
        """
        gears = self.train.gears
        forces = [abs(f) for f in self.answer.flank_force.values()]
        forces += [abs(t) / gears[g].base_radius for g, t in self.situation.torques.items()]
        forces += np.abs(self.situation.push[0]).ravel().tolist()
        return max(forces, default=0.0) or 1.0

    @cached_property
    def length_scale(self) -> float:
        """Deflection of the case [m]: largest compression, gap taken up, or error; 1 µm when none.

        Displacements do not count, because a free one could be claimed to be arbitrarily large.
        """
        closed = [p for p in self._flanks() if p.force > CERTIFY.band * self.force_scale]
        lengths = [p.law.compression(p.force) for p in closed]
        lengths += [abs(p.at_rest) for p in closed]
        lengths += np.linalg.norm(self.situation.offset[0], axis=1).tolist()
        return max(lengths, default=0.0) or 1e-6

    @cached_property
    def resolution(self) -> float:
        """Round-off of a length [m]: sixteen times that of displacements, errors and gaps."""
        gears, here = self.train.gears, self.situation
        moved = [abs(f) * gears[g].base_radius for g, f in self.answer.rotation.items()]
        moved += [float(np.abs(self.moved(g)).max()) for g in gears]
        positions, still = self.train.flank_positions(self.answer.index), np.zeros(3)
        gaps = [
            abs(approach(mesh, drive, positions[mesh.flank_name(drive)], (0.0, 0.0), still))
            for mesh in self.train.meshes.values()
            for drive in mesh.flanks
        ]
        gaps += [limit for ring in self.train.drums for limit in (ring.up, ring.down)]
        errors = float(np.abs(here.offset[0]).max(initial=0.0))
        largest = max(moved, default=0.0) + errors + max(gaps, default=0.0)
        return 16.0 * float(np.finfo(float).eps) * largest


ROUNDED = 16.0 * float(np.finfo(float).eps)
"""Rounding of energies, relative to the sum of their magnitudes."""


def force_balance(state: ClaimedState) -> dict[str, float]:
    """Return the unbalanced force [N] on gears that can be displaced."""
    train = state.train
    total = {name: -force @ train.gears[name].frame for name, _, _, force in state.bearings()}
    for push in state.pushes:
        for gear, sign in ((push.pushed, 1.0), (push.pushing, -1.0)):
            bodies = [gear] if gear is None or push.gear else [gear, train.gears[gear].carrier]
            for body in bodies:
                if body in total:
                    total[body] = total[body] + sign * push.force * push.normal
    for pull in state.pulls:
        total[pull.gear] = total[pull.gear] + pull.reaction
    for body, outside, _ in state.outside():
        if body in total:
            total[body] = total[body] + outside
    return {g: float(np.linalg.norm(train.gears[g].frame @ f)) for g, f in total.items()}


def moment_balance(state: ClaimedState) -> dict[str, float]:
    """Return the unbalanced moment over base radius [N] on each group of gears that turn as one."""
    train = state.train
    unbalanced = {}
    for group in state.rigid.paths:
        if not set(train.held) & set(group):
            radius = max(train.gears[g].base_radius for g in group)
            unbalanced[next(iter(group))] = abs(math.fsum(state.moment[g] for g in group)) / radius
    return unbalanced


def penetration(state: ClaimedState) -> dict[str, float]:
    """Return the overlap [m] of contacts beyond the compression under the claimed force."""
    overlaps = {}
    for push in state.pushes:
        overlap = push.approach - push.law.compression(max(push.force, 0.0))
        overlaps[push.name] = overlap - state.resolution
    for pull in state.pulls:
        overlaps[pull.name] = float(np.linalg.norm(pull.offset)) - pull.law.reach - state.resolution
    return overlaps


def complementarity(state: ClaimedState) -> dict[str, float]:
    """Return the work [J] of a force over an open gap, by contact."""
    return {
        p.name: p.force * (p.law.compression(max(p.force, 0.0)) - p.approach)
        - abs(p.force) * state.resolution
        for p in state.pushes
    }


def deformation_law(state: ClaimedState, band: float) -> dict[str, float]:
    """Return the misfit [m] of compressed contacts, shafts and bearings with their laws.

    Parameters
    ----------
    state : ClaimedState
    band : float
        Force [N] below which a contact counts as open; complementarity judges it then.
    """
    misfits = {
        p.name: abs(p.approach - p.law.compression(p.force)) for p in state.pushes if p.force > band
    }
    for name, wind, torque in state.winds():
        shaft = state.train.shafts[name]
        lag = abs(wind - torque / shaft.stiffness)
        misfits[name] = lag * state.train.gears[shaft.first].base_radius
    for name, moved, stiffness, force in state.bearings():
        held = stiffness > 0.0
        off = (moved - force / np.where(held, stiffness, 1.0))[held]
        misfits[f"bearing {name}"] = float(np.linalg.norm(off))
    for name, gear in state.train.gears.items():
        allowed = np.zeros(3)
        if gear.support is not None:
            allowed = (gear.frame @ state.moved(name)) @ gear.frame
        misfits[f"gear {name}"] = float(np.linalg.norm(state.moved(name) - allowed))
    for held in state.train.held:
        turned = state.answer.rotation[held] * state.train.gears[held].base_radius
        misfits[f"gear {held} rotation"] = abs(turned)
    return {name: misfit - state.resolution for name, misfit in misfits.items()}


def cone_membership(state: ClaimedState, band: float) -> dict[str, float]:
    """Return the excess [N] of forces over those that their contacts or graphs admit.

    Parameters
    ----------
    state : ClaimedState
    band : float
        Radius [m] within which a graph's corner admits its whole step.
    """
    excess, band = {p.name: -p.force for p in state.pushes}, band + state.resolution
    for name, _, stiffness, force in state.bearings():
        excess[f"bearing {name}"] = float(np.linalg.norm(force[stiffness == 0.0]))
    excess |= state.squeezes(band)
    for pull in state.pulls:
        radius = float(np.linalg.norm(pull.offset))
        size = float(np.linalg.norm(pull.reaction))
        low, high = interval(pull.law, radius, band)
        along = size
        # Within the band the force has no direction; along the gear's axis it never acts.
        frame = state.train.gears[pull.gear].frame
        lifting = float(np.linalg.norm(pull.reaction - frame.T @ (frame @ pull.reaction)))
        sideways = 0.0
        if radius > band:
            outward = pull.offset / radius
            along = -float(pull.reaction @ outward)
            sideways = float(np.linalg.norm(pull.reaction + along * outward))
            sideways -= size * band / radius
        excess[pull.name] = max(low - along, along - high, sideways, lifting)
    return excess


def energy_gap(state: ClaimedState) -> dict[str, float]:
    """Return potential minus complementary energy [J], beyond rounding: zero at an equilibrium.

    Bearings and rings may store far more energy against one another than the load supplies.
    """
    primal, dual = [], []
    for gear, torque in state.situation.torques.items():
        primal.append(-torque * state.answer.rotation[gear])
    for gear, force, moment in state.outside():
        work = float(force @ state.answer.displacement[gear])
        primal.append(-work - moment * state.answer.rotation[gear])
    for push in state.pushes:
        primal.append(push.law.energy(push.approach))
        dual += [-released(push.law, max(push.force, 0.0)), push.force * push.at_rest]
    for name, wind, torque in state.winds():
        shaft = state.train.shafts[name]
        if not math.isinf(shaft.stiffness):
            primal.append(0.5 * shaft.stiffness * wind**2)
        dual += [-0.5 * torque**2 / shaft.stiffness, -torque * shaft.clocking]
    for _, moved, stiffness, force in state.bearings():
        primal.append(0.5 * float(stiffness @ moved**2))
        held = stiffness > 0.0
        dual.append(-0.5 * float((force[held] ** 2 / stiffness[held]).sum()))
    for spline in state.train.splines.values() if state.train.slip is not None else ():
        bent = float(np.linalg.norm(state.bending(spline)))
        energy = 0.5 * spline.bending_stiffness * bent**2
        primal.append(energy)
        dual.append(-energy)
    for pull in state.pulls:
        # Cone membership judges a force that exceeds a graph's strength.
        size = min(float(np.linalg.norm(pull.reaction)), pull.law.strength)
        primal.append(pull.law.energy(float(np.linalg.norm(pull.offset))))
        dual += [-complementary(pull.law, size), float(pull.reaction @ pull.centre)]
    forces = [abs(p.force) for p in state.pushes]
    forces += [float(np.linalg.norm(p.reaction)) for p in state.pulls]
    rounding = ROUNDED * math.fsum(map(abs, (*primal, *dual))) + state.resolution * math.fsum(
        forces
    )
    gap = abs(math.fsum(primal) - math.fsum(dual))
    return {"the whole train": max(gap - rounding - _unresolved(state), 0.0)}


def _unresolved(state: ClaimedState) -> float:
    """Return the energy [J] of the rounding of lengths: K s (|d| + s), as in the certificate."""
    step, found = state.resolution, 0.0
    for push in state.pushes:
        if push.approach > -step and isinstance(push.law, PowerLaw) and not push.law.is_rigid:
            force = max(push.force, 0.0)
            off = abs(push.approach - push.law.compression(force))
            found += step * (off + step) / push.law.tangent(force)[0]
    for name, wind, torque in state.winds():
        shaft = state.train.shafts[name]
        if not math.isinf(shaft.stiffness):
            turn = step / state.train.gears[shaft.first].base_radius
            lag = abs(wind - torque / shaft.stiffness)
            found += shaft.stiffness * turn * (lag + turn)
    for _, moved, stiffness, force in state.bearings():
        held = stiffness > 0.0
        lag = np.abs(moved[held] - force[held] / stiffness[held])
        found += step * float((stiffness[held] * (lag + step)).sum())
    for pull in state.pulls:
        radius = float(np.linalg.norm(pull.offset))
        found += pull.law.energy(radius + step) - pull.law.energy(max(radius - step, 0.0))
    return found


@dataclass(frozen=True)
class Figures:
    """A residual: the figures of all elements in `unit`, and the scale of the case."""

    elements: dict[str, float]
    unit: str
    scale: float

    @property
    def worst(self) -> float:
        """Largest figure, not below zero; infinite if any figure is not a number."""
        values = [*self.elements.values(), 0.0]
        return math.inf if any(map(math.isnan, values)) else max(values)

    @property
    def scaled(self) -> float:
        """The largest figure over the scale."""
        return self.worst / self.scale


def judged(train: Train, answer: Equilibrium) -> dict[str, Figures]:
    """Return all residuals of a claim; infinite, with the reason, if it cannot be judged."""
    state = ClaimedState(train, answer)
    if state.fault:
        return {name: Figures({state.fault: math.inf}, unit, 1.0) for name, unit in UNITS.items()}
    load, deflection = state.force_scale, state.length_scale
    scale = {"N": load, "m": deflection, "J": load * deflection}
    found = {
        "force_balance": force_balance(state),
        "moment_balance": moment_balance(state),
        "penetration": penetration(state),
        "complementarity": complementarity(state),
        "deformation_law": deformation_law(state, CERTIFY.band * load),
        "cone_membership": cone_membership(state, CERTIFY.band * deflection),
        "energy_gap": energy_gap(state),
    }
    return {name: Figures(found[name], unit, scale[unit]) for name, unit in UNITS.items()}


UNITS = {
    "force_balance": "N",
    "moment_balance": "N",
    "penetration": "m",
    "complementarity": "J",
    "deformation_law": "m",
    "cone_membership": "N",
    "energy_gap": "J",
}
"""The residuals and their units."""


def _tangent(ring: RoundRing, radius: float) -> tuple[float, float]:
    """Return where the tangent of a ring's wall at a radius begins [m], and its slope [N/m]."""
    gap = max(radius - ring.radius, (ring.radius or 1.0) * EPS)
    force = ring.stiffness * gap**ring.power
    if ring.power == 1.0:
        return ring.radius, ring.stiffness
    slope = ring.power * force / gap
    return ring.radius + gap - force / slope, slope


def interval(law: RadialLaw, radius: float, band: float = 0.0) -> tuple[float, float]:
    """Return the forces [N] that the graph admits within `band` [m] about `radius` [m].

    So an answer on a corner, up to round-off, is judged by the whole step. On a steep piece, it is
    judged by its place rather than by the force that round-off of the place would give.
    """
    low, high = math.inf, 0.0
    begin = 0.0
    for piece in law.pieces:
        end = begin + piece.length
        if begin - band <= radius <= end + band:
            slope = piece.stiffness
            for place in (radius - band, radius + band):
                inner = min(max(place, begin), end) - begin
                here = piece.force + (slope * inner if slope else 0.0)
                low, high = min(low, here), max(high, here)
        begin = end
    if radius <= band:
        low = 0.0
    if radius >= begin - band:
        low, high = min(low, law.pieces[-1].end_force), math.inf
    return low, high


def released(law: Law, force: float) -> float:
    """Return the complementary energy ∫δ dF [J] of a contact; a table's, by trapezoids."""
    if isinstance(law, PowerLaw):
        return 0.5 * law.b * force**2 + 0.6 * law.c * math.cbrt(force) ** 5
    forces = [*(f for f in law.forces if f < force), force]
    return float(np.trapezoid([law.compression(f) for f in forces], forces))


def complementary(law: RadialLaw, force: float) -> float:
    """Return the conjugate energy sup_R (F R − W(R)) [J], exact for every piece."""
    total = 0.0
    for piece in law.pieces:
        over = force - piece.force
        if over <= 0.0:
            continue
        if piece.stiffness > 0.0 and over <= piece.stiffness * piece.length:
            total += over**2 / (2.0 * piece.stiffness)
        elif math.isinf(piece.length):
            return math.inf
        else:
            total += over * piece.length - 0.5 * piece.stiffness * piece.length**2
    return total
