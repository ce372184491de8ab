"""Answers on the bench: approaches and forces of every element, in S samples."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from loadshare.certify.many.graphs import Graph
from loadshare.certify.many.laws import area, interpolated, strain_energy
from loadshare.certify.many.layout import flat, lying, size, times
from loadshare.train.equilibria import Equilibria
from loadshare.train.radial import ROUNDING
from loadshare.train.situations import Situations

if TYPE_CHECKING:
    from loadshare.certify.many.judge import Judge

Array = NDArray[np.float64]


class Pull(NamedTuple):
    """A radial element."""

    gear: int  # number
    graph: Graph
    offset: Array  # (S, 3): of the gear's centre from the element's [m]
    centre: Array  # (3,): of the element [m]
    reaction: Array  # (S, 3): force on the gear, as claimed [N]


class Wind(NamedTuple):
    """A shaft. The torque of a rigid one is what balances the gears beyond it."""

    first: int  # number of the gear
    angle: Array  # (S,): φ_first − φ_second − clocking [rad]
    torque: Array  # (S,): as claimed, for an elastic one [N·m]
    stiffness: Array  # (S or 1,) [N·m/rad]
    clocking: Array  # (S or 1,) [rad]
    is_elastic: bool


class Bearing(NamedTuple):
    """What holds a gear that can be displaced."""

    gear: int  # number
    frame: Array  # (2, 3)
    moved: Array  # (S, 2): displacement in the frame [m]
    stiffness: Array  # (S or 1, 2) [N/m]
    force: Array  # (S, 2): as claimed [N]


class Bench:
    """Claimed equilibria, and what follows from them at the positions where they stand.

    All arrays are laid out as `layout` says.

    Parameters
    ----------
    judge : Judge
    situations : Situations
    answers : Equilibria

    Attributes
    ----------
    force, approach, at_rest, compression, dual, primal : ndarray, shape (S, flanks)
        Claimed force [N], approach, what remains of it when nothing turns or moves, compression at
        the claimed force [m]; complementary energy at the force, strain energy at the approach [J].
    ring_force, ring_approach, ring_at_rest, ring_wall : ndarray, shape (S, contacts)
        The same of drums, all stops and then all arcs; and their compliance [m/N].
    ring_push : ndarray, shape (S, gears, 3)
        Sum of their forces on each gear [N].
    pulls, winds, bearings : list of Pull, Wind, Bearing
    moment : ndarray, shape (S, gears)
        Of the load, flanks and elastic shafts on each gear [N·m].
    fault : ndarray of bool, shape (S,)
        Whether a law has no meaning, or a gear stands beyond a ring's neighbour (see `State`).
    load, deflection : ndarray, shape (S,)
        Scales [N], [m] (see `State`).
    """

    def __init__(self, judge: Judge, situations: Situations, answers: Equilibria) -> None:
        self.of, self.train = judge, judge.train
        self.situations, self.answers = situations.laid(lying), answers.laid(lying)
        self.count = len(answers.rotation)
        self.force = self.answers.flank_force
        self._flanks()
        self._scales()
        self.fault = np.zeros(self.count, dtype=bool)
        self._ring_contacts()
        self.pulls = list(self._pulls())
        self.moment = self._moments()
        self.winds = list(self._winds())
        self.bearings = list(self._bearings())

    def _flanks(self) -> None:
        of, situations, answers = self.of, self.situations, self.answers
        offset, moved = flat(situations.offset), flat(answers.displacement)
        gap = np.where(
            of.is_drive, situations.gap[:, of.mesh_of], situations.backlash[:, of.mesh_of]
        )
        self.at_rest = times(offset, of.flat_pushing) - gap
        self.approach = times(answers.rotation, of.turning) + self.at_rest
        self.approach += times(moved, of.flat_pushing)
        b, c = situations.bending[:, of.mesh_of], situations.hertz[:, of.mesh_of]
        positive = np.maximum(self.force, 0.0)
        root = np.zeros_like(positive)
        if c.any():
            np.cbrt(positive, out=root, where=positive > 0.0)
        square = root * root
        self.compression = b * positive + c * square
        self.dual = 0.5 * b * positive**2 + 0.6 * c * (square * square * root)
        self.primal = strain_energy(b, c, self.approach, root)
        for e, mesh in of.tabled:
            self._tabulate(e, mesh, positive[:, e])

    def _tabulate(self, e: int, mesh: int, force: Array) -> None:
        """Compression and energies of a tabulated flank."""
        table = self.situations.table[:, mesh]
        forces, compressions = (
            np.broadcast_to(t, (self.count, t.shape[1])) for t in (table[:, 0], table[:, 1])
        )
        self.compression[:, e] = interpolated(forces, compressions, force)
        self.dual[:, e] = area(forces, compressions, force)
        approach = np.maximum(self.approach[:, e], 0.0)
        true = np.where(approach > 0.0, interpolated(compressions, forces, approach), 0.0)
        self.primal[:, e] = true * approach - area(forces, compressions, true)

    def _scales(self) -> None:
        pushed = (np.abs(self.situations.torque) / self.of.radius).max(axis=1, initial=0.0)
        load = np.maximum(np.abs(self.force).max(axis=1, initial=0.0), pushed)
        self.load = np.where(load == 0.0, 1.0, load)
        closed = self.force > 0.0
        lengths = np.maximum(self.compression, np.abs(self.at_rest))
        lengths = np.where(closed, lengths, 0.0).max(axis=1, initial=0.0)
        shifts = np.sqrt((self.situations.offset**2).sum(axis=2)).max(axis=1, initial=0.0)
        deflection = np.maximum(lengths, shifts)
        self.deflection = np.where(deflection == 0.0, 1e-6, deflection)

    def _ring_contacts(self) -> None:
        situations, order = self.situations, self.of.order
        moved = self.answers.displacement
        self.ring_force = self.answers.ring_force
        self.ring_push = lying(np.zeros(moved.shape))
        approach, at_rest, wall = [], [], []
        number = 0
        for d, ring in enumerate(self.train.drums):
            across = moved[:, order[ring.gear]] @ ring.across
            for side, sign in ((0, 1.0), (1, -1.0)):
                limit = situations.stop[:, d, side]
                approach.append(sign * across - limit)
                at_rest.append(-limit + np.zeros(self.count))
                wall.append(situations.wall[:, d] + np.zeros(self.count))
                force = self.ring_force[:, number]
                self.ring_push[:, order[ring.gear]] -= sign * force[:, None] * ring.across
                number += 1
        for d, ring in enumerate(self.train.drums):
            for side, neighbour in enumerate(ring.neighbours):
                nominal = self.of.nominal[d][side]
                relative = moved[:, order[ring.gear]] - moved[:, order[neighbour]]
                apart = situations.arc_shift[:, d, side] + relative
                here = nominal + apart
                self.fault |= ~(here @ nominal > 0.0)
                length = size(here)
                grown = 2.0 * apart @ nominal + (apart**2).sum(axis=1)
                distance = math.sqrt(nominal @ nominal)
                margin = grown / (length + distance) + situations.arc_clearance[:, d, side]
                normal = here / length[:, None]
                force = self.ring_force[:, number]
                approach.append(-margin)
                at_rest.append((normal * relative).sum(axis=1) - margin)
                wall.append(situations.wall[:, d] + np.zeros(self.count))
                self.ring_push[:, order[ring.gear]] += force[:, None] * normal
                self.ring_push[:, order[neighbour]] -= force[:, None] * normal
                number += 1
        none = np.zeros((self.count, 0))
        self.ring_approach, self.ring_at_rest, self.ring_wall = (
            np.stack(v).T if v else none for v in (approach, at_rest, wall)
        )

    def _pulls(self) -> Iterator[Pull]:
        """Round rings, then splines; a law without meaning is a fault of its sample."""
        situations, order = self.situations, self.of.order
        moved, reaction = self.answers.displacement, self.answers.radial_reaction
        zero = np.zeros(self.count)
        for q, ring in enumerate(self.train.rounds):
            gear = order[ring.gear]
            radius, stiffness = situations.round_radius[:, q], situations.round_stiffness[:, q]
            graph = Graph(zero, zero, zero, radius + zero, stiffness + zero)
            yield Pull(gear, graph, moved[:, gear] - ring.offset, ring.offset, reaction[:, q])
        for k, name in enumerate(self.train.splines):
            gear = order[name]
            stiffness, given, reach, fixed, per_torque = situations.spline[:, k].T
            torque = np.abs(self.force @ -self.of.moment[:, gear])
            bound = np.where(np.isnan(fixed), per_torque * torque, fixed)
            continuous = bound / stiffness
            stick = np.where(np.isnan(given), continuous, np.minimum(given, continuous))
            drops = stiffness * given > bound * (1.0 + ROUNDING)
            self.fault |= drops | (~np.isnan(given) & (reach < stick))
            stick = np.where((reach < stick) & np.isnan(given), np.inf, stick)
            graph = Graph(*(v + zero for v in (stiffness, stick, bound, reach, stiffness)))
            q = len(self.train.rounds) + k
            yield Pull(gear, graph, moved[:, gear], np.zeros(3), reaction[:, q])

    def _moments(self) -> Array:
        order, claimed = self.of.order, self.answers.shaft_torque
        moment = self.situations.torque + times(self.force, self.of.moment)
        for s, shaft in enumerate(self.train.shafts.values()):
            if not math.isinf(shaft.stiffness):
                moment[:, order[shaft.first]] -= claimed[:, s]
                moment[:, order[shaft.second]] += claimed[:, s]
        return moment

    def _winds(self) -> Iterator[Wind]:
        phi, order = self.answers.rotation, self.of.order
        for s, shaft in enumerate(self.train.shafts.values()):
            a, b = order[shaft.first], order[shaft.second]
            clocking = self.situations.clocking[:, s]
            is_elastic = not math.isinf(shaft.stiffness)
            claimed = self.answers.shaft_torque[:, s]
            torque = claimed if is_elastic else self.moment @ self.of.beyond[s]
            stiffness = self.situations.torsion[:, s]
            yield Wind(a, phi[:, a] - phi[:, b] - clocking, torque, stiffness, clocking, is_elastic)

    def _bearings(self) -> Iterator[Bearing]:
        moved, force = self.answers.displacement, self.answers.support_force
        for k, gear in enumerate(self.train.gears.values()):
            if gear.moves:
                held = self.situations.support[:, k]
                yield Bearing(k, gear.frame, times(moved[:, k], gear.frame.T), held, force[:, k])
