"""Run of the map: every method on every family."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from benchmarks.stress.families import FAMILIES
from benchmarks.stress.methods import OURS, methods
from benchmarks.stress.verdict import Outcome, Verdict, judge


@dataclass(frozen=True, slots=True)
class Cell:
    """The results of a method on a family.

    Attributes
    ----------
    method, family : str
    counts : mapping of outcome to int
        Certified, refused, wrong, crashed, or not for it (outside the method's class).
    missed : int
        Problems with an answer that were not certified.
    unnamed : int
        Problems without an answer whose refusal names no element that lacks one.
    loose : int
        Wrong answers that would pass at 1e-6.
    seconds : float
    slowest : float
        Longest time of a problem [s].
    sentences : tuple of str
        Kinds of its failures, the most frequent first.
    failures : tuple of (int, str, str)
        Number, outcome and message of each problem without the required outcome.
    """

    method: str
    family: str
    counts: dict[str, int]
    missed: int
    unnamed: int
    loose: int
    seconds: float
    slowest: float
    sentences: tuple[str, ...]
    failures: tuple[tuple[int, str, str], ...]

    @property
    def total(self) -> int:
        """Number of problems given."""
        return sum(self.counts.values())

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain data."""
        return {name: getattr(self, name) for name in self.__slots__}


def run(
    families: Iterable[str],
    peers: bool,
    quick: bool,
    tell: Callable[[str], None],
) -> Iterator[Cell]:
    """Judge methods on families.

    Parameters
    ----------
    families : iterable of str
    peers : bool
        Whether to include peers.
    quick : bool
        Every tenth problem.
    tell : callable
        Called with the name of each step.
    """
    for name in families:
        for method, (answer, every) in methods(peers).items():
            tell(f"{FAMILIES[name].title}: {method}")
            stride = max(every, 10 if quick else 1)
            with warnings.catch_warnings():
                # A peer's warnings are ignored: its answer is judged.
                warnings.simplefilter("error" if method == OURS else "ignore")
                verdicts = [judge(p, answer) for p in FAMILIES[name].problems(stride)]
            yield cell_of(method, name, verdicts)


def cell_of(method: str, family: str, verdicts: list[Verdict]) -> Cell:
    """Count the verdicts of a method on a family."""
    counts = {o.value: 0 for o in Outcome}
    reasons: dict[str, int] = {}
    for verdict in verdicts:
        counts[verdict.outcome.value] += 1
        if not verdict.as_it_should_be:
            reason = _reason(verdict)
            reasons[reason] = reasons.get(reason, 0) + 1
    wrong = [v for v in verdicts if v.outcome is Outcome.WRONG]
    return Cell(
        method=method,
        family=family,
        counts=counts,
        missed=sum(
            v.solvable and v.outcome not in (Outcome.CERTIFIED, Outcome.UNFIT) for v in verdicts
        ),
        unnamed=sum(
            not v.solvable and v.outcome is Outcome.REFUSED and not v.named for v in verdicts
        ),
        loose=sum(v.worst <= 1e-6 for v in wrong),
        seconds=sum(v.seconds for v in verdicts),
        slowest=max(v.seconds for v in verdicts),
        sentences=tuple(sorted(reasons, key=lambda r: -reasons[r])[:2]),
        failures=tuple(
            (v.number, v.outcome.value, v.reason) for v in verdicts if not v.as_it_should_be
        ),
    )


def _reason(verdict: Verdict) -> str:
    """Return the kind of a failure, without its figures."""
    reason = verdict.reason.split(";")[0].split(" (")[0]
    if verdict.outcome is Outcome.WRONG:
        reason = reason.split(" at ")[0]
        return "claims an answer that fails: " + " ".join(reason.split()[:-1] or [reason])
    if verdict.outcome is Outcome.CRASHED:
        return f"raises {reason[:80]}"
    return reason.removeprefix("position 1: ")[:80]
