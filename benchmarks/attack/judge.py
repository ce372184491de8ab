"""What the certificate makes of tampered answers."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice, repeat

import numpy as np

from benchmarks.attack.victims import Victim, victims
from benchmarks.attack.ways import WAYS
from loadshare.certify import certify

EACH = 40
"""Attacks on one victim."""
ALLOWED = 1e-9
"""Error of a torque, over the largest one, above which no answer may pass."""
ROUNDING = 1e-14
"""Error, over the largest torque, that is that of the reference in double digits."""


@dataclass(frozen=True, slots=True)
class Attack:
    """One tampered answer.

    Attributes
    ----------
    train, way : str
    passed : bool
    error : float
        Of the worst torque, over the largest.
    margin : float
        Least bound on a torque less its error, over the largest torque; infinite without bounds.
    """

    train: str
    way: str
    passed: bool
    error: float
    margin: float

    @property
    def slipped(self) -> bool:
        """Whether a wrong torque passed."""
        return self.passed and self.error > ALLOWED


def attacks(seed: int, count: int, each: int = EACH) -> Iterator[Attack]:
    """Yield so many attacks, on one victim after another.

    Parameters
    ----------
    seed, count : int
        The attacks depend on nothing else.
    each : int
        Attacks on one victim.
    """
    ways = list(WAYS)
    odds = np.array([WAYS[w][1] for w in ways])
    for number, victim in enumerate(victims(seed)):
        if count <= 0:
            return
        rng = np.random.default_rng([seed, number])
        order = rng.choice(ways, size=4 * each, p=odds / odds.sum())
        # A way that this train gives no room is as good as tried.
        tried = map(one, repeat(victim), order, repeat(rng))
        found = list(islice((a for a in tried if a is not None), min(each, count)))
        count -= len(found)
        yield from found


def part(share: tuple[int, int]) -> list[Attack]:
    """Attack with one seed so many times, in a process of its own."""
    return list(attacks(*share))


def one(victim: Victim, way: str, rng: np.random.Generator) -> Attack | None:
    """Tamper and judge; None where there is no room for this way."""
    claim = WAYS[way][0](victim, rng)
    if claim is None:
        return None
    certificate = certify(victim.train, claim)
    errors = victim.errors(claim)
    margin = min(
        (b - errors[n] for n, b in certificate.bound.torque.items() if n in errors),
        default=math.inf,
    )
    return Attack(
        victim.case.name,
        str(way),
        bool(certificate.passed),
        float(max(errors.values()) / victim.largest),
        float(margin / victim.largest),
    )
