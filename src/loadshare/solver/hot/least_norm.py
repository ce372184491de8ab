r"""Places of least norm of many samples at once.

With the moves M that the forces of a sample leave open, in lengths y = root (x − origin) (see
`undetermined.norm`), and shares s = Mᵀ y, the place of least norm is that of

.. math:: \min \lVert s \rVert^2 \quad\text{such that}\quad L s \le b ,

where L s ≤ b are the limits of contacts that carry nothing, arcs with their faces at the last s.
For the few shares of a part that moves by itself, every set of limits that may be reached is tried.
Samples with an element on a level piece or at the edge of its disc, and parts with more shares, are
left to `undetermined.places`. Source: formulation, section 4.
"""

from __future__ import annotations

from functools import partial
from itertools import combinations
from typing import NamedTuple

import numpy as np

from loadshare.array_types import Array, Flags, Numbers, States
from loadshare.scene.loading import Loading
from loadshare.scene.statics import unresisted
from loadshare.scene.structure import Structure
from loadshare.settings import CONTACT, PLACES
from loadshare.solver.hot import contact_states as at
from loadshare.solver.hot.contact_states import FREE, HELD, LEVEL
from loadshare.solver.hot.determined import Batch, alike_of
from loadshare.solver.hot.elements import arcs_at, arcs_of, pick
from loadshare.solver.hot.iterate import Iterate, pushes
from loadshare.solver.undetermined.norm import Norm, norms_of
from loadshare.solver.undetermined.places import independent
from loadshare.train.situations import Situations


class LeastPlaces(NamedTuple):
    """Places of least norm.

    Attributes
    ----------
    x : ndarray, shape (S, n)
        Coordinates, in the units of the force method.
    known, moved : ndarray of bool, shape (S,)
        Whether the place was found, and is another than before.
    """

    x: Array
    known: Flags
    moved: Flags


class _Part(NamedTuple):
    """Moves (n, d) that are independent of all others, in lengths y; and what limits them.

    Attributes
    ----------
    moves : ndarray, shape (n, d)
        Orthonormal.
    flat : ndarray of int
        Numbers of flanks and stops.
    arcs, rounds : list of int
        Numbers of arcs, and of radial elements.
    """

    moves: Array
    flat: Numbers
    arcs: list[int]
    rounds: list[int]


def least_norm(
    structure: Structure, situations: Situations, loading: Loading, iterate: Iterate
) -> LeastPlaces:
    """Return the places of least norm of S samples.

    Parameters
    ----------
    structure : Structure
    situations : Situations
    loading : Loading
    iterate : Iterate
        A place of each sample, and its forces.
    """
    count, nobody = loading.count, np.zeros(loading.count, dtype=bool)
    places = LeastPlaces(iterate.x.copy(), nobody, nobody.copy())
    if structure.train.slip is not None or (loading.tabulated >= 0).any():
        return places
    push = iterate.force[:, structure.columns.contacts]
    largest = np.abs(iterate.force[:, structure.springs :]).max(axis=1, initial=0.0)
    carries = PLACES.carries * np.maximum(pushes(loading), largest)
    kinds = Batch(structure, loading, iterate).kinds(carries)
    norm = _norm(structure, situations, count)
    for rows, some in alike_of(np.hstack([(push > carries[:, None]).astype(np.int8), kinds])):
        if (some[structure.rows :] == LEVEL).any():
            continue
        make = partial(_parts, structure, loading, some, norm.root)
        parts = structure.cached(("least norm", some.tobytes()), make)
        here = _Samples(structure, situations.take(rows), loading.take(rows), iterate.take(rows))
        found = here.least(Norm(norm.root, norm.origin[rows]), parts)
        for whole, own in zip(places, found, strict=True):
            whole[rows] = own
    return places


def _norm(structure: Structure, situations: Situations, count: int) -> Norm:
    """Return the norm of the coordinates, in the units of the force method."""
    coordinates, turned = structure.coordinates, structure.turned(situations)
    root, origin = norms_of(structure.train, coordinates.rotation, structure.size, turned)
    return Norm(root, np.broadcast_to(origin / structure.length, (count, structure.size)))


