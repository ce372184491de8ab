"""The certificate of an equilibrium (formulation, section 8).

It is recomputed from the train and the claimed displacements and forces alone. No solver's word, no
programme and no row enters it: a slip in any of them shows here.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import TypeVar

from loadshare.certify import residuals
from loadshare.certify.bound import Bound, bound_of
from loadshare.certify.floats import FloatState, float_states
from loadshare.certify.state import State
from loadshare.certify.tolerance import checked_tolerance
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.train import Train

TOLERANCE = 1e-9
"""Largest scaled residual of a certified answer."""
BAND = 1e-9
"""Band in which a margin counts as none, in deflections of the case."""


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


@dataclass(frozen=True, slots=True)
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
    load, deflection : float
        Scales [N], [m].
    bound : Bound
        How far every torque, force and displacement is from the exact equilibrium, at most.
    """

    residuals: Mapping[str, Residual]
    floats: Mapping[str, FloatState]
    tolerance: float
    load: float
    deflection: float
    # Many claims are bounded another way than one: both bounds hold, and results are the same.
    bound: Bound = field(compare=False)

    @property
    def worst(self) -> float:
        """Largest scaled residual."""
        return max(r.scaled for r in self.residuals.values())

    @property
    def passed(self) -> bool:
        """Whether every residual, and the error of every torque, is within the tolerance.

        The error of a torque counts over the largest torque of the train. Where friction that
        remembers its slip shares a force with its stop, no bound is sought, and balance decides.
        """
        proved = self.bound.relative <= self.tolerance
        return self.worst <= self.tolerance and proved

    @property
    def failing(self) -> dict[str, Residual]:
        """Residuals beyond the tolerance."""
        return {n: r for n, r in self.residuals.items() if not r.scaled <= self.tolerance}


Value = TypeVar("Value")


@dataclass(frozen=True, eq=False)
class _Later(Mapping[str, Value]):
    """A mapping that is made when it is first looked into."""

    make: Callable[[], Mapping[str, Value]]

    @cached_property
    def _made(self) -> Mapping[str, Value]:
        return self.make()

    def __getitem__(self, key: str) -> Value:
        return self._made[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._made)

    def __len__(self) -> int:
        return len(self._made)


def certify_later(train: Train, answer: Equilibrium, tolerance: float, bound: Bound) -> Certificate:
    """Return the certificate of an answer that passed when it was judged with many others.

    Its figures are computed, as `certify` computes them, when they are first asked for.

    Parameters
    ----------
    train, answer, tolerance
        As for `certify`.
    bound : Bound
        As it was found with the many others.
    """
    # The batch's scales may differ in the last digit, and a result that is loaded again would.
    state = State(train, answer)
    return Certificate(
        residuals=_Later(partial(_residuals, state)),
        floats=_Later(partial(_floats, state)),
        tolerance=tolerance,
        load=state.force_scale,
        deflection=state.length_scale,
        bound=bound,
    )


def _floats(state: State) -> Mapping[str, FloatState]:
    return {} if state.fault else float_states(state, BAND)


def certify(
    train: Train, answer: Equilibrium, tolerance: float = TOLERANCE, rigorous: bool = False
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
    state = State(train, answer)
    load, deflection = _scales(state)
    return Certificate(
        residuals=_residuals(state),
        floats=_floats(state),
        tolerance=tolerance,
        load=load,
        deflection=deflection,
        bound=Bound.none(train) if state.fault else bound_of(train, answer, rigorous),
    )


def _scales(state: State) -> tuple[float, float]:
    """Load [N] and deflection [m]."""
    return (1.0, 1.0) if state.fault else (state.force_scale, state.length_scale)


def _residuals(state: State) -> Mapping[str, Residual]:
    load, deflection = _scales(state)
    work = load * deflection
    judged: dict[str, tuple[Callable[[], tuple[float, str]], str, float]] = {
        "force_balance": (lambda: residuals.force_balance(state), "N", load),
        "moment_balance": (lambda: residuals.moment_balance(state), "N", load),
        "penetration": (lambda: residuals.penetration(state), "m", deflection),
        "complementarity": (lambda: residuals.complementarity(state), "J", work),
        "deformation_law": (
            lambda: residuals.deformation_law(state, BAND * load),
            "m",
            deflection,
        ),
        "cone_membership": (
            lambda: residuals.cone_membership(state, BAND * deflection),
            "N",
            load,
        ),
        "energy_gap": (lambda: residuals.energy_gap(state), "J", work),
    }

    def figure(judge: Callable[[], tuple[float, str]], unit: str, scale: float) -> Residual:
        value, where = (math.inf, state.fault) if state.fault else judge()
        ratio = value / scale
        return Residual(value, unit, math.inf if math.isnan(ratio) else ratio, where)

    return {name: figure(*how) for name, how in judged.items()}
