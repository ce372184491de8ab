"""The judge of a train: its mechanics, written down once for all answers."""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from loadshare.certify.bound import Bounds, Columns, bounds
from loadshare.certify.bound.one import columns_of
from loadshare.certify.certificate import TOLERANCE
from loadshare.certify.many.bench import Bench
from loadshare.certify.many.residuals import scaled_residuals
from loadshare.certify.many.verdicts import Verdicts
from loadshare.certify.mechanics import Mechanics, judged, mechanics
from loadshare.certify.rigid import rigid_shafts
from loadshare.train.equilibria import Equilibria
from loadshare.train.ring import DrumRing, transverse
from loadshare.train.situations import Situations
from loadshare.train.train import Train

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

TOGETHER = 2048
"""Answers judged together: as many as a processor's own memory holds."""


class Judge:
    """The mechanics of a train.

    Parameters
    ----------
    train : Train

    Attributes
    ----------
    order : dict of gear to int
    flanks : list of (int, Mesh, bool)
        Number of the mesh, the mesh, drive or coast flank.
    turning : ndarray, shape (gears, flanks)
        Approach per rotation [m].
    pushing : ndarray, shape (gears, 3, flanks)
        Approach per displacement; a flank's force on a gear is the negative of it.
    moment : ndarray, shape (flanks, gears)
        Moment per force [m].
    nominal : list of ndarray, shape (2, 3)
        Way to every drum's centre from each neighbour's [m].
    radius : ndarray, shape (gears,)
        Base radii [m].
    groups : list of list of int
        Gears that turn as one.
    beyond : ndarray, shape (shafts, gears)
        Torque of every rigid shaft per moment on the gears beyond it (see `RigidShafts`).
    tabled : list of (int, int)
        Flanks with a tabulated law, and their meshes.
    """

    def __init__(self, train: Train) -> None:
        self.train = train
        gears = list(train.gears.values())
        self.order = {g.name: k for k, g in enumerate(gears)}
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
        self.nominal = [
            np.array([_apart(train, r.gear, neighbour) for neighbour in r.neighbours])
            for r in train.drums
        ]
        self.radius = np.array([g.base_radius for g in gears])
        rigid = rigid_shafts(train)
        self.groups = [[self.order[g] for g in group] for group in rigid.groups]
        self.beyond = np.zeros((len(train.shafts), count))
        for w, name in enumerate(train.shafts):
            for gear, sign in rigid.beyond.get(name, {}).items():
                self.beyond[w, self.order[gear]] = sign
        self.tabled = [
            (e, k) for e, (k, m, _) in enumerate(self.flanks) if hasattr(m.laws[0], "forces")
        ]

    def squeezed(self, ring: DrumRing) -> bool:
        """Whether nothing gives way between the arcs of a ring (see `State.squeezes`)."""
        return math.isinf(ring.stiffness) and not any(
            self.train.gears[n].moves for n in ring.neighbours
        )

    @cached_property
    def columns(self) -> Columns:
        """The mechanics as columns, for bounds."""
        return columns_of(self.train)

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
            # What is out of balance is refused in any case.
            wanted = residuals.max(axis=1) <= tolerance
            limits = self.bounds(situations, answers, wanted)
            return Verdicts(residuals, tolerance, load, deflection, limits)
        limits = self.bounds(situations, answers)
        count = len(answers.rotation)
        if count <= TOGETHER:
            return self._together(situations, answers, tolerance, limits)
        parts = [slice(at, at + TOGETHER) for at in range(0, count, TOGETHER)]
        return Verdicts.joined(
            [self._together(situations.take(p), answers.part(p), tolerance, limits) for p in parts],
            limits,
        )

    def bounds(
        self, situations: Situations, answers: Equilibria, wanted: Flags | None = None
    ) -> Bounds:
        """Bound the errors of S claimed equilibria.

        Parameters
        ----------
        situations : Situations
        answers : Equilibria
        wanted : ndarray of bool, shape (S,), optional
            Claims that are worth every effort; with it, bounds are found by Numba.
        """
        compiled = wanted is not None
        return bounds(self.columns, situations, answers, compiled=compiled, wanted=wanted)

    def _together(
        self, situations: Situations, answers: Equilibria, tolerance: float, limits: Bounds
    ) -> Verdicts:
        with np.errstate(all="ignore"):
            bench = Bench(self, situations, answers)
            residuals = scaled_residuals(bench)
            return Verdicts(residuals, tolerance, bench.load, bench.deflection, limits)


def _apart(train: Train, gear: str, neighbour: str) -> Array:
    """Way from a neighbour's nominal centre, across the gear's axis (3,) [m]."""
    here = train.gears[gear]
    return transverse(here.centre - train.gears[neighbour].centre, here.axis)