def _parts(structure: Structure, loading: Loading, some: States, root: Array) -> list[_Part]:
    """Return the parts of the moves that a set of carrying elements leaves open."""
    carry, kinds = some[: structure.rows], some[structure.rows :]
    flat, vectors = structure.flat, structure.vectors[structure.columns.flat]
    radials = [radial.matrix for radial in structure.radials]
    ties = [structure.vectors[structure.columns.springs], vectors[carry[:flat] != 0]]
    ties += [loading.relative[a] for a in np.flatnonzero(carry[flat:])]
    ties += [radials[j] for j in np.flatnonzero(kinds == HELD).tolist()]
    idle = np.flatnonzero(carry[:flat] == 0)
    arcs, rounds = (
        np.flatnonzero(carry[flat:] == 0).tolist(),
        np.flatnonzero(kinds == FREE).tolist(),
    )
    limits = [v[None] for v in vectors[idle]] + [loading.relative[a] for a in arcs]
    limits += [radials[j] for j in rounds]
    parts = []
    for moves in independent(unresisted(np.vstack(ties) / root), root, limits):
        across = moves / root[:, None]
        meets = [bool(np.linalg.norm(matrix @ across) > PLACES.loose) for matrix in limits]
        of_arcs, of_rounds = meets[len(idle) :][: len(arcs)], meets[len(idle) + len(arcs) :]
        parts.append(
            _Part(
                moves,
                idle[np.array(meets[: len(idle)], dtype=bool)],
                [a for a, met in zip(arcs, of_arcs, strict=True) if met],
                [j for j, met in zip(rounds, of_rounds, strict=True) if met],
            )
        )
    return parts


class _Samples:
    """Samples of one set of carrying elements."""

    def __init__(
        self, structure: Structure, situations: Situations, loading: Loading, iterate: Iterate
    ) -> None:
        self.structure, self.loading, self.iterate = structure, loading, iterate
        self.rows = np.arange(loading.count)
        self.arcs = arcs_of(loading, self.rows)
        force = np.maximum(iterate.force[:, structure.columns.contacts], 0.0)
        b, c = (v[:, structure.columns.contacts] for v in (loading.bending, loading.hertz))
        # A force that counts as none may still compress a soft contact far.
        self.compressed = _compression(b, c, force)
        drums = [arc.drum for arc in structure.arcs]
        floats = situations.stop.max(axis=2)[:, drums] / structure.length
        distance = np.linalg.norm(self.arcs.nominal, axis=1)
        self.sagitta = floats**2 / (2.0 * distance)
        self.unit = _length_units(structure, loading)

    def least(self, norm: Norm, parts: list[_Part]) -> LeastPlaces:
        """Return the places of least norm, given the parts of what moves."""
        before, lengths = self.iterate.x, norm.lengths(self.iterate.x)
        x, known = before.copy(), np.ones(len(before), dtype=bool)
        rests = known.copy()
        for part in parts:
            across = part.moves / norm.root[:, None]
            start = lengths @ part.moves
            shares, found = self._least_shares(part, across, start)
            known &= found
            rests &= np.abs(shares - start).max(axis=1) <= PLACES.inside * self.unit
            x += (shares - start) @ across.T
        play = PLACES.play * self.unit + PLACES.inside * np.abs(x).max(axis=1, initial=0.0)
        # A shorter move would leave the place determined.
        moved = known & ~rests & (np.abs(x - before).max(axis=1, initial=0.0) > play)
        return LeastPlaces(np.where(moved[:, None], x, before), known & (rests | moved), moved)

    def _least_shares(self, part: _Part, across: Array, start: Array) -> tuple[Array, Flags]:
        """Return the least shares (k, d) of a part, and whether they were found."""
        if start.shape[1] > PLACES.few or len(part.flat) + len(part.arcs) > PLACES.limits:
            return start, np.zeros(len(start), dtype=bool)
        flat, room = self._flat(part, across, start)
        if not part.arcs:
            shares, found = _least_in(flat, room, self.unit)
            return shares, found & self._in_discs(part, across, shares - start)
        wide, bounds = self._faces(part, across, start, wide=True)
        shares, found = _least_in(
            np.concatenate([flat, wide], axis=1), np.hstack([room, bounds]), self.unit
        )
        arrived = np.zeros(len(start), dtype=bool)
        for _ in range(PLACES.renewals):
            faces, bounds = self._faces(part, across, start, shares - start)
            limits = np.concatenate([flat, faces], axis=1), np.hstack([room, bounds])
            here, inside = _least_in(*limits, self.unit)
            found &= inside | arrived
            step = np.abs(here - shares).max(axis=1)
            shares = np.where((found & ~arrived)[:, None], here, shares)
            arrived |= step <= PLACES.inside * self.unit
            if (arrived | ~found).all():
                break
        return shares, found & arrived & self._in_discs(part, across, shares - start)

    def _flat(self, part: _Part, across: Array, start: Array) -> tuple[Array, Array]:
        """Return limits (k, l, d) of flanks and stops, of unit size, and their bounds (k, l)."""
        columns = self.structure.springs + part.flat
        vectors = self.structure.vectors[columns]
        room = pick(self.loading.gap, self.rows)[:, columns] + self.compressed[:, part.flat]
        room = np.maximum(room - self.iterate.x @ vectors.T, 0.0)
        limits = np.broadcast_to(vectors @ across, (len(start), len(columns), start.shape[1]))
        return _of_unit_size(limits, room, start)

    def _faces(
        self,
        part: _Part,
        across: Array,
        start: Array,
        moved: Array | None = None,
        wide: bool = False,
    ) -> tuple[Array, Array]:
        """Return limits of arcs: their faces after shares have moved, or wide ones at rest."""
        x = self.iterate.x
        there = np.zeros_like(x) if moved is None else x + moved @ across.T
        normals, margins = arcs_at(self.arcs, there)
        normals = normals[:, part.arcs]
        vectors = -np.einsum("kai,ain->kan", normals, self.arcs.relative[part.arcs])
        room = (margins + self.compressed[:, self.structure.flat :])[:, part.arcs]
        at_shares = start if moved is None else start + moved
        if wide:
            room = room + self.sagitta[:, part.arcs] - (vectors @ x[:, :, None])[:, :, 0]
            room = np.maximum(room, 0.0)
        return _of_unit_size(vectors @ across, room, at_shares)

    def _in_discs(self, part: _Part, across: Array, moved: Array) -> Flags:
        """Return whether radial elements stay in the discs in which they carry nothing, (k,)."""
        fits, x = np.ones(len(moved), dtype=bool), self.iterate.x
        for j in part.rounds:
            column, matrix = self.structure.radial_column(j), self.structure.radials[j].matrix
            centre = pick(self.loading.gap, self.rows)[:, column : column + 2]
            places = (v @ matrix.T - centre for v in (x, x + moved @ across.T))
            radius, after = (np.hypot(*place.T) for place in places)
            numbers = pick(self.loading.radial, self.rows)[:, j]
            law = at.graph(numbers, self.iterate.force @ self.loading.carried[j], radius)
            fits &= after <= law.reach
        return fits


