"""A stress problem: a case, with the level of the knob that makes it hard."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from benchmarks.stress.workbench import Workbench
from loadshare.case import Case

COUNT = 200
"""Number of problems of a family."""

Build = Callable[[float, np.random.Generator], Workbench]


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """One problem of a family.

    Attributes
    ----------
    family : str
    number : int
        0-based.
    level : float
        Level of the family's knob.
    case : Case
        With one position.
    """

    family: str
    number: int
    level: float
    case: Case

    @property
    def name(self) -> str:
        """Family and number, as ``light-load 17``."""
        return f"{self.family} {self.number}"


@dataclass(frozen=True, slots=True, eq=False)
class Family:
    """Problems of one kind, from harmless to extreme.

    Attributes
    ----------
    name : str
        Name on the command line.
    title : str
        Title in the picture.
    knob : str
        The quantity that is varied.
    levels : tuple of float
        From harmless to extreme; the problems are spread evenly over them.
    build : callable
        Builds a problem from a level and a random generator.
    count : int
        Number of problems.
    """

    name: str
    title: str
    knob: str
    levels: tuple[float, ...]
    build: Build
    count: int = COUNT

    def level(self, number: int) -> float:
        """Level of problem `number` (0-based)."""
        return self.levels[number * len(self.levels) // self.count]

    def problem(self, number: int) -> Problem:
        """Build problem `number` (0-based); the same one every time.

        Raises
        ------
        IndexError
            If there is no such problem.
        """
        if not 0 <= number < self.count:
            last = self.count - 1
            raise IndexError(f"problem {number}: family {self.name} has problems 0 to {last}")
        level = self.level(number)
        generator = np.random.default_rng([zlib.crc32(self.name.encode()), number])
        case = self.build(level, generator).case(f"{self.name} {number}")
        return Problem(self.name, number, level, case)

    def problems(self, every: int = 1) -> Iterator[Problem]:
        """Build every problem, or every `every`-th."""
        for number in range(0, self.count, every):
            yield self.problem(number)
