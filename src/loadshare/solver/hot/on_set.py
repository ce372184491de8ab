"""Samples on one set: the data on which Newton passes and checks of signs work."""

from __future__ import annotations

import numpy as np

from loadshare.array_types import Array, Flags, Numbers, States
from loadshare.scene.loading import Loading
from loadshare.scene.structure import Structure
from loadshare.settings import HOT
from loadshare.solver.hot import contact_states as at
from loadshare.solver.hot.elements import arc_at, pick
from loadshare.solver.hot.iterate import Iterate
from loadshare.solver.hot.radials import RadialTangent


class OnSet:
    """Some samples on one set, with their numbers and iterates.

    Attributes
    ----------
    settled, refused, burst : ndarray of bool, shape (k,)
        Whether the passes arrived; whether a law has no meaning or a number overflowed; whether
        rigid contacts contradict one another, so that their forces grow without bound.
    gross, gross_to : ndarray, shape (k, switches)
        Elements that were clearly wrong before the passes had settled, and the corrected set.
    loose : ndarray of int, shape (k, flanks with a power law)
        How many passes in a row a flank was not compressed.
    outside : ndarray of int, shape (k, radial elements)
        How many passes in a row an element was beyond its level piece, or held inward.
    patience : ndarray of int, shape (radial elements,)
        How many such passes show that an element has left its piece.
    fixed : dict of int to Graph
        Laws of radial elements that do not follow the torque.
    linear : dict of int to Block
        Tangents of radial elements that stay the same.
    """

    def __init__(
        self,
        structure: Structure,
        loading: Loading,
        states: States,
        rows: Numbers,
        iterate: Iterate,
    ) -> None:
        self.structure, self.loading, self.basis = structure, loading, structure.basis(states)
        self.states, self.rows, basis = states, rows, self.basis
        columns, count = basis.columns, len(rows)
        shape = (count, len(columns))
        self.load = np.broadcast_to(pick(loading.load, rows), (count, structure.size))
        self.gap = np.array(np.broadcast_to(pick(loading.gap, rows)[:, columns], shape))
        self.bending = np.broadcast_to(pick(loading.bending, rows)[:, columns], shape)
        self.hertz = np.broadcast_to(pick(loading.hertz, rows)[:, columns], shape)
        self.power = np.flatnonzero((loading.hertz[:, columns] > 0.0).any(axis=0))
        self.table = np.flatnonzero(loading.tabulated[columns] >= 0)
        tables = pick(loading.tables, rows)[:, loading.tabulated[columns[self.table]]]
        self.points = tables[:, :, 0], tables[:, :, 1]
        self.x, self.floor = iterate.x[rows], iterate.floor[rows]
        self.force, self.root = iterate.force[rows][:, columns], iterate.root[rows][:, columns]
        self.z = self.force @ basis.redundant
        self.lean = self.x, self.force
        self.compression, self.misfit = np.zeros(shape), np.zeros(count)
        first_arc = structure.columns.arcs.start
        arcs = columns - first_arc
        self.arc_at = np.flatnonzero((arcs >= 0) & (arcs < len(structure.arcs)))
        self.arc = arcs[self.arc_at]
        self.radial = [
            (j, int(status), int(np.searchsorted(columns, structure.radial_column(j))))
            for j, status in enumerate(states[structure.rows :])
            if status != at.OPEN
        ]
        self.scalar = np.flatnonzero(columns < structure.columns.contacts.stop)
        self.contact = self.scalar[columns[self.scalar] >= structure.springs]
        n = basis.redundant
        self.products = (n[:, :, None] * n[:, None, :]).reshape(len(columns), n.shape[1] ** 2)
        self.shared = self._shared()
        self.push = np.abs(self.load).max(axis=1, initial=0.0)
        self.unit = np.where(self.push > 0.0, self.push, 1.0)
        self.settled, self.burst = np.zeros(count, dtype=bool), np.zeros(count, dtype=bool)
        self.refused = np.zeros(count, dtype=bool)
        self.gross = np.zeros((count, structure.switches), dtype=bool)
        self.gross_to = np.repeat(states[None, :], count, axis=0)
        self.loose = np.zeros((count, len(self.power)), dtype=int)
        self.outside = np.zeros((count, structure.switches - structure.rows), dtype=int)
        self.patience = np.where(states[structure.rows :] == at.WALL, HOT.inward, HOT.outside)
        self.fixed: dict[int, at.Graph] = {}
        self.linear: dict[int, RadialTangent] = {}

    def _shared(self) -> Array:
        """Return redundants (r, q), orthonormal, in which only rigid elements take part.

        Round-off would determine their size, and would not come to rest.
        """
        yields = np.asarray(((self.bending > 0.0) | (self.hertz > 0.0)).any(axis=0))
        yields[self.table] = True
        for _, status, k in self.radial:
            yields[k : k + 2] = status != at.PINNED
        n = self.basis.redundant
        _, sizes, right = np.linalg.svd(n[yields], full_matrices=True)
        return right[int((sizes > HOT.shared).sum()) :].T

    def at_arcs(self) -> tuple[Array, Array]:
        """Return loads and gaps with the arcs' faces turned to the present coordinates."""
        if not len(self.arc):
            return self.load, self.gap
        load, gap = np.array(self.load), self.gap
        for k, a in zip(self.arc_at, self.arc, strict=True):
            normal, margin = arc_at(self.loading, a, self.rows, self.x)
            base = self.basis.directions[k]
            load -= self.force[:, k, None] * (-normal @ self.loading.relative[a] - base)
            gap[:, k] = margin + self.x @ base
        return load, gap

    def room(self) -> Array:
        """Return how far every contact may close from the present coordinates, (k, rows)."""
        structure, rows = self.structure, self.structure.columns.contacts
        room = pick(self.loading.gap, self.rows)[:, rows] - self.x @ structure.vectors[rows].T
        for a in range(len(structure.arcs)):
            room[:, structure.flat + a] = arc_at(self.loading, a, self.rows, self.x)[1]
        return np.asarray(room)

    def graph(self, j: int, offset: Array) -> at.Graph:
        """Return the law of a radial element at an offset; found once if it is always the same."""
        known = self.fixed.get(j)
        if known is not None:
            return known
        numbers = pick(self.loading.radial, self.rows)[:, j]
        carried = self.force @ self.loading.carried[j, self.basis.columns]
        radius = np.sqrt((offset * offset).sum(axis=1))
        found = at.graph(numbers, carried, radius)
        if not np.isnan(numbers[:, 3]).any() and (numbers[:, 6] == 1.0).all():
            self.fixed[j] = found
        return found

    def offset(self, j: int, x: Array | None = None) -> Array:
        """Return the offset (k, 2) of a radial element, at the samples' coordinates or at x."""
        column, matrix = self.structure.radial_column(j), self.structure.radials[j].matrix
        centre = pick(self.loading.gap, self.rows)[:, column : column + 2]
        return np.asarray((self.x if x is None else x) @ matrix.T - centre)

    def move(self, these: Flags, share: Array) -> None:
        """Go along loose moves by shares (k, l), rolling along arcs in contact."""
        loose = self.basis.loose
        self.x = np.where(these[:, None], self.x + share @ loose.T, self.x)
        apart = self.x @ loose @ loose.T
        for _ in range(HOT.rolls if len(self.arc) else 0):
            held = (self.at_arcs()[1] + self.compression) @ self.basis.particular
            self.x = np.where(these[:, None], held + apart, self.x)

    def store(self, iterate: Iterate) -> None:
        """Write the samples back to the iterate."""
        columns = self.basis.columns
        iterate.x[self.rows] = self.x
        force = np.zeros((len(self.rows), len(self.structure.kinds)))
        force[:, columns] = self.force
        iterate.force[self.rows] = force
        iterate.root[np.ix_(self.rows, columns)] = self.root
