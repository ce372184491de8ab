"""Time inside a peer's compiled calls, without the Python code around them."""

from __future__ import annotations

import time
from collections.abc import Callable
from statistics import median
from typing import Any, TypeVar

Returned = TypeVar("Returned")
TRIALS = 501
"""Number of empty calls from which the cost of reading the clock is found."""


class Clock:
    """Sum of the time inside calls, and of the time that solvers report.

    Attributes
    ----------
    wall, cpu : int
        Elapsed and processor time inside the calls, less the cost of reading the clock [ns].
    reported : float
        Time that the solver itself reports [s]; it may not include updates of its data.
    """

    def __init__(self) -> None:
        self._cost = (0, 0)
        looks = []
        for _ in range(TRIALS):
            self.reset()
            self.call(int)
            looks.append((self.wall, self.cpu))
        self._cost = (int(median(w for w, _ in looks)), int(median(c for _, c in looks)))
        self.reset()

    def reset(self) -> None:
        """Reset all times to zero."""
        self.wall = self.cpu = 0
        self.reported = 0.0

    def call(self, function: Callable[..., Returned], *args: Any, **how: Any) -> Returned:
        """Call a function of an extension module, and add the time that it takes."""
        cpu, wall = time.process_time_ns(), time.perf_counter_ns()
        found = function(*args, **how)
        wall, cpu = time.perf_counter_ns() - wall, time.process_time_ns() - cpu
        self.wall += wall - self._cost[0]
        self.cpu += cpu - self._cost[1]
        return found

    def report(self, seconds: Any) -> None:
        """Add the time that a solver reports, if it reports any."""
        self.reported += float(seconds or 0.0)
