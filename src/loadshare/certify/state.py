"""The mechanical state of claims: approaches, forces and graphs of every element, body by body.

Nothing here uses programmes or rows. Forces are vectors that act on centres, moments are force
times base radius, and each contact is judged at the displaced position.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from loadshare.array_types import Array, Flags
from loadshare.certify.graphs import Graph, spline_graphs, wall
from loadshare.certify.laws import area, interpolated, strain_energy
from loadshare.certify.mechanics import Mechanics
from loadshare.settings import CERTIFY
from loadshare.train.equilibria import Equilibria
from loadshare.train.situations import Situations


class ClaimedState:
    """S claims at their positions.

    The samples are the last axis of every array, next to one another in memory: sums and largest
    values over a few elements then run along the samples, which is several times faster. Elements
    are in the order of `Mechanics`.

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
        Claimed force [N], approach, value of its tangent plane at zero coordinates, compression at
        the claimed force [m].
    way : ndarray, shape (drums, 2, 3, S)
        Vector from each neighbour's centre to the limited gear's [m].
    ring_force : ndarray, shape (drums, 4, S)
        Forces of both arcs and both stops [N].
    load, deflection : ndarray, shape (S,)
        Scales [N], [m].
    resolution : ndarray, shape (S,)
        Round-off of a length [m].
    beyond : ndarray of bool, shape (drums, 2, S)
        Whether a gear is beyond the neighbour on whose ring its own rolls: there the arc's
        inequality holds, but no gear can be.
    """

    @np.errstate(all="ignore")
    def __init__(self, mechanics: Mechanics, situations: Situations, answers: Equilibria) -> None:
        self.of = mechanics
        self.here, self.claim = situations.mapped(_samples_last), answers.mapped(_samples_last)
        self.count = len(answers.rotation)
        self.force = self.claim.flank_force
        self._put_flanks()
        self._put_scales()
        self.beyond = np.zeros((0, 2, self.count), dtype=bool)
        self.ring_force = np.zeros((0, 4, self.count))
        if len(mechanics.drum):
            self._put_drums()

    def _put_flanks(self) -> None:
        of, here, claim = self.of, self.here, self.claim
        gap = here.gap
        offset, moved = (v.reshape(-1, v.shape[-1]) for v in (here.offset, claim.displacement))
        self.at_rest = times(of.pushing, offset) - gap
        self._limits = np.abs(gap).max(axis=0, initial=0.0)
        self.approach = times(of.turning, claim.rotation)
        self.approach += times(of.pushing, moved)
        self.approach += self.at_rest
        b, c = here.bending, here.hertz
        positive = np.maximum(self.force, 0.0)
        self._root = np.zeros_like(positive)
        if c.any():
            np.cbrt(positive, out=self._root, where=positive > 0.0)
        self.compression = b * positive + c * (self._root * self._root)
        if len(of.tabled):
            forces, compressions = self._tables
            self.compression[of.tabled] = interpolated(forces, compressions, positive[of.tabled])

    @cached_property
    def _tables(self) -> tuple[Array, Array]:
        """Forces and compressions of the tabulated flanks, shape (tabled, points, S or 1)."""
        tables = self.here.table[self.of.tabled]
        return tables[:, 0], tables[:, 1]

    @cached_property
    def energies(self) -> tuple[Array, Array]:
        """Strain energy at the approach, complementary energy at the force, (contacts, S) [J]."""
        of, here, root = self.of, self.here, self._root
        flanks, tabled = len(root), of.tabled
        approach, positive = self.approach[:flanks], np.maximum(self.force[:flanks], 0.0)
        b, c = here.bending, here.hertz
        square = root * root
        dual = 0.5 * b * positive**2 + 0.6 * c * (square * square * root)
        primal = strain_energy(b, c, approach, root)
        if len(tabled):
            forces, compressions = self._tables
            dual[tabled] = area(forces, compressions, positive[tabled])
            pressed = np.maximum(approach[tabled], 0.0)
            true = np.where(pressed > 0.0, interpolated(compressions, forces, pressed), 0.0)
            primal[tabled] = true * pressed - area(forces, compressions, true)
        if not len(of.drum):
            return primal, dual
        wall = np.repeat(here.wall, 4, axis=0)
        approach, force = self.approach[flanks:], self.force[flanks:]
        yields = (wall > 0.0) & (approach > 0.0)
        pressed = np.where(yields, 0.5 * approach**2 / np.where(yields, wall, 1.0), 0.0)
        released = 0.5 * self.compression[flanks:] * force
        return np.concatenate([primal, pressed]), np.concatenate([dual, released])

    def _put_scales(self) -> None:
        """Find load, deflection and resolution.

        Load: the largest flank force or external push; 1 N when nothing acts. Deflection: the
        largest compression, gap taken up, or error; 1 µm when none. Reactions of rigid limits and
        displacements do not count: any preload of two opposite stops would be in balance and would
        hide what is not, and a free displacement could be claimed arbitrarily large. A contact with
        less force than the band counts as open.

        Resolution: the rounding of a length, as a sum of displacements, errors and gaps in double
        precision. With a play of centimetres it is more than a billionth of a light load's
        deflection; bounds on forces hold all the same.
        """
        pushed = (np.abs(self.here.torque) / self.of.radius[:, None]).max(axis=0, initial=0.0)
        pushed = np.maximum(pushed, np.abs(self.here.push).max(axis=(0, 1), initial=0.0))
        load = np.maximum(np.abs(self.force).max(axis=0, initial=0.0), pushed)
        self.load = np.where(load == 0.0, 1.0, load)
        lengths = np.maximum(self.compression, np.abs(self.at_rest))
        carries = self.force > CERTIFY.band * self.load
        closed = np.where(carries, lengths, 0.0).max(axis=0, initial=0.0)
        shifts = size(self.here.offset).max(axis=0, initial=0.0)
        deflection = np.maximum(closed, shifts)
        self.deflection = np.where(deflection == 0.0, CERTIFY.least_deflection, deflection)
        turned = np.abs(self.claim.rotation) * self.of.radius[:, None]
        moved = np.abs(self.claim.displacement).max(axis=(0, 1), initial=0.0)
        furthest = np.maximum(turned.max(axis=0, initial=0.0), moved)
        limits = np.maximum(self._limits, np.abs(self.here.stop).max(axis=(0, 1), initial=0.0))
        errors = np.abs(self.here.offset).max(axis=(0, 1), initial=0.0)
        self.resolution = CERTIFY.resolution * (furthest + errors + limits)

    @cached_property
    def pushed(self) -> tuple[Array, Array] | None:
        """Moments [N·m] and forces [N] of external forces on gears; None if there are none."""
        return self.of.loaded(self.here.push) if self.here.push.any() else None

    @cached_property
    def moment(self) -> Array:
        """Moment of the load, flanks and elastic shafts on each gear [N·m], shape (gears, S)."""
        of, claim = self.of, self.claim
        moment = times(of.moment, claim.flank_force)
        moment += self.here.torque
        if self.pushed is not None:
            moment += self.pushed[0]
        if len(of.elastic):
            moment += times(of.shaft_moment, claim.shaft_torque)
        return np.asarray(moment)

    def _put_drums(self) -> None:
        of, here, moved = self.of, self.here, self.claim.displacement
        nominal, claimed = of.nominal[..., None], self.claim.ring_force
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
        force[:, :2] = claimed[of.claims.arcs].reshape(-1, 2, self.count)
        force[:, 2:] = claimed[of.claims.stops].reshape(-1, 2, self.count)
        self.ring_force = force
        compression = here.wall[:, None] * np.maximum(force, 0.0)
        self.at_rest = np.broadcast_to(self.at_rest, self.force.shape)
        self.force, self.approach, self.at_rest, self.compression = (
            np.concatenate([flanks, rings.reshape(-1, self.count)])
            for flanks, rings in (
                (self.force, force),
                (self.approach, approach),
                (self.at_rest, at_rest),
                (self.compression, compression),
            )
        )

    @cached_property
    def reaction(self) -> Array:
        """Force of every radial element on its gear [N], shape (radials, 3, S)."""
        return self.claim.radial_reaction

    @cached_property
    def bend(self) -> Array:
        """Bending p − s of the shafts of splines with memory [m], shape (splines, 3, S).

        Their slip s is the displacement p less this bending.
        """
        claims = self.of.claims
        pushed = self.reaction[claims.splines] + self.reaction[claims.spline_stops]
        return np.asarray(-pushed / self.here.spline[:, :1])

    @cached_property
    def centres(self) -> Array:
        """Centre of every radial element [m], shape (radials, 3, S or 1)."""
        rounds, train = self.here.round_offset, self.of.train
        found = np.zeros((len(self.of.pulls), 3, rounds.shape[-1]))
        found[self.of.claims.rounds] = rounds
        if train.slip is not None:
            for q, gear in enumerate(train.splines, self.of.claims.splines.start):
                found[q] = np.reshape(train.slip[gear], (3, 1))
        return found

    @cached_property
    def offset(self) -> Array:
        """Vector from the centre of every radial element [m], shape (radials, 3, S)."""
        place = self.claim.displacement[self.of.pulled]
        if self.of.train.slip is not None:
            for part in (self.of.claims.splines, self.of.claims.spline_stops):
                place[part] -= self.bend
        return np.asarray(place - self.centres)

    @cached_property
    def graph(self) -> Graph:
        """Graphs of the radial elements."""
        zero, here = np.zeros((len(self.of.train.rounds), 1)), self.here
        reach, stiffness = here.round_radius, here.round_stiffness
        if (here.round_power != 1.0).any():
            radius = self.radius[self.of.claims.rounds]
            reach, stiffness = wall(reach, stiffness, here.round_power, radius)
        rings = Graph(zero, zero, zero, reach, stiffness)
        graphs = [rings, *self._spline_graphs[0]]
        return Graph(
            *(
                np.concatenate([np.broadcast_to(v, (len(v), self.count)) for v in parts])
                for parts in zip(*graphs, strict=True)
            )
        )

    @property
    def lawless(self) -> Flags:
        """Whether a spline has no law, shape (splines, S)."""
        return self._spline_graphs[1]

    @cached_property
    def _spline_graphs(self) -> tuple[list[Graph], Flags]:
        train = self.of.train
        if not train.splines:
            return [], np.zeros((0, self.count), dtype=bool)
        numbers = self.here.spline.swapaxes(0, 1)
        return spline_graphs(numbers, self.transmitted, memory=train.slip is not None)

    @cached_property
    def transmitted(self) -> Array:
        """Torque that each spline transmits to its gear [N·m], shape (splines, S)."""
        return times(self.of.spline_moment, self.claim.flank_force)

    @cached_property
    def tangent(self) -> Array:
        """Compliance of every contact at its force [m/N], shape (contacts, S).

        Infinite where a Hertz contact carries nothing; 0 where it follows a table.
        """
        of, here, root = self.of, self.here, self._root
        b, c = here.bending, here.hertz
        with np.errstate(divide="ignore", invalid="ignore"):
            flanks = b + np.where(c > 0.0, 2.0 * c / (3.0 * root), 0.0)
        flanks[of.tabled] = 0.0
        walls = np.repeat(here.wall, 4, axis=0) if len(of.drum) else np.zeros((0, 1))
        return np.concatenate([np.broadcast_to(v, (len(v), self.count)) for v in (flanks, walls)])

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

        That of a rigid shaft is not claimed: it is what balances the gears beyond the shaft.
        """
        found = times(self.of.beyond, self.moment)
        found[self.of.elastic] = self.claim.shaft_torque[self.of.elastic]
        return np.asarray(found)

    @cached_property
    def moved(self) -> Array:
        """Displacements in the frames of the gears that can be displaced [m], (moving, 2, S)."""
        return times(self.of.frames, self.claim.displacement[self.of.moving])

    @cached_property
    def support(self) -> tuple[Array, Array]:
        """Stiffness of the bearings that can yield [N/m], their force [N], (moving, 2, S or 1)."""
        moving = self.of.moving
        return self.here.support[moving], self.claim.support_force[moving]

    @cached_property
    def faulty(self) -> Flags:
        """Whether a claim cannot be judged, shape (S,).

        A figure is not a number, a spline has no law, or a gear is beyond its neighbour.
        """
        bad = self.lawless.any(axis=0) | self.beyond.any(axis=(0, 1))
        for claimed in self.claim.arrays:
            bad = bad | ~np.isfinite(claimed.reshape(-1, self.count).sum(axis=0))
        return np.asarray(bad)


def times(matrix: Array, columns: Array) -> Array:
    """Return the product of a matrix, or of many, with S columns.

    Few columns are each multiplied as if alone, so that no digit depends on the others.
    """
    if not 1 < columns.shape[-1] <= CERTIFY.side_by_side:
        return np.asarray(matrix @ columns)
    alone = np.ascontiguousarray(np.moveaxis(columns, -1, 0))[..., None]
    return np.ascontiguousarray(np.moveaxis((matrix @ alone)[..., 0], 0, -1))


def total(figures: Array) -> Array:
    """Return sums over elements, (elements, S), added one by one even if there is one claim."""
    if figures.shape[1] == 1 and len(figures):
        return np.asarray(np.add.accumulate(figures)[-1])
    return np.asarray(figures.sum(axis=0))


def size(vectors: Array, axis: int = 1) -> Array:
    """Return the lengths of vectors along an axis."""
    return np.asarray(np.sqrt((vectors**2).sum(axis=axis)))


_AXES = {dimensions: (*range(1, dimensions), 0) for dimensions in range(1, 6)}


def _samples_last(array: Array) -> Array:
    return np.ascontiguousarray(array.transpose(_AXES[array.ndim]))
