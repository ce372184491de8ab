"""The certificate of many answers at once: the same figures as `certify`, as arrays.

It is built as the single certificate is, from force vectors on bodies and the train's own approach,
and like it knows of no solver and no scene. Tests hold the two against each other, on right answers
and on wrong ones.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from loadshare.certify.certificate import BAND, TOLERANCE
from loadshare.certify.mechanics import Mechanics, judged, mechanics
from loadshare.certify.state import turned
from loadshare.train.equilibria import Equilibria
from loadshare.train.radial import ROUNDING
from loadshare.train.ring import DrumRing, RoundRing, transverse
from loadshare.train.situations import Situations
from loadshare.train.train import Train

Array = NDArray[np.float64]

RESIDUALS = (
    "force_balance",
    "moment_balance",
    "penetration",
    "complementarity",
    "deformation_law",
    "cone_membership",
    "energy_gap",
)
TOGETHER = 2048
"""Answers judged together: as many as a processor's own memory holds."""


@dataclass(frozen=True, slots=True, eq=False)
class Verdicts:
    """Certificates of S answers.

    Attributes
    ----------
    residuals : ndarray, shape (S, 7)
        Scaled, in the order of `RESIDUALS`; infinite where an answer cannot be judged.
    tolerance : float
    load, deflection : ndarray, shape (S,)
        Scales [N], [m].
    """

    residuals: Array
    tolerance: float
    load: Array
    deflection: Array

    @property
    def worst(self) -> Array:
        """Largest scaled residual of every answer."""
        return np.asarray(self.residuals.max(axis=1))

    @property
    def passed(self) -> NDArray[np.bool_]:
        """Whether every scaled residual is within the tolerance."""
        return np.asarray(self.worst <= self.tolerance)


class Judge:
    """The mechanics of a train, written once for all answers.

    Parameters
    ----------
    train : Train
    """

    def __init__(self, train: Train) -> None:
        self.train = train
        gears = list(train.gears.values())
        self.order = {g.name: k for k, g in enumerate(gears)}
        self.moving = [k for k, g in enumerate(gears) if g.support is not None]
        meshes = list(train.meshes.values())
        self.flanks = [(k, m, d) for k, m in enumerate(meshes) for d in m.flanks]
        self.mesh_of = np.array([k for k, _, _ in self.flanks], dtype=int)
        self.is_drive = np.array([d for _, _, d in self.flanks], dtype=bool)
        count, width = len(gears), len(self.flanks)
        self.turning = np.zeros((count, width))
        self.pushing = np.zeros((count, 3, width))
        self.moment = np.zeros((width, count))
        for e, (_, mesh, drive) in enumerate(self.flanks):
            driver, driven = self.order[mesh.driver], self.order[mesh.driven]
            on_driver, on_driven, normal = mesh.direction(drive)
            self.turning[driver, e] += on_driver
            self.turning[driven, e] += on_driven
            self.pushing[driver, :, e] += normal
            self.pushing[driven, :, e] -= normal
            along = 1.0 if drive else -1.0
            self.moment[e, driver] -= along * mesh.radii[0]
            self.moment[e, driven] += along * mesh.radii[1]
        self.flat_pushing = self.pushing.reshape(3 * count, width)
        self.drums = [r for r in train.rings.values() if isinstance(r, DrumRing)]
        self.rounds = [r for r in train.rings.values() if isinstance(r, RoundRing)]
        self.nominal = [
            np.array([_apart(train, r.gear, neighbour) for neighbour in r.neighbours])
            for r in self.drums
        ]
        self.radius = np.array([g.base_radius for g in gears])
        self.groups = _turning_as_one(train)
        self.tabled = [
            (e, k) for e, (k, m, _) in enumerate(self.flanks) if hasattr(m.laws[0], "forces")
        ]

    def squeezed(self, ring: DrumRing) -> bool:
        """Whether nothing gives way between the arcs of a ring (see `State.squeezes`)."""
        return math.isinf(ring.stiffness) and not any(
            self.train.gears[n].moves for n in ring.neighbours
        )

    @cached_property
    def _mechanics(self) -> Mechanics:
        return mechanics(self)

    def judge(
        self,
        situations: Situations,
        answers: Equilibria,
        tolerance: float = TOLERANCE,
        compiled: bool = False,
    ) -> Verdicts:
        """Judge S claimed equilibria.

        Parameters
        ----------
        situations : Situations
        answers : Equilibria
        tolerance : float
            Largest scaled residual of a certified answer.
        compiled : bool
            With Numba, one answer after another, instead of NumPy: the same figures up to
            round-off, several times as fast once it is compiled.
        """
        if compiled:
            residuals, load, deflection = judged(self._mechanics, situations, answers)
            return Verdicts(residuals, tolerance, load, deflection)
        count = len(answers.rotation)
        parts = [slice(at, at + TOGETHER) for at in range(0, count, TOGETHER)]
        with np.errstate(all="ignore"):
            if len(parts) <= 1:
                return _Bench(self, situations, answers).verdicts(tolerance)
            every = [
                _Bench(self, situations.take(p), answers.part(p)).verdicts(tolerance) for p in parts
            ]
        residuals, load, deflection = (
            np.concatenate([getattr(v, name) for v in every])
            for name in ("residuals", "load", "deflection")
        )
        return Verdicts(residuals, tolerance, load, deflection)


