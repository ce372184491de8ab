r"""The force method: every force of a scene as one column of its equilibrium.

Springs, flanks, stops, ring faces and radial elements all push along fixed directions,

.. math:: A^T \mu = f, \qquad A x = g + \delta(\mu),

with forces μ, coordinates x, external loads f, gaps g and compressions δ. Geometry alone fixes A,
so it is reduced once per train; errors, clearances, loads and compliances only enter f, g and the
laws. On an active set, the forces are

.. math:: \mu = P f + N z, \qquad A^T P = 1,\; A^T N = 0,

and the redundants z follow from compatibility, :math:`N^T(g + \delta(\mu)) = 0`; then
:math:`x = P^T(g + \delta(\mu))`. A four-branch train has three redundants. Source: formulation,
section 11.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import accumulate, pairwise
from typing import Any

import numpy as np

from loadshare.array_types import Array, States
from loadshare.scene.coordinates import Coordinates, coordinates_of
from loadshare.scene.statics import Basis, basis_of
from loadshare.scene.units import units_of
from loadshare.settings import STATICS
from loadshare.train.mesh import Mesh
from loadshare.train.ring import DrumRing, transverse
from loadshare.train.situations import Situations, situation_of
from loadshare.train.train import Train


@dataclass(frozen=True, slots=True)
class ColumnSlices:
    """Columns of each kind of element.

    Attributes
    ----------
    shafts, supports, bends : slice
        Springs: elastic shafts, elastic supports, shafts of splines that remember their slip.
    flanks, stops, arcs : slice
        Contacts; the directions of arcs turn with the coordinates.
    radials : slice
        Two columns of every radial element.
    """

    shafts: slice
    supports: slice
    bends: slice
    flanks: slice
    stops: slice
    arcs: slice
    radials: slice

    @classmethod
    def of(cls, counts: Iterable[int]) -> ColumnSlices:
        """Put kinds of elements with these numbers of columns one after another."""
        ends = list(accumulate(counts, initial=0))
        return cls(*(slice(*pair) for pair in pairwise(ends)))

    @property
    def springs(self) -> slice:
        """All springs."""
        return slice(self.shafts.start, self.bends.stop)

    @property
    def flat(self) -> slice:
        """Contacts whose direction does not change: flanks and stops."""
        return slice(self.flanks.start, self.stops.stop)

    @property
    def rings(self) -> slice:
        """Contacts of drums: stops and arcs."""
        return slice(self.stops.start, self.arcs.stop)

    @property
    def contacts(self) -> slice:
        """All contacts."""
        return slice(self.flanks.start, self.arcs.stop)


@dataclass(frozen=True, slots=True, eq=False)
class ArcElement:
    """An exclusion arc of a drum ring.

    Attributes
    ----------
    name : str
    ring : DrumRing
    drum, side : int
        Number of the drum, and of its neighbour.
    relative : ndarray, shape (3, n)
        Matrix from the coordinates to the relative displacement of the two centres.
    """

    name: str
    ring: DrumRing
    drum: int
    side: int
    relative: Array


@dataclass(frozen=True, slots=True, eq=False)
class RadialElement:
    """A spline or a round ring, or one part of a spline with memory.

    Attributes
    ----------
    name, gear : str
    kind : {"ring", "spline", "friction", "clearance"}
        A spline with memory is two elements, its friction and its clearance.
    number : int
        Of the round ring or spline.
    matrix : ndarray, shape (2, n)
        P.
    """

    name: str
    gear: str
    kind: str
    number: int
    matrix: Array


@dataclass(frozen=True, eq=False)
class Structure:
    """All elements of a train, each with its direction.

    Attributes
    ----------
    train : Train
    coordinates : Coordinates
    columns : ColumnSlices
        Columns of the elements, in this order.
    vectors : ndarray, shape (m, n)
        A; rows of springs are scaled to unit norm, those of contacts are not. Arcs are taken at
        rest.
    names : tuple of str, length m
    kinds : tuple of str, length m
        "shaft", "support", "bending", "drive flank", "coast flank", "stop", "arc" or "radial".
    shafts : tuple of (int, float)
        Number of every elastic shaft, and its wind-up in radians per unit of its column.
    supports : tuple of (int, int)
        Number of the gear of every elastic support, and its axis.
    flanks : tuple of (int, Mesh, bool)
        Number of the mesh, the mesh, drive or coast flank.
    arcs : tuple of ArcElement
    radials : tuple of RadialElement
    opposed : tuple of (int, int)
        Numbers of the contacts that are the opposed arcs of one ring, if its neighbours do not
        move. A float that rolls between them moves across both; rigid faces of both at once would
        wedge it in.
    force, length : float
        Units [N], [m], rounded to powers of 8 and of 2: scaling by them is exact, cube roots
        included, so that answers do not depend on them.
    """

    train: Train
    coordinates: Coordinates
    columns: ColumnSlices
    vectors: Array
    names: tuple[str, ...]
    kinds: tuple[str, ...]
    shafts: tuple[tuple[int, float], ...]
    supports: tuple[tuple[int, int], ...]
    flanks: tuple[tuple[int, Mesh, bool], ...]
    arcs: tuple[ArcElement, ...]
    radials: tuple[RadialElement, ...]
    opposed: tuple[tuple[int, int], ...]
    force: float
    length: float

    @property
    def size(self) -> int:
        """Number of coordinates n."""
        return self.coordinates.size

    @cached_property
    def springs(self) -> int:
        """Number of springs."""
        return int(self.columns.springs.stop)

    @cached_property
    def flat(self) -> int:
        """Number of contacts whose direction does not change: flanks and stops."""
        return len(self.names[self.columns.flat])

    @cached_property
    def rows(self) -> int:
        """Number of contacts: flanks, stops, arcs."""
        return len(self.names[self.columns.contacts])

    def radial_column(self, j: int) -> int:
        """Return the first of the two columns of a radial element."""
        return int(self.columns.radials.start) + 2 * j

    @property
    def row_names(self) -> tuple[str, ...]:
        """Names of the contacts."""
        return self.names[self.columns.contacts]

    @cached_property
    def removed(self) -> tuple[tuple[str, str], ...]:
        """Names of what did not become a coordinate or an element, and why."""
        train = self.train
        flanks = [m.flank_name(False) for m in train.meshes.values() if math.isinf(m.backlash)]
        splines = [s.name for s in train.splines.values() if s.friction_force == 0.0]
        return (
            *self.coordinates.removed,
            *((name, "no backlash given: the flank cannot touch") for name in flanks),
            *((f"{name} friction", "its bound is zero") for name in splines),
        )

    @cached_property
    def levers(self) -> Array:
        """Torque that reaches the gear of each radial element other than through its meshes.

        Per unit of the force of every column [m], shape (radials, m).
        """
        found = np.zeros((len(self.radials), len(self.names)))
        for j, radial in enumerate(self.radials):
            levers = self.train.levers(radial.gear)
            names = self.names[self.columns.flanks]
            found[j, self.columns.flanks] = [levers.get(name, 0.0) for name in names]
        return found

    def turned(self, situations: Situations) -> Array:
        """Rotation of every gear at zero coordinates [rad], shape (S or 1, gears)."""
        if not self._lags:
            return np.zeros((1, len(self.train.gears)))
        return np.asarray(situations.clocking @ self.coordinates.lag.T)

    @cached_property
    def _lags(self) -> bool:
        return bool(self.coordinates.lag.any())

    @cached_property
    def turning(self) -> Array:
        """Approach of every flank per rotation of every gear [m], shape (flanks, gears)."""
        order = self.train.order
        found = np.zeros((len(self.flanks), len(order)))
        for e, to in enumerate(self.train.approaches.values()):
            for gear, arm in to.turning.items():
                found[e, order[gear]] = arm
        return found

    @cached_property
    def approach_per_offset(self) -> Array:
        """Approach of every flank per centre offset, shape (flanks, 3 gears)."""
        order = self.train.order
        found = np.zeros((len(self.flanks), len(order), 3))
        for e, to in enumerate(self.train.approaches.values()):
            for gear, along in to.shifting.items():
                found[e, order[gear]] = along
        return found.reshape(len(self.flanks), -1)

    @cached_property
    def load_per_torque(self) -> Array:
        """Load on the coordinates per torque on the gears, shape (gears, n)."""
        return np.array([self.coordinates.turned((gear, 1.0)) for gear in self.train.gears])

    @cached_property
    def nominal(self) -> Array:
        """Vectors from the neighbours' centres to the arcs' own, at rest, shape (arcs, 3) [m]."""
        gears, rings = self.train.gears, [(a.ring, a.ring.neighbours[a.side]) for a in self.arcs]
        ways = [(gears[ring.gear], gears[neighbour]) for ring, neighbour in rings]
        found = [transverse(one.centre - other.centre, one.axis) for one, other in ways]
        return np.array(found).reshape(-1, 3)

    @cached_property
    def relative(self) -> Array:
        """Relative displacement of the arcs' centres by coordinate, shape (arcs, 3, n)."""
        return np.array([a.relative for a in self.arcs]).reshape(-1, 3, self.size)

    @cached_property
    def load_per_force(self) -> Array:
        """Load on the coordinates per force on the gears, shape (3 gears, n).

        A pin transmits the force on its planet to the carrier.
        """
        at, gears = self.coordinates, self.train.gears
        found = []
        for name, gear in gears.items():
            moved = at.moved(name)
            if gear.carrier is not None:
                moved = moved + at.moved(gear.carrier)
                moved += np.outer(gear.pin_motion, at.turned((gear.carrier, 1.0)))
            found.append(moved)
        return np.concatenate(found)

    def gaps_of_flanks(self, situations: Situations) -> Array:
        """Return the gap of every flank with errors and clockings [m], shape (S or 1, flanks)."""
        flat = situations.offset.reshape(len(situations.offset), -1)
        is_small = len(flat) < STATICS.samples or self.approach_per_offset.size <= STATICS.dense
        nearer = self.approach_per_offset if is_small else self._approach_per_offset_sparse
        near = np.asarray(flat @ nearer.T)
        if self._lags:
            near = near + self.turned(situations) @ self.turning.T
        return np.asarray(situations.gap - near)

    def centres(self, situations: Situations) -> Array:
        """Return the centres m of the radial elements, shape (S or 1, radials, 2) [m]."""
        train, offset = self.train, situations.round_offset
        found = np.zeros((len(offset), len(self.radials), 2))
        for j, radial in enumerate(self.radials):
            frame = train.gears[radial.gear].frame
            if radial.kind == "ring":
                found[:, j] = offset[:, radial.number] @ frame.T
            elif radial.kind == "friction" and train.slip is not None:
                found[:, j] = frame @ train.slip[radial.gear]
        return found

    @cached_property
    def _approach_per_offset_sparse(self) -> Any:
        """`approach_per_offset` as a sparse matrix; `Any`, since SciPy has no types."""
        from scipy.sparse import csr_array

        return csr_array(self.approach_per_offset)

    @property
    def switches(self) -> int:
        """Length of an active set: one number per row, one per radial element."""
        return self.rows + len(self.radials)

    @cached_property
    def cache(self) -> dict[tuple[Any, ...], Any]:
        """Quantities that engines keep for active sets."""
        return {}

    def cached(self, key: tuple[Any, ...], make: Callable[[], Any]) -> Any:
        """Return a quantity that an engine needs for an active set, computed on first use."""
        found = self.cache.get(key)
        if found is None:
            found = make()
            if len(self.cache) >= STATICS.sets:
                self.cache.clear()
            self.cache[key] = found
        return found

    @cached_property
    def _bases(self) -> dict[bytes, Basis]:
        return {}

    def basis(self, states: States) -> Basis:
        """Return the statics of an active set, computed once.

        Parameters
        ----------
        states : ndarray of int8, shape (switches,)
            0 for an element that does not act, anything else for one that does.
        """
        acts = np.ascontiguousarray(states != 0)
        key = acts.tobytes()
        known = self._bases.get(key)
        if known is None:
            columns = np.concatenate(
                [
                    np.arange(self.springs),
                    self.springs + np.flatnonzero(acts[: self.rows]),
                    self.springs + self.rows + np.flatnonzero(np.repeat(acts[self.rows :], 2)),
                ]
            ).astype(np.intp)
            if len(self._bases) >= STATICS.sets:
                self._bases.clear()
            known = self._bases[key] = basis_of(columns, self.vectors[columns])
        return known


