r"""The force method: every force of a scene as one column of its equilibrium.

Springs, flanks, stops, ring faces and radial elements all push along fixed directions,

.. math:: A^T \mu = f, \qquad A x = g + \delta(\mu),

with forces μ, coordinates x, external loads f, gaps g and compressions δ. Geometry alone fixes A,
so it is reduced once per train; errors, clearances, loads and compliances only enter f, g and the
laws. On a set of elements that act, the forces are

.. math:: \mu = P f + N z, \qquad A^T P = 1,\; A^T N = 0,

and the redundants z follow from compatibility, :math:`N^T(g + \delta(\mu)) = 0`; then
:math:`x = P^T(g + \delta(\mu))`. A four-branch train has three redundants. Source: formulation,
section 11.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from loadshare.scene.scene import Array, Scene
from loadshare.train.ring import DrumRing, RoundRing
from loadshare.train.situations import Situations
from loadshare.train.train import Spline

OPPOSED = 1e-4
"""Angle [rad] to which two arcs of a ring must be opposed for a squeeze between them to be sham."""
SETS = 2000
"""Sets of which the statics are kept; with more, all are forgotten, so that memory is bounded."""
RANK = 1e-10
"""Singular values of directions below this, relative to the largest, count as zero."""


@dataclass(frozen=True, slots=True, eq=False)
class Basis:
    """Statics of one set of acting elements.

    Attributes
    ----------
    columns : ndarray of int, shape (k,)
        The acting elements.
    directions : ndarray, shape (k, n)
        Their rows of A.
    particular : ndarray, shape (k, n)
        P.
    redundant : ndarray, shape (k, r)
        N, orthonormal.
    loose : ndarray, shape (n, l)
        Moves of the coordinates that no acting element resists, orthonormal. P is the
        pseudo-inverse, so that coordinates are of least norm.
    """

    columns: NDArray[np.intp]
    directions: Array
    particular: Array
    redundant: Array
    loose: Array


@dataclass(frozen=True, eq=False)
class Elements:
    """All elements of a scene: springs first, then rows, then two columns per radial element.

    Attributes
    ----------
    scene : Scene
        Of any position; gives names, coordinates and directions.
    vectors : ndarray, shape (m, n)
        A; rows of unit norm for springs, as they are for contacts.
    springs : int
        Their number s.
    kinds : tuple of str, length m
        "shaft", "support", or the kind of the row or "radial".
    force, length : float
        Units [N], [m], rounded to powers of 8 and of 2: scaling by them is exact, cube roots
        included, so that answers do not depend on them.
    """

    scene: Scene
    vectors: Array
    springs: int
    kinds: tuple[str, ...]
    force: float
    length: float

    @property
    def rows(self) -> int:
        """Number of contact rows: flanks, stops, arcs."""
        return len(self.scene.rows) + len(self.scene.arcs)

    def radial_column(self, j: int) -> int:
        """First of the two columns of a radial element."""
        return self.springs + self.rows + 2 * j

    @cached_property
    def row_names(self) -> tuple[str, ...]:
        """Names of the rows in the order of the columns."""
        names = [r.name for r in self.scene.rows] + [a.name for a in self.scene.arcs]
        return tuple(names)

    @cached_property
    def opposed(self) -> tuple[tuple[int, int], ...]:
        """Pairs of rows that are the opposed arcs of one ring.

        A float that rolls between them moves across both. Faces of both at once would wedge it in,
        unless the neighbours give way.
        """
        pairs = []
        first, arcs = len(self.scene.rows), self.scene.arcs
        for k in range(0, len(arcs), 2):
            normals = [a.arc.normal(np.zeros(3)) for a in arcs[k : k + 2]]
            rigid = all(_between_rigid(self.scene, a.name) for a in arcs[k : k + 2])
            if rigid and np.linalg.norm(normals[0] + normals[1]) < OPPOSED:
                pairs.append((first + k, first + k + 1))
        return tuple(pairs)

    @property
    def switches(self) -> int:
        """Length of a set's code: one number per row, one per radial element."""
        return self.rows + len(self.scene.radials)

    @cached_property
    def kept(self) -> dict[tuple[Any, ...], Any]:
        """Room for what an engine keeps of a set."""
        return {}

    def keep(self, key: tuple[Any, ...], value: Any) -> Any:
        """Keep what an engine needs of a set, and return it."""
        if len(self.kept) >= SETS:
            self.kept.clear()
        self.kept[key] = value
        return value

    @cached_property
    def _bases(self) -> dict[bytes, Basis]:
        return {}

    def basis(self, code: NDArray[np.int8]) -> Basis:
        """Return the statics of a set, computed once.

        Parameters
        ----------
        code : ndarray of int8, shape (switches,)
            0 for an element that does not act, anything else for one that does.
        """
        acts = np.ascontiguousarray(code != 0)
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
            if len(self._bases) >= SETS:
                self._bases.clear()
            known = self._bases[key] = _basis(columns, self.vectors[columns])
        return known


