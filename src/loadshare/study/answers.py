"""Certified equilibria of single trains, for studies that follow them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from loadshare.errors import Refused
from loadshare.job.answer import Answer
from loadshare.job.ladder import climb, climb_all
from loadshare.job.machine import Machine
from loadshare.settings import CERTIFY
from loadshare.solver import Options
from loadshare.train.train import Train

BACKEND = Options(solver="clarabel")
"""For trains that remember: the hot path knows holonomic friction only."""


def certified(train: Train, position: int) -> Answer:
    """Solve and certify a position of a train.

    Raises
    ------
    Refused
        If it has no certified equilibrium, or one with displacements that are too large.
    """
    return each_certified(train, [position])[0]


def each_certified(train: Train, positions: Sequence[int]) -> list[Answer]:
    """Solve and certify positions of a train, together.

    Raises
    ------
    Refused
        As `certified`, for the first of them that is refused.
    """
    found: Iterable[Answer | Refused]
    if train.slip is not None:
        found = (climb(train, k, BACKEND, CERTIFY.tolerance) for k in positions)
    else:
        found = climb_all(Machine(train), positions, Options(), CERTIFY.tolerance)
    answers = []
    for answer in found:
        refused = answer if isinstance(answer, Refused) else answer.refused()
        if refused is not None:
            raise refused
        assert isinstance(answer, Answer)
        answers.append(answer)
    return answers
