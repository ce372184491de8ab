"""The certificate of an equilibrium (formulation, section 8).

It is recomputed from the train and the claimed displacements and forces alone. No solver's word, no
programme and no row enters it: a slip in any of them shows here.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np

from loadshare.certify.bound import Bound
from loadshare.certify.bound.one import bound_of_one
from loadshare.certify.fault import fault_of
from loadshare.certify.floats import FloatState, float_states
from loadshare.certify.mechanics import mechanics_of
from loadshare.certify.residuals import FIGURES, RESIDUALS, scales, worst_of_one
from loadshare.certify.state import ClaimedState
from loadshare.certify.tolerance import checked_tolerance
from loadshare.later import Later, known
from loadshare.settings import CERTIFY
from loadshare.train.equilibria import Equilibria
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.situations import situation_of
from loadshare.train.train import Train


@dataclass(frozen=True, slots=True)
class Residual:
    """One figure of a certificate.

    Attributes
    ----------
    value : float
        In `unit`.
    unit : str
    scaled : float
        Over the case's load, deflection, or both; dimensionless.
    where : str
        Element that shows the value.
    """

    value: float
    unit: str
    scaled: float
    where: str


@dataclass(frozen=True)
class Certificate:
    """Verdict on an answer.

    Attributes
    ----------
    residuals : mapping of str to Residual
        "force_balance" [N], "moment_balance" [N, over base radius], "penetration" [m],
        "complementarity" [J], "deformation_law" [m], "cone_membership" [N], "energy_gap" [J].
    floats : mapping of gear to FloatState
    tolerance : float
        Largest scaled residual allowed.
    scales : mapping of str to float
        Of the case: its load by "N", its deflection by "m", and their product by "J".
    proved_together : float or None
        What was `proved` of an answer that was judged with many others.
    prove : callable
        Returns the bounds on everything.
    """

    residuals: Mapping[str, Residual]
    floats: Mapping[str, FloatState]
    tolerance: float
    scales: Mapping[str, float]
    # Many claims are bounded another way than one: both bounds hold, and results are the same.
    proved_together: float | None = field(compare=False)
    prove: Callable[[], Bound] = field(compare=False, repr=False)

    @property
    def load(self) -> float:
        """Load of the case [N]."""
        return self.scales["N"]

    @property
    def deflection(self) -> float:
        """Deflection of the case [m]."""
        return self.scales["m"]

    @cached_property
    def bound(self) -> Bound:
        """How far every torque, force and displacement is from the exact equilibrium, at most."""
        found, other = self.prove(), self.proved_together
        return found if other is None else replace(found, relative=min(found.relative, other))

    @property
    def proved(self) -> float:
        """Largest distance of a torque from the exact one, over the largest torque, proved."""
        other = self.proved_together
        return self.bound.relative if other is None else other

    @property
    def worst(self) -> float:
        """Largest scaled residual."""
        return max(r.scaled for r in self.residuals.values())

    @property
    def passed(self) -> bool:
        """Whether every residual, and the error of every torque, is within the tolerance.

        The error of a torque counts over the largest torque of the train.
        """
        return self.worst <= self.tolerance and self.proved <= self.tolerance

    @property
    def failing(self) -> dict[str, Residual]:
        """Residuals beyond the tolerance."""
        return {n: r for n, r in self.residuals.items() if not r.scaled <= self.tolerance}

    @property
    def shortfall(self) -> str:
        """These in words."""
        return "; ".join(
            f"{name.replace('_', ' ')} {r.value:.3g} {r.unit} at {r.where} ({r.scaled:.1e} of the "
            f"case, allowed {self.tolerance:.0e})"
            for name, r in self.failing.items()
        )


def certify_later(
    train: Train,
    answer: Equilibrium,
    claimed: Equilibria,
    tolerance: float,
    proved: float,
    prove: Callable[[], Bound],
) -> Certificate:
    """Return the certificate of an answer that passed when it was judged with many others.

    Its figures are computed, as `certify` computes them, when they are first asked for.

    Parameters
    ----------
    train, answer, tolerance
        As for `certify`.
    claimed : Equilibria
        The answer as the only sample.
    proved, prove
        As in `Certificate`.
    """
    # The batch's scales may differ in the last digit, and a result that is loaded again would.
    single = _Single(train, answer, claimed)
    return Certificate(
        residuals=Later(single.residuals),
        floats=Later(single.floats),
        tolerance=tolerance,
        scales=Later(single.scales),
        proved_together=proved,
        prove=prove,
    )


def certify(
    train: Train,
    answer: Equilibrium,
    tolerance: float = CERTIFY.tolerance,
    rigorous: bool = False,
) -> Certificate:
    """Judge a claimed equilibrium.

    Parameters
    ----------
    train : Train
    answer : Equilibrium
    tolerance : float
        Largest scaled residual, and largest error of a torque over the largest torque, of a
        certified answer.
    rigorous : bool
        Find the residuals behind the bound in twice the working precision in any case, not only
        where plain arithmetic does not suffice.

    Returns
    -------
    Certificate
        Passed or not; nothing is raised for a wrong answer.

    Raises
    ------
    ValueError
        If the tolerance is no tolerance.
    """
    tolerance = checked_tolerance(tolerance)
    single = _Single(train, answer)
    residuals = single.residuals()
    prove: Callable[[], Bound] = partial(single.bound, rigorous)
    # What is wrong anyway is bounded for those only who ask.
    if all(r.scaled <= tolerance for r in residuals.values()):
        prove = known(prove())
    return Certificate(
        residuals=residuals,
        floats=single.floats(),
        tolerance=tolerance,
        scales=single.scales(),
        proved_together=None,
        prove=prove,
    )


class _Single:
    """An answer as a batch of one."""

    def __init__(
        self, train: Train, answer: Equilibrium, claimed: Equilibria | None = None
    ) -> None:
        self.train, self.undetermined = train, answer.undetermined
        self.situation = situation_of(train, answer.index)
        with np.errstate(all="ignore"):
            self.claimed = claimed or Equilibria.of(train, answer)

    @cached_property
    def state(self) -> ClaimedState:
        with np.errstate(all="ignore"):
            return ClaimedState(mechanics_of(self.train), self.situation, self.claimed)

    @cached_property
    def fault(self) -> str:
        with np.errstate(all="ignore"):
            return fault_of(self.state)

    @cached_property
    def _scales(self) -> dict[str, float]:
        if self.fault:
            return dict.fromkeys("NmJ", 1.0)
        return {unit: float(size[0]) for unit, size in scales(self.state).items()}

    def scales(self) -> Mapping[str, float]:
        return self._scales

    def residuals(self) -> Mapping[str, Residual]:
        with np.errstate(all="ignore"):
            return {name: self._residual(name) for name in RESIDUALS}

    def _residual(self, name: str) -> Residual:
        figures, unit = FIGURES[name]
        value, where = (math.inf, self.fault) if self.fault else worst_of_one(figures(self.state))
        ratio = value / self._scales[unit]
        return Residual(value, unit, math.inf if math.isnan(ratio) else ratio, where)

    def floats(self) -> Mapping[str, FloatState]:
        if self.fault:
            return {}
        # What is claimed may be of any size.
        with np.errstate(all="ignore"):
            return float_states(self.state, self.undetermined, CERTIFY.band)

    def bound(self, rigorous: bool) -> Bound:
        if self.fault:
            return Bound.none(self.train)
        return bound_of_one(self.train, self.situation, self.claimed, rigorous)