@lru_cache(maxsize=STATICS.trains)
def structure_of(train: Train) -> Structure:
    """Set up the force method for a train."""
    if train.is_placed_anew:
        raise ValueError("every position of this train has a structure of its own")
    at, here, order = coordinates_of(train), situation_of(train, train.placed or 1), train.order
    unit = np.eye(at.size)
    shafts, shaft_columns = [], []
    for s, shaft in enumerate(train.shafts.values()):
        if not math.isinf(shaft.stiffness):
            wind = at.turned((shaft.first, 1.0), (shaft.second, -1.0))
            rate = float(np.linalg.norm(wind))
            shafts.append((s, rate))
            shaft_columns.append((shaft.name, "shaft", wind / rate if rate else wind))
    supports, support_columns = [], []
    for name, where in at.displacement.items():
        support = train.gears[name].support
        for k in np.flatnonzero(support).tolist() if support is not None else ():
            supports.append((order[name], k))
            support_columns.append((f"bearing {name}", "support", unit[where.start + k]))
    bends = [
        # The shaft of a spline that remembers its slip bends by p − s.
        (f"{train.splines[gear].name} shaft", "bending", bent)
        for gear, where in at.slip.items()
        for bent in (unit[at.displacement[gear]] - unit[where]) / np.sqrt(2.0)
    ]
    flanks = tuple(
        (m, mesh, drive) for m, mesh in enumerate(train.meshes.values()) for drive in mesh.flanks
    )
    stops = [
        (name, "stop", sign * ring.across @ at.moved(ring.gear))
        for ring in train.drums
        for name, sign in zip(ring.stop_names, (1.0, -1.0), strict=True)
    ]
    arcs = tuple(
        ArcElement(ring.arc_name(n), ring, d, side, at.moved(ring.gear) - at.moved(n))
        for d, ring in enumerate(train.drums)
        for side, n in enumerate(ring.neighbours)
    )
    normals = [here.arc(a.ring, a.side).normal(np.zeros(3)) for a in arcs]
    radials = tuple(_radials(train, at))
    groups: list[list[tuple[str, str, Array]]] = [
        shaft_columns,
        support_columns,
        bends,
        [_flank(at, train, mesh, drive) for _, mesh, drive in flanks],
        stops,
        [(a.name, "arc", -(n @ a.relative)) for a, n in zip(arcs, normals, strict=True)],
        [(r.name, "radial", component) for r in radials for component in r.matrix],
    ]
    columns = [column for group in groups for column in group]
    flat = len(flanks) + len(stops)
    opposed = tuple(
        (flat + k, flat + k + 1)
        for k in range(0, len(arcs), 2)
        if np.linalg.norm(normals[k] + normals[k + 1]) < STATICS.opposed
        and not any(train.gears[n].moves for n in arcs[k].ring.neighbours)
    )
    structure = Structure(
        train,
        at,
        ColumnSlices.of(map(len, groups)),
        np.array([vector for *_, vector in columns]).reshape(-1, at.size),
        tuple(name for name, *_ in columns),
        tuple(kind for _, kind, _ in columns),
        tuple(shafts),
        tuple(supports),
        flanks,
        arcs,
        radials,
        opposed,
        1.0,
        1.0,
    )
    force, length = units_of(structure, here)
    return replace(structure, force=force, length=length)


def _flank(at: Coordinates, train: Train, mesh: Mesh, drive: bool) -> tuple[str, str, Array]:
    """Return name, kind and row of a flank."""
    name = mesh.flank_name(drive)
    to = train.approaches[name]
    row = at.turned(*to.turning.items())
    for gear, along in to.shifting.items():
        row += along @ at.moved(gear)
    return name, "drive flank" if drive else "coast flank", row


def _radials(train: Train, at: Coordinates) -> Iterator[RadialElement]:
    """Yield round rings, then splines, each as one element or, with memory, as two."""
    for k, ring in enumerate(train.rounds):
        moved = at.components(at.displacement[ring.gear])
        yield RadialElement(ring.name, ring.gear, "ring", k, moved)
    for k, (gear, spline) in enumerate(train.splines.items()):
        if train.slip is None:
            moved = at.components(at.displacement[gear])
            yield RadialElement(spline.name, gear, "spline", k, moved)
            continue
        slipped = at.components(at.slip[gear])
        yield RadialElement(spline.name, gear, "friction", k, slipped)
        yield RadialElement(spline.stop_name, gear, "clearance", k, slipped)
