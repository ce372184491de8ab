"""The certificate of an equilibrium (formulation, section 8).

It is recomputed from the train and the claimed displacements and forces alone. Nothing of a solver,
of a programme or of its rows enters it, so that a mistake in any of them shows here.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from itertools import groupby
from typing import Any, cast

from loadshare.certify.bound import Bound
from loadshare.certify.claims import Claims
from loadshare.certify.floats import FloatState
from loadshare.certify.residuals import Residual
from loadshare.certify.tolerance import checked_tolerance
from loadshare.later import Later
from loadshare.settings import CERTIFY
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.train import Train


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
        Of the case: its load under "N", its deflection under "m", and their product under "J".
    proved_together : float or None
        The value of `proved` for an answer that was judged together with many others.
    claims : Claims
        Claims among which the answer is judged.
    row : int
        Its number among them.
    """

    residuals: Mapping[str, Residual]
    floats: Mapping[str, FloatState]
    tolerance: float
    scales: Mapping[str, float]
    # Many claims are bounded in another way than one: both bounds hold, so it is not compared.
    proved_together: float | None = field(compare=False)
    claims: Claims = field(compare=False, repr=False)
    row: int = field(compare=False, repr=False)

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
        """Bounds on the distance of every torque, force and displacement from the exact ones."""
        found, other = self.claims.bounds[self.row], self.proved_together
        return found if other is None else replace(found, relative=min(found.relative, other))

    @property
    def proved(self) -> float:
        """Proved bound on the error of every torque, over the largest torque."""
        other = self.proved_together
        return self.bound.relative if other is None else other

    @property
    def worst(self) -> float:
        """Largest scaled residual."""
        return max(r.scaled for r in self.residuals.values())

    @property
    def passed(self) -> bool:
        """Whether every residual, and the error of every torque, is within the tolerance.

        The error of a torque is taken over the largest torque of the train.
        """
        return self.worst <= self.tolerance and self.proved <= self.tolerance

    @property
    def failing(self) -> dict[str, Residual]:
        """Residuals beyond the tolerance."""
        return {n: r for n, r in self.residuals.items() if not r.scaled <= self.tolerance}

    @property
    def shortfall(self) -> str:
        """The failing residuals in words."""
        return "; ".join(
            f"{name.replace('_', ' ')} {r.value:.3g} {r.unit} at {r.where} ({r.scaled:.1e} of the "
            f"case, allowed {self.tolerance:.0e})"
            for name, r in self.failing.items()
        )


def certified(
    claims: Claims, tolerance: float, proved: Sequence[float] | None = None
) -> list[Certificate]:
    """Return the certificates of claims, whose figures are computed when they are first read.

    Parameters
    ----------
    claims : Claims
    tolerance : float
        As for `certify`.
    proved : sequence of float, optional
        The value of `proved` for each, if it was judged together with many others.
    """
    return [
        Certificate(
            residuals=Later(partial(_of_row, claims, "residuals", row)),
            floats=Later(partial(_of_row, claims, "floats", row)),
            tolerance=tolerance,
            scales=Later(partial(_of_row, claims, "scales", row)),
            proved_together=None if proved is None else proved[row],
            claims=claims,
            row=row,
        )
        for row in range(len(claims.positions))
    ]


def _of_row(claims: Claims, figures: str, row: int) -> Mapping[str, Any]:
    return cast("Mapping[str, Any]", getattr(claims, figures)[row])


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
        Always find the residuals behind the bound in twice the working precision, not only where
        plain arithmetic does not suffice.

    Returns
    -------
    Certificate
        Passed or not; nothing is raised for a wrong answer.

    Raises
    ------
    ValueError
        If the tolerance is not one that can be certified by.
    """
    tolerance = checked_tolerance(tolerance)
    (certificate,) = certified(Claims.of(train, [answer], rigorous), tolerance)
    # The bound of an answer that fails anyway is computed only if it is read.
    if all(r.scaled <= tolerance for r in certificate.residuals.values()):
        _ = certificate.bound
    return certificate


def certify_all(
    trains: Sequence[Train], answers: Sequence[Equilibrium], tolerance: float
) -> list[Certificate]:
    """Judge equilibria; consecutive ones of one train are judged together.

    Parameters
    ----------
    trains : sequence of Train
        The train of each answer; the same object for answers of one train.
    answers : sequence of Equilibrium
    tolerance : float
        As for `certify`.
    """
    found: list[Certificate] = []
    for _, group in groupby(range(len(trains)), key=lambda k: id(trains[k])):
        for some in in_groups(list(group)):
            claims = Claims.of(trains[some[0]], [answers[k] for k in some])
            found += certified(claims, tolerance)
    return found


def in_groups(every: Sequence[int]) -> list[Sequence[int]]:
    """Return numbers of answers in groups that are judged together."""
    width = CERTIFY.side_by_side
    return [every[at : at + width] for at in range(0, len(every), width)]