class _Bench:
    """Answers on the bench: approaches and forces, then residuals.

    All arrays lie with the samples next to one another in memory: sums and largest values over a
    few elements then run along the samples, which is several times faster.
    """

    def __init__(self, judge: Judge, situations: Situations, answers: Equilibria) -> None:
        self.of, self.train = judge, judge.train
        self.situations = situations = situations.laid(_lying)
        self.answers = answers = answers.laid(_lying)
        self.count = len(answers.rotation)
        self.force = answers.flank_force
        offset, moved = _flat(situations.offset), _flat(answers.displacement)
        gap = np.where(
            judge.is_drive,
            situations.gap[:, judge.mesh_of],
            situations.backlash[:, judge.mesh_of],
        )
        self.at_rest = _times(offset, judge.flat_pushing) - gap
        self.approach = _times(answers.rotation, judge.turning) + self.at_rest
        self.approach += _times(moved, judge.flat_pushing)
        self.bending = situations.bending[:, judge.mesh_of]
        self.hertz = situations.hertz[:, judge.mesh_of]
        positive = np.maximum(self.force, 0.0)
        root = np.zeros_like(positive)
        if self.hertz.any():
            np.cbrt(positive, out=root, where=positive > 0.0)
        square = root * root
        self.compression = self.bending * positive + self.hertz * square
        self.dual = 0.5 * self.bending * positive**2 + 0.6 * self.hertz * (square * square * root)
        self.primal = self._strain(root)
        for e, k in judge.tabled:
            self._tabulate(e, k, positive[:, e])
        self._scales(offset)
        self._ring_contacts()
        self._pulls()

    def _strain(self, root: Array) -> Array:
        """Strain energy at the approach, from the cube roots of the claimed forces.

        The energy is ∫F dδ at the claimed approach, so the force there has to be found. Where the
        deformation law holds, one step of Newton's method from the claimed force arrives at it;
        elsewhere it is found from above.
        """
        b, c = self.bending, self.hertz
        approach = np.maximum(self.approach, 0.0)
        linear = np.where(b > 0.0, approach / np.where(b > 0.0, b, 1.0), 0.0)
        energy = 0.5 * linear * approach
        if c.any():
            curve, rise = (b * root + c) * root * root, (3.0 * b * root + 2.0 * c) * root
            step = (curve - approach) / rise
            y = root - step
            powers = c > 0.0
            far = powers & (approach > 0.0) & ~(np.abs(step) <= 1e-8 * root)
            if far.any():
                wide = (np.broadcast_to(v, far.shape)[far] for v in (b, c, approach))
                y[far] = _root(*wide)
            square = y * y
            curved = (0.5 * b * y + 0.4 * c) * (square * square * y)
            energy = np.where(powers, curved, energy)
        return np.asarray(np.where(self.approach <= 0.0, 0.0, energy))

    def _tabulate(self, e: int, mesh: int, force: Array) -> None:
        """Compression and energies of a tabulated flank."""
        table = self.situations.table[:, mesh]
        forces, compressions = (
            np.broadcast_to(t, (self.count, t.shape[1])) for t in (table[:, 0], table[:, 1])
        )
        self.compression[:, e] = _interpolated(forces, compressions, force)
        self.dual[:, e] = _area(forces, compressions, force)
        approach = np.maximum(self.approach[:, e], 0.0)
        true = np.where(approach > 0.0, _interpolated(compressions, forces, approach), 0.0)
        self.primal[:, e] = true * approach - _area(forces, compressions, true)

    def _scales(self, offset: Array) -> None:
        """Load and deflection of every answer (see `State`)."""
        torque = self.situations.torque
        pushed = (np.abs(torque) / self.of.radius).max(axis=1, initial=0.0)
        load = np.maximum(np.abs(self.force).max(axis=1, initial=0.0), pushed)
        self.load = np.where(load == 0.0, 1.0, load)
        closed = self.force > 0.0
        lengths = np.maximum(self.compression, np.abs(self.at_rest))
        lengths = np.where(closed, lengths, 0.0).max(axis=1, initial=0.0)
        shifts = np.sqrt((self.situations.offset**2).sum(axis=2)).max(axis=1, initial=0.0)
        deflection = np.maximum(lengths, shifts)
        self.deflection = np.where(deflection == 0.0, 1e-6, deflection)

    def _ring_contacts(self) -> None:
        """Stops, then arcs: approach, at rest, compliance, force, and their push on each gear."""
        situations, order = self.situations, self.of.order
        moved = self.answers.displacement
        self.ring_push = _lying(np.zeros(moved.shape))
        approach, at_rest, wall = [], [], []
        number = 0
        for d, ring in enumerate(self.of.drums):
            across = moved[:, order[ring.gear]] @ ring.across
            for side, sign in ((0, 1.0), (1, -1.0)):
                limit = situations.stop[:, d, side]
                approach.append(sign * across - limit)
                at_rest.append(-limit + np.zeros(self.count))
                wall.append(situations.wall[:, d] + np.zeros(self.count))
                force = self.answers.ring_force[:, number]
                self.ring_push[:, order[ring.gear]] -= sign * force[:, None] * ring.across
                number += 1
        for d, ring in enumerate(self.of.drums):
            for side, neighbour in enumerate(ring.neighbours):
                nominal = self.of.nominal[d][side]
                relative = moved[:, order[ring.gear]] - moved[:, order[neighbour]]
                apart = situations.arc_shift[:, d, side] + relative
                here = nominal + apart
                size = np.sqrt((here**2).sum(axis=1))
                grown = 2.0 * apart @ nominal + (apart**2).sum(axis=1)
                distance = math.sqrt(nominal @ nominal)
                margin = grown / (size + distance) + situations.arc_clearance[:, d, side]
                normal = here / size[:, None]
                force = self.answers.ring_force[:, number]
                approach.append(-margin)
                at_rest.append((normal * relative).sum(axis=1) - margin)
                wall.append(situations.wall[:, d] + np.zeros(self.count))
                self.ring_push[:, order[ring.gear]] += force[:, None] * normal
                self.ring_push[:, order[neighbour]] -= force[:, None] * normal
                number += 1
        none = np.zeros((self.count, 0))
        self.ring_approach, self.ring_at_rest, self.ring_wall = (
            np.stack(v).T if v else none for v in (approach, at_rest, wall)
        )

    def _pulls(self) -> None:
        """Radial elements: offsets, laws, reactions."""
        situations, order = self.situations, self.of.order
        moved = self.answers.displacement
        zero = np.zeros(self.count)
        self.pull_gear: list[int] = []
        self.pull_offset: list[Array] = []
        self.pull_centre: list[Array] = []
        self.pull_law: list[tuple[Array, ...]] = []
        self.fault = np.zeros(self.count, dtype=bool)
        for q, ring in enumerate(self.of.rounds):
            self.pull_gear.append(order[ring.gear])
            self.pull_offset.append(moved[:, order[ring.gear]] - ring.offset)
            self.pull_centre.append(ring.offset)
            radius = situations.round_radius[:, q] + zero
            self.pull_law.append(
                (zero, zero, zero, radius, situations.round_stiffness[:, q] + zero)
            )
        for k, gear in enumerate(self.train.splines):
            self.pull_gear.append(order[gear])
            self.pull_offset.append(moved[:, order[gear]])
            self.pull_centre.append(np.zeros(3))
            stiffness, given, reach, fixed, per_torque = situations.spline[:, k].T
            torque = np.abs(self.force @ -self.of.moment[:, order[gear]])
            bound = np.where(np.isnan(fixed), per_torque * torque, fixed)
            continuous = bound / stiffness
            stick = np.where(np.isnan(given), continuous, np.minimum(given, continuous))
            drops = stiffness * given > bound * (1.0 + ROUNDING)
            self.fault |= drops | (~np.isnan(given) & (reach < stick))
            stick = np.where((reach < stick) & np.isnan(given), np.inf, stick)
            law = (stiffness, stick, bound, reach, stiffness)
            self.pull_law.append(tuple(v + zero for v in law))

    def verdicts(self, tolerance: float) -> Verdicts:
        """All residuals, scaled."""
        work = self.load * self.deflection
        figures = np.stack(
            [
                self._force_balance() / self.load,
                self._moment_balance() / self.load,
                self._penetration() / self.deflection,
                self._complementarity() / work,
                self._deformation_law() / self.deflection,
                self._cone_membership() / self.load,
                self._energy_gap() / work,
            ]
        ).T
        answers = self.answers
        finite = np.ones(self.count, dtype=bool)
        for claimed in (
            answers.rotation,
            answers.displacement,
            answers.flank_force,
            answers.ring_force,
            answers.radial_reaction,
            answers.shaft_torque,
            answers.support_force,
        ):
            finite &= np.isfinite(claimed.sum(axis=tuple(range(1, claimed.ndim))))
        bad = self.fault | ~finite | np.isnan(figures).any(axis=1)
        return Verdicts(
            np.where(bad[:, None], np.inf, figures), tolerance, self.load, self.deflection
        )

    def _force_balance(self) -> Array:
        pushes = self.of.flat_pushing @ self.force.T
        total = self.ring_push - np.moveaxis(pushes.reshape(-1, 3, self.count), -1, 0)
        for j, gear in enumerate(self.pull_gear):
            total[:, gear] += self.answers.radial_reaction[:, j]
        worst = np.zeros(self.count)
        gears = list(self.train.gears.values())
        for k in self.of.moving:
            frame = gears[k].frame
            balance = _times(total[:, k], frame.T) - self.answers.support_force[:, k]
            worst = np.fmax(worst, np.sqrt((balance**2).sum(axis=1)))
        return np.asarray(worst)

    def _winds(self) -> list[tuple[int, int, int, Array, Array]]:
        """Number, gears, wind-up and torque of every shaft; no torque for a rigid one."""
        phi, order = self.answers.rotation, self.of.order
        found = []
        for s, shaft in enumerate(self.train.shafts.values()):
            a, b = order[shaft.first], order[shaft.second]
            wind = phi[:, a] - phi[:, b] - self.situations.clocking[:, s]
            torque = self.answers.shaft_torque[:, s]
            if math.isinf(shaft.stiffness):
                torque = np.zeros(self.count)
            found.append((s, a, b, wind, torque))
        return found

    def _bearings(self) -> list[tuple[int, Array, Array, Array]]:
        """Gear, stiffness, displacement and bearing force of every gear that can be displaced."""
        gears = list(self.train.gears.values())
        moved = self.answers.displacement
        return [
            (
                k,
                self.situations.support[:, k],
                _times(moved[:, k], gears[k].frame.T),
                self.answers.support_force[:, k],
            )
            for k in self.of.moving
        ]

    def _moment_balance(self) -> Array:
        moment = self.situations.torque + _times(self.force, self.of.moment)
        for _, a, b, _, torque in self._winds():
            moment[:, a] -= torque
            moment[:, b] += torque
        worst = np.zeros(self.count)
        held = self.of.order[self.train.output]
        for group in self.of.groups:
            if held not in group:
                total = moment[:, group].sum(axis=1)
                worst = np.fmax(worst, np.abs(total) / self.of.radius[group].max())
        return worst

    def _penetration(self) -> Array:
        worst = (self.approach - self.compression).max(axis=1, initial=0.0)
        allowed = self.ring_wall * np.maximum(self.answers.ring_force, 0.0)
        worst = np.maximum(worst, (self.ring_approach - allowed).max(axis=1, initial=0.0))
        for offset, law in zip(self.pull_offset, self.pull_law, strict=True):
            beyond = np.sqrt((offset**2).sum(axis=1)) - law[3]
            worst = np.maximum(worst, np.where(np.isinf(law[4]), beyond, 0.0))
        return np.asarray(worst)

    def _complementarity(self) -> Array:
        work = self.force * (self.compression - self.approach)
        forces = self.answers.ring_force
        rings = forces * (self.ring_wall * np.maximum(forces, 0.0) - self.ring_approach)
        return np.asarray(np.maximum(work.max(axis=1, initial=0.0), rings.max(axis=1, initial=0.0)))

    def _deformation_law(self) -> Array:
        band = BAND * self.load[:, None]
        misfit = np.where(self.force > band, np.abs(self.approach - self.compression), 0.0)
        worst = misfit.max(axis=1, initial=0.0)
        forces = self.answers.ring_force
        misfit = np.where(forces > band, np.abs(self.ring_approach - self.ring_wall * forces), 0.0)
        worst = np.maximum(worst, misfit.max(axis=1, initial=0.0))
        for s, a, _, wind, torque in self._winds():
            off = np.abs(wind - torque / self.situations.torsion[:, s])
            worst = np.maximum(worst, off * self.of.radius[a])
        for _, stiffness, moved_to, force in self._bearings():
            held = stiffness > 0.0
            off = np.where(held, moved_to - force / np.where(held, stiffness, 1.0), 0.0)
            worst = np.maximum(worst, np.sqrt((off**2).sum(axis=1)))
        moved = self.answers.displacement
        for k, gear in enumerate(self.train.gears.values()):
            off = moved[:, k]
            if gear.support is not None:
                off = off - _times(off, gear.frame.T @ gear.frame)
            worst = np.maximum(worst, np.sqrt((off**2).sum(axis=1)))
        output = self.of.order[self.train.output]
        held = np.abs(self.answers.rotation[:, output]) * self.of.radius[output]
        return np.asarray(np.maximum(worst, held))

    def _cone_membership(self) -> Array:
        worst = np.maximum(
            (-self.force).max(axis=1, initial=0.0),
            (-self.answers.ring_force).max(axis=1, initial=0.0),
        )
        for _, stiffness, _, force in self._bearings():
            free = np.where(stiffness > 0.0, 0.0, force)
            worst = np.maximum(worst, np.sqrt((free**2).sum(axis=1)))
        band = BAND * self.deflection
        worst = np.maximum(worst, self._squeezes(band))
        for j, (offset, law) in enumerate(zip(self.pull_offset, self.pull_law, strict=True)):
            reaction = self.answers.radial_reaction[:, j]
            radius = np.sqrt((offset**2).sum(axis=1))
            size = np.sqrt((reaction**2).sum(axis=1))
            low, high = _interval(law, radius, band)
            outward = offset / np.where(radius > 0.0, radius, 1.0)[:, None]
            leaning = -(reaction * outward).sum(axis=1)
            along = np.where(radius > band, leaning, size)
            sideways = np.sqrt(((reaction + leaning[:, None] * outward) ** 2).sum(axis=1))
            sideways = np.where(radius > band, sideways, 0.0)
            worst = np.maximum(worst, np.maximum(np.maximum(low - along, along - high), sideways))
        return np.asarray(worst)

    def _squeezes(self, band: Array) -> Array:
        """What the squeeze of opposed rigid arcs leaves open (see `State.squeezes`)."""
        worst = np.zeros(self.count)
        for d, ring in enumerate(self.of.drums):
            if not self.of.squeezed(ring):
                continue
            nominal = self.of.nominal[d]
            start = nominal + self.situations.arc_shift[:, d]
            unit = start / np.sqrt((start**2).sum(axis=2))[:, :, None]
            wedge = np.sqrt((unit.sum(axis=1) ** 2).sum(axis=1))
            first = 2 * len(self.of.drums) + 2 * d
            squeeze = self.answers.ring_force[:, first : first + 2].min(axis=1)
            distance = float(np.sqrt((nominal**2).sum(axis=1)).min())
            worst = np.maximum(worst, squeeze * turned(wedge + 0.0 * band, band, distance))
        return worst

    def _energy_gap(self) -> Array:
        gap = -(self.situations.torque * self.answers.rotation).sum(axis=1)
        gap = gap + (self.primal + self.dual - self.force * self.at_rest).sum(axis=1)
        forces = np.maximum(self.answers.ring_force, 0.0)
        wall = self.ring_wall
        stored = np.where(
            (wall > 0.0) & (self.ring_approach > 0.0),
            0.5 * self.ring_approach**2 / np.where(wall > 0.0, wall, 1.0),
            0.0,
        )
        rings = stored + 0.5 * wall * forces**2 - self.answers.ring_force * self.ring_at_rest
        gap += rings.sum(axis=1)
        for s, shaft in enumerate(self.train.shafts.values()):
            if not math.isinf(shaft.stiffness):
                _, _, _, wind, torque = self._winds()[s]
                stiffness = self.situations.torsion[:, s]
                gap += 0.5 * stiffness * wind**2 + 0.5 * torque**2 / stiffness
                gap += torque * self.situations.clocking[:, s]
        for _, stiffness, moved, force in self._bearings():
            held = stiffness > 0.0
            dual = np.where(held, force**2 / np.where(held, stiffness, 1.0), 0.0)
            gap += 0.5 * (stiffness * moved**2 + dual).sum(axis=1)
        for j, (offset, law) in enumerate(zip(self.pull_offset, self.pull_law, strict=True)):
            reaction = self.answers.radial_reaction[:, j]
            gap += _energy(law, np.sqrt((offset**2).sum(axis=1)))
            gap += _complementary(law, np.sqrt((reaction**2).sum(axis=1)))
            gap -= reaction @ self.pull_centre[j]
        return np.asarray(np.abs(gap))


