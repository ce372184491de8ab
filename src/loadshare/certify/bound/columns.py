r"""The mechanics of a train as columns: which force does work on which coordinate.

A claim is a set of coordinates X (rotations times a radius, displacements; all lengths) and of
forces F. Flanks, shafts, bearings and stops are one column each, arcs and radial elements two, the
components of a vector in the transverse frame. Balance and compatibility of the exact equilibrium
are

.. math:: A^T F = f, \qquad A X - g = \delta(F),

with A from the train's geometry alone. It is built here from the train's meshes, not from the
programme that a solver sees, so that a mistake in one shows in the other. Source: formulation,
sections 2 and 16.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate, pairwise
from typing import NamedTuple

import numpy as np

from loadshare.array_types import Array, Flags, Numbers
from loadshare.certify.bound.statics import Statics, force_at_end
from loadshare.certify.bound.twofold import Twofold, quotient, two_product
from loadshare.certify.mechanics import mechanics_of
from loadshare.certify.rigid import rigid_shafts
from loadshare.settings import BOUND
from loadshare.train.equilibria import Names
from loadshare.train.train import Train

UNIT = 0.5 * np.finfo(float).eps
"""Rounding of one operation, relative to its result."""


@dataclass(frozen=True, slots=True)
class Turn:
    """How a gear turns: φ = X/R − lag, or −lag alone where its group is held.

    Attributes
    ----------
    coordinate : int or None
        Number of X.
    radius : float
        R [m], the largest base radius of the gears that turn as one.
    shafts : tuple of (int, float)
        Rigid shafts between the group's first gear and this one, with the sign of their clocking.
    """

    coordinate: int | None
    radius: float
    shafts: tuple[tuple[int, float], ...]


class _Row(NamedTuple):
    """A column: arms of rotations, directions of displacements, and coordinates that add to it."""

    name: str
    turned: Iterable[tuple[str, float]] = ()
    moved: Iterable[tuple[str, Array]] = ()
    unit: Mapping[int, float] = {}


class Columns:
    """The columns of a train.

    Parameters
    ----------
    train : Train

    Attributes
    ----------
    order, moving, elastic_shafts, all_flanks, meshes, tabled
        As in `Mechanics`: `all_flanks` are its flanks, `meshes` the mesh of each.
    coordinates : tuple of str
        Names, "gear rotation" or "gear x", "gear y".
    turns : dict of gear to Turn
    places : dict of gear to int
        First of the two coordinates of a gear that can be displaced.
    slips : dict of gear to int
        First of the two coordinates of the slip of a spline with memory.
    names : tuple of str
        Element of every column.
    flanks, shafts, bearings, stops, arcs, radials, bends : slice
        Columns by kind; arcs and radials in pairs, `bends` the shafts of splines with memory.
    matrix : Twofold
        A, shape (m, n).
    claims : Names
        Order of contacts and radial elements in a claim.
    first_pair, pairs : int
        Column from which on elements have two, and how many such elements there are.
    """

    def __init__(self, train: Train) -> None:
        self.train, self.claims = train, Names(train)
        of = mechanics_of(train)
        self.order, self.moving, self.elastic_shafts = of.order, of.moving, of.elastic
        self.all_flanks, self.meshes = tuple(of.flanks), of.mesh_of
        self.tabled = np.array(of.tabled, dtype=np.intp)
        self.turns, names = _turns(train)
        self.places: dict[str, int] = {}
        self.slips: dict[str, int] = {}
        for gear in train.gears.values():
            if gear.moves:
                self.places[gear.name] = len(names)
                names += [f"{gear.name} x", f"{gear.name} y"]
        for spline in train.splines if train.slip is not None else ():
            self.slips[spline] = len(names)
            names += [f"{spline} slip x", f"{spline} slip y"]
        self.coordinates = tuple(names)
        kinds = list(self._kinds())
        ends = list(accumulate(map(len, kinds), initial=0))
        self.flanks, self.shafts, self.bearings, self.stops, self.bends, self.arcs, self.radials = (
            slice(*pair) for pair in pairwise(ends)
        )
        rows = [row for kind in kinds for row in kind]
        self.names = tuple(row.name for row in rows)
        self.matrix = self._matrix(rows)
        self.first_pair = self.arcs.start
        self.pairs = (len(rows) - self.first_pair) // 2
        self._statics: dict[bytes, Statics] = {}

    def both(self, radial: int) -> slice:
        """Return the columns of a radial element, given its number in a claim."""
        return self.all_of(slice(radial, radial + 1))

    def all_of(self, radials: slice) -> slice:
        """Return the columns of radial elements that follow one another in a claim."""
        start = self.radials.start
        return slice(start + 2 * radials.start, start + 2 * radials.stop)

    @cached_property
    def shaft_arms(self) -> Array:
        """First base radius of every shaft that yields [m]."""
        gears, shafts = self.train.gears, list(self.train.shafts.values())
        return np.array([gears[shafts[k].first].base_radius for k in self.elastic_shafts])

    @cached_property
    def pushed(self) -> Array:
        """Contribution of every external force to f, shape (3 gears, n).

        A pin passes the force on its planet on to the carrier.
        """
        gears = self.train.gears
        part = np.zeros((len(self.order), 3, len(self.coordinates)))
        for name, k in self.order.items():
            carrier = gears[name].carrier
            for body in (name,) if carrier is None else (name, carrier):
                if (at := self.places.get(body)) is not None:
                    part[k, :, at : at + 2] += gears[body].frame.T
            turn = self.turns[carrier] if carrier is not None else None
            if turn is not None and turn.coordinate is not None:
                part[k, :, turn.coordinate] += gears[name].pin_motion / turn.radius
        return part.reshape(-1, len(self.coordinates))

    @cached_property
    def between_fixed(self) -> Flags:
        """Drums whose neighbours cannot be displaced, so that opposed arcs hold the same body."""
        gears = self.train.gears
        return np.array(
            [not any(gears[n].moves for n in r.neighbours) for r in self.train.drums], dtype=bool
        )

    @cached_property
    def moments(self) -> Array:
        """Torque that each spline transmits to its gear per flank force, (splines, flanks) [m]."""
        return mechanics_of(self.train).spline_moment

    @cached_property
    def splined(self) -> Array:
        """Which pairs of columns belong to a spline, 1 or 0, shape (pairs, splines)."""
        found = np.zeros((self.pairs, len(self.train.splines)))
        first = (self.arcs.stop - self.arcs.start) // 2
        for q, k in self.claims.on_splines:
            found[first + q, k] = 1.0
        return found

    @cached_property
    def constants(self) -> Array:
        """Contributions of clockings and centre offsets to lengths, shape (shafts + 3 gears, m)."""
        shafts = list(self.train.shafts.values())
        on = np.zeros((len(shafts) + 3 * len(self.order), len(self.names)))
        for e, to in enumerate(self.train.approaches.values()):
            for gear, arm in to.turning.items():
                for k, lag in self.turns[gear].shafts:
                    on[k, e] -= lag * arm
            for gear, along in to.shifting.items():
                at = len(shafts) + 3 * self.order[gear]
                on[at : at + 3, e] += along
        for at, k in enumerate(self.elastic_shafts, self.shafts.start):
            arm = self.train.gears[shafts[k].first].base_radius
            on[k, at] -= arm
            for gear, sign in ((shafts[k].first, 1.0), (shafts[k].second, -1.0)):
                for j, lag in self.turns[gear].shafts:
                    on[j, at] -= sign * lag * arm
        return on

    @cached_property
    def units(self) -> Array:
        """Radius [m] by which a rotation was multiplied; 1 for displacements, shape (n,)."""
        found = np.ones(len(self.coordinates))
        for turn in self.turns.values():
            if turn.coordinate is not None:
                found[turn.coordinate] = turn.radius
        return found

    @cached_property
    def sizes(self) -> Array:
        """Sizes of the entries of A, shape (m, n)."""
        return np.abs(self.matrix.high)

    @cached_property
    def roundings(self) -> Array:
        """Rounding of the balance at every coordinate, over the sizes of its terms, shape (n,)."""
        terms = np.count_nonzero(self.sizes, axis=0)
        return np.asarray((terms + 4) * UNIT)

    @cached_property
    def contacts(self) -> Numbers:
        """Columns of flanks and stops."""
        every = np.arange(len(self.names))
        return np.concatenate([every[self.flanks], every[self.stops]])

    @cached_property
    def is_contact(self) -> Flags:
        """Which columns are flanks or stops, shape (m,)."""
        found = np.zeros(len(self.names), dtype=bool)
        found[self.contacts] = True
        return found

    @cached_property
    def arms(self) -> Array:
        """Base radius at which the torque of every flank is given [m]."""
        return np.array([m.first_radius for m, _ in self.all_flanks])

    def over_meshes(self, torques: Array) -> Array:
        """Return sums over both flanks of every mesh, from figures of the flanks, (…, flanks)."""
        if not len(self.meshes):
            return torques
        first = np.flatnonzero(np.diff(self.meshes, prepend=-1))
        return np.asarray(np.add.reduceat(torques, first, axis=-1))

    def force_at_end(self, moves: Array) -> float:
        """Return the largest force of an element that ends one of some moves, per load along it.

        At least 1.
        """
        high = self.matrix.high
        pairs = high[self.first_pair :].reshape(-1, 2, high.shape[1])
        return force_at_end(moves, high[self.contacts], pairs)

    def statics(self, columns: Numbers) -> Statics:
        """Return the statics of columns that act, computed once."""
        key = columns.tobytes()
        known = self._statics.get(key)
        if known is None:
            if len(self._statics) >= BOUND.sets:
                self._statics.clear()
            known = self._statics[key] = Statics.of(self.matrix.high[columns])
        return known

    def _matrix(self, rows: Sequence[_Row]) -> Twofold:
        """Return A, shape (m, n)."""
        found = Twofold(*np.zeros((2, len(rows), len(self.coordinates))))
        turned, moved = [], []
        for number, row in enumerate(rows):
            for where, value in row.unit.items():
                found.high[number, where] = value
            for gear, arm in row.turned:
                if (turn := self.turns[gear]).coordinate is not None:
                    turned.append((number, turn.coordinate, arm, turn.radius))
            for gear, way in row.moved:
                if gear in self.places:
                    moved.append((number, self.places[gear], self.train.gears[gear].frame, way))
        if turned:
            numbers, firsts, arms, radii = map(np.array, zip(*turned, strict=True))
            for total, part in zip(found, quotient(arms, radii), strict=True):
                np.add.at(total, (numbers, firsts), part)
        if moved:
            *places, frames, ways = zip(*moved, strict=True)
            terms = two_product(np.array(frames), np.array(ways)[:, None, :])
            every = np.concatenate(terms, axis=2).tolist()
            for number, first, along in zip(*places, every, strict=True):
                for at, parts in enumerate(along, start=first):
                    nearest = math.fsum(parts)
                    found.high[number, at] += nearest
                    found.low[number, at] += math.fsum([*parts, -nearest])
        return found

    def _kinds(self) -> Iterator[list[_Row]]:
        """Yield the columns of every kind of element, in order."""
        train, both = self.train, (0, 1)
        gears, drums = train.gears, train.drums
        yield [
            _Row(name, to.turning.items(), to.shifting.items())
            for name, to in train.approaches.items()
        ]
        elastic = (s for s in train.shafts.values() if not math.isinf(s.stiffness))
        arms = ((s, gears[s.first].base_radius) for s in elastic)
        yield [_Row(s.name, ((s.first, arm), (s.second, -arm))) for s, arm in arms]
        yield [
            _Row(f"bearing {gear}", unit={first + k: 1.0})
            for gear, first in self.places.items()
            for k in both
        ]
        yield [
            _Row(name, moved=((ring.gear, sign * ring.across),))
            for ring in drums
            for name, sign in zip(ring.stop_names, (1.0, -1.0), strict=True)
        ]
        yield [
            _Row(f"{train.splines[g].name} shaft", unit={self.places[g] + k: 1.0, slip + k: -1.0})
            for g, slip in self.slips.items()
            for k in both
        ]
        yield [
            _Row(
                ring.arc_name(neighbour),
                moved=((neighbour, -gears[ring.gear].frame[k]),),
                unit={self.places[ring.gear] + k: 1.0},
            )
            for ring in drums
            for neighbour in ring.neighbours
            for k in both
        ]
        pairs = [(r.name, self.places[r.gear]) for r in train.rounds]
        pairs += [(s.name, (self.slips or self.places)[g]) for g, s in train.splines.items()]
        pairs += [(train.splines[g].stop_name, slip) for g, slip in self.slips.items()]
        yield [_Row(name, unit={at + k: 1.0}) for name, at in pairs for k in both]


def _turns(train: Train) -> tuple[dict[str, Turn], list[str]]:
    """Return how every gear turns, and the names of the rotations."""
    order = {name: k for k, name in enumerate(train.shafts)}
    turns: dict[str, Turn] = {}
    names: list[str] = []
    for paths in rigid_shafts(train).paths:
        first, radius = next(iter(paths)), max(train.gears[g].base_radius for g in paths)
        coordinate = None if first in train.held else len(names)
        for gear, path in paths.items():
            # The second gear of a shaft lags the first by its clocking.
            lags = tuple((order[shaft], -sign) for shaft, sign in path.items())
            turns[gear] = Turn(coordinate, radius, lags)
        if coordinate is not None:
            names.append(f"{first} rotation")
    return turns, names
