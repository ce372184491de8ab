r"""The bound of large batches: residuals of every claim, one small matrix for all.

It is the bound of `quick`, with all that is the same for claims of which the same contacts act put
into four numbers. With r the largest residual of balance, q the norm of :math:`L^T \epsilon`, w the
rounding of lengths,

.. math:: \lvert \Delta F_e \rvert \le \kappa_e\, r + \lVert L_e \rVert (q + \lambda\, r + \mu\, w).

Arrays run along the claims. Claims with radial elements that act, or with tables, are not for it.
Source: formulation, section 16.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from loadshare.certify.bound.bound import BALANCED, SINGULAR
from loadshare.certify.bound.claim import EPS
from loadshare.certify.bound.columns import Columns
from loadshare.certify.bound.laws import LIGHT
from loadshare.certify.bound.quick import NEAR, OPPOSED, SECANT
from loadshare.certify.bound.statics import Statics
from loadshare.train.equilibria import Equilibria
from loadshare.train.ring import transverse
from loadshare.train.situations import Situations

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

WIDE = 10.0
"""Times the error without it, over which the turn of lines is bounded."""
MOST = 62
"""Contacts of which the closed ones make a number."""


def is_plain(columns: Columns, answers: Equilibria) -> bool:
    """Whether claims are for this bound."""
    train = columns.train
    tabled = any(hasattr(law, "forces") for m in train.meshes.values() for law in m.laws)
    contacts = len(columns.contacts) + 2 * len(train.drums)
    return not (tabled or train.splines or contacts > MOST or bool(answers.radial_reaction.any()))


@dataclass(frozen=True, eq=False)
class Residuals:
    """What claims leave over, arrays along the claims.

    Attributes
    ----------
    force : ndarray, shape (contacts, S)
        Of flanks, stops and arcs [N].
    gap : ndarray, shape (contacts, S)
        Their gaps; negative where they overlap [m].
    springs : ndarray, shape (springs, S)
        Forces of shafts and bearings [N].
    slack : ndarray, shape (springs, S)
        Their misfits [m].
    load, width : ndarray, shape (n, S or 1), (S,)
        f [N], rounding of lengths [m].
    turn : ndarray, shape (arcs, 2, S)
        Unit vector of every arc's line less its nominal one.
    """

    force: Array
    gap: Array
    springs: Array
    slack: Array
    load: Array
    width: Array
    turn: Array


class Batch:
    """Bounds of many claims of a train.

    Parameters
    ----------
    columns : Columns
    situations : Situations
    answers : Equilibria
    """

    def __init__(self, columns: Columns, situations: Situations, answers: Equilibria) -> None:
        self.columns, self.here, self.answers = columns, situations, answers
        self.count = len(answers.rotation)
        train = columns.train
        self.held = [
            2 * k + axis
            for k, gear in enumerate(columns.places)
            for axis in (0, 1)
            if situations.support[:, columns.order[gear], axis].any()
        ]
        self.spring_columns = [
            *range(columns.shafts.start, columns.shafts.stop),
            *(columns.bearings.start + k for k in self.held),
        ]
        ends = [(train.gears[r.gear], train.gears[n]) for r in train.drums for n in r.neighbours]
        ways = [transverse(g.centre - n.centre, g.axis) @ g.frame.T for g, n in ends]
        self.nominal = np.array(ways).reshape(-1, 2)
        self.apart = np.sqrt((self.nominal**2).sum(axis=1))
        matrix, first = columns.matrix.high, columns.arcs.start
        arcs = [
            -(way / size) @ matrix[first + 2 * k : first + 2 * k + 2]
            for k, (way, size) in enumerate(zip(self.nominal, self.apart, strict=True))
        ]
        self.contact_rows = np.concatenate(
            [matrix[list(columns.contacts)], np.reshape(arcs, (-1, matrix.shape[1]))]
        )
        self.spring_rows = matrix[self.spring_columns]

    def relative(self) -> Array:
        """Largest error of a torque over the largest torque, shape (S,); infinite if not shown."""
        found = self._residuals()
        arms = self.columns.arms
        flanks = len(arms)
        force = found.force
        torque = np.abs(self.here.torque).T
        radius = np.array([[g.base_radius] for g in self.columns.train.gears.values()])
        scale = np.maximum(np.abs(force[:flanks]).max(axis=0), (torque / radius).max(axis=0))
        largest = np.maximum(
            (np.abs(force[:flanks]) * arms[:, None]).max(axis=0), torque.max(axis=0)
        )
        scale, largest = (np.where(v > 0.0, v, 1.0) for v in (scale, largest))
        closed = (force != 0.0) | (found.gap <= NEAR * np.abs(found.gap).max(axis=0))
        doubled = self._doubled(closed, force)
        closed &= ~doubled
        numbers = (1 << np.arange(len(closed))) @ closed.astype(np.int64)
        relative = np.full(self.count, np.inf)
        for number in np.unique(numbers):
            alike = np.flatnonzero(numbers == number)
            acting = closed[:, alike[0]]
            rows = slice(None) if len(alike) == self.count else alike
            errors = self._errors(found, acting, doubled, rows, scale)
            if errors is not None:
                relative[rows] = errors / largest[rows] + EPS
        return relative

    def _residuals(self) -> Residuals:
        columns, here, answers, train = self.columns, self.here, self.answers, self.columns.train
        x = np.zeros((len(columns.coordinates), self.count))
        for gear, turn in columns.turns.items():
            if turn.coordinate is not None and not turn.shafts:
                x[turn.coordinate] = turn.radius * answers.rotation[:, columns.order[gear]]
        for gear, at in columns.places.items():
            frame = train.gears[gear].frame
            x[at : at + 2] = frame @ answers.displacement[:, columns.order[gear]].T
        rest, widest = self._rest()
        stops = columns.stops.stop - columns.stops.start
        flanks = columns.flanks.stop
        gaps = [-(self.contact_rows[: flanks + stops] @ x) - rest[: flanks + stops]]
        turned, margins = self._arcs(x)
        force = np.concatenate([answers.flank_force.T, answers.ring_force.T])
        springs = [
            answers.shaft_torque[:, k]
            / train.gears[list(train.shafts.values())[k].first].base_radius
            for k in columns.elastic_shafts
        ]
        gears = list(columns.places)
        springs += [
            answers.support_force[:, columns.order[gears[k // 2]], k % 2] for k in self.held
        ]
        forces = np.array(springs).reshape(-1, self.count)
        yielded = self._spring_compliance() * forces
        slack = self.spring_rows @ x + rest[flanks + stops :] - yielded
        load = np.zeros((len(x), len(here.torque)))
        for gear, turn in columns.turns.items():
            if turn.coordinate is not None:
                load[turn.coordinate] += here.torque[:, columns.order[gear]] / turn.radius
        width = EPS * (
            np.abs(x).max(axis=0, initial=0.0) + widest + np.abs(yielded).max(axis=0, initial=0.0)
        )
        gap = np.concatenate([*gaps, margins])
        return Residuals(force, gap, forces, slack, load, width, turned)

    def _rest(self) -> tuple[Array, Array]:
        """Lengths at X = 0 of flanks, stops and springs (…, S or 1) [m], and their size."""
        columns, here, train = self.columns, self.here, self.columns.train
        shafts, gears = len(train.shafts), len(columns.order)
        names = [*columns.contacts, *self.spring_columns]
        on, gaps = columns.constants
        varying = np.concatenate(
            [
                np.broadcast_to(v, (max(len(here.clocking), len(here.offset)), v.shape[1]))
                for v in (here.clocking, here.offset.reshape(len(here.offset), -1))
            ],
            axis=1,
        )
        assert varying.shape[1] == shafts + 3 * gears
        rest = on[:, names].T @ varying.T
        limits = np.zeros((len(names), max(len(here.gap), len(here.backlash), len(here.stop))))
        for e, (mesh, drive) in enumerate(gaps):
            limits[e] = (here.gap if drive else here.backlash)[:, mesh]
        stops = here.stop.reshape(len(here.stop), -1)
        limits[len(gaps) : len(gaps) + stops.shape[1]] = stops.T
        widest = np.abs(here.offset).max(axis=(1, 2), initial=0.0) + np.abs(limits).max(
            axis=0, initial=0.0
        )
        return rest - limits, widest

    def _spring_compliance(self) -> Array:
        """Compliance of shafts and bearings, shape (springs, S or 1) [m/N]."""
        columns, here, train = self.columns, self.here, self.columns.train
        arms = [s.first for s in train.shafts.values()]
        found = [
            train.gears[arms[k]].base_radius ** 2 / here.torsion[:, k]
            for k in columns.elastic_shafts
        ]
        gears = list(columns.places)
        found += [1.0 / here.support[:, columns.order[gears[k // 2]], k % 2] for k in self.held]
        count = max((len(f) for f in found), default=1)
        return np.array([np.broadcast_to(f, (count,)) for f in found]).reshape(-1, count)

    def _arcs(self, x: Array) -> tuple[Array, Array]:
        """Turns of the arcs' lines (arcs, 2, S) and margins (arcs, S) [m]."""
        columns, here, train = self.columns, self.here, self.columns.train
        turn, margins = [], []
        for k, (way, apart) in enumerate(zip(self.nominal, self.apart, strict=True)):
            drum, side = divmod(k, 2)
            frame = train.gears[train.drums[drum].gear].frame
            first = columns.arcs.start + 2 * k
            moved = columns.matrix.high[first : first + 2] @ x
            moved = moved + frame @ here.arc_shift[:, drum, side].T
            along, square = way @ moved, (moved**2).sum(axis=0)
            length = np.sqrt(apart * apart + 2.0 * along + square)
            longer = (2.0 * along + square) / (length + apart)
            margins.append(longer + here.arc_clearance[:, drum, side])
            turn.append((moved - longer * (way / apart)[:, None]) / length)
        if not turn:
            return np.zeros((0, 2, self.count)), np.zeros((0, self.count))
        return np.array(turn), np.array(margins)

    def _doubled(self, closed: Flags, force: Array) -> Flags:
        """Contacts without clearance to an opposed one that carries at least as much."""
        doubled = np.zeros_like(closed)
        flanks, contacts = len(self.columns.arms), len(self.columns.contacts)
        for start in (*range(flanks, contacts, 2), *range(contacts, len(closed), 2)):
            if start >= contacts:
                k = start - contacts
                cosine = self.nominal[k] @ self.nominal[k + 1] / (self.apart[k] * self.apart[k + 1])
                if cosine > -OPPOSED:
                    continue
            both = closed[start] & closed[start + 1]
            second = force[start] >= force[start + 1]
            doubled[start + 1] = both & second
            doubled[start] = both & ~second
        return doubled

    def _errors(
        self,
        found: Residuals,
        acting: Flags,
        doubled: Flags,
        rows: NDArray[np.intp] | slice,
        scale: Array,
    ) -> Array | None:
        """Largest error of a torque [N·m] of claims of which the same contacts act."""
        here, columns = self.here, self.columns
        flanks, contacts = len(columns.arms), len(columns.contacts)
        on = np.flatnonzero(acting)
        force, gap = found.force[on][:, rows], found.gap[on][:, rows]
        springs, slack = found.springs[:, rows], found.slack[:, rows]
        scale = scale[rows]
        part = on < flanks
        mesh = columns.meshes[on[part]]

        def some(array: Array) -> Array:
            return array if len(array) == 1 or isinstance(rows, slice) else array[rows]

        b, c = some(here.bending)[:, mesh].T, some(here.hertz)[:, mesh].T
        wall = np.repeat(some(here.wall), 2, axis=1).T
        walls = np.concatenate([wall, wall])[on[~part] - flanks]
        yields = np.zeros_like(force)
        yields[part] = b * force[part]
        least, most = np.zeros(len(on)), np.zeros(len(on))
        least[part], most[part] = b.min(axis=1, initial=np.inf), b.max(axis=1, initial=0.0)
        if c.any():
            root = np.cbrt(np.maximum(force[part], 0.0))
            yields[part] += c * (root * root)
            low = np.maximum(force[part], LIGHT * scale).min(axis=1)
            high = np.maximum(force[part].max(axis=1), LIGHT * scale.max())
            least[part] += 2.0 / 3.0 * c.min(axis=1) / np.cbrt(high)
            most[part] += 2.0 / 3.0 * c.max(axis=1) / np.cbrt(low)
        if not part.all():
            yields[~part] = walls * force[~part]
            least[~part], most[~part] = walls.min(axis=1), walls.max(axis=1)
        misfit = -gap - yields
        misfit = np.where(force == 0.0, np.maximum(misfit, 0.0), misfit)
        compliance = self._spring_compliance()
        least = SECANT * np.concatenate([least, compliance.min(axis=1)])
        most = np.concatenate([most, compliance.max(axis=1)])
        directions = np.concatenate([self.contact_rows[on], self.spring_rows])
        known = self._operators(directions, least)
        if known is None:
            return None
        statics, root_matrix, sizes = known
        passes = np.abs(statics.particular)
        forces = np.concatenate([force, springs])
        left = found.load[:, rows] if found.load.shape[1] > 1 else found.load
        left = left - directions.T @ forces
        arcs = on[on >= contacts] - contacts
        for k in arcs:
            first = columns.arcs.start + 2 * k
            tilt = found.turn[k][:, rows] * found.force[contacts + k][rows]
            left += columns.matrix.high[first : first + 2].T @ tilt
        slope = passes.sum(axis=1)
        residual = np.abs(left).max(axis=0) + EPS * np.abs(forces).max(axis=0) * len(forces)
        bent = np.sqrt(((root_matrix.T @ np.concatenate([misfit, slack])) ** 2).sum(axis=0))
        width = found.width[rows] + EPS * np.abs(yields).max(axis=0, initial=0.0)
        into, spread = float(slope @ (most * sizes)), float(sizes.sum())
        deepest = np.abs(misfit).max(axis=0, initial=0.0) + np.abs(slack).max(axis=0, initial=0.0)
        ways = np.abs(self.contact_rows) @ passes.T
        by_load, by_energy, by_gap = (
            float((ways @ v).max(initial=0.0))
            for v in (most * slope, most * sizes, np.ones(len(most)))
        )

        def worst(residual: Array, width: Array, weights: Array) -> Array:
            """Largest weighted error of a force."""
            energy = bent + into * residual + spread * width
            of_load, of_energy = (float((v * weights).max(initial=0.0)) for v in (slope, sizes))
            return np.asarray(of_load * residual + of_energy * energy)

        def way(residual: Array, width: Array) -> Array:
            """Largest displacement of a contact [m]."""
            energy = bent + into * residual + spread * width
            shifted = by_load * residual + by_energy * energy + by_gap * (deepest + width)
            return np.asarray(shifted)

        one = np.ones(len(directions))
        largest, moved = worst(residual, width, one), way(residual, width)
        proved = np.isfinite(largest)
        if len(arcs):
            # Errors act along lines that are nominal here; what that leaves out is bounded over a
            # box some times as wide, which must hold the result.
            turn = np.abs(found.turn[arcs][:, :, rows]).max(axis=(0, 1))
            bow = (np.abs(force[on >= contacts]) / self.apart[arcs][:, None]).max(axis=0)
            residual = residual + 2.0 * WIDE * (turn * largest + bow * moved)
            width = width + WIDE * turn * moved + (WIDE * moved) ** 2 / self.apart.min()
            again, further = worst(residual, width, one), way(residual, width)
            proved &= (again <= WIDE * largest) & (further <= WIDE * moved)
            largest, moved = again, further
        open_ = ~acting[:, None] & ~doubled[:, rows]
        proved &= np.where(open_, found.gap[:, rows], np.inf).min(axis=0, initial=np.inf) > moved
        proved &= force.min(axis=0, initial=0.0) >= 0.0
        light = np.maximum(force[part].min(axis=0, initial=np.inf), LIGHT * scale)
        proved &= largest <= 0.1 * light
        if statics.moves.size:
            stray = np.abs(statics.moves.T @ left).max(axis=0)
            proved &= stray <= BALANCED * scale
            residual = residual + stray + EPS * scale
        weights = np.zeros(len(directions))
        weights[: len(on)][part] = columns.arms[on[part]]
        errors = worst(residual, width, weights)
        return np.where(proved, errors, math.inf)

    def _operators(self, directions: Array, least: Array) -> tuple[Statics, Array, Array] | None:
        """Statics, L and the lengths of its rows; None if rigid parts share by themselves."""
        statics = Statics.of(directions)
        n = statics.redundant
        stiff = n.T @ (least[:, None] * n)
        if not np.isfinite(stiff).all():
            return None
        values, vectors = np.linalg.eigh(stiff)
        if values.size and values.min() <= SINGULAR * values.max():
            return None
        root = n @ (vectors / np.sqrt(values))
        return statics, root, np.sqrt((root**2).sum(axis=1))
