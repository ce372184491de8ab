"""Random numbers as a drawing of trains needs them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TypeVar

import numpy as np

Item = TypeVar("Item")


class Dice:
    """Random numbers that depend on a seed and on the number of a train, and on nothing else."""

    def __init__(self, seed: int, number: int) -> None:
        self._draw = np.random.default_rng([seed, number])

    def chance(self, part: float) -> bool:
        """Tell whether something of this probability happens."""
        return bool(self._draw.random() < part)

    def pick(self, options: Sequence[Item]) -> Item:
        """One of several, each as likely."""
        return options[int(self._draw.integers(len(options)))]

    def some(self, options: Sequence[Item], part: float) -> list[Item]:
        """Those of several that are chosen, each with this probability."""
        return [option for option in options if self.chance(part)]

    def count(self, low: int, high: int) -> int:
        """A whole number between two, both included."""
        return int(self._draw.integers(low, high + 1))

    def between(self, low: float, high: float) -> float:
        """A number between two."""
        return float(self._draw.uniform(low, high))

    def spread(self, decades: float) -> float:
        """A factor, log-uniform over this many decades to either side of 1."""
        return float(10.0 ** self._draw.uniform(-decades, decades))

    def angle(self) -> float:
        """An angle of a whole turn [rad]."""
        return self.between(0.0, math.tau)


def metres(value: float) -> str:
    """A length [m] as a case writes it."""
    return f"{value!r} m"


def radians(value: float) -> str:
    """An angle [rad] as a case writes it."""
    return f"{value!r} rad"
