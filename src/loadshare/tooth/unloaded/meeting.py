"""Whether the teeth of a misaligned pair meet at every position of the mesh cycle."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING

import numpy as np

from loadshare.errors import Problem
from loadshare.tooth.geometry.gap import NoContactError
from loadshare.tooth.unloaded.positions import Pair, touching
from loadshare.tooth.words import plain, problem

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

POSITIONS = 16
"""Positions of the mesh cycle that are looked at."""


def meeting_problems(pair: Pair, misalignment: DataclassInstance) -> list[Problem]:
    """The problem of a misalignment with which no teeth meet at some position; none without one."""
    values = {part.name: getattr(misalignment, part.name) for part in fields(misalignment)}
    off = {name: value for name, value in values.items() if value}
    if not off:
        return []
    try:
        touching(pair, list(np.arange(POSITIONS) / POSITIONS))
    except NoContactError as error:
        name, value = next(iter(off.items()))
        alone = len(off) == 1
        key, given = (f"misalignment.{name}", plain(value)) if alone else ("misalignment", "")
        return [problem(key, given, str(error), "less; wider faces or longer teeth help too")]
    return []
