"""Random numbers for drawing random trains."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TypeVar

import numpy as np

Item = TypeVar("Item")


class Dice:
    """Random numbers that depend only on a seed and on the number of a train."""

    def __init__(self, seed: int, number: int) -> None:
        self._draw = np.random.default_rng([seed, number])

    def chance(self, part: float) -> bool:
        """Return True with the given probability."""
        return bool(self._draw.random() < part)

    def pick(self, options: Sequence[Item]) -> Item:
        """Return one of several options, each equally likely."""
        return options[int(self._draw.integers(len(options)))]

    def some(self, options: Sequence[Item], part: float) -> list[Item]:
        """Return a random selection of options, each chosen with the given probability."""
        return [option for option in options if self.chance(part)]

    def count(self, low: int, high: int) -> int:
        """Return a whole number between two, both included."""
        return int(self._draw.integers(low, high + 1))

    def between(self, low: float, high: float) -> float:
        """Return a number between two."""
        return float(self._draw.uniform(low, high))

    def spread(self, decades: float) -> float:
        """Return a factor, log-uniform over the given number of decades on either side of 1."""
        return float(10.0 ** self._draw.uniform(-decades, decades))

    def angle(self) -> float:
        """Return an angle within a whole turn [rad]."""
        return self.between(0.0, math.tau)


def metres(value: float) -> str:
    """Return a length [m] as it is written in a case."""
    return f"{value!r} m"


def radians(value: float) -> str:
    """Return an angle [rad] as it is written in a case."""
    return f"{value!r} rad"
