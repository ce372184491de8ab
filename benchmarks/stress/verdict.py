"""Verdict on a problem: certified, refused, wrong, crashed."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from time import perf_counter

from benchmarks.peers.loop import Failure, NotForThis
from benchmarks.stress.problem import Problem
from benchmarks.stress.truth import Truth, truth_of
from loadshare.certify import certify
from loadshare.errors import Refused
from loadshare.train import Train, build_train
from loadshare.train.equilibrium import Equilibrium

Method = Callable[[Problem, Train], Equilibrium]
"""Answers a problem, or raises `Refused` or `Failure`; any other exception counts as a crash."""


class Outcome(Enum):
    """Outcomes of a method on a problem."""

    CERTIFIED = "certified"
    REFUSED = "refused"
    WRONG = "wrong"
    CRASHED = "crashed"
    UNFIT = "not for it"


@dataclass(frozen=True, slots=True)
class Verdict:
    """The verdict on one method for one problem.

    Attributes
    ----------
    family : str
    number : int
    level : float
    outcome : Outcome
    solvable : bool
        Whether an answer exists.
    reason : str
        The refusal, the residual that failed, or the exception.
    named : bool
        For a problem without an answer: whether the refusal names an element at fault.
    seconds : float
    worst : float
        Largest scaled residual of a claimed answer; infinite without one.
    """

    family: str
    number: int
    level: float
    outcome: Outcome
    solvable: bool
    reason: str
    named: bool
    seconds: float
    worst: float

    @property
    def as_it_should_be(self) -> bool:
        """Whether a solvable problem was certified, or any other one refused by name."""
        if self.outcome is Outcome.UNFIT:
            return True
        if self.solvable:
            return self.outcome is Outcome.CERTIFIED
        return self.outcome is Outcome.REFUSED and self.named


def judge(problem: Problem, method: Method) -> Verdict:
    """Give a problem to a method and judge its answer.

    An answer counts as certified only if the certificate, evaluated here, passes; a certified
    answer to a problem that has none would still be wrong.
    """
    train = build_train(problem.case)
    truth = truth_of(train)
    worst = math.inf
    start = perf_counter()
    try:
        found = method(problem, train)
    except NotForThis as unfit:
        reason, outcome = str(unfit), Outcome.UNFIT
    except (Refused, Failure) as refusal:
        reason, outcome = str(refusal), Outcome.REFUSED
    except Exception as fault:  # noqa: BLE001 -- whatever a method raises is a finding of the map
        reason, outcome = f"{type(fault).__name__}: {fault}", Outcome.CRASHED
    else:
        reason, outcome, worst = _judged(train, found, truth)
    return Verdict(
        family=problem.family,
        number=problem.number,
        level=problem.level,
        outcome=outcome,
        solvable=truth.solvable,
        reason=reason,
        named=any(_names(reason, element) for element in truth.elements),
        seconds=perf_counter() - start,
        worst=worst,
    )


def _names(message: str, gear: str) -> bool:
    """Return whether a message names a gear, its ring or spline, or a mesh or shaft of it."""
    return re.search(rf"\b(gear|ring|spline) {gear}\b|\b{gear}-\w|\w-{gear}\b", message) is not None


def _judged(train: Train, found: Equilibrium, truth: Truth) -> tuple[str, Outcome, float]:
    certificate = certify(train, found)
    if not certificate.passed:
        failing = "; ".join(
            f"{name.replace('_', ' ')} {r.scaled:.1e} at {r.where}"
            for name, r in certificate.failing.items()
        )
        reason = failing or f"bound on the torques {certificate.bound.relative:.1e}"
        return reason, Outcome.WRONG, certificate.worst
    if not truth.solvable:
        return f"an answer where there is none ({truth.why})", Outcome.WRONG, math.inf
    return f"residual {certificate.worst:.1e}", Outcome.CERTIFIED, certificate.worst


def ours(problem: Problem, train: Train) -> Equilibrium:
    """Answer a problem with the library."""
    import loadshare as ls

    return ls.explain(problem.case, 1).equilibrium
