"""The judge of a train: the certificate of many answers at once."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from loadshare.array_types import Array, Flags
from loadshare.certify.bound import Bounds, Columns, bounds, completed
from loadshare.certify.bound.batch import is_covered, judged
from loadshare.certify.bound.one import columns_of
from loadshare.certify.mechanics import mechanics_of
from loadshare.certify.residuals import scaled_residuals
from loadshare.certify.state import ClaimedState
from loadshare.certify.validity import Measuring, measuring
from loadshare.certify.verdicts import Verdicts
from loadshare.settings import CERTIFY
from loadshare.train.equilibria import Equilibria
from loadshare.train.situations import Situations
from loadshare.train.train import Train


class Judge:
    """The judge of a train.

    Parameters
    ----------
    train : Train

    Attributes
    ----------
    mechanics : Mechanics
    """

    def __init__(self, train: Train) -> None:
        self.train = train
        self.mechanics = mechanics_of(train)

    @cached_property
    def columns(self) -> Columns:
        """The mechanics as columns, for bounds."""
        return columns_of(self.train)

    @cached_property
    def measuring(self) -> Measuring:
        """The measures of displacements."""
        return measuring(self.train)

    def judge(
        self,
        situations: Situations,
        answers: Equilibria,
        tolerance: float = CERTIFY.tolerance,
        compiled: bool = False,
        bounded: bool = True,
    ) -> Verdicts:
        """Judge S claimed equilibria.

        Parameters
        ----------
        situations : Situations
        answers : Equilibria
        tolerance : float
            Largest scaled residual of a certified answer.
        compiled : bool
            Use Numba, one answer after another, instead of NumPy: the same verdicts, several times
            as fast once it is compiled. The residuals are then those behind the bound, and the
            energy gap, which follows from them, is left to single answers. Splines with memory
            and answers too soft for this are judged with NumPy all the same.
        bounded : bool
            Whether to try every method to bound errors. Otherwise nothing passes with NumPy, and
            with Numba only answers whose first bound is good enough.
        """
        if compiled and self.compiles:
            return self._compiled(situations, answers, tolerance, bounded)
        limits = None
        if bounded:
            # A bound within the tolerance is close enough, as in `completed`.
            limits = bounds(self.columns, situations, answers, enough=tolerance)
        return self._by_numpy(situations, answers, tolerance, limits)

    @property
    def compiles(self) -> bool:
        """Whether answers can be judged with Numba."""
        return is_covered(self.columns)

    def _compiled(
        self, situations: Situations, answers: Equilibria, tolerance: float, bounded: bool
    ) -> Verdicts:
        found, relative = judged(self.columns, situations, answers)
        # In very soft springs the energy gap does not follow from forces that are in balance.
        found.worst[_is_soft(situations, found.scale, found.deflection, tolerance)] = np.nan
        if self.measuring.uncertain:
            # Compiled code does not measure how far these meshes are open.
            found.displaced[:] = np.nan
        for figure, name in ((found.worst, "worst"), (found.displaced, "displaced")):
            left = np.flatnonzero(np.isnan(figure))
            if len(left):
                some = situations.take(left), answers.take(left)
                figure[left] = getattr(self._by_numpy(*some, tolerance), name)
        # Answers that are out of balance are refused in any case.
        wanted = bounded & (found.worst <= tolerance)
        limits = completed(self.columns, situations, answers, relative, tolerance, wanted)
        return Verdicts(
            found.worst, tolerance, found.scale, found.deflection, found.displaced, limits
        )

    def _by_numpy(
        self,
        situations: Situations,
        answers: Equilibria,
        tolerance: float,
        limits: Bounds | None = None,
    ) -> Verdicts:
        count = len(answers.rotation)
        if limits is None:
            limits = Bounds(self.columns, np.full(count, np.inf), None, None, None)
        figures = [
            self._together(situations.take(part), answers.take(part))
            for part in np.split(np.arange(count), range(CERTIFY.together, count, CERTIFY.together))
        ]
        worst, load, deflection = (np.concatenate(each) for each in zip(*figures, strict=True))
        with np.errstate(all="ignore"):
            displaced = self.measuring.worst(situations, answers, deflection)
        return Verdicts(worst, tolerance, load, deflection, displaced, limits)

    def _together(self, situations: Situations, answers: Equilibria) -> tuple[Array, Array, Array]:
        """Return the largest scaled residuals and both scales."""
        with np.errstate(all="ignore"):
            state = ClaimedState(self.mechanics, situations, answers)
            # Column by column: rows are too short to be worth a loop each.
            worst = np.maximum.reduce(list(scaled_residuals(state).T))
            return worst, state.load, state.deflection


def _is_soft(situations: Situations, load: Array, deflection: Array, tolerance: float) -> Flags:
    """Return whether a force error within the tolerance may exceed it as energy in some spring.

    An error f of a spring's force leaves an energy gap of f²/2K; energies are scaled by load times
    deflection.
    """
    springs = (situations.spline[..., 0], situations.support.reshape(len(situations.support), -1))
    soft = np.zeros(len(load), dtype=bool)
    with np.errstate(all="ignore"):
        least = 0.5 * tolerance * load / deflection
    for stiffness in (*springs, situations.round_stiffness):
        if not stiffness.any():
            continue
        there = np.where(stiffness > 0.0, stiffness, np.inf)
        soft |= there.min(axis=1, initial=np.inf) < least
    return soft
