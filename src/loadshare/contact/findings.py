"""What a solve can find instead of an answer, and how long it may look."""

import math
from dataclasses import dataclass


class Unsolved(RuntimeError):  # noqa: N818 -- a finding, not a fault
    """A programme has no answer, or none was found; the message says which."""


@dataclass(slots=True)
class Work:
    """Newton steps of exact solves that are left to those who look for one answer."""

    left: float = math.inf

    def step(self) -> None:
        """Take one.

        Raises
        ------
        Unsolved
            If none is left.
        """
        if self.left <= 0:
            raise Unsolved("no consistent active set was found in the steps allowed")
        self.left -= 1
