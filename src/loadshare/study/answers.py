"""Certified equilibria, one position at a time: the only way in which a study solves."""

from __future__ import annotations

from loadshare.certify.certificate import TOLERANCE
from loadshare.errors import Refused
from loadshare.job.ladder import Answer, climb, climb_all
from loadshare.job.machine import Machine
from loadshare.solver import Options
from loadshare.train.train import Train

BACKEND = Options(solver="clarabel")
"""For trains that remember: the hot path knows holonomic friction only."""


def certified(train: Train, position: int) -> Answer:
    """Solve and certify a position of a train.

    Raises
    ------
    Refused
        If it has no certified equilibrium.
    """
    if train.slip is not None:
        return climb(train, position, BACKEND, TOLERANCE)
    (found,) = climb_all(Machine(train), [position], Options(), TOLERANCE)
    if isinstance(found, Refused):
        raise found
    return found