def _apart(train: Train, gear: str, neighbour: str) -> Array:
    """Way from a neighbour's nominal centre, across the gear's axis (3,) [m]."""
    here = train.gears[gear]
    return transverse(here.centre - train.gears[neighbour].centre, here.axis)


def _lying(array: Array) -> Array:
    """The same array with its first axis next to one another in memory."""
    return np.moveaxis(np.ascontiguousarray(np.moveaxis(array, 0, -1)), -1, 0)


def _flat(array: Array) -> Array:
    """Put the inner axes of such an array (S, …) together, (S, all of them)."""
    inner = np.moveaxis(array, 0, -1)
    return np.asarray(inner.reshape(-1, inner.shape[-1]).T)


def _times(array: Array, matrix: Array) -> Array:
    """Return the product of such an array with a matrix, lying as it does."""
    return np.asarray((matrix.T @ array.T).T)


def _turning_as_one(train: Train) -> list[list[int]]:
    """Numbers of the gears joined by rigid shafts."""
    order = {g: k for k, g in enumerate(train.gears)}
    group = list(range(len(order)))
    for shaft in train.shafts.values():
        if math.isinf(shaft.stiffness):
            a, b = group[order[shaft.first]], group[order[shaft.second]]
            group = [a if g == b else g for g in group]
    return [[k for k, g in enumerate(group) if g == which] for which in sorted(set(group))]