def elements_of(scene: Scene) -> Elements:
    """Set up the force method for a scene's train."""
    springs, kinds = _springs(scene)
    origin = np.zeros(scene.size)
    rows = [r.vector for r in scene.rows_at(origin)]
    radials = [component for r in scene.radials for component in r.matrix]
    vectors = np.array([*springs, *rows, *radials]).reshape(-1, scene.size)
    kinds += [r.kind for r in scene.rows] + ["arc"] * len(scene.arcs)
    kinds += ["radial"] * len(radials)
    return Elements(
        scene,
        vectors,
        len(springs),
        tuple(kinds),
        8.0 ** round(math.log(scene.force_unit(), 8.0)),
        2.0 ** round(math.log2(scene.length_unit())),
    )


def _between_rigid(scene: Scene, arc: str) -> bool:
    """Whether the neighbour of an arc stands in a rigid bearing."""
    train = scene.train
    neighbours = {
        ring.arc_name(n): n
        for ring in train.rings.values()
        if isinstance(ring, DrumRing)
        for n in ring.neighbours
    }
    return not train.gears[neighbours[arc]].moves


def _springs(scene: Scene) -> tuple[list[Array], list[str]]:
    """Directions of elastic shafts and supports."""
    train = scene.train
    vectors, kinds = [], []
    for shaft in train.shafts.values():
        if not math.isinf(shaft.stiffness):
            vectors.append(wind_up(scene, shaft.first, shaft.second)[0])
            kinds.append("shaft")
    for name, where in scene.displacement.items():
        support = train.gears[name].support
        assert support is not None
        for k, stiffness in enumerate(support):
            if stiffness > 0.0:
                vectors.append(np.eye(scene.size)[where.start + k])
                kinds.append("support")
    return vectors, kinds


def wind_up(scene: Scene, first: str, second: str) -> tuple[Array, float]:
    """Return the unit vector of a shaft's wind-up, and how many radians a unit along it is."""
    wind = np.zeros(scene.size)
    for gear, sign in ((first, 1.0), (second, -1.0)):
        r = scene.rotation[gear]
        if r.index is not None:
            wind[r.index] += sign * r.rate
    size = float(np.linalg.norm(wind))
    return (wind / size if size else wind), size


def _basis(columns: NDArray[np.intp], directions: Array) -> Basis:
    left, sizes, right = np.linalg.svd(directions, full_matrices=True)
    rank = int((sizes > RANK * sizes.max(initial=0.0)).sum())
    particular = left[:, :rank] / sizes[:rank] @ right[:rank]
    return Basis(
        columns, directions, particular, np.ascontiguousarray(left[:, rank:]), right[rank:].T
    )


