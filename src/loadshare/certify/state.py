"""Claims seen as mechanics: approaches, forces and graphs of every element, body by body.

Nothing here knows of programmes or rows. Forces are vectors that act on centres, moments are force
times base radius, and each contact is judged at the displaced position.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from loadshare.certify.graphs import Graph
from loadshare.certify.laws import area, interpolated, strain_energy
from loadshare.certify.mechanics import Mechanics
from loadshare.contact.radial import ROUNDING
from loadshare.train.equilibria import Equilibria
from loadshare.train.situations import Situations

Array = NDArray[np.float64]


class State:
    """S claims at the positions where they stand.

    The samples are the last axis of every array, next to one another in memory: sums and largest
    values over a few elements then run along the samples, which is several times faster. Elements
    stand in the order of `Mechanics`.

    Parameters
    ----------
    mechanics : Mechanics
    situations : Situations
    answers : Equilibria

    Attributes
    ----------
    of : Mechanics
    here : Situations
    claim : Equilibria
    count : int
        S.
    force, approach, at_rest, compression : ndarray, shape (contacts, S)
        Claimed force [N], approach, what remains of it when all coordinates of its tangent plane
        are zero, compression at the claimed force [m].
    primal, dual : ndarray, shape (contacts, S)
        Strain energy at the approach, complementary energy at the force [J].
    way : ndarray, shape (drums, 2, 3, S)
        From each neighbour's centre to the limited gear's [m].
    ring_force : ndarray, shape (drums, 4, S)
        Of both arcs and both stops [N].
    bend : ndarray, shape (splines, 3, S)
        p − s of splines with memory, whose slip s is what the bending of their shafts leaves of
        the displacement p [m].
    offset, reaction : ndarray, shape (radials, 3, S)
        Way from a radial element's centre [m], its force on the gear [N].
    graph : Graph
        Of the radial elements.
    moment : ndarray, shape (gears, S)
        Of the load, flanks and elastic shafts on each gear [N·m].
    load, deflection : ndarray, shape (S,)
        Scales [N], [m].
    beyond : ndarray of bool, shape (drums, 2, S)
        Whether a gear stands beyond the neighbour on whose ring its own rolls: there the arc's
        inequality holds, and no gear can be.
    lawless : ndarray of bool, shape (splines, S)
        Whether a spline has no law.
    """

    @np.errstate(all="ignore")
    def __init__(self, mechanics: Mechanics, situations: Situations, answers: Equilibria) -> None:
        self.of = mechanics
        self.here, self.claim = situations.mapped(_samples_last), answers.mapped(_samples_last)
        self.count = len(answers.rotation)
        self.force = self.claim.flank_force
        self._put_flanks()
        self._put_scales()
        self.moment = self._moments()
        self.beyond = np.zeros((0, 2, self.count), dtype=bool)
        self.ring_force = np.zeros((0, 4, self.count))
        if len(mechanics.drum):
            self._put_drums()
        self.lawless = np.zeros((0, self.count), dtype=bool)
        if mechanics.pulls:
            self._put_radials()

    def _put_flanks(self) -> None:
        of, here, claim = self.of, self.here, self.claim
        gap = np.where(of.is_drive[:, None], here.gap[of.mesh_of], here.backlash[of.mesh_of])
        offset, moved = (v.reshape(-1, v.shape[-1]) for v in (here.offset, claim.displacement))
        self.at_rest = of.pushing @ offset - gap
        self.approach = of.turning @ claim.rotation
        self.approach += of.pushing @ moved
        self.approach += self.at_rest
        b, c = here.bending[of.mesh_of], here.hertz[of.mesh_of]
        positive = np.maximum(self.force, 0.0)
        root = np.zeros_like(positive)
        if c.any():
            np.cbrt(positive, out=root, where=positive > 0.0)
        square = root * root
        self.compression = b * positive + c * square
        self.dual = 0.5 * b * positive**2 + 0.6 * c * (square * square * root)
        self.primal = strain_energy(b, c, self.approach, root)
        for e in of.tabled:
            self._tabulate(e, positive[e])

    def _tabulate(self, e: int, force: Array) -> None:
        """Compression and energies of a tabulated flank."""
        forces, compressions = (
            np.broadcast_to(t, (len(t), self.count)) for t in self.here.table[self.of.mesh_of[e]]
        )
        self.compression[e] = interpolated(forces, compressions, force)
        self.dual[e] = area(forces, compressions, force)
        approach = np.maximum(self.approach[e], 0.0)
        true = np.where(approach > 0.0, interpolated(compressions, forces, approach), 0.0)
        self.primal[e] = true * approach - area(forces, compressions, true)

    def _put_scales(self) -> None:
        """Load: the largest flank force or external push; 1 N when nothing acts.

        Deflection: the largest compression, gap taken up, or error; 1 µm when none. Reactions of
        rigid limits and displacements do not count: any preload of two opposite stops would be in
        balance and would hide what is not, and a free displacement could be claimed as large as one
        likes.
        """
        pushed = (np.abs(self.here.torque) / self.of.radius[:, None]).max(axis=0, initial=0.0)
        load = np.maximum(np.abs(self.force).max(axis=0, initial=0.0), pushed)
        self.load = np.where(load == 0.0, 1.0, load)
        lengths = np.maximum(self.compression, np.abs(self.at_rest))
        closed = np.where(self.force > 0.0, lengths, 0.0).max(axis=0, initial=0.0)
        shifts = size(self.here.offset).max(axis=0, initial=0.0)
        deflection = np.maximum(closed, shifts)
        self.deflection = np.where(deflection == 0.0, 1e-6, deflection)

    def _moments(self) -> Array:
        of, claim = self.of, self.claim
        moment = of.moment @ self.force
        moment += self.here.torque
        if len(of.elastic):
            moment += of.shaft_moment @ claim.shaft_torque
        return np.asarray(moment)

    def _put_drums(self) -> None:
        of, here, moved = self.of, self.here, self.claim.displacement
        nominal, stops = of.nominal[..., None], 2 * len(of.drum)
        relative = moved[of.drum][:, None] - moved[of.neighbours]
        apart = here.arc_shift + relative
        self.way = nominal + apart
        self.beyond = ~((self.way * nominal).sum(axis=2) > 0.0)
        length = size(self.way, axis=2)
        # Free of cancellation where nothing moves far.
        grown = ((nominal + self.way) * apart).sum(axis=2) / (length + of.distance[..., None])
        rolled = (self.way * relative).sum(axis=2) / length
        across = (of.across[..., None] * moved[of.drum]).sum(axis=1)
        approach, at_rest, force = (np.empty((len(of.drum), 4, self.count)) for _ in range(3))
        approach[:, :2] = -(grown + here.arc_clearance)
        at_rest[:, :2] = rolled + approach[:, :2]
        at_rest[:, 2:] = -here.stop
        approach[:, 2] = across
        approach[:, 3] = -across
        approach[:, 2:] -= here.stop
        force[:, :2] = self.claim.ring_force[stops:].reshape(-1, 2, self.count)
        force[:, 2:] = self.claim.ring_force[:stops].reshape(-1, 2, self.count)
        self.ring_force = force
        wall = here.wall[:, None]
        compression = wall * np.maximum(force, 0.0)
        yields = (wall > 0.0) & (approach > 0.0)
        primal = np.where(yields, 0.5 * approach**2 / np.where(yields, wall, 1.0), 0.0)
        dual = 0.5 * compression * force
        self.at_rest = np.broadcast_to(self.at_rest, self.force.shape)
        self.force, self.approach, self.at_rest, self.compression, self.primal, self.dual = (
            np.concatenate([flanks, rings.reshape(-1, self.count)])
            for flanks, rings in (
                (self.force, force),
                (self.approach, approach),
                (self.at_rest, at_rest),
                (self.compression, compression),
                (self.primal, primal),
                (self.dual, dual),
            )
        )

    def _put_radials(self) -> None:
        of, here, claim = self.of, self.here, self.claim
        splines, rounds = len(of.train.splines), len(of.train.rounds)
        self.reaction = claim.radial_reaction[of.claimed]
        place = claim.displacement[of.pulled]
        zero = np.zeros((rounds, 1))
        graphs = [Graph(zero, zero, zero, here.round_radius, here.round_stiffness)]
        if splines:
            graphs = [*self._spline_graphs(), *graphs]
        if of.train.slip is not None:
            pushed = self.reaction[:splines] + self.reaction[splines : 2 * splines]
            self.bend = -pushed / here.spline[:, :1]
            place[: 2 * splines] -= np.concatenate([self.bend, self.bend])
        self.offset = place - of.centres[..., None]
        self.graph = Graph(
            *(
                np.concatenate([np.broadcast_to(v, (len(v), self.count)) for v in parts])
                for parts in zip(*graphs, strict=True)
            )
        )

    def _spline_graphs(self) -> list[Graph]:
        """Graphs of splines; with memory those of friction and of the stop at the end of the slip.

        With memory there is no step where a spline starts to slip.
        """
        stiffness, given, reach, fixed, per_torque = self.here.spline.swapaxes(0, 1)
        bound = np.where(np.isnan(fixed), per_torque * np.abs(self.transmitted), fixed)
        continuous = bound / stiffness
        free = np.isnan(given)
        stick = np.where(free, continuous, np.minimum(given, continuous))
        self.lawless = stiffness * given > bound * (1.0 + ROUNDING)
        self.lawless |= ~free & (reach < stick)
        if self.of.train.slip is None:
            stick = np.where((reach < stick) & free, np.inf, stick)
            return [Graph(stiffness, stick, bound, reach, stiffness)]
        self.lawless |= stiffness * given < bound * (1.0 - ROUNDING)
        zero, endless = np.zeros_like(bound), np.full_like(bound, np.inf)
        room = np.maximum(reach - continuous, 0.0)
        return [Graph(zero, zero, bound, endless, endless), Graph(zero, zero, zero, room, endless)]

    @cached_property
    def transmitted(self) -> Array:
        """Torque that each spline's gear takes over it [N·m], shape (splines, S)."""
        return np.asarray(self.of.spline_moment @ self.claim.flank_force)

    @cached_property
    def overlap(self) -> Array:
        """Approach less compression [m], shape (contacts, S)."""
        return np.asarray(self.approach - self.compression)

    @cached_property
    def radius(self) -> Array:
        """Size of the offset of every radial element [m], shape (radials, S)."""
        return size(self.offset)

    @cached_property
    def arc_push(self) -> Array:
        """Force of every arc on its drum's gear [N], shape (drums, 2, 3, S)."""
        force = self.ring_force[:, :2]
        return np.asarray(self.way * (force / size(self.way, axis=2))[:, :, None])

    @cached_property
    def stop_push(self) -> Array:
        """Force of both stops on every drum's gear [N], shape (drums, 3, S)."""
        pressed = self.ring_force[:, 3] - self.ring_force[:, 2]
        return np.asarray(self.of.across[..., None] * pressed[:, None])

    @cached_property
    def wind(self) -> Array:
        """Wind-up φ_first − φ_second − clocking [rad], shape (shafts, S)."""
        ends = self.claim.rotation[self.of.shaft]
        return np.asarray(ends[:, 0] - ends[:, 1] - self.here.clocking)

    @cached_property
    def torque(self) -> Array:
        """Torque of every shaft [N·m], shape (shafts, S).

        That of a rigid one is nobody's claim: it is what balances the gears beyond it.
        """
        found = self.of.beyond @ self.moment
        found[self.of.elastic] = self.claim.shaft_torque[self.of.elastic]
        return np.asarray(found)

    @cached_property
    def moved(self) -> Array:
        """Displacements in the frames of the gears that can be displaced [m], (moving, 2, S)."""
        return np.asarray(self.of.frames @ self.claim.displacement[self.of.moving])

    @cached_property
    def support(self) -> tuple[Array, Array]:
        """Stiffness of the bearings that can yield [N/m], their force [N], (moving, 2, S or 1)."""
        moving = self.of.moving
        return self.here.support[moving], self.claim.support_force[moving]

    @cached_property
    def faulty(self) -> NDArray[np.bool_]:
        """Whether a claim cannot be judged, shape (S,).

        A figure is not a number, a spline has no law, or a gear stands beyond its neighbour.
        """
        bad = self.lawless.any(axis=0) | self.beyond.any(axis=(0, 1))
        for claimed in self.claim.arrays:
            bad = bad | ~np.isfinite(claimed.reshape(-1, self.count).sum(axis=0))
        return np.asarray(bad)


def size(vectors: Array, axis: int = 1) -> Array:
    """Lengths of vectors along an axis."""
    return np.asarray(np.sqrt((vectors**2).sum(axis=axis)))


_AXES = {dimensions: (*range(1, dimensions), 0) for dimensions in range(1, 6)}


def _samples_last(array: Array) -> Array:
    return np.ascontiguousarray(array.transpose(_AXES[array.ndim]))