def _root(b: Array, c: Array, compression: Array) -> Array:
    """F^(1/3) of the law b F + c F^(2/3), c > 0, by Newton's method from above."""
    y = np.sqrt(compression / c)
    y = np.where(b > 0.0, np.minimum(y, np.cbrt(compression / np.where(b > 0.0, b, 1.0))), y)
    for _ in range(60):
        step = ((b * y + c) * y * y - compression) / ((3.0 * b * y + 2.0 * c) * y)
        y = y - step
        if (np.abs(step) <= 1e-15 * y).all():
            break
    return np.asarray(y)


def _interpolated(axis: Array, values: Array, at: Array) -> Array:
    """Values of tables (S, points) at `at` (S,), straight beyond the last point."""
    last = (~np.isnan(axis)).sum(axis=1) - 2
    k = np.clip((axis <= at[:, None]).sum(axis=1) - 1, 0, last)[:, None]
    x0, x1, y0, y1 = (
        np.take_along_axis(a, k + step, 1)[:, 0] for a in (axis, values) for step in (0, 1)
    )
    return np.asarray(y0 + (y1 - y0) / (x1 - x0) * (at - x0))


def _area(forces: Array, compressions: Array, force: Array) -> Array:
    """∫δ dF of tables up to `force` (S,)."""
    total = np.zeros(len(force))
    points = (~np.isnan(forces)).sum(axis=1)
    for k in range(forces.shape[1] - 1):
        inside = k + 1 < points
        start = forces[:, k]
        end = np.where(k + 2 < points, forces[:, k + 1], np.inf)
        upper = np.minimum(force, end)
        low = compressions[:, k]
        slope = (compressions[:, k + 1] - low) / (forces[:, k + 1] - start)
        width = np.where(inside, np.maximum(upper - start, 0.0), 0.0)
        part = width * (low + 0.5 * slope * width)
        total += np.where(inside & (width > 0.0), part, 0.0)
    return total


