"""The numbers that vary from sample to sample, in the order and the units of the force method.

Errors, clearances, loads and compliances of many situations become loads f, gaps g and laws δ of
the columns of :mod:`loadshare.scene.structure`. Source: formulation, section 11.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np

from loadshare.array_types import Array, Flags, Numbers
from loadshare.scene.structure import Structure
from loadshare.settings import LAWS
from loadshare.train.situations import Situations


@dataclass(frozen=True, eq=False)
class Loading:
    """Numbers that vary, in the units of the force method; leading axes are S or 1.

    Attributes
    ----------
    count : int
        S.
    load : ndarray, shape (S or 1, n)
        f.
    gap : ndarray, shape (S or 1, m)
        g; the clearance of an arc is in `clearance` instead.
    bending, hertz : ndarray, shape (S or 1, m)
        b and c of every scalar element.
    tabulated : ndarray of int, shape (m,)
        Number of an element's table, −1 if it has none.
    tables : ndarray, shape (S or 1, tables, 2, points)
    nominal, shift : ndarray, shape (arcs, 3) and (S or 1, arcs, 3)
        d₀ of the arcs is their sum.
    clearance : ndarray, shape (S or 1, arcs)
    relative : ndarray, shape (arcs, 3, n)
        Matrices from the coordinates to the relative displacement of an arc's centres.
    radial : ndarray, shape (S or 1, radials, 8)
        First stiffness (K_w; 0 inside a ring), S1 (NaN for F_m/K_w), S2 or the ring's radius, F_m
        (NaN if it follows the torque), τ/radius [1/m], stiffness beyond S2, power of the force
        there, and the force at which a wall with a power is taken to begin.
    carried : ndarray, shape (radials, m)
        Torque that reaches the gear of each element over its spline, per unit of each force [m].
    """

    count: int
    load: Array
    gap: Array
    bending: Array
    hertz: Array
    tabulated: Numbers
    tables: Array
    nominal: Array
    shift: Array
    clearance: Array
    relative: Array
    radial: Array
    carried: Array

    def take(self, rows: Numbers) -> Loading:
        """Return some of the samples."""
        varying = {
            f.name: value[rows]
            for f in fields(self)
            if f.name not in ("count", "tabulated", "nominal", "relative", "carried")
            and len(value := getattr(self, f.name)) > 1
        }
        return replace(self, count=len(rows), **varying)

    def one(self, row: int) -> Loading:
        """Return a sample alone."""
        return self.take(np.array([row]))

    @cached_property
    def loaded(self) -> Numbers:
        """Coordinates with a load in some sample."""
        return np.flatnonzero(self.load.any(axis=0))

    @cached_property
    def push(self) -> Array:
        """Largest load of every sample, shape (S or 1,)."""
        return np.asarray(np.abs(self.load[:, self.loaded]).max(axis=1, initial=0.0))

    @cached_property
    def steady(self) -> Flags:
        """Elements whose b is the same in all samples, shape (m,)."""
        return np.asarray((self.bending == self.bending[:1]).all(axis=0))

    @cached_property
    def curved(self) -> Flags:
        """Elements with c > 0 in some sample, shape (m,)."""
        return np.asarray(self.hertz.any(axis=0))

    @cached_property
    def nonlinear(self) -> slice:
        """Columns from the first to the last element whose law is a power or a table."""
        at = np.flatnonzero(self.curved | (self.tabulated >= 0))
        return slice(at[0], at[-1] + 1) if len(at) else slice(0)

    @cached_property
    def root(self) -> Array:
        """Cube root of the largest load of every sample, shape (S or 1,); 1 if there is none."""
        return np.cbrt(np.where(self.push > 0.0, self.push, 1.0))

    @cached_property
    def laws(self) -> bytes:
        """Key of what an active set's structure depends on: kinds of laws, constant compliances."""
        first = self.radial[:, :, 0]
        constant = np.append(
            np.where(self.steady, self.bending[0], np.nan),
            np.where((first == first[:1]).all(axis=0), first[0], np.nan),
        )
        return self.curved.tobytes() + self.tabulated.tobytes() + constant.tobytes()

    @cached_property
    def follows(self) -> Flags:
        """Radial elements whose friction follows the torque in some sample, shape (radials,)."""
        return np.asarray(np.isnan(self.radial[:, :, 3]).any(axis=0))


