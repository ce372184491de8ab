"""Cases as a study takes them, and positions that differ in nothing."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from loadshare.case import Case, load_case
from loadshare.tooth import resolve
from loadshare.train.situations import VARYING, situation_of
from loadshare.train.train import Train


def loaded(case: Case | str | Path) -> Case:
    """Return a case, read from its file if a path is given, its mesh laws computed."""
    return resolve(case if isinstance(case, Case) else load_case(case))


def alike(trains: Iterable[Train], positions: Iterable[int]) -> list[list[int]]:
    """Group positions that differ in nothing that bears on the mechanics, in any of the trains."""
    trains = list(trains)
    groups: dict[tuple[object, ...], list[int]] = {}
    for position in positions:
        key = tuple(_situation(train, position) for train in trains)
        groups.setdefault(key, []).append(position)
    return list(groups.values())


def _situation(train: Train, position: int) -> tuple[object, ...]:
    """What a position brings, as something to compare."""
    if train.is_placed_anew:
        return (position,)
    situation = situation_of(train, position)
    return tuple(getattr(situation, name).tobytes() for name in VARYING)
