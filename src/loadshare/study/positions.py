"""What studies share: cases prepared for them, groups of identical positions, certified answers."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from contextlib import suppress
from pathlib import Path

from loadshare.case import Case
from loadshare.case.keys import Path as Key
from loadshare.case.keys import parse
from loadshare.case.reader import opened
from loadshare.errors import Refused
from loadshare.job.answer import Answer
from loadshare.job.ladder import climb, climb_all
from loadshare.job.machine import Machine
from loadshare.settings import CERTIFY
from loadshare.solver import Options
from loadshare.study.parameter import split_outside
from loadshare.tooth import affects_laws, resolve, with_own_laws
from loadshare.train.situations import VARYING, situation_of
from loadshare.train.train import Train


def loaded(case: Case | str | Path, varied: Iterable[str] = ()) -> Case:
    """Return a case with its mesh laws computed, read from its file if a path is given.

    Laws that may depend on a varied input are left to be computed for each of its values, except
    those of which a number itself varies.

    Parameters
    ----------
    case : Case or path
    varied : iterable of str
        Key paths and patterns of the varied inputs; several may be joined by ``=``.
    """
    paths = paths_of(varied)
    own = with_own_laws(opened(case), paths)
    return own if any(map(affects_laws, paths)) else resolve(own)


def paths_of(varied: Iterable[str]) -> list[Key]:
    """Return the paths of keys and patterns; several may be joined by ``=``."""
    paths: list[Key] = []
    for part in (part for key in varied for part in split_outside(key, "=")):
        # A text that is not a key path is reported where it is used.
        with suppress(ValueError):
            paths.append(parse(part))
    return paths


def alike(trains: Iterable[Train], positions: Iterable[int]) -> list[list[int]]:
    """Group positions whose mechanics are identical in each of the trains."""
    trains = list(trains)
    groups: dict[tuple[object, ...], list[int]] = {}
    for position in positions:
        key = tuple(_situation(train, position) for train in trains)
        groups.setdefault(key, []).append(position)
    return list(groups.values())


def _situation(train: Train, position: int) -> tuple[object, ...]:
    """Return the data of a position that decide its mechanics, for comparison."""
    if train.is_placed_anew:
        return (position,)
    situation = situation_of(train, position)
    return tuple(getattr(situation, name).tobytes() for name in VARYING)


BACKEND = Options(solver="clarabel")
"""For trains that remember slip: the fast method handles holonomic friction only."""


def certified(train: Train, position: int) -> Answer:
    """Solve and certify a position of a train.

    Raises
    ------
    Refused
        If it has no certified equilibrium, or the displacements are too large.
    """
    return each_certified(train, [position])[0]


def each_certified(train: Train, positions: Sequence[int]) -> list[Answer]:
    """Solve and certify several positions of a train together.

    Raises
    ------
    Refused
        As `certified`, for the first position that is refused.
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
