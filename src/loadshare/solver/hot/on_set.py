"""Samples on one set: the data on which Newton passes and checks of signs work.

All arrays of samples are of one library, NumPy's or another; see `loadshare.array_library`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from loadshare.array_library import largest, lengths, to_numpy
from loadshare.array_types import Array, Flags, Numbers, States
from loadshare.scene.loading import Loading
from loadshare.scene.statics import Basis
from loadshare.scene.structure import Structure
from loadshare.settings import HOT
from loadshare.solver.hot import contact_states as at
from loadshare.solver.hot.elements import Arcs, arcs_at, arcs_of, pick
from loadshare.solver.hot.iterate import Iterate
from loadshare.solver.hot.radials import RadialTangent


class OnSet:
    """Some samples on one set, with their numbers and iterates.

    Elements of a set are sorted: springs, contacts, radial elements with two columns each.

    Parameters
    ----------
    structure, loading, iterate
        As for `vectorised.settle`.
    states : ndarray of int8, shape (switches,)
        The set.
    rows : ndarray of int, shape (k,)
        Numbers of the samples.
    library : module
        Array library to use.

    Attributes
    ----------
    settled, refused, burst : ndarray of bool, shape (k,)
        Whether the passes arrived; whether a law has no meaning or a number overflowed; whether
        rigid contacts contradict one another, so that their forces grow without bound.
    gross, gross_to : ndarray, shape (k, switches)
        Elements that were clearly wrong before the passes had settled, and the corrected set.
    root : ndarray, shape (k, nonlinear laws)
        Cube root of the force at the next tangent of each power law, then of each table.
    loose : ndarray of int, shape (k, power laws)
        How many passes in a row a flank was not compressed.
    outside : dict of int to ndarray of int, shape (k,)
        How many passes in a row a radial element was beyond its level piece, or held inward.
    fixed : dict of int to Graph
        Laws of radial elements that do not follow the torque.
    linear : dict of int to RadialTangent
        Tangents of radial elements that stay the same.
    """

    def __init__(
        self,
        structure: Structure,
        loading: Loading,
        states: States,
        rows: Numbers,
        iterate: Iterate,
        library: Any = np,
    ) -> None:
        self.structure, self.loading, self.rows = structure, loading, rows
        self.states, basis, self.library = states, structure.basis(states), library
        columns, every = basis.columns, structure.columns
        of_samples = library.asarray
        tables = basis.directions, basis.particular, basis.redundant, basis.loose
        self.basis = Basis(columns, *map(of_samples, tables))
        self.vectors = of_samples(structure.vectors[every.contacts])
        self.scalar = slice(0, int(np.searchsorted(columns, every.contacts.stop)))
        self.contact = slice(structure.springs, self.scalar.stop)
        switches = columns[self.contact] - structure.springs
        self.closed = of_samples(states[: structure.rows] == at.CLOSED)
        self.contact_of = of_samples(_places(switches, structure.rows))
        self.acts = of_samples(np.isin(np.arange(structure.rows), switches))
        self.arc = {
            k: column - every.arcs.start
            for k, column in enumerate(columns.tolist())
            if every.arcs.start <= column < every.arcs.stop
        }
        self.radial = [
            (j, int(status), int(np.searchsorted(columns, structure.radial_column(j))))
            for j, status in enumerate(states[structure.rows :])
            if status != at.OPEN
        ]
        self._take_numbers(columns)
        self._take_laws(columns, iterate)
        self.x, self.floor = of_samples(iterate.x[rows]), of_samples(iterate.floor[rows])
        self.force = of_samples(iterate.force[rows][:, columns])
        n = self.basis.redundant
        self.z = self.force @ n
        self.lean = self.x, self.force
        self.compression, self.misfit = library.zeros_like(self.gap), 0.0 * self.floor
        pairs = len(columns), n.shape[1] ** 2
        self.products = library.reshape(n[:, :, None] * n[:, None, :], pairs)
        self.push = largest(self.load)
        self.unit = library.where(self.push > 0.0, self.push, 1.0)
        nobody = library.zeros_like(self.push, dtype=library.bool)
        self.settled = self.burst = self.refused = nobody
        shape = len(rows), structure.switches
        self.gross = library.broadcast_to(nobody[:, None], shape)
        self.gross_to = library.broadcast_to(of_samples(states)[None, :], shape)
        self.loose = library.zeros_like(self.hertz, dtype=library.int64)
        self.outside: dict[int, Numbers] = {}
        self.fixed: dict[int, at.Graph] = {}
        self.linear: dict[int, RadialTangent] = {}

    def _take_numbers(self, columns: Numbers) -> None:
        """Take the numbers of the samples: loads, gaps, arcs and graphs of radial elements."""
        loading, rows, given = self.loading, self.rows, self.library.asarray
        count, structure = len(rows), self.structure
        self.load = given(np.broadcast_to(pick(loading.load, rows), (count, structure.size)))
        gap = pick(loading.gap, rows)
        self.gap_of_contacts = given(gap[:, structure.columns.contacts])
        self.gap = given(np.broadcast_to(gap[:, columns], (count, len(columns))))
        self.arcs = Arcs(*map(given, arcs_of(loading, rows)))
        self.numbers = given(pick(loading.radial, rows))
        self.carried = given(loading.carried[:, columns])
        firsts = map(structure.radial_column, range(len(structure.radials)))
        self.centres = [given(gap[:, k : k + 2]) for k in firsts]
        self.matrices = [given(radial.matrix) for radial in structure.radials]

    def _take_laws(self, columns: Numbers, iterate: Iterate) -> None:
        """Take the laws of the scalar elements, and the roots at which they are renewed."""
        loading, rows, given = self.loading, self.rows, self.library.asarray
        shape = len(rows), len(columns)
        power = np.flatnonzero(loading.curved[columns])
        table = np.flatnonzero(loading.tabulated[columns] >= 0)
        nonlinear = np.concatenate([power, table])
        self.power, self.table, self.nonlinear = given(power), given(table), columns[nonlinear]
        self.law_of = given(_places(nonlinear, len(columns)))
        self.power_of = given(_places(columns[power] - self.structure.springs, self.structure.rows))
        bending = np.broadcast_to(pick(loading.bending, rows)[:, columns], shape)
        hertz = np.broadcast_to(pick(loading.hertz, rows)[:, columns], shape)
        self.bending, self.hertz = given(bending), given(hertz[:, power])
        self.bending_of_power = given(bending[:, power])
        tables = pick(loading.tables, rows)[:, loading.tabulated[columns[table]]]
        self.points = given(tables[:, :, 0]), given(tables[:, :, 1])
        self.root = given(iterate.root[rows][:, self.nonlinear])
        yields = np.asarray(((bending > 0.0) | (hertz > 0.0)).any(axis=0))
        yields[table] = True
        self.shared = given(self._shared(yields))

    def _shared(self, yields: Flags) -> Array:
        """Return redundants (r, q), orthonormal, in which only rigid elements take part.

        Round-off would determine their size, and would not come to rest.
        """
        for _, status, k in self.radial:
            yields[k : k + 2] = status != at.PINNED
        n = self.structure.basis(self.states).redundant
        _, sizes, right = np.linalg.svd(n[yields], full_matrices=True)
        return right[int((sizes > HOT.shared).sum()) :].T

    @property
    def patience(self) -> Mapping[int, int]:
        """How many passes show that a radial element has left its piece, by its number."""
        return {j: HOT.inward if s == at.WALL else HOT.outside for j, s, _ in self.radial}

    def at_arcs(self) -> tuple[Array, Array]:
        """Return loads and gaps with the arcs' faces turned to the present coordinates."""
        load, gap, xp = self.load, self.gap, self.library
        if not self.arc:
            return load, gap
        normals, margins = arcs_at(self.arcs, self.x)
        for k, a in self.arc.items():
            base = self.basis.directions[k, :]
            turned = -normals[:, a, :] @ self.arcs.relative[a, :, :] - base
            load = load - self.force[:, k, None] * turned
            here = (margins[:, a] + self.x @ base)[:, None]
            gap = xp.concat([gap[:, :k], here, gap[:, k + 1 :]], axis=1)
        return load, gap

    def room(self) -> Array:
        """Return how far every contact may close from the present coordinates, (k, rows)."""
        room: Array = self.gap_of_contacts - self.x @ self.vectors.T
        if self.structure.arcs:
            margins = arcs_at(self.arcs, self.x)[1]
            room = self.library.concat([room[:, : self.structure.flat], margins], axis=1)
        return room

    def graph(self, j: int, offset: Array) -> at.Graph:
        """Return the law of a radial element at an offset; found once if it is always the same."""
        known = self.fixed.get(j)
        if known is not None:
            return known
        xp, numbers = self.library, self.numbers[:, j, :]
        found = at.graph(numbers, self.force @ self.carried[j, :], lengths(offset))
        if not xp.any(xp.isnan(numbers[:, 3])) and xp.all(numbers[:, 6] == 1.0):
            self.fixed[j] = found
        return found

    def offset(self, j: int, x: Array | None = None) -> Array:
        """Return the offset (k, 2) of a radial element, at the samples' coordinates or at x."""
        found: Array = (self.x if x is None else x) @ self.matrices[j].T - self.centres[j]
        return found

    def move(self, these: Flags, share: Array) -> None:
        """Go along loose moves by shares (k, l), rolling along arcs in contact."""
        loose, where = self.basis.loose, self.library.where
        self.x = where(these[:, None], self.x + share @ loose.T, self.x)
        apart = self.x @ loose @ loose.T
        for _ in range(HOT.rolls if self.arc else 0):
            held = (self.at_arcs()[1] + self.compression) @ self.basis.particular
            self.x = where(these[:, None], held + apart, self.x)

    def store(self, iterate: Iterate) -> None:
        """Write the samples back to the iterate."""
        columns = self.structure.basis(self.states).columns
        iterate.x[self.rows] = to_numpy(self.x)
        force = np.zeros((len(self.rows), len(self.structure.kinds)))
        force[:, columns] = to_numpy(self.force)
        iterate.force[self.rows] = force
        iterate.root[np.ix_(self.rows, self.nonlinear)] = to_numpy(self.root)


def _places(columns: Numbers, count: int) -> Numbers:
    """Return where each of `count` places is among some columns, their number for none."""
    found = np.full(count, len(columns))
    found[columns] = np.arange(len(columns))
    return found
