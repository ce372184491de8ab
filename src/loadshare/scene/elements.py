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
from loadshare.train.memory import SlipFriction
from loadshare.train.ring import DrumRing

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
    springs, kinds = spring_directions(scene)
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


def spring_directions(scene: Scene) -> tuple[list[Array], list[str]]:
    """Unit directions (n,) of elastic shafts and supports, and which of these they are."""
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
    for radial in scene.radials:
        if isinstance(radial.source, SlipFriction):
            # The shaft of a spline that remembers its slip bends by p − s.
            bent = np.eye(scene.size)[scene.displacement[radial.gear]] - radial.matrix
            vectors += list(bent / np.sqrt(2.0))
            kinds += ["bending"] * 2
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


def unresisted(directions: Array) -> Array:
    """Orthonormal moves (n, l) across all of some directions (k, n)."""
    _, sizes, right = np.linalg.svd(directions, full_matrices=True)
    return np.asarray(right[_rank(sizes) :].T)


def _rank(sizes: Array) -> int:
    return int((sizes > RANK * sizes.max(initial=0.0)).sum())


def _basis(columns: NDArray[np.intp], directions: Array) -> Basis:
    left, sizes, right = np.linalg.svd(directions, full_matrices=True)
    rank = _rank(sizes)
    particular = left[:, :rank] / sizes[:rank] @ right[:rank]
    return Basis(
        columns, directions, particular, np.ascontiguousarray(left[:, rank:]), right[rank:].T
    )
