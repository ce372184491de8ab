"""Answers in physical terms, from the iterate of a batch."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np

from loadshare.array_types import Array, Flags, States
from loadshare.scene.loading import Loading
from loadshare.scene.structure import Structure
from loadshare.settings import HOT
from loadshare.solver.hot.contact_states import PINNED
from loadshare.solver.hot.iterate import Iterate
from loadshare.train.equilibria import Equilibria, Names
from loadshare.train.situations import Situations

if TYPE_CHECKING:
    from loadshare.solver.hot.products import SparseRows


def equilibria(
    structure: Structure, situations: Situations, iterate: Iterate, compiled: bool = False
) -> Equilibria:
    """Return displacements and forces of all samples in SI units.

    With `compiled`, for many samples, products skip zeros; the result is the same up to round-off.
    """
    names = Names(structure.train)
    to: _Map = structure.cached(("map",), partial(_map, structure, names))
    force, tables = iterate.force, (*[iterate.x] * 2, *[iterate.force] * 3)
    if compiled:
        from loadshare.solver.hot.products import products

        found = [products(*each) for each in zip(tables, to.rows, strict=True)]
    else:
        found = [table @ matrix for table, matrix in zip(tables, to.matrices, strict=True)]
    rotation, displacement, reaction, torque, support = found
    rotation += structure.turned(situations)
    count, gears, radials = len(force), len(names.gears), len(names.radials)
    flanks, rings = structure.columns.flanks, structure.columns.rings
    return Equilibria(
        names,
        rotation,
        displacement.reshape(count, gears, 3),
        _pushes(force, flanks.start, flanks.stop, structure.force),
        _pushes(force, rings.start, rings.stop, structure.force),
        reaction.reshape(count, radials, 3),
        torque,
        support.reshape(count, gears, 2),
    )


def pin(structure: Structure, loading: Loading, iterate: Iterate, states: States) -> None:
    """Move gears that are pinned exactly to their pins, to the last digit.

    A friction bound may be so far above the load that a slip by round-off does work that counts.
    """
    for j in range(states.shape[1] - structure.rows):
        rows = np.flatnonzero(states[:, structure.rows + j] == PINNED)
        first = structure.radial_column(j)
        for column in (first, first + 1) if len(rows) else ():
            (at,) = np.flatnonzero(structure.vectors[column])
            pins = np.broadcast_to(loading.gap[:, column], len(states))
            iterate.x[rows, at] = pins[rows] / structure.vectors[column, at]


def without_noise(structure: Structure, iterate: Iterate, rows: Flags, searched: Flags) -> bool:
    """Set radial forces of some samples that are round-off to zero; return whether there are any.

    An element that holds a gear which no load reaches carries the round-off of the gear's contact
    forces. Contact forces are set to zero only in samples that were searched: without a torque, the
    round-off that presses flanks together would be the largest torque of the case.
    """
    contacts, first = structure.columns.contacts, structure.columns.radials.start
    force = iterate.force[rows]
    size = np.abs(force)
    size[:, first:] = np.repeat(np.hypot(force[:, first::2], force[:, first + 1 :: 2]), 2, axis=1)
    noise = (size > 0.0) & (size <= HOT.sign * np.abs(force).max(axis=1, initial=0.0)[:, None])
    noise[:, : contacts.start] = False
    noise[~searched[rows], contacts] = False
    iterate.force[rows] = np.where(noise, 0.0, force)
    return bool(noise.any())


def _pushes(force: Array, first: int, last: int, unit: float) -> Array:
    """Return forces of contacts [N]; one that pulls, by rounding, is set to zero."""
    found = np.maximum(force[:, first:last], 0.0)
    found *= unit
    return found


@dataclass(frozen=True)
class _Map:
    """Matrices from coordinates (n) and forces (m) to physical quantities in SI units.

    Attributes
    ----------
    matrices : tuple of ndarray
        To rotations (n, gears) and displacements (n, 3 gears); to reactions of radial elements
        (m, 3 radials), shafts' torques (m, shafts) and supports' forces (m, 2 gears).
    """

    matrices: tuple[Array, ...]

    @cached_property
    def rows(self) -> list[SparseRows]:
        """Sparse transposed matrices: a coordinate belongs to one or two gears, a force to one."""
        from loadshare.solver.hot.products import rows_of

        return [rows_of(matrix.T) for matrix in self.matrices]


def _map(structure: Structure, names: Names) -> _Map:
    """Return the matrices of a machine."""
    train, at, columns = structure.train, structure.coordinates, structure.columns
    gears, n, m = len(names.gears), structure.size, len(structure.kinds)
    rotation, displacement = np.zeros((n, gears)), np.zeros((n, gears, 3))
    support = np.zeros((m, gears, 2))
    reaction, torque = np.zeros((m, len(names.radials), 3)), np.zeros((m, len(train.shafts)))
    for column, (s, rate) in enumerate(structure.shafts, columns.shafts.start):
        torque[column, s] = 1.0 / rate
    for column, (g, k) in enumerate(structure.supports, columns.supports.start):
        support[column, g, k] = 1.0
    for g, name in enumerate(names.gears):
        gear, r, where = train.gears[name], at.rotation[name], at.displacement.get(name)
        if r.index is not None:
            rotation[r.index, g] = r.rate
        if where is not None:
            displacement[where, g] = gear.frame
    for j, (_, name) in enumerate(names.radials):
        column = structure.radial_column(j)
        reaction[column : column + 2, j] = -train.gears[name].frame
    return _Map(
        (
            rotation * structure.length,
            displacement.reshape(n, -1) * structure.length,
            reaction.reshape(m, -1) * structure.force,
            torque * structure.force,
            support.reshape(m, -1) * structure.force,
        )
    )