@dataclass(frozen=True, eq=False)
class Data:
    """What varies, in the units of the force method; leading axes are S or 1.

    Attributes
    ----------
    count : int
        S.
    load : ndarray, shape (S or 1, n)
        f.
    gap : ndarray, shape (S or 1, m)
        g; for an arc its clearance does not stand here but in `clearance`.
    bending, hertz : ndarray, shape (S or 1, m)
        b and c of every scalar element.
    tabulated : ndarray of int, shape (m,)
        Number of the table of an element, −1 without.
    tables : ndarray, shape (S or 1, tables, 2, points)
    nominal, shift : ndarray, shape (arcs, 3) and (S or 1, arcs, 3)
        d₀ of the arcs is their sum.
    clearance : ndarray, shape (S or 1, arcs)
    relative : ndarray, shape (arcs, 3, n)
        Relative displacement of an arc's centres from the coordinates.
    radial : ndarray, shape (S or 1, radials, 6)
        First stiffness (K_w; 0 inside a ring), S1 (NaN for F_m/K_w), S2 or the ring's radius, F_m
        (NaN where it follows the torque), τ/radius [1/m], stiffness beyond S2.
    carried : ndarray, shape (radials, m)
        Torque that reaches the gear of each element over its spline, per unit of each force [m].
    """

    count: int
    load: Array
    gap: Array
    bending: Array
    hertz: Array
    tabulated: NDArray[np.intp]
    tables: Array
    nominal: Array
    shift: Array
    clearance: Array
    relative: Array
    radial: Array
    carried: Array

    @cached_property
    def loaded(self) -> NDArray[np.intp]:
        """Coordinates with a load in some sample."""
        return np.flatnonzero(self.load.any(axis=0))

    @cached_property
    def push(self) -> Array:
        """Largest load of every sample, shape (S or 1,)."""
        return np.asarray(np.abs(self.load[:, self.loaded]).max(axis=1, initial=0.0))

    @cached_property
    def steady(self) -> NDArray[np.bool_]:
        """Elements whose b is the same in all samples, shape (m,)."""
        return np.asarray((self.bending == self.bending[:1]).all(axis=0))

    @cached_property
    def curved(self) -> NDArray[np.bool_]:
        """Elements with c > 0 in some sample, shape (m,)."""
        return np.asarray(self.hertz.any(axis=0))

    @cached_property
    def laws(self) -> bytes:
        """What the structure of a set depends on: power laws, and compliances that do not vary."""
        constant = np.where(self.steady, self.bending[0], np.nan)
        return self.curved.tobytes() + constant.tobytes()


def data_of(elements: Elements, situations: Situations) -> Data:
    """Write the numbers of many situations in the order and the units of the elements."""
    scene, train = elements.scene, elements.scene.train
    force, length = elements.force, elements.length
    size = scene.size
    order = {g: k for k, g in enumerate(train.gears)}
    to_load = np.zeros((len(order), size))
    for gear, k in order.items():
        r = scene.rotation[gear]
        if r.index is not None:
            to_load[k, r.index] = r.rate
    gaps, bends, hertz = _springs_of(elements, situations)
    tabulated = np.full(len(elements.kinds), -1)
    meshes = list(train.meshes.values())
    flat = situations.offset.reshape(len(situations.offset), -1)
    flanks = [(m, mesh, drive) for m, mesh in enumerate(meshes) for drive in mesh.flanks]
    shifts = np.zeros((len(flanks), len(order), 3))
    for e, (_, mesh, drive) in enumerate(flanks):
        normal = mesh.direction(drive)[2]
        shifts[e, order[mesh.driver]], shifts[e, order[mesh.driven]] = normal, -normal
    nearer = shifts.reshape(len(flanks), -1) @ flat.T
    for e, (m, mesh, drive) in enumerate(flanks):
        on_driver, on_driven, _ = mesh.direction(drive)
        constant = on_driver * scene.rotation[mesh.driver].constant
        constant += on_driven * scene.rotation[mesh.driven].constant
        room = situations.gap[:, m] if drive else situations.backlash[:, m]
        gaps.append(room - constant - nearer[e])
        bends.append(situations.bending[:, m])
        hertz.append(situations.hertz[:, m])
        if situations.table.shape[-1] and situations.table[0, m, 0, 1] > 0.0:
            tabulated[elements.springs + e] = m
    none = np.zeros(1)
    drums = situations.wall.shape[1]
    for d in range(drums):
        for side in (0, 1):
            gaps.append(situations.stop[:, d, side])
            bends.append(situations.wall[:, d])
            hertz.append(none)
    for d in range(drums):
        for _ in (0, 1):
            gaps.append(none)
            bends.append(situations.wall[:, d])
            hertz.append(none)
    for radial in scene.radials:
        for component in radial.centre:
            gaps.append(np.array([component]))
            bends.append(none)
            hertz.append(none)
    arcs = scene.arcs
    return Data(
        count=situations.count,
        load=situations.torque @ to_load / force,
        gap=_columns(gaps, 1.0 / length),
        bending=_columns(bends, force / length),
        hertz=_columns(hertz, math.cbrt(force) ** 2 / length),
        tabulated=tabulated,
        tables=situations.table / np.array([force, length])[:, None],
        nominal=np.array([a.arc.nominal for a in arcs]).reshape(-1, 3) / length,
        shift=situations.arc_shift.reshape(len(situations.arc_shift), -1, 3) / length,
        clearance=situations.arc_clearance.reshape(len(situations.arc_clearance), -1) / length,
        relative=np.array([a.relative for a in arcs]).reshape(-1, 3, size),
        radial=_radials(elements, situations),
        carried=_carried(elements),
    )


