"""What varies from sample to sample, in the order and the units of the force method.

Errors, clearances, loads and compliances of many situations become loads f, gaps g and laws δ of
the columns of :mod:`loadshare.scene.elements`. Source: formulation, section 11.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from loadshare.scene.elements import Elements, wind_up
from loadshare.scene.scene import Array
from loadshare.train.memory import SlipFriction, SlipStop
from loadshare.train.ring import RoundRing
from loadshare.train.situations import Situations
from loadshare.train.train import Spline


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

    def one(self, row: int) -> Data:
        """Return a sample alone."""
        varying = {
            f.name: value[row : row + 1]
            for f in fields(self)
            if f.name not in ("count", "tabulated", "nominal", "relative", "carried")
            and len(value := getattr(self, f.name)) > 1
        }
        return replace(self, count=1, **varying)

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
    for radial in scene.radials:
        if isinstance(radial.source, SlipFriction):
            gaps += [np.zeros(1)] * 2
            bends += [np.full(1, 0.5 / radial.source.spline.bending_stiffness)] * 2
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
        elif isinstance(radial.source, SlipFriction | SlipStop):
            # Friction is level for ever; its stop is a rigid ring. Both bounds are fixed.
            (piece,) = radial.source.law(0.0).pieces
            table[:, j, 2] = piece.length / elements.length
            table[:, j, 3] = piece.force / elements.force
            table[:, j, 5] = np.inf
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