def _interval(law: tuple[Array, ...], radius: Array, band: Array) -> tuple[Array, Array]:
    """Forces that a graph admits at a radius, corners widened by the band."""
    first, stick, bound, reach, last = law
    low, high = np.full(len(radius), np.inf), np.zeros(len(radius))
    level_end = np.maximum(reach, np.where(np.isinf(stick), 0.0, stick))
    pieces = (
        (np.zeros(len(radius)), stick, np.zeros(len(radius)), first, stick > 0.0),
        (stick, level_end, bound, np.zeros(len(radius)), (level_end > stick)),
        (
            level_end,
            np.full(len(radius), np.inf),
            bound,
            last,
            np.isfinite(last) & ~np.isinf(stick),
        ),
    )
    for begin, end, force, slope, there in pieces:
        on = there & (radius >= begin - band) & (radius <= end + band)
        inner = np.minimum(np.maximum(radius, begin), end) - begin
        here = force + np.where(slope > 0.0, slope * inner, 0.0)
        low = np.where(on, np.minimum(low, here), low)
        high = np.where(on, np.maximum(high, here), high)
    low = np.where(radius <= band, 0.0, low)
    stopped = np.isinf(last) & (radius >= reach - band)
    low = np.where(stopped, np.minimum(low, bound), low)
    high = np.where(stopped, np.inf, high)
    return low, high


