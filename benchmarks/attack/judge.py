"""The verdict of the certificate on tampered answers."""

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
"""Number of attacks on one victim."""
ALLOWED = 1e-9
"""Error of a torque, over the largest one, above which no answer may pass."""
ROUNDING = 1e-14
"""Error from rounding the reference to double precision, over the largest torque."""


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
        Smallest difference between the bound on a torque and its error, over the largest torque;
        infinite without bounds.
    """

    train: str
    way: str
    passed: bool
    error: float
    margin: float

    @property
    def slipped(self) -> bool:
        """Whether the answer passed with a wrong torque."""
        return self.passed and self.error > ALLOWED


def attacks(seed: int, count: int, each: int = EACH) -> Iterator[Attack]:
    """Yield `count` attacks, on one victim after another.

    Parameters
    ----------
    seed, count : int
        They alone determine the attacks.
    each : int
        Number of attacks on one victim.
    """
    ways = list(WAYS)
    odds = np.array([WAYS[w][1] for w in ways])
    for number, victim in enumerate(victims(seed)):
        if count <= 0:
            return
        rng = np.random.default_rng([seed, number])
        order = rng.choice(ways, size=4 * each, p=odds / odds.sum())
        # Some ways do not apply to this train, so more are drawn than are needed.
        tried = map(one, repeat(victim), order, repeat(rng))
        found = list(islice((a for a in tried if a is not None), min(each, count)))
        count -= len(found)
        yield from found


def part(share: tuple[int, int]) -> list[Attack]:
    """Return the attacks of one share (seed, count), in a process of its own."""
    return list(attacks(*share))


def one(victim: Victim, way: str, rng: np.random.Generator) -> Attack | None:
    """Tamper with the victim's answer and judge the claim; None if the way does not apply to it."""
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
