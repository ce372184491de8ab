"""The judge of a train: the certificate of many answers at once."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from loadshare.certify.arguments import Arguments, arguments_of, judged
from loadshare.certify.bound import Bounds, Columns, bounds
from loadshare.certify.bound.one import columns_of
from loadshare.certify.mechanics import mechanics_of
from loadshare.certify.residuals import scaled_residuals
from loadshare.certify.state import State
from loadshare.certify.verdicts import Verdicts
from loadshare.settings import CERTIFY
from loadshare.train.equilibria import Equilibria
from loadshare.train.situations import Situations
from loadshare.train.train import Train

Flags = NDArray[np.bool_]


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
    def arguments(self) -> Arguments:
        """The mechanics as the compiled certificate reads them."""
        return arguments_of(self.mechanics)

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
            With Numba, one answer after another, instead of NumPy: the same figures up to
            round-off, several times as fast once it is compiled. Splines with memory are judged
            with NumPy all the same.
        bounded : bool
            Whether errors are bounded; without a bound nothing passes.
        """
        if compiled and self.train.slip is None:
            residuals, load, deflection = judged(self.arguments, situations, answers)
            # What is out of balance is refused in any case.
            wanted = residuals.max(axis=1) <= tolerance
            limits = self.bounds(situations, answers, wanted)
            return Verdicts(residuals, tolerance, load, deflection, limits)
        count = len(answers.rotation)
        if bounded:
            limits = self.bounds(situations, answers)
        else:
            limits = Bounds(self.columns, np.full(count, np.inf), None, None, None)
        if count <= CERTIFY.together:
            return self._together(situations, answers, tolerance, limits)
        parts = [slice(at, at + CERTIFY.together) for at in range(0, count, CERTIFY.together)]
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
            state = State(self.mechanics, situations, answers)
            residuals = scaled_residuals(state)
            return Verdicts(residuals, tolerance, state.load, state.deflection, limits)