def _columns(values: list[Array], factor: float) -> Array:
    """Stand one-dimensional arrays of length S or 1 side by side, times a factor."""
    if not values:
        return np.zeros((1, 0))
    # Written lengthwise and turned at the end: a column of a wide table is slow to write.
    table = np.empty((len(values), max(len(v) for v in values)))
    for row, value in zip(table, values, strict=True):
        row[:] = value
    table *= factor
    return np.ascontiguousarray(table.T)


def _springs_of(
    elements: Elements, situations: Situations
) -> tuple[list[Array], list[Array], list[Array]]:
    """Presets and compliances of elastic shafts and supports."""
    scene, train = elements.scene, elements.scene.train
    gaps: list[Array] = []
    bends: list[Array] = []
    for s, shaft in enumerate(train.shafts.values()):
        if math.isinf(shaft.stiffness):
            continue
        a, b = scene.rotation[shaft.first], scene.rotation[shaft.second]
        _, rate = wind_up(scene, shaft.first, shaft.second)
        gaps.append((situations.clocking[:, s] - a.constant + b.constant) / rate)
        bends.append(1.0 / (situations.torsion[:, s] * rate**2))
    for g, (name, gear) in enumerate(train.gears.items()):
        if name not in scene.displacement:
            continue
        assert gear.support is not None
        for k, stiffness in enumerate(gear.support):
            if stiffness > 0.0:
                gaps.append(np.zeros(1))
                bends.append(1.0 / situations.support[:, g, k])
    return gaps, bends, [np.zeros(1)] * len(gaps)


def _radials(elements: Elements, situations: Situations) -> Array:
    """Numbers of every radial law, in the units of the force method."""
    scene, train = elements.scene, elements.scene.train
    stiff = elements.force / elements.length
    rounds = [n for n, r in train.rings.items() if isinstance(r, RoundRing)]
    splines = list(train.splines)
    varying = (situations.spline, situations.round_radius, situations.round_stiffness)
    table = np.zeros((max(map(len, varying)), len(scene.radials), 6))
    for j, radial in enumerate(scene.radials):
        if isinstance(radial.source, Spline):
            given = situations.spline[:, splines.index(radial.gear)]
            table[:, j, 0] = table[:, j, 5] = given[:, 0] / stiff
            table[:, j, 1:3] = given[:, 1:3] / elements.length
            table[:, j, 3] = given[:, 3] / elements.force
            table[:, j, 4] = given[:, 4]
        else:
            q = rounds.index(radial.gear)
            table[:, j, 2] = situations.round_radius[:, q] / elements.length
            table[:, j, 5] = situations.round_stiffness[:, q] / stiff
    return table


def _carried(elements: Elements) -> Array:
    """Torque over each spline per unit of every force [m]."""
    scene, train = elements.scene, elements.scene.train
    carried = np.zeros((len(scene.radials), len(elements.kinds)))
    for j, radial in enumerate(scene.radials):
        column = elements.springs
        for mesh in train.meshes.values():
            for drive in mesh.flanks:
                on_driver, on_driven, _ = mesh.direction(drive)
                if radial.gear == mesh.driver:
                    carried[j, column] += on_driver
                if radial.gear == mesh.driven:
                    carried[j, column] += on_driven
                column += 1
    return carried