def _energy(law: tuple[Array, ...], radius: Array) -> Array:
    """Strain energy of a graph at a radius."""
    first, stick, bound, reach, last = law
    rise = np.minimum(radius, stick)
    throughout = np.isinf(stick)
    level = np.where(throughout, 0.0, np.clip(radius, stick, reach) - stick)
    beyond = np.where(throughout, 0.0, np.maximum(radius - reach, 0.0))
    rising = np.isfinite(last) & (beyond > 0.0)
    tail = np.where(rising, bound * beyond + 0.5 * np.where(rising, last, 0.0) * beyond**2, 0.0)
    return np.asarray(0.5 * first * rise**2 + bound * np.where(level > 0.0, level, 0.0) + tail)


def _complementary(law: tuple[Array, ...], force: Array) -> Array:
    """Conjugate energy of a graph at a force."""
    first, stick, bound, reach, last = law
    throughout = np.isinf(stick)
    has_rise = first > 0.0
    stiff = np.where(has_rise, first, 1.0)
    end = np.where(throughout, np.inf, first * stick)
    under = np.minimum(force, end)
    energy = np.where(has_rise, under**2 / (2.0 * stiff), 0.0)
    rest = np.where(throughout, 0.0, np.maximum(force - end, 0.0))
    energy += np.where(rest > 0.0, rest * np.where(throughout, 0.0, stick), 0.0)
    over = np.where(throughout, 0.0, np.maximum(force - bound, 0.0))
    energy += np.where(over > 0.0, over * (reach - np.where(throughout, 0.0, stick)), 0.0)
    rising = np.isfinite(last)
    tail = np.where(rising, over**2 / (2.0 * np.where(rising, last, 1.0)), 0.0)
    return np.asarray(energy + tail)