def loading_of(structure: Structure, situations: Situations) -> Loading:
    """Write the numbers of many situations in the order and the units of the elements."""
    columns, train = structure.columns, structure.train
    force, length = structure.force, structure.length
    gaps: list[Block] = [(columns.flanks, structure.gaps_of_flanks(situations))]
    bends: list[Block] = []
    shafts, turned = list(train.shafts.values()), structure.turned(situations)
    for column, (s, rate) in enumerate(structure.shafts, columns.shafts.start):
        a, b = (turned[:, train.order[gear]] for gear in (shafts[s].first, shafts[s].second))
        gaps.append((column, (situations.clocking[:, s] - a + b) / rate))
        bends.append((column, 1.0 / (situations.torsion[:, s] * rate**2)))
    for column, (g, k) in enumerate(structure.supports, columns.supports.start):
        bends.append((column, 1.0 / situations.support[:, g, k]))
    if train.slip is not None:
        bends.append((columns.bends, np.repeat(0.5 / situations.spline[:, :, 0], 2, axis=1)))
    bends.append((columns.flanks, situations.bending))
    gaps.append((columns.stops, situations.stop.reshape(len(situations.stop), -1)))
    walls = np.repeat(situations.wall, 2, axis=1)
    bends += [(columns.stops, walls), (columns.arcs, walls)]
    centres = structure.centres(situations)
    gaps.append((columns.radials, centres.reshape(len(centres), -1)))
    tabulated = np.full(len(structure.names), -1)
    if situations.table.shape[-1]:
        has = situations.table[0, :, 0, 1] > 0.0
        tabulated[columns.flanks] = np.where(has, np.arange(len(has)), -1)
    load = situations.torque @ structure.load_per_torque
    if situations.push.any():
        load = load + situations.push.reshape(len(situations.push), -1) @ structure.load_per_force
    load = load / force
    return Loading(
        count=situations.count,
        load=load,
        gap=_side_by_side(structure, gaps, 1.0 / length),
        bending=_side_by_side(structure, bends, force / length),
        hertz=_side_by_side(
            structure,
            [(columns.flanks, situations.hertz)],
            math.cbrt(force) ** 2 / length,
        ),
        tabulated=tabulated,
        tables=situations.table / np.array([force, length])[:, None],
        nominal=structure.nominal / length,
        shift=situations.arc_shift.reshape(len(situations.arc_shift), -1, 3) / length,
        clearance=situations.arc_clearance.reshape(len(situations.arc_clearance), -1) / length,
        relative=structure.relative,
        radial=_radials(structure, situations, load),
        carried=structure.levers,
    )


Block = tuple[slice | int, Array]
"""Columns, and their values (S or 1, columns), or (S or 1,) for a single one."""


def _side_by_side(structure: Structure, blocks: list[Block], factor: float) -> Array:
    """Put values in their columns, times a factor; zero elsewhere."""
    row = np.zeros((1, len(structure.names)))
    varying = []
    for columns, values in blocks:
        if len(values) > 1:
            varying.append((columns, values))
        else:
            row[:, columns] = values * factor
    # Values that are the same in all samples are written to all rows at once.
    table = np.empty((max((len(values) for _, values in varying), default=1), row.shape[1]))
    table[:] = row
    for columns, values in varying:
        np.multiply(values, factor, out=table[:, columns])
    return table


def _radials(structure: Structure, situations: Situations, load: Array) -> Array:
    """Return the numbers of every radial law, in the units of the force method.

    Parameters
    ----------
    structure : Structure
    situations : Situations
    load : ndarray, shape (S or 1, n)
        Over the force unit.
    """
    here, radials = situations, structure.radials
    bent = bool((here.round_power != 1.0).any())
    varying = (here.spline, here.round_radius, here.round_stiffness, load if bent else load[:1])
    table = np.zeros((max(map(len, varying)), len(radials), 8))
    if not radials:
        return table
    table[:, :, 6] = 1.0
    if bent:
        # Of the sample's own load: a force that is faint under a large load of another sample is
        # none under a small one.
        push = np.abs(load).max(axis=1, initial=0.0)
        table[:, :, 7] = LAWS.wall_start * np.where(push > 0.0, push, 1.0)[:, None]
    stiffness, stick, reach, bound, per_torque = np.moveaxis(here.spline, 2, 0)
    for j, radial in enumerate(radials):
        k, row = radial.number, table[:, j]
        match radial.kind:
            case "ring":
                row[:, 2], row[:, 5] = here.round_radius[:, k], here.round_stiffness[:, k]
                row[:, 6] = power = here.round_power[0, k]
                row[:, 5] *= structure.length ** (power - 1.0)
            case "spline":
                row[:, 0] = row[:, 5] = stiffness[:, k]
                row[:, 1], row[:, 2], row[:, 3] = stick[:, k], reach[:, k], bound[:, k]
                row[:, 4] = per_torque[:, k]
            case "friction":
                # A level piece without end.
                row[:, 2], row[:, 3], row[:, 5] = np.inf, bound[:, k], np.inf
            case _:
                # A rigid ring.
                room = reach[:, k] - bound[:, k] / stiffness[:, k]
                row[:, 2], row[:, 5] = np.maximum(room, 0.0), np.inf
    stiff = structure.force / structure.length
    table /= [stiff, structure.length, structure.length, structure.force, 1.0, stiff, 1.0, 1.0]
    return table