def _of_unit_size(limits: Array, room: Array, shares: Array) -> tuple[Array, Array]:
    """Return limits (k, l, d) of unit size, and bounds (k, l), from the room left at shares."""
    size = np.linalg.norm(limits, axis=2)
    met = size > PLACES.loose
    size = np.where(met, size, 1.0)
    bounds = np.where(met, (room + (limits @ shares[:, :, None])[:, :, 0]) / size, np.inf)
    return np.where(met[:, :, None], limits / size[:, :, None], 0.0), bounds


def _least_in(limits: Array, bounds: Array, unit: Array) -> tuple[Array, Flags]:
    """Return the points (k, d) of least norm with L s ≤ b, and whether they were found."""
    count, number, size = limits.shape
    least, found = np.zeros((count, size)), np.asarray((bounds >= 0.0).all(axis=1))
    near = PLACES.inside * unit
    for reached in range(1, size + 1):
        for some in combinations(range(number), reached):
            if found.all():
                return least, found
            faces = limits[:, some]
            gram = faces @ faces.transpose(0, 2, 1)
            met = np.isfinite(bounds[:, some]).all(axis=1)
            met &= np.linalg.det(gram) > PLACES.loose
            gram = np.where(met[:, None, None], gram, np.eye(reached))
            ends = np.where(met[:, None], bounds[:, some], 0.0)
            push = np.linalg.solve(gram, ends[:, :, None])
            point = (push.transpose(0, 2, 1) @ faces)[:, 0]
            over = ((limits @ point[:, :, None])[:, :, 0] - bounds).max(axis=1)
            takes = met & ~found & (push[:, :, 0] <= 0.0).all(axis=1) & (over <= near)
            least[takes], found = point[takes], found | takes
    return least, found


def _compression(b: Array, c: Array, force: Array) -> Array:
    return np.asarray(b * force + c * np.cbrt(force) ** 2)


def _length_units(structure: Structure, loading: Loading) -> Array:
    """Return the unit of length of every sample, (S,), as `Scene.length_unit` has it."""
    kinds = np.array(structure.kinds[structure.columns.flanks])
    drives = structure.columns.flanks.start + np.flatnonzero(kinds == "drive flank")
    push = pushes(loading)[:, None]
    b, c, gap = (v[:, drives] for v in (loading.bending, loading.hertz, loading.gap))
    yielded = np.median(_compression(b, c, push), axis=1)
    found = np.maximum(yielded, CONTACT.of_gaps * np.abs(gap).max(axis=1))
    return np.broadcast_to(found, (loading.count,))
