"""Certified equilibria, one position at a time: the only way in which a study solves."""

from __future__ import annotations

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
    found: Answer | Refused
    if train.slip is not None:
        found = climb(train, position, BACKEND, CERTIFY.tolerance)
    else:
        (found,) = climb_all(Machine(train), [position], Options(), CERTIFY.tolerance)
    refused = found if isinstance(found, Refused) else found.refused()
    if refused is not None:
        raise refused
    assert isinstance(found, Answer)
    return found
