"""The coefficients of a machine's equations, at many values of an input at once."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from loadshare.array_types import Array, Flags
from loadshare.scene.loading import loading_of
from loadshare.scene.structure import Structure, structure_of
from loadshare.train import Train
from loadshare.train.gear import Gear
from loadshare.train.shape import shape_of
from loadshare.train.situations import Situations


@dataclass(frozen=True, slots=True, eq=False)
class Numbers:
    """The coefficients of a machine's equations at S values, in the units of its elements.

    Attributes
    ----------
    vectors : ndarray, shape (S or 1, m, n)
        A.
    load, gap, bending, hertz : ndarray, shape (S or 1, n), (S or 1, m) ...
        f, g, b, c; see `loadshare.scene.loading.Loading`.
    tabulated : ndarray of int, shape (S or 1, m)
        Number of the table of every element, −1 without.
    tables : ndarray, shape (S or 1, tables, 2, points)
    nominal, shift, clearance : ndarray, shape (S or 1, arcs, 3), (S or 1, arcs, 3), (S or 1, arcs)
    relative : ndarray, shape (S or 1, arcs, 3, n)
    radial : ndarray, shape (S or 1, radials, 7)
    carried : ndarray, shape (S or 1, radials, m)
    """

    vectors: Array
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

    @classmethod
    def of(cls, structure: Structure, situations: Situations) -> Numbers:
        """Collect the numbers of a machine."""
        loading = loading_of(structure, situations)
        carried = loading.carried.copy()
        carried[_idle(structure, situations)] = 0.0
        own: dict[str, Any] = {
            "vectors": structure.vectors,
            "tabulated": loading.tabulated,
            "nominal": loading.nominal,
            "relative": loading.relative,
            "carried": carried,
        }
        names = [f.name for f in fields(cls)]
        return cls(**{n: own[n][None] if n in own else getattr(loading, n) for n in names})

    @classmethod
    def stacked(cls, parts: Sequence[Numbers]) -> Numbers:
        """Return the numbers of several machines, one after another."""
        names = [f.name for f in fields(cls)]
        return cls(**{n: np.concatenate([getattr(p, n) for p in parts]) for n in names})

    @property
    def kinds(self) -> tuple[Flags, Flags, NDArray[np.intp]]:
        """Which elements have a Hertz part and which bend, at any value; tables and their points.

        The last array has the number of every element's table, then the points of a table.
        """
        points = np.append(self.tabulated[0], self.tables.shape[-1])
        curved, bends = (np.asarray((v > 0.0).any(axis=0)) for v in (self.hertz, self.bending))
        return curved, bends, points

    def row(self, number: int) -> Numbers:
        """Return the numbers at one of the values."""
        return self.take(slice(number, number + 1))

    def take(self, rows: NDArray[np.intp] | slice) -> Numbers:
        """Return the numbers at some of the values."""
        every = {f.name: getattr(self, f.name) for f in fields(self)}
        return Numbers(**{k: v[rows] if len(v) > 1 else v for k, v in every.items()})


def _idle(structure: Structure, situations: Situations) -> list[int]:
    """Return radial elements of gears without shaft, load or hold: no torque passes over them.

    The torques of such a gear's meshes balance; their sum is round-off, whose sign is meaningless.
    """
    train = situations.train
    turned = {gear for s in train.shafts.values() for gear in (s.first, s.second)}
    turned |= set(train.held)
    gears = list(train.gears)
    turned |= {gears[k] for k in np.flatnonzero(np.any(situations.torque, axis=0))}
    return [j for j, radial in enumerate(structure.radials) if radial.gear not in turned]


def structure_like(base: Structure, train: Train) -> Structure:
    """Return the structure of a train that differs from `base` in an input, in the latter's units.

    If a support's matrix changes, the directions in which it acts turn; coordinates stay those of
    `base`.

    Raises
    ------
    ValueError
        If the train has other elements.
    """
    turned = dict(_turned(base.train, train))
    seen = replace(train, gears={**train.gears, **turned}) if turned else train
    found = base
    if shape_of(seen) != shape_of(base.train):
        found = structure_of(seen)
        if found.kinds != base.kinds or found.coordinates.names != base.coordinates.names:
            raise ValueError("the parameter changes the set of elements")
        found = replace(found, force=base.force, length=base.length)
    if not turned:
        return found
    vectors, gears = found.vectors.copy(), list(train.gears)
    for column, (gear, axis) in enumerate(found.supports, found.columns.supports.start):
        if (name := gears[gear]) in turned:
            where = found.coordinates.displacement[name]
            vectors[column, where] = turned[name].frame @ train.gears[name].frame[axis]
    return replace(found, vectors=vectors)


def _turned(base: Train, train: Train) -> Iterator[tuple[str, Gear]]:
    """Yield gears whose support acts in other directions of the same plane, in their old frame."""
    for (name, before), now in zip(base.gears.items(), train.gears.values(), strict=True):
        same = before.frame is now.frame or np.array_equal(before.frame, now.frame)
        if not same and np.array_equal(before.plane, now.plane):
            yield name, replace(now, frame=before.frame)
